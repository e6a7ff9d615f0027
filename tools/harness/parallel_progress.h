#pragma once

#include <atomic>
#include <mutex>
#include <string_view>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include "burnish/precompute/progress.h"

namespace burnish {

/// work(i) for each i below `count`, in parallel in blocks of `grain`, telling `progress` after
/// each block. Throws Cancelled when it asks to stop.
template <class Work>
void parallel_with_progress(std::string_view stage, size_t count, size_t grain,
                            const Progress& progress, const Work& work) {
  std::atomic<size_t> done = 0;
  std::atomic<bool> stop = false;
  std::mutex reporting;
  tbb::task_group_context context;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, grain),
      [&](const tbb::blocked_range<size_t>& range) {
        if (stop) return;
        for (size_t i = range.begin(); i < range.end(); ++i) work(i);
        done += range.size();
        // A thread that finds another one reporting has nothing newer to tell.
        const std::unique_lock lock(reporting, std::try_to_lock);
        if (!progress || !lock || stop || progress(stage, done, count)) return;
        stop = true;
        context.cancel_group_execution();
      },
      context);
  if (stop) throw Cancelled();
  if (progress && count > 0 && !progress(stage, count, count)) throw Cancelled();
}

}  // namespace burnish
