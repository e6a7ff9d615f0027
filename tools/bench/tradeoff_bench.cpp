#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <regex>

#include "bench.h"
#include "burnish/formats/error.h"
#include "burnish/formats/image_file.h"
#include "burnish/formats/material_file.h"
#include "burnish/material/presets.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/program.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/sg_rival.h"
#include "harness/rivals/sh_rival.h"
#include "harness/rivals/uncompressed_rival.h"
#include "harness/rivals/unshadowed_rival.h"
#include "stations.h"
#include "subject.h"
#include "tradeoff/grid.h"
#include "tradeoff/sweep.h"
#include "tradeoff/trade_pictures.h"
#include "tradeoff/trades.h"

namespace burnish::tools {
namespace {

constexpr int kUncompressedVertices = 200;  // a megabyte each, with their ladder

struct Options {
  std::string scene = "dish";
  std::string environment = kStudioName;
  std::string material;
  BakeOptions bake;
  int views = 4;
  TrialOptions trial;
  std::string only;
  std::string folder = "tradeoff";
  FrameClock clock = FrameClock::wall;
  TradePictureOptions pictures;
  CommonOptions common;

  std::string file(const std::string& name) const {
    return (std::filesystem::path(folder) / name).string();
  }
};

Material material_named(const std::string& name) {
  if (lower_extension(name) == ".json") return read_material(name);
  const MaterialPreset* preset = find_material_preset(name);
  if (!preset)
    throw UsageError(
        fmt::format("--material: found '{}', expected a material file (.json) or a "
                    "preset (burnish info --materials lists them)",
                    name));
  return preset->material;
}

TrialScene load_scene(const Options& options, Work& work) {
  TrialScene scene;
  scene.scene = load_subject(options.scene);
  if (!options.material.empty()) {
    scene.scene.materials = {material_named(options.material)};
    scene.scene.material_id.clear();
  }
  scene.environment = options.environment;
  scene.map = load_environment(options.environment, work);
  scene.eyes = eyes_around(scene.scene.camera, options.views);
  return scene;
}

/// What a sweep holds of settings by row key, to render them again.
struct Plan {
  std::vector<SweepEntry> entries;
  std::map<std::string, Settings> settings;
};

/// Makes the entries of a plan.
class Planner {
 public:
  Planner(const Options& options, Trial& trial, const std::string& scene_key)
      : options_(options), trial_(trial), scene_key_(scene_key) {
    if (!options.only.empty()) only_ = std::regex(options.only);
  }

  void add_settings(const GridPoint& point) {
    RowKind kind = RowKind::grid;
    if (point.name.starts_with("paper")) kind = RowKind::paper;
    if (point.name == "fast" || point.name == "balanced" || point.name == "accurate")
      kind = RowKind::preset;
    const Settings& settings = point.settings;
    add(point.name, kind, settings, "", [this, settings] { return trial_.run(settings); });
  }
  /// `id` tells the rival's own dials, for the key.
  void add_rival(const std::string& name, const Settings& settings, const Trial::MakeRival& make,
                 int vertices = 0) {
    add(name, RowKind::rival, settings, name, [this, settings, make, vertices] {
      TrialOutcome outcome = trial_.run_rival(settings, make, vertices);
      if (vertices > 0) outcome.bake_s = 0;  // of a part only
      return outcome;
    });
  }
  Plan take() { return std::move(plan_); }

 private:
  void add(const std::string& name, RowKind kind, const Settings& settings, const std::string& id,
           const std::function<TrialOutcome()>& run) {
    SweepEntry entry;
    entry.row.name = name;
    entry.row.kind = kind;
    entry.row.settings = settings_json(settings);
    entry.row.key = sweep_key({scene_key_, id, entry.row.settings.dump()});
    plan_.settings[entry.row.key] = settings;
    const size_t vertices = trial_.scene().scene.mesh.positions.size();
    if (options_.only.empty() || std::regex_search(name, only_))
      entry.measure = [run, vertices] {
        throw_if_interrupted();
        return sweep_row(run(), vertices);
      };
    plan_.entries.push_back(std::move(entry));
  }

  const Options& options_;
  Trial& trial_;
  std::string scene_key_;
  std::regex only_;
  Plan plan_;
};

void add_rivals(Planner& planner, const Settings& base, Work& work) {
  const auto progress = [&work] { return work.progress(); };
  for (const int lobes : {1, 7, 15})
    planner.add_rival(fmt::format("SG, {}", lobes), base, [=](const RivalScene& scene) {
      return sg_rival(scene, {.lobes = lobes}, progress());
    });
  planner.add_rival("SH, order 5", base, [=](const RivalScene& scene) {
    return sh_rival(scene, {.order = 5, .directions = std::min(base.bake.directions, 128)},
                    progress());
  });
  planner.add_rival("unshadowed", base,
                    [](const RivalScene& scene) { return unshadowed_rival(scene); });
  planner.add_rival(
      "uncompressed", base,
      [=](const RivalScene& scene) {
        return uncompressed_rival(scene,
                                  {.shading = base.shading,
                                   .directions = base.bake.directions,
                                   .resolution = base.bake.resolution},
                                  progress());
      },
      kUncompressedVertices);
}

void write_sweep(const Options& options, const Sweep& sweep) {
  write_json(options.file("tradeoff.json"), sweep_json(sweep));
  std::vector<BenchRow> rows;
  for (const SweepRow& row : sweep.rows) {
    BenchRow flat = {{"scene", sweep.scene},
                     {"environment", sweep.environment},
                     {"commit", sweep.machine.value("commit", "")}};
    flat.update(flat_row(row));
    rows.push_back(std::move(flat));
  }
  write_text(options.file("tradeoff.csv"), format_csv(rows));
}

/// Rows of an earlier run on the same scene. Throws Error where the folder holds another's.
std::vector<SweepRow> earlier_rows(const Options& options, const Sweep& sweep) {
  const std::string path = options.file("tradeoff.json");
  if (!std::filesystem::exists(path)) return {};
  Sweep earlier = read_sweep(path);
  if (earlier.scene_key != sweep.scene_key)
    throw Error(ErrorKind::input, path,
                fmt::format("found a sweep of {} under {} with another mesh, map, views, vertices "
                            "or truth, expected this one's or another --out",
                            earlier.scene, earlier.environment));
  return earlier.rows;
}

void write_pictures(const Options& options, Trial& trial, const Plan& plan, const Trade& time,
                    Sweep& sweep) {
  sweep.pictures = nlohmann::ordered_json::array();
  for (const size_t i : rows_to_show(sweep, time)) {
    throw_if_interrupted();
    const SweepRow& row = sweep.rows[i];
    const TradePicture picture = trade_picture(trial, plan.settings.at(row.key), options.pictures);
    std::string file = "picture-" + row.name + ".png";
    for (char& c : file)
      if (c == ' ' || c == ',') c = '-';
    write_png(picture.picture, options.file(file));
    sweep.pictures.push_back({{"file", file},
                              {"name", row.name},
                              {"flip", picture.flip},
                              {"relative_l2", picture.relative_l2},
                              {"psnr_db", picture.psnr_db}});
  }
}

void check(const Options& options) {
  check_bake_options(options.bake);
  try {
    const std::regex only(options.only);
  } catch (const std::regex_error&) {
    throw UsageError(
        fmt::format("--only: found '{}', expected a regular expression", options.only));
  }
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  if (error)
    throw Error(ErrorKind::output, options.folder, "cannot be made a folder: " + error.message());
  require_writable(std::vector{options.file("tradeoff.json"), options.file("tradeoff.csv")});
}

void run(const Options& options) {
  check(options);
  Work work(options.common);
  Trial trial(load_scene(options, work), options.trial, work.progress());
  Sweep sweep;
  sweep.scene = trial.scene().scene.name;
  sweep.environment = trial.scene().environment;
  sweep.scene_key = trial.key();
  sweep.vertices = trial.scene().scene.mesh.positions.size();
  sweep.machine = machine_record(work.threads());

  GridOptions grid;
  grid.base.bake = options.bake;
  Planner planner(options, trial, sweep.scene_key);
  for (const GridPoint& point : tradeoff_grid(trial.scene().scene.materials, grid))
    planner.add_settings(point);
  add_rivals(planner, grid.base, work);
  const Plan plan = planner.take();
  const std::vector<SweepRow> known = earlier_rows(options, sweep);
  size_t measured = 0;
  sweep.rows = run_sweep(plan.entries, known, [&](const std::vector<SweepRow>& rows) {
    sweep.rows = rows;
    write_sweep(options, sweep);
    ++measured;
  });
  if (sweep.rows.empty())
    throw UsageError(
        fmt::format("--only: found '{}', expected a part of a row's name", options.only));
  const std::vector<Trade> trades = trades_of(sweep, options.clock);
  for (const Trade& trade : trades)
    write_text(options.file("error-" + trade.name + ".svg"), plot_svg(plot_of(sweep, trade)));
  write_pictures(options, trial, plan, trades[0], sweep);
  write_sweep(options, sweep);
  work.print(fmt::format("tradeoff of {} under {}, {} vertices: {} rows, {} of them new\n\n{}",
                         sweep.scene, sweep.environment, sweep.vertices, sweep.rows.size(),
                         measured, trades_text(sweep, trades)));
}

}  // namespace

std::function<void()> declare_tradeoff_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  std::string names;
  for (const std::string& name : scene_names()) names += (names.empty() ? "" : ", ") + name;
  add_file(app, "SCENE", "SCENE|MESH", options->scene,
           fmt::format("a built-in scene ({}) or a mesh file (default {})", names, options->scene));
  add_file(app, "--env", "MAP", options->environment,
           fmt::format("lat-long environment, or {} (the default)", kStudioName));
  add_file(app, "--material", "MATERIAL", options->material,
           "a preset or a material file in place of the scene's materials");
  add_number(app, "--vertices", "N", options->trial.vertices, {1, 10'000'000, ""},
             "drawn for each view, on which errors are measured");
  add_number(app, "--views", "N", options->views, {1, 64}, "around the scene's camera");
  add_number(app, "--noise", "E", options->trial.truth.noise, {0.0001, 1, ""},
             "of the truth, relative L2, at which its sampling stops");
  add_number(app, "--samples", "SPP", options->trial.truth.most_samples,
             {64, 1 << 20, "samples a vertex"}, "at most, of the truth");
  add_choice(
      app, "--truth", options->trial.fitted_truth, {{"map", false}, {"lights", true}},
      "lit by the map, or by the lobes that it is fitted by, which leaves out the fit's error "
      "(but not that highlights are of the map)");
  add_number(app, "--frames", "N", options->trial.frames, {1, 1000},
             "timed for each view; the shortest counts");
  add_choice(app, "--time", options->clock, {{"wall", FrameClock::wall}, {"cpu", FrameClock::cpu}},
             "clock of the plots and fronts: cpu where the machine does other things, too");
  add_parsed(app, "--only", "REGEX",
             "measures only rows whose name it is found in; others that --out holds are kept",
             "a regular expression", [options](const std::string& text) {
               options->only = text;
               return true;
             });
  add_size(app, options->pictures.width, options->pictures.height);
  add_file(app, "--out", "DIR", options->folder,
           fmt::format("folder of the results, made if missing (default {}); an interrupted sweep "
                       "goes on from it",
                       options->folder));
  add_bake_options(app, options->bake);
  app.add_flag("-q,--quiet", options->common.quiet, "print errors only: no progress, no table");
  add_number(app, "--threads", "N", options->common.threads, {0, 1024},
             "worker threads, 0 for all of the machine");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
