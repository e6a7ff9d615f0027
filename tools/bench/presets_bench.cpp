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
#include "tradeoff/pareto.h"
#include "tradeoff/preset_choice.h"
#include "tradeoff/trial.h"

namespace burnish::tools {
namespace {

struct Options {
  std::vector<std::string> scenes = paper_scene_names();
  std::string environment = kStudioName;
  int views = 2;
  BakeOptions bake;
  TrialOptions trial;
  BenchOptions bench;
};

void measure_on(const std::string& name, const Options& options, Work& work,
                std::vector<PresetCandidate>& candidates) {
  TrialScene scene;
  scene.scene = load_subject(name);
  scene.environment = options.environment;
  scene.map = load_environment(options.environment, work);
  scene.eyes = eyes_around(scene.scene.camera, options.views);
  Trial trial(std::move(scene), options.trial, work.progress());
  for (PresetCandidate& candidate : candidates) {
    throw_if_interrupted();
    Settings settings;
    settings.bake = options.bake;
    settings.shading = candidate.shading;
    const TrialOutcome outcome = trial.run(settings);
    candidate.frame_ms.push_back(outcome.frame_ms);
    candidate.relative_l2.push_back(outcome.error.without_noise);
  }
}

BenchRow row_of(const std::string& what, const PresetCandidate& candidate, const PresetMean& mean,
                const std::vector<std::string>& scenes) {
  BenchRow row = {
      {"what", what}, {"settings", candidate.name}, {"cost", mean.cost}, {"error", mean.error}};
  for (size_t i = 0; i < scenes.size(); ++i) {
    row[scenes[i] + "_ms"] = candidate.frame_ms[i];
    row[scenes[i]] = candidate.relative_l2[i];
  }
  return row;
}

void run(const Options& options) {
  check_bake_options(options.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  std::vector<PresetCandidate> candidates = preset_candidates();
  for (const std::string& scene : options.scenes) measure_on(scene, options, work, candidates);
  const std::vector<PresetMean> means = preset_means(candidates);
  std::vector<BenchRow> rows;
  const auto add = [&](const std::string& what, size_t i) {
    if (i == candidates.size()) return;  // nothing fits the budget
    rows.push_back(row_of(what, candidates[i], means[i], options.scenes));
  };
  add("fast", most_accurate_within(means, kFastBudget));
  add("balanced", most_accurate_within(means, kBalancedBudget));
  add("accurate", most_accurate_within(means, kAccurateBudget));
  std::vector<TradePoint> points;
  for (const PresetMean& mean : means) points.push_back({mean.cost, mean.error});
  for (const size_t i : pareto_front(points)) add("front", i);
  for (size_t i = 0; i < means.size(); ++i) add("all", i);
  report_bench("presets", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_presets_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("SCENES", options->scenes, "built-in scenes or mesh files")
      ->option_text("[SCENE...]")
      ->capture_default_str();
  add_file(app, "--env", "MAP", options->environment,
           fmt::format("lat-long environment, or {} (the default)", kStudioName));
  add_number(app, "--vertices", "N", options->trial.vertices, {1, 10'000'000, ""},
             "drawn for each view, on which errors are measured");
  add_number(app, "--views", "N", options->views, {1, 64}, "around each scene's camera");
  add_number(app, "--noise", "E", options->trial.truth.noise, {0.0001, 1, ""},
             "of the truth, relative L2, at which its sampling stops");
  add_number(app, "--frames", "N", options->trial.frames, {1, 1000},
             "timed for each view; the shortest counts");
  add_bake_options(app, options->bake);
  add_report_options(app, options->bench);
  add_number(app, "--threads", "N", options->bench.threads, {0, 1024},
             "worker threads, 0 for all of the machine");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
