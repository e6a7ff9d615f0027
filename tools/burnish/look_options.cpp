#include "look_options.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/light/local_lights.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/program.h"
#include "common/settings_option.h"
#include "harness/parallel_prefilter.h"
#include "harness/studio_environment.h"

namespace burnish::tools {
namespace {

void add_lobes_option(CLI::App& app, LookOptions& options) {
  add_number(app, "--lobes", "N", options.fit.lobes, {1, 128}, "lights to fit without --lights");
}

/// All dials of shading.
void add_dials(CLI::App& app, LookOptions& options) {
  add_shading_options(app, options.shading);
  add_number(app, "--terms", "N", options.shading.terms, {0, 1024},
             "PCA terms used, at most those baked; 0 for all");
  add_choice(app, "--specular-from", options.specular_from_map, {{"map", true}, {"lobes", false}},
             "what highlights reflect: the environment map or the fitted lights");
}

void add_light_options(CLI::App& app, LookOptions& options) {
  add_file(app, "--env", "ENV", options.environment,
           fmt::format("lat-long environment map, .exr or .hdr, or '{}' for the built-in one; "
                       "may be left out when --lights is given",
                       kStudioName));
  add_file(app, "--lights", "FILE.json", options.lights,
           "lights to use, as fit-light writes them (default: fitted to ENV)");
  add_lobes_option(app, options);
  add_number(app, "--rotate-env", "DEG", options.rotate_deg, {-3600, 3600, "degrees"},
             "turns the environment about the upward axis, counter-clockwise from above");
  add_choice(app, "--up", options.up, {{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}},
             "the mesh's upward axis");
}

/// The light file's rig in the environment's frame, or one fitted to the environment.
LightFile load_lights(const LookOptions& options, const Image& environment, Work& work,
                      nlohmann::ordered_json& report) {
  if (!options.lights.empty()) {
    report["lights"] = options.lights;
    return read_lights(options.lights);
  }
  const Stopwatch watch;
  const LightFit fit = fit_light(environment, options.fit, work.progress());
  report["fit_s"] = watch.seconds();
  report["fit_relative_l2"] = fit.error.relative_l2;
  LightFile file;
  file.rig = fit.rig;
  return file;
}

/// Lights of a file are sound as read; those fitted to a map of extreme values may be too bright.
PreparedLights checked_lights(const LightRig& rig, const PreparedTransfer& transfer,
                              const LookOptions& options) {
  try {
    return prepare_lights(rig, transfer, options.shading);
  } catch (const std::invalid_argument& error) {
    throw Error(ErrorKind::input, options.lights.empty() ? options.environment : options.lights,
                error.what());
  }
}

/// The textures of the material, at the transfer's vertices.
std::optional<VaryingSubject> load_textures(const LookOptions& options,
                                            const MaterialFile& material,
                                            const Transfer& transfer) {
  if (material.textures.empty()) return {};
  if (transfer.texcoords.empty())
    throw Error(ErrorKind::input, options.transfer,
                fmt::format("has no texture coordinates (UVs), expected some for the textures of "
                            "{}: bake a mesh that has them",
                            options.material.name));
  const MaterialPictures pictures = read_material_pictures(material, options.material.name);
  return varying_subject(transfer,
                         make_material_maps(material.material, pictures, material.textures.wrap));
}

void scale_map(Image& environment, float factor, const LookOptions& options) {
  float most = 0;
  for (Rgb& pixel : environment.pixels) {
    pixel *= factor;
    most = std::max(most, pixel.maxCoeff());
  }
  if (most > kMaxRadiance)
    throw Error(ErrorKind::input, options.environment,
                fmt::format("a radiance of {} with a scale of {}, expected at most {}", most,
                            factor, kMaxRadiance));
}

}  // namespace

void add_look_options(CLI::App& app, LookOptions& options) {
  add_file(app, "FILE.h5", "FILE.h5", options.transfer, "transfer file of bake (required)")
      ->required();
  add_settings_option(app, {{&SettingsFile::lights, "lights",
                             [&options](CLI::App& dials) { add_lobes_option(dials, options); }},
                            {&SettingsFile::shading, "shading",
                             [&options](CLI::App& dials) { add_dials(dials, options); }}});
  add_light_options(app, options);
  add_material_options(app, options.material);
  add_parsed(app, "--camera", "CAMERA",
             "ox,oy,oz,tx,ty,tz,fov: eye and target in mesh units, vertical field of view in "
             "degrees, above 0, below 180 (default: frames the mesh)",
             "seven numbers ox,oy,oz,tx,ty,tz,fov with different eye and target and fov above 0, "
             "below 180",
             [&options](const std::string& found) {
               try {
                 parse_camera(found);
               } catch (const std::invalid_argument&) {
                 return false;
               }
               options.camera = found;
               return true;
             });
  add_dials(app, options);
}

Look load_look(const LookOptions& options, Work& work) {
  if (options.environment.empty() && options.lights.empty())
    throw UsageError("no light given, expected --env or --lights");
  Look look;
  const MaterialFile material = load_material(options.material);
  look.material = material.material;
  look.transfer = read_transfer(options.transfer);
  throw_if_interrupted();
  if (!look.transfer.bases.empty() && options.shading.terms > look.transfer.terms())
    throw UsageError(fmt::format("--terms: found {}, expected at most the {} that {} holds",
                                 options.shading.terms, look.transfer.terms(), options.transfer));
  look.prepared = prepare_transfer(look.transfer);
  look.varying = load_textures(options, material, look.transfer);
  throw_if_interrupted();
  if (!options.environment.empty()) look.environment = load_environment(options.environment, work);

  look.report = {{"transfer", options.transfer},
                 {"environment", options.environment},
                 {"material", options.material.name}};
  LightFile lights = load_lights(options, look.environment, work, look.report);
  throw_if_interrupted();
  // A light file's own rotation and scale change lights and map alike, so that they stay the same
  // light.
  lights.world_from_environment =
      world_from_environment(up_direction(options.up), options.rotate_deg) *
      lights.world_from_environment;
  look.world_from_environment = lights.world_from_environment;
  look.rig = world_lights(lights);
  look.lights = checked_lights(look.rig, look.prepared, options);
  scale_map(look.environment, lights.scale, options);
  look.report["lobes"] = look.rig.lobes.size();
  look.report["directional_lights"] = look.rig.directionals.size();
  look.report["sphere_lights"] = look.rig.spheres.size();
  look.report["rectangle_lights"] = look.rig.rectangles.size();

  const bool has_map = !look.environment.pixels.empty();
  look.specular_from_map = options.specular_from_map && has_map;
  if (look.specular_from_map && look.material.has_specular()) {
    const Stopwatch watch;
    look.filtered = prefilter_in_parallel(look.environment);
    look.filtered.environment_from_world = look.world_from_environment.transpose();
    look.report["prefilter_s"] = watch.seconds();
  }
  throw_if_interrupted();
  return look;
}

Camera look_camera(const LookOptions& options, const Transfer& transfer, float aspect) {
  const Vector3f up = up_direction(options.up);
  if (!options.camera.empty()) return parse_camera(options.camera, up);
  Eigen::AlignedBox3f box;
  for (const Vector3f& position : transfer.positions) box.extend(position);
  return frame_bounds(box.min(), box.max(), aspect, up);
}

}  // namespace burnish::tools
