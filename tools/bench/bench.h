#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "common/command.h"
#include "common/work.h"

/// What the stations' benchmarks share: repetition and median, and results as a table, JSON and
/// CSV. A station is a command that makes rows, one a measurement.
namespace burnish::tools {

struct BenchOptions {
  int repeat = 5;  ///< timed runs, after `warmup` untimed ones
  int warmup = 1;
  bool quiet = false;
  int threads = 0;  ///< 0: as many as the machine has
  std::string json;
  std::string csv;

  CommonOptions common() const { return {quiet, threads, {}}; }
};

/// Declares --quiet, --json and --csv.
void add_report_options(CLI::App& app, BenchOptions& options);

/// Those, --repeat, --warmup and --threads.
void add_bench_options(CLI::App& app, BenchOptions& options);

/// Wall clock of the timed runs.
struct Timing {
  double median_s = 0;  ///< of an even number: the mean of the middle two
  double min_s = 0;
  double max_s = 0;
};

Timing summarise(std::vector<double> seconds);

/// Runs `work` warm-up and timed times. Throws Cancelled between runs after Ctrl-C.
Timing measure(const BenchOptions& options, const std::function<void()>& work);

/// One measurement: values by column, in the order of the columns. Numbers and text only.
using BenchRow = nlohmann::ordered_json;

/// Adds the median, minimum and maximum in ms, and the number of runs.
void add_timing(BenchRow& row, const Timing& timing, const BenchOptions& options);

/// Rows as aligned columns under their names, below a list of what is the same in all of them. The
/// columns are those of all rows, in the order of their first appearance; a row without a value
/// leaves it empty.
std::string format_table(const std::vector<BenchRow>& rows);

/// A table for each value of the column "what", for stations that measure different things.
std::string format_tables(const std::vector<BenchRow>& rows);

/// The same as RFC 4180 CSV.
std::string format_csv(const std::vector<BenchRow>& rows);

/// Prints the table and writes the files that were asked for, each with the machine's record.
void report_bench(const std::string& station, const std::vector<BenchRow>& rows,
                  const BenchOptions& options, Work& work);

}  // namespace burnish::tools
