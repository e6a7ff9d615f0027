#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "burnish/precompute/progress.h"

namespace burnish::tools {

/// The text of a progress bar, at most `columns` wide, without line control: stage, bar, percentage
/// and the time left as the time so far foretells it. A `total` of 0 counts as not begun.
std::string progress_line(std::string_view stage, std::uint64_t done, std::uint64_t total,
                          double elapsed_s, int columns);

/// A bar on stderr while work runs. Shows only on a terminal, and is erased at the end. It redraws
/// ever more rarely the longer a stage takes (0.1 s to 1 s), and not at all for work under 0.3 s.
class ProgressBar {
 public:
  /// Draws nothing if `quiet` or if stderr is not a terminal.
  explicit ProgressBar(bool quiet);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// A callback for the libraries: draws, and asks the work to stop once a signal has arrived.
  /// Refers to this bar.
  Progress callback();
  /// Erases what is drawn, so that other text can be printed.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void update(std::string_view stage, std::uint64_t done, std::uint64_t total);

  bool enabled_;
  bool drawn_ = false;
  std::string stage_;
  Clock::time_point stage_start_;
  Clock::time_point next_draw_;
};

}  // namespace burnish::tools
