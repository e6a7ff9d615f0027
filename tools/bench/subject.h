#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "burnish/precompute/bake.h"
#include "common/scene_input.h"
#include "common/work.h"
#include "harness/error_metrics.h"
#include "harness/procedural_scenes.h"
#include "harness/render.h"

/// What the stations measure on: a scene and the studio's light, and the truth about both.
namespace burnish::tools {

/// Dials of what is measured on.
struct SubjectOptions {
  std::string name = "sphere";  ///< a procedural scene's name or a mesh file
  BakeOptions bake;
  int reference_samples = 256;  ///< a vertex
  std::uint64_t seed = 1;
};

/// Declares SCENE|MESH, --reference, --seed and the bake's dials.
void add_subject_options(CLI::App& app, SubjectOptions& options);

/// The procedural studio, as it is and ready for shading.
struct StudioLight {
  Image map;
  PreparedLights lights;
  PrefilteredEnvironment filtered;

  Lighting lighting() const { return {&lights, &filtered}; }
};
StudioLight make_studio_light(const PreparedTransfer& transfer, const ShadingOptions& options,
                              Work& work);

/// How far the shaded vertices are from the truth under the studio's light, seen from `eye`.
RelativeL2 vertex_error(const Subject& subject, const StudioLight& studio, const Vector3f& eye,
                        const ShadingOptions& shading, const SubjectOptions& options, Work& work);

}  // namespace burnish::tools
