#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include <hwy/cache_control.h>

namespace burnish {

/// Memory that is soon read, on its way to the near caches a range at a time, between steps of
/// other work: a processor waits for only some dozen lines at once.
class Fetcher {
 public:
  /// Ranges beyond the first kMost are left to be waited for.
  void add(const void* data, size_t bytes) {
    if (bytes > 0 && end_ < kMost) ranges_[end_++] = {static_cast<const char*>(data), bytes};
  }
  size_t waiting() const { return end_ - next_; }
  /// The next ranges, at most so many.
  void fetch(size_t count) {
    for (const size_t until = std::min(end_, next_ + count); next_ < until; ++next_) {
      const Range& range = ranges_[next_];
      for (size_t i = 0; i < range.bytes; i += kLine) hwy::Prefetch(range.data + i);
      hwy::Prefetch(range.data + range.bytes - 1);
    }
    if (next_ == end_) next_ = end_ = 0;
  }

 private:
  static constexpr size_t kLine = 64, kMost = 512;
  struct Range {
    const char* data;
    size_t bytes;  ///< not 0
  };
  std::array<Range, kMost> ranges_;
  size_t next_ = 0, end_ = 0;
};

}  // namespace burnish
