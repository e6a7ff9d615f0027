#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

#include "burnish/precompute/progress.h"

namespace burnish {

/// One stage of work done by several threads, told to a Progress by one thread at a time.
class ProgressMonitor {
 public:
  ProgressMonitor(const Progress& progress, std::string_view stage, std::uint64_t total)
      : progress_(progress), stage_(stage), total_(total) {
    advance(0);
  }

  /// Throws Cancelled if this or an earlier call was told to stop.
  void advance(std::uint64_t steps) {
    if (!progress_) return;
    const std::lock_guard lock(mutex_);
    done_ += steps;
    if (!cancelled_ && !progress_(stage_, done_, total_)) cancelled_ = true;
    if (cancelled_) throw Cancelled();
  }

 private:
  const Progress& progress_;
  std::string_view stage_;
  std::uint64_t total_, done_ = 0;
  bool cancelled_ = false;
  std::mutex mutex_;
};

}  // namespace burnish
