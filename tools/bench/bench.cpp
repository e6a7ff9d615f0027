#include "bench.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"

namespace burnish::tools {
namespace {

std::vector<std::string> columns_of(const std::vector<BenchRow>& rows) {
  std::vector<std::string> columns;
  for (const BenchRow& row : rows)
    for (const auto& [name, value] : row.items())
      if (std::find(columns.begin(), columns.end(), name) == columns.end()) columns.push_back(name);
  return columns;
}

/// Numbers with `digits` significant digits, or all of them for 0.
std::string cell_text(const BenchRow& row, const std::string& column, int digits) {
  if (!row.contains(column) || row[column].is_null()) return "";
  const auto& value = row[column];
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float() || digits == 0) return value.dump();
  return fmt::format("{:.{}g}", value.get<double>(), digits);
}

std::string csv_quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

void add_report_options(CLI::App& app, BenchOptions& options) {
  app.add_flag("-q,--quiet", options.quiet, "print errors only: no progress, no table");
  add_file(app, "--json", "FILE.json", options.json, "also write the rows as JSON", ".json");
  add_file(app, "--csv", "FILE.csv", options.csv, "also write the rows as CSV", ".csv");
}

void add_bench_options(CLI::App& app, BenchOptions& options) {
  add_number(app, "--repeat", "N", options.repeat, {1, 1000}, "timed runs; their median counts");
  add_number(app, "--warmup", "N", options.warmup, {0, 1000}, "untimed runs before them");
  add_number(app, "--threads", "N", options.threads, {0, 1024},
             "worker threads, 0 for all of the machine");
  add_report_options(app, options);
}

Timing summarise(std::vector<double> seconds) {
  if (seconds.empty()) return {};
  std::sort(seconds.begin(), seconds.end());
  const size_t middle = seconds.size() / 2;
  const double median =
      seconds.size() % 2 == 1 ? seconds[middle] : (seconds[middle - 1] + seconds[middle]) / 2;
  return {median, seconds.front(), seconds.back()};
}

Timing measure(const BenchOptions& options, const std::function<void()>& work) {
  std::vector<double> seconds;
  for (int run = 0; run < options.warmup + options.repeat; ++run) {
    throw_if_interrupted();
    const Stopwatch watch;
    work();
    if (run >= options.warmup) seconds.push_back(watch.seconds());
  }
  return summarise(std::move(seconds));
}

void add_timing(BenchRow& row, const Timing& timing, const BenchOptions& options) {
  row["median_ms"] = timing.median_s * 1e3;
  row["min_ms"] = timing.min_s * 1e3;
  row["max_ms"] = timing.max_s * 1e3;
  row["runs"] = options.repeat;
}

std::string format_table(const std::vector<BenchRow>& rows) {
  std::string constants;
  std::vector<std::string> columns;
  for (const std::string& column : columns_of(rows)) {
    const std::string first = cell_text(rows.front(), column, 4);
    const bool constant = std::all_of(rows.begin(), rows.end(), [&](const BenchRow& row) {
      return cell_text(row, column, 4) == first;
    });
    if (constant)
      constants += fmt::format("{:<26}{}\n", column, first);
    else
      columns.push_back(column);
  }
  std::vector<std::string> lines(columns.empty() ? 0 : rows.size() + 1);
  for (size_t c = 0; c < columns.size(); ++c) {
    size_t width = columns[c].size();
    for (const BenchRow& row : rows) width = std::max(width, cell_text(row, columns[c], 4).size());
    const auto add = [&](std::string& line, const std::string& cell) {
      // Names to the left, figures to the right.
      line += c == 0 ? fmt::format("{:<{}}", cell, width) : fmt::format("  {:>{}}", cell, width);
    };
    add(lines[0], columns[c]);
    for (size_t i = 0; i < rows.size(); ++i) add(lines[i + 1], cell_text(rows[i], columns[c], 4));
  }
  return constants + (constants.empty() || lines.empty() ? "" : "\n") +
         fmt::format("{}", fmt::join(lines, "\n"));
}

std::string format_csv(const std::vector<BenchRow>& rows) {
  const std::vector<std::string> columns = columns_of(rows);
  std::string text;
  const auto add_line = [&](const auto& cell_of) {
    for (const std::string& column : columns) {
      if (&column != &columns.front()) text += ',';
      text += csv_quoted(cell_of(column));
    }
    text += "\r\n";
  };
  add_line([](const std::string& column) { return column; });
  for (const BenchRow& row : rows)
    add_line([&](const std::string& column) { return cell_text(row, column, 0); });
  return text;
}

std::string format_tables(const std::vector<BenchRow>& rows) {
  std::vector<std::pair<std::string, std::vector<BenchRow>>> tables;
  for (const BenchRow& row : rows) {
    const std::string what = row.value("what", "");
    auto table = std::find_if(tables.begin(), tables.end(),
                              [&](const auto& known) { return known.first == what; });
    if (table == tables.end()) table = tables.insert(tables.end(), {what, {}});
    table->second.push_back(row);
  }
  std::string text;
  for (const auto& [what, own] : tables) text += (text.empty() ? "" : "\n\n") + format_table(own);
  return text;
}

void report_bench(const std::string& station, const std::vector<BenchRow>& rows,
                  const BenchOptions& options, Work& work) {
  const nlohmann::ordered_json machine = machine_record(work.threads());
  work.print(fmt::format("{} on {} ({}, {} threads), {}, commit {}\n\n{}", station,
                         machine["cpu"].get<std::string>(), machine["isa"].get<std::string>(),
                         work.threads(), machine["compiler"].get<std::string>(),
                         machine["commit"].get<std::string>(), format_tables(rows)));
  write_json(options.json, {{"station", station}, {"machine", machine}, {"rows", rows}});
  if (options.csv.empty()) return;
  std::vector<BenchRow> complete;
  for (BenchRow row : rows) {
    row["station"] = station;
    row.update(machine);
    complete.push_back(std::move(row));
  }
  write_text(options.csv, format_csv(complete));
}

}  // namespace burnish::tools
