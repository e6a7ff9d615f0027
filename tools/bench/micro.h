#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace burnish::tools {

/// A loop too short for a stopwatch.
struct MicroBenchmark {
  std::string name;
  size_t items = 0;            ///< what one call of `work` passes over
  std::function<void()> work;  ///< its results must reach memory
};

struct MicroOptions {
  int repetitions = 9;
  double repetition_s = 0.02;  ///< at least, each
};

/// Median over the repetitions of the ns an item takes, by Google Benchmark, in the order given.
/// Repetitions of all benchmarks are interleaved at random, so that a busy neighbour on the machine
/// hits all alike. May be called once in a process. Ctrl-C ends it by the Cancelled of
/// throw_if_interrupted().
std::vector<double> time_benchmarks(const std::vector<MicroBenchmark>& benchmarks,
                                    const MicroOptions& options);

}  // namespace burnish::tools
