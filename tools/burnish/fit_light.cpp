#include "burnish/precompute/fit_light.h"

#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/light_file.h"
#include "burnish/light/environment_map.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/work.h"
#include "look_options.h"

namespace burnish::tools {
namespace {

struct Options {
  std::string environment;
  std::string output;
  LightFitOptions fit;
  CommonOptions common;
};

void run(const Options& options) {
  require_writable(std::vector{options.output, options.common.report});
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
  write_json(options.common.report, {{"environment", options.environment},
                                     {"output", options.output},
                                     {"lobes", fit.rig.lobes.size()},
                                     {"relative_l2", fit.error.relative_l2},
                                     {"irradiance_relative_l2", fit.error.irradiance_relative_l2},
                                     {"iterations", fit.iterations},
                                     {"seconds", seconds},
                                     {"machine", machine_record(work.threads())}});
  work.print(
      fmt::format("{} lobes in {:.1f} s; relative L2 error: radiance {:.1f} %, irradiance {:.1f} %",
                  fit.rig.lobes.size(), seconds, 100 * fit.error.relative_l2,
                  100 * fit.error.irradiance_relative_l2));
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
  add_number(app, "--lobes", "N", options->fit.lobes, {1, 128}, "lights to fit, at most");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
