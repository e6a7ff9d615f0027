#include <memory>

#include <fmt/format.h>

#include "bench.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/program.h"
#include "common/work.h"
#include "stations.h"
#include "subject.h"
#include "tradeoff/tuner.h"

namespace burnish::tools {
namespace {

struct Options {
  std::vector<std::string> scenes = paper_scene_names();
  std::string environment = kStudioName;
  std::vector<double> errors = {0.10, 0.05, 0.025};
  std::vector<double> ms = {};
  int views = kTuningViews;
  Settings base;
  TrialOptions trial;
  double whole_noise = 0.05;
  BenchOptions bench;
};

/// All vertices of bakes with no more terms than were chosen, seen from where tune has not looked.
TrialOptions whole_options(const Options& options) {
  TrialOptions whole = options.trial;
  whole.vertices = 0;
  whole.most_terms = 0;
  whole.truth.noise = options.whole_noise;
  whole.truth.first_samples = 16;
  return whole;
}

std::vector<Vector3f> unseen_eyes(const Camera& camera, int views) {
  const std::vector<Vector3f> all = eyes_around(camera, 4 * views);
  std::vector<Vector3f> eyes;
  for (size_t i = 1; i < all.size(); i += 4) eyes.push_back(all[i]);
  return eyes;
}

/// Whether a target was refused, or held on the whole scene.
BenchRow outcome_row(const TuneTarget& target, const TuneResult& result, Trial& whole) {
  BenchRow row;
  row["target"] = target.error > 0 ? fmt::format("{:g} %", 1e2 * target.error)
                                   : fmt::format("{:g} ms", target.ms);
  row["tried"] = result.tried.size();
  if (!result.chosen) {
    const TriedPoint& nearest = result.tried[*result.nearest];
    row["verdict"] = "refused";
    row["expected_error"] = promised_error(nearest.check ? *nearest.check : nearest.outcome);
    row["settings"] = nearest.point.name;
    return row;
  }
  const TriedPoint& chosen = result.tried[*result.chosen];
  const TrialOutcome found = whole.run(chosen.point.settings);
  const bool holds =
      target.error > 0 ? found.error.without_noise <= target.error : found.frame_ms <= target.ms;
  row["verdict"] = holds ? "kept" : "broken";
  row["expected_error"] = promised_error(*chosen.check);
  row["whole_error"] = found.error.without_noise;
  row["whole_standard_error"] = found.error.standard_error;
  row["expected_ms"] = chosen.check->frame_ms;
  row["whole_ms"] = found.frame_ms;
  row["settings"] = chosen.point.name;
  return row;
}

void add_scene(const std::string& name, const Options& options, Work& work,
               std::vector<BenchRow>& rows) {
  const Progress progress = work.progress();
  const Image map = load_environment(options.environment, work);
  TrialScene scene = tuning_scene(load_subject(name), options.environment, map, options.views);
  TrialScene unseen = scene;
  unseen.eyes = unseen_eyes(scene.scene.camera, options.views);
  unseen.check_eyes.clear();
  const std::vector<GridPoint> grid = tuning_grid(scene.scene.materials, {options.base});
  Trial trial(std::move(scene), options.trial, progress);
  Trial whole(std::move(unseen), whole_options(options), progress);
  const auto step = [&](size_t done, size_t of) {
    throw_if_interrupted();
    if (progress) progress("tune", done, of);
  };
  const TuneCalls calls = {[&](const Settings& settings) { return trial.run(settings); },
                           [&](const Settings& settings) { return trial.check(settings); }, step};
  std::vector<TuneTarget> targets;
  for (const double error : options.errors) targets.push_back({error, 0});
  for (const double ms : options.ms) targets.push_back({0, ms});
  for (const TuneTarget& target : targets) {
    BenchRow row = {{"scene", name}};
    row.update(outcome_row(target, tune(grid, target, calls), whole));
    rows.push_back(std::move(row));
  }
}

void run(const Options& options) {
  check_bake_options(options.base.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  std::vector<BenchRow> rows;
  for (const std::string& scene : options.scenes) {
    add_scene(scene, options, work, rows);
    work.print(fmt::format("{}: done", scene));
  }
  report_bench("promise", rows, options.bench, work);
  size_t broken = 0;
  for (const BenchRow& row : rows) broken += row["verdict"] == "broken";
  if (broken > 0) throw CheckFailed(fmt::format("{} promises of {} broken", broken, rows.size()));
}

}  // namespace

std::function<void()> declare_promise_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->trial.vertices = 1000;  // as tune
  app.add_option("SCENES", options->scenes, "built-in scenes or mesh files")
      ->option_text("[SCENE...]")
      ->capture_default_str();
  add_file(app, "--env", "MAP", options->environment,
           fmt::format("lat-long environment, or {} (the default)", kStudioName));
  app.add_option("--errors", options->errors, "targets: relative L2 errors of vertex radiance")
      ->option_text("E,...")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 10.0));
  app.add_option("--ms", options->ms, "targets: times of a frame, in ms")
      ->option_text("T,...")
      ->delimiter(',')
      ->check(CLI::Range(1e-6, 1e6));
  add_number(app, "--vertices", "N", options->trial.vertices, {1, 10'000'000, ""},
             "that tune draws for each view");
  add_number(app, "--views", "N", options->views, {1, 16},
             "of tune, and as many others for the whole scene");
  add_number(app, "--noise", "E", options->trial.truth.noise, {0.0001, 1, ""},
             "of tune's truth, relative L2");
  add_number(app, "--whole-noise", "E", options->whole_noise, {0.0001, 1, ""},
             "of the whole scene's truth, whose many vertices average it out");
  add_bake_options(app, options->base.bake);
  for (const char* found : {"--terms", "--target-error"}) app.remove_option(app.get_option(found));
  add_report_options(app, options->bench);
  add_number(app, "--threads", "N", options->bench.threads, {0, 1024},
             "worker threads, 0 for all of the machine");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
