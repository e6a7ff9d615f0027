#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "bench.h"
#include "burnish/formats/error.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/program.h"
#include "reproduce/page.h"
#include "stations.h"

namespace burnish::tools {
namespace {

struct Options {
  std::vector<std::string> names;
  std::string out;
  std::string data;
  std::string docs;
  BenchOptions bench;
};

std::string figure_names() {
  std::string names;
  for (const Figure& figure : all_figures()) names += fmt::format(", {}", figure.name);
  return "all" + names;
}

/// In the order of the paper, each once. Throws UsageError.
std::vector<const Figure*> wanted_figures(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (name != "all" && std::none_of(all_figures().begin(), all_figures().end(),
                                      [&](const Figure& figure) { return figure.name == name; }))
      throw UsageError(
          fmt::format("unknown figure '{}', expected one or more of {}", name, figure_names()));
  const auto named = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  std::vector<const Figure*> wanted;
  for (const Figure& figure : all_figures())
    if (named("all") || named(figure.name)) wanted.push_back(&figure);
  return wanted;
}

std::string out_folder(const Options& options) {
  if (!options.out.empty()) return options.out;
  if (options.docs.empty()) return "reproduction";
  return std::filesystem::path(options.docs).replace_extension().string();
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error(ErrorKind::output, folder, "cannot be made: " + error.message());
}

/// The station's row of a figure: the figure's name leads.
std::vector<BenchRow> station_rows(const MadeFigure& made) {
  std::vector<BenchRow> rows;
  for (const BenchRow& own : made.result.rows) {
    const std::string what = own.value("what", "");
    BenchRow row = {{"what", made.figure->name + (what.empty() ? "" : ", " + what)}};
    for (const auto& [column, value] : own.items())
      if (column != "what") row[column] = value;
    rows.push_back(std::move(row));
  }
  return rows;
}

void write_page(const Options& options, const std::vector<MadeFigure>& made, int threads) {
  namespace fs = std::filesystem;
  const fs::path page_folder = fs::absolute(options.docs).parent_path();
  const std::string pictures =
      fs::absolute(out_folder(options)).lexically_relative(page_folder).generic_string();
  write_text(options.docs, reproduction_page(made, pictures, machine_record(threads)));
}

void run(const Options& options) {
  const std::vector<const Figure*> wanted = wanted_figures(options.names);
  require_writable(std::vector{options.bench.json, options.bench.csv, options.docs});
  if (!options.data.empty() && !std::filesystem::is_directory(options.data))
    throw Error(ErrorKind::input, options.data, "no such folder");
  const std::string folder = out_folder(options);
  make_folder(folder);
  Work work(options.bench.common());
  const auto warn = [](const std::string& text) { fmt::print(stderr, "warning: {}\n", text); };
  const FigureContext context = {work, options.bench, {.warn = warn}, options.data};
  std::vector<MadeFigure> made;
  std::vector<BenchRow> rows;
  for (const Figure* figure : wanted) {
    throw_if_interrupted();
    const Stopwatch watch;
    FigureResult result = figure->make(context);
    made.push_back({figure, std::move(result), watch.seconds()});
    write_figure_files(made.back(), folder);
    for (BenchRow& row : station_rows(made.back())) rows.push_back(std::move(row));
    work.print(fmt::format("{} ({:.1f} s): {}\n", figure->title, made.back().seconds,
                           made.back().result.found));
  }
  if (!options.docs.empty()) write_page(options, made, work.threads());
  report_bench("reproduce", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_reproduce_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("NAME", options->names, "figures: " + figure_names())->required()->type_name("");
  add_file(app, "--out", "DIR", options->out,
           "folder of the pictures and CSV files, one figure after the other; made if missing "
           "(default: reproduction, or FILE without .md)");
  add_file(app, "--data", "DIR", options->data,
           "folder of measured BRDFs (brdf/*.bsdf) and maps (env/*.hdr, *.exr); without it, what "
           "needs them is left out");
  add_file(app, "--docs", "FILE.md", options->docs, "also write a page of all that was made",
           ".md");
  options->bench.repeat = 9;
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
