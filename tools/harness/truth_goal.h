#pragma once

#include <cstdint>

namespace burnish {

/// When a truth is good enough. Samples are doubled until its noise is low enough or there would be
/// too many.
struct TruthGoal {
  double noise = 0.005;      ///< of all values together, RelativeL2::truth_noise; >= 0
  int first_samples = 64;    ///< per point or pixel, >= 1
  int most_samples = 16384;  ///< at least those are taken that come first
  std::uint64_t seed = 1;
};

/// How good it became.
struct TruthQuality {
  int samples = 0;       ///< per point or pixel
  double noise = 0;      ///< as in the goal
  bool reached = false;  ///< the goal
};

}  // namespace burnish
