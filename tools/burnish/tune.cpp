#include <memory>

#include <fmt/format.h>

#include "burnish/formats/settings_file.h"
#include "commands.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/program.h"
#include "common/scene_input.h"
#include "common/work.h"
#include "material_options.h"
#include "tradeoff/tuner.h"

namespace burnish::tools {
namespace {

struct Options {
  std::string mesh, environment, output;
  MaterialOptions material;
  CLI::Option* material_option = nullptr;
  TuneTarget target;
  Settings base;
  int views = kTuningViews, vertices = 1000;
  double noise = 0.01;
  CommonOptions common;
};

TrialScene load_scene(const Options& options, Work& work) {
  ProceduralScene scene = load_subject(options.mesh);
  if (options.material_option->count() > 0 || scene.material_id.empty()) {
    scene.materials = {load_material(options.material).material};
    scene.material_id.clear();
  }
  return tuning_scene(std::move(scene), options.environment,
                      load_environment(options.environment, work), options.views);
}

nlohmann::ordered_json outcome_json(const TrialOutcome& outcome) {
  return {{"frame_ms", outcome.frame_ms},
          {"prepare_ms", outcome.prepare_ms},
          {"relative_l2", outcome.error.without_noise},
          {"truth_noise", outcome.error.truth_noise},
          {"bake_s", outcome.bake_s},
          {"file_bytes", outcome.file_bytes},
          {"bytes_per_vertex", outcome.bytes_per_vertex}};
}

nlohmann::ordered_json report_of(const TuneResult& result) {
  nlohmann::ordered_json tried = nlohmann::ordered_json::array();
  for (const TriedPoint& point : result.tried) {
    nlohmann::ordered_json json = {{"name", point.point.name}};
    json.update(outcome_json(point.outcome));
    if (point.check) json["check"] = outcome_json(*point.check);
    tried.push_back(json);
  }
  return tried;
}

std::string text_of(const TriedPoint& tried) {
  const TrialOutcome& outcome = tried.check ? *tried.check : tried.outcome;
  return fmt::format(
      "{}: {:.3g} % of error, {:.3g} ms a frame, {} B a vertex, {} of file, {:.3g} s "
      "to bake",
      tried.point.name, 100 * promised_error(outcome), outcome.frame_ms, outcome.bytes_per_vertex,
      bytes_text(static_cast<double>(outcome.file_bytes)), outcome.bake_s);
}

std::string target_text(const TuneTarget& target) {
  return target.error > 0 ? fmt::format("an error of {:.3g} %", 100 * target.error)
                          : fmt::format("{:.3g} ms a frame", target.ms);
}

void check_usage(const Options& options) {
  check_bake_options(options.base.bake);
  if ((options.target.error > 0) == (options.target.ms > 0))
    throw UsageError("expected one of --target-error and --target-ms");
}

void run(const Options& options) {
  check_usage(options);
  require_writable(std::array{options.output, options.common.report});
  Work work(options.common);
  const Progress progress = work.progress();
  TrialOptions trial_options;
  trial_options.vertices = options.vertices;
  trial_options.truth.noise = options.noise;
  TrialScene scene = load_scene(options, work);
  const std::vector<Material> materials = scene.scene.materials;
  Trial trial(std::move(scene), trial_options, progress);
  const std::vector<GridPoint> grid = tuning_grid(materials, {options.base});
  const auto step = [&](size_t done, size_t of) {
    throw_if_interrupted();
    if (progress) progress("tune", done, of);
  };
  const TuneResult result =
      tune(grid, options.target,
           {[&](const Settings& settings) { return trial.run(settings); },
            [&](const Settings& settings) { return trial.check(settings); }, step});
  nlohmann::ordered_json report = {{"mesh", options.mesh},
                                   {"environment", options.environment},
                                   {"target_error", options.target.error},
                                   {"target_ms", options.target.ms},
                                   {"met", result.chosen.has_value()},
                                   {"tried", report_of(result)},
                                   {"machine", machine_record(work.threads())}};
  if (result.chosen) report["chosen"] = *result.chosen;
  write_json(options.common.report, report);
  if (!result.chosen)
    throw CheckFailed(fmt::format("{} is out of reach; nearest is {}", target_text(options.target),
                                  text_of(result.tried[*result.nearest])));
  const TriedPoint& chosen = result.tried[*result.chosen];
  SettingsFile file = settings_file(chosen.point.settings);
  file.source = fmt::format("burnish tune {} {} for {}; expected {}", options.mesh,
                            options.environment, target_text(options.target), text_of(chosen));
  write_settings(file, options.output);
  work.print(fmt::format("{} of {} settings tried", result.tried.size(), grid.size()));
  work.print(fmt::format("{}: {}", options.output, text_of(chosen)));
}

}  // namespace

std::function<void()> declare_tune(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_file(app, "MESH", "MESH", options->mesh,
           "mesh file, or the name of a built-in scene of demo (required)")
      ->required();
  add_file(app, "ENV", "ENV", options->environment,
           "lat-long environment map, .exr or .hdr, or 'studio' for the built-in one (required)")
      ->required();
  add_file(app, "-o,--output", "FILE.json", options->output, "settings to write (required)",
           ".json")
      ->required();
  add_bake_options(app, options->base.bake);
  // Found, not given; and the bake's own target.
  for (const char* found : {"--terms", "--target-error"}) app.remove_option(app.get_option(found));
  add_number(app, "--target-error", "E", options->target.error, {0.0, 10.0},
             "relative L2 error of the vertices' radiance: the fastest settings below it");
  add_number(app, "--target-ms", "T", options->target.ms, {0.0, 1e6, "ms"},
             "time of a frame, lights included: the most accurate settings below it");
  add_material_options(app, options->material);
  options->material_option = app.get_option("--material");
  add_number(app, "--views", "N", options->views, {1, 16}, "eyes around the mesh");
  add_number(app, "--vertices", "N", options->vertices, {0, 1 << 24},
             "vertices that errors are measured on for each view, 0 for all");
  add_number(app, "--noise", "E", options->noise, {0.0, 1.0},
             "of the Monte Carlo truth, as a relative L2 error");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
