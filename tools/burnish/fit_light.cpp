#include "burnish/precompute/fit_light.h"

#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/light/environment_map.h"
#include "commands.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/settings_option.h"
#include "common/work.h"
#include "harness/light_picture.h"
#include "look_options.h"

namespace burnish::tools {
namespace {

struct Options {
  std::string environment;
  std::string output;
  std::string preview;
  float exposure_stops = 0;  ///< beyond the preview's own
  LightFitOptions fit;
  CommonOptions common;
};

void write_preview(const Options& options, const Image& environment, const LightRig& rig) {
  if (options.preview.empty()) return;
  const float stops = picture_exposure_stops(environment) + options.exposure_stops;
  write_png(draw_light_fit(environment, rig, stops), options.preview);
}

std::string summary(const LightFit& fit, const LightFitOptions& options, double seconds) {
  std::string text =
      fmt::format("{} lobes in {:.1f} s; relative L2 error: radiance {:.1f} %, irradiance {:.1f} %",
                  fit.rig.lobes.size(), seconds, 100 * fit.error.relative_l2,
                  100 * fit.error.irradiance_relative_l2);
  if (!fit.met_target)
    text += fmt::format("; the target of {:g} % is not met", 100 * options.target_error);
  return text;
}

void run(const Options& options) {
  require_writable(std::vector{options.output, options.preview, options.common.report});
  Work work(options.common);
  const Image environment = load_environment(options.environment, work);
  const Stopwatch watch;
  const LightFit fit = fit_light(environment, options.fit, work.progress());
  const double seconds = watch.seconds();
  throw_if_interrupted();

  LightFile file;
  file.source = std::filesystem::path(options.environment).filename().string();
  file.fit_relative_l2 = fit.error.relative_l2;
  file.fit_irradiance_relative_l2 = fit.error.irradiance_relative_l2;
  file.rig = fit.rig;
  write_lights(file, options.output);
  write_preview(options, environment, fit.rig);
  write_json(options.common.report, {{"environment", options.environment},
                                     {"output", options.output},
                                     {"lobes", fit.rig.lobes.size()},
                                     {"relative_l2", fit.error.relative_l2},
                                     {"irradiance_relative_l2", fit.error.irradiance_relative_l2},
                                     {"met_target", fit.met_target},
                                     {"iterations", fit.iterations},
                                     {"seconds", seconds},
                                     {"machine", machine_record(work.threads())}});
  work.print(summary(fit, options.fit, seconds));
}

}  // namespace

std::function<void()> declare_fit_light(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_file(app, "ENV", "ENV", options->environment,
           "lat-long environment map, .exr or .hdr, or 'studio' for the built-in one (required)")
      ->required();
  add_file(app, "-o,--output", "FILE.json", options->output, "light file to write (required)",
           ".json")
      ->required();
  LightFitOptions& fit = options->fit;
  const auto add_lobes = [options](CLI::App& dials) {
    add_number(dials, "--lobes", "N", options->fit.lobes, {1, 128}, "lights to fit, at most");
  };
  add_settings_option(app, {{&SettingsFile::lights, "lights", add_lobes}});
  add_lobes(app);
  add_number(
      app, "--target-error", "E", fit.target_error, {0.0, 1.0},
      "relative L2 error of the radiance: lights are added until it is met (0: all of them)");
  app.add_flag("--isotropic", fit.isotropic,
               "round lobes only, as spherical Gaussians, to compare with");
  app.add_flag("--signed", fit.signed_colors, "lights may be negative");
  add_number(app, "--cells", "N", fit.cells, {256, 16384}, "areas the map is averaged over");
  add_number(app, "--irradiance-weight", "W", fit.irradiance_weight, {0.0, 1e6},
             "of the irradiance's error against that of the radiance");
  add_file(app, "--preview", "FILE.png", options->preview,
           "writes the map, the lights with an ellipse each, and their difference side by side",
           ".png");
  add_number(app, "--exposure", "EV", options->exposure_stops, {-40, 40, "stops"},
             "brightens the preview, beyond the map's typical radiance at middle grey");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
