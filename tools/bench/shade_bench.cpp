#include <memory>
#include <string>
#include <vector>

#include "bench.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "shade_tables.h"
#include "stations.h"

namespace burnish::tools {
namespace {

struct Table {
  const char* name;
  std::vector<BenchRow> (*measure)(const ShadeBench& bench);
};

constexpr Table kTables[] = {
    {"frame", frame_table},     {"bound", bound_table},   {"table1", table1},
    {"targets", targets_table}, {"growth", growth_table}, {"short", short_table},
    {"memory", memory_table},   {"pixels", pixels_table}, {"monte-carlo", monte_carlo_table}};

struct Options {
  SubjectOptions subject;
  std::string transfer;
  std::string only = "all";
  BenchOptions bench;
};

void run(const Options& options) {
  check_bake_options(options.subject.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  ShadeScene scene = load_shade_scene(options.subject, options.transfer, work);
  const ShadeBench bench = {scene, options.subject, options.bench, work};
  std::vector<BenchRow> rows;
  for (const Table& table : kTables) {
    if (options.only != "all" && options.only != table.name) continue;
    for (BenchRow& row : table.measure(bench)) {
      row["scene"] = scene.name;
      rows.push_back(std::move(row));
    }
  }
  report_bench("shade", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_shade_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->bench.repeat = 25;
  options->subject.name = "knot";
  add_subject_options(app, options->subject);
  add_file(app, "--transfer", "FILE.h5", options->transfer,
           "measure on a baked file instead of baking SCENE", ".h5");
  std::vector<std::pair<std::string, std::string>> choices = {{"all", "all"}};
  for (const Table& table : kTables) choices.emplace_back(table.name, table.name);
  add_choice(app, "--only", options->only, choices, "the table to measure");
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
