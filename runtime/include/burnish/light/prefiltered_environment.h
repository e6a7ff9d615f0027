#pragma once

#include <functional>
#include <span>
#include <vector>

#include "burnish/light/environment_map.h"
#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/batch.h"

namespace burnish {

/// An environment averaged over isotropic lobes of a ladder of bandwidths, each a factor of sqrt(2)
/// from the next, on the six faces of a cube (docs/lights.md, "Filtered maps").
struct PrefilteredEnvironment {
  struct Level {
    float bandwidth;  ///< ASG bandwidth of the lobe (an SG of twice this sharpness); 0: a cosine
    float variance;   ///< mean square of a sine from the lobe's axis, in one of two directions
    int resolution;   ///< texels along the edge of a face
    /// [6][resolution + 2]^2: coefficients of a quadratic B-spline, with a border of one texel. The
    /// fourth number is padding.
    std::vector<Eigen::Array4f> coefficients;
  };
  std::vector<Level> levels;  ///< by rising bandwidth
  Image map;                  ///< what lobes narrower than the last level's blend into
  /// Turns world directions into the environment's frame; may be changed at any time, at no cost.
  Eigen::Matrix3f environment_from_world = Eigen::Matrix3f::Identity();
};

struct PrefilterOptions {
  /// Of the last level. Memory and time grow with it: 1 kB for each unit of bandwidth, and 3.4
  /// times that in all. Maps of too few pixels end earlier.
  float max_bandwidth = 16384;
  /// Runs body(i) once for every i in [0, count), in any order, on any threads, and returns when
  /// all are done. Empty: one after the other, on the calling thread.
  std::function<void(int count, const std::function<void(int)>& body)> parallel_for;
};

/// Filters a lat-long environment of at least one pixel, finite and >= 0. Throws
/// std::invalid_argument where there is no pixel.
PrefilteredEnvironment prefilter_environment(const Image& environment,
                                             const PrefilterOptions& options = {});

/// Mean radiance of the environment under a lobe: (integral of lobe * L) / (integral of lobe), at
/// least 0. An anisotropic lobe is a row of round taps along its long axis: 0.9 + 3 sqrt(r - 1)
/// of them, rounded up, for a ratio r of the bandwidths, but at most `max_taps`; fewer are wider.
/// 1 tap: the round lobe of the same area. A constant environment gives exactly that constant, to
/// the bit. Errors: docs/lights.md, "Filtered maps".
Rgb eval_prefiltered(const PrefilteredEnvironment& environment,
                     const AnisotropicGaussian<float>& lobe, int max_taps) noexcept;

namespace batch {

struct RgbResults {
  std::span<float> red, green, blue;
};

/// Of many lobes, whose amplitudes do not matter and may be left out: results[i] of lobe i, in a
/// fraction of the time.
void eval_prefiltered(const PrefilteredEnvironment& environment, const AnisotropicGaussians& lobes,
                      int max_taps, const RgbResults& results) noexcept;

}  // namespace batch
}  // namespace burnish
