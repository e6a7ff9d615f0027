#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "burnish/formats/mesh_frames.h"
#include "burnish/precompute/fit_light.h"
#include "burnish/shading/shade.h"
#include "common/work.h"
#include "harness/camera.h"
#include "harness/picture.h"
#include "harness/primary_hits.h"
#include "harness/reference_integrator.h"
#include "material_options.h"

namespace burnish::tools {

/// What render and shade have in common: light, material, viewpoint and the dials of the shading.
struct LookOptions {
  std::string transfer;
  std::string environment;  ///< file, or kStudioName
  std::string lights;       ///< light file; empty: fitted to the environment
  LightFitOptions fit;
  float rotate_deg = 0;
  UpAxis up = UpAxis::y;
  MaterialOptions material;
  bool specular_from_map = true;
  ShadingOptions shading;
  std::string camera;  ///< "ox,oy,oz,tx,ty,tz,fov"; empty: frames the mesh
};

/// Declares all of them; FILE.h5 is the first positional.
void add_look_options(CLI::App& app, LookOptions& options);

/// A baked mesh and all that lights it.
struct Look {
  Transfer transfer;
  PreparedTransfer prepared;
  Material material;                       ///< where nothing varies
  std::optional<VaryingSubject> varying;   ///< of a material with textures
  Image environment;                       ///< no pixels without --env
  Eigen::Matrix3f world_from_environment;  ///< of `environment`
  LightRig rig;                            ///< in the world
  PreparedLights lights;                   ///< of `rig`
  PrefilteredEnvironment filtered;
  bool specular_from_map = true;
  nlohmann::ordered_json report;  ///< what was read and how long it took

  /// These refer to the object.
  Subject subject() const {
    return {&transfer, {&material, 1}, {}, varying ? &*varying : nullptr, &prepared};
  }
  Lighting lighting() const { return {&lights, specular_from_map ? &filtered : nullptr}; }
  EnvironmentLight environment_light() const {
    return {environment.pixels.empty() ? nullptr : &environment, world_from_environment};
  }
  ReferenceLights reference_lights() const {
    return {environment_light(), rig.spheres, rig.directionals, rig.rectangles};
  }
};

/// Reads, fits and filters what the options name. Throws UsageError where they contradict each
/// other.
Look load_look(const LookOptions& options, Work& work);

/// The camera of --camera, or one that frames the transfer's vertices.
Camera look_camera(const LookOptions& options, const Transfer& transfer, float aspect);

}  // namespace burnish::tools
