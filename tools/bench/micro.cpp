#include "micro.h"

#include <algorithm>
#include <map>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "bench.h"
#include "common/interrupt.h"

namespace burnish::tools {
namespace {

/// Keeps the seconds an item took in every repetition; prints nothing.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      const auto iterations = static_cast<double>(run.iterations);
      seconds_[run.run_name.function_name].push_back(run.real_accumulated_time / iterations);
    }
  }

  /// Of one call of the benchmark's work.
  double median_s(const std::string& name) const { return summarise(seconds_.at(name)).median_s; }

 private:
  std::map<std::string, std::vector<double>> seconds_;
};

}  // namespace

std::vector<double> time_benchmarks(const std::vector<MicroBenchmark>& benchmarks,
                                    const MicroOptions& options) {
  std::vector<std::string> arguments = {
      "burnish-bench", fmt::format("--benchmark_repetitions={}", options.repetitions),
      fmt::format("--benchmark_min_time={}", options.repetition_s),
      "--benchmark_enable_random_interleaving=true"};
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  int argc = static_cast<int>(argv.size());
  benchmark::Initialize(&argc, argv.data());
  for (const MicroBenchmark& micro : benchmarks)
    benchmark::RegisterBenchmark(micro.name.c_str(), [&micro](benchmark::State& state) {
      for (auto unused : state) {
        (void)unused;
        micro.work();
        benchmark::ClobberMemory();
        // Once a pass over many items costs nothing.
        if (interrupted()) {
          state.SkipWithError("interrupted");
          break;
        }
      }
    });
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::ClearRegisteredBenchmarks();
  throw_if_interrupted();

  std::vector<double> ns;
  for (const MicroBenchmark& micro : benchmarks)
    ns.push_back(collector.median_s(micro.name) * 1e9 / static_cast<double>(micro.items));
  return ns;
}

}  // namespace burnish::tools
