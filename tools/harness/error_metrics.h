#pragma once

#include <span>

#include "harness/picture.h"

namespace burnish {

/// Distance of an approximation from a reference, as a fraction of the reference: |a - b| / |b|
/// over all values and channels, |.| the root of the sum of squares. A reference by Monte Carlo is
/// itself off by its noise, which adds to the distance in quadrature.
struct RelativeL2 {
  double value = 0;           ///< as measured; 0 / 0 is 0, infinite for a black reference
  double truth_noise = 0;     ///< what a perfect approximation would measure: the noise alone
  double without_noise = 0;   ///< sqrt(value^2 - truth_noise^2), 0 where the noise is the larger
  double standard_error = 0;  ///< of `value` because of the noise; an upper bound, as the channels'
                              ///< noise is taken as fully dependent
  size_t count = 0;           ///< pixels or vertices compared
};

/// Over values (vertices). All spans have one length; `variance` (of each reference value, per
/// channel) may be empty for an exact reference.
RelativeL2 relative_l2(std::span<const Rgb> approximation, std::span<const Rgb> reference,
                       std::span<const Rgb> variance = {});

/// Over the pixels that the mesh fills in both pictures, which have the same size.
RelativeL2 relative_l2(const Picture& approximation, const Picture& reference);

/// Pictures in a row, top-aligned, `gap` pixels of `fill` between them.
Image side_by_side(std::span<const Image> pictures, int gap = 8, const Rgb& fill = Rgb::Ones());

/// Grey picture of |luminance(a) - luminance(b)| times `gain`. Both have the same size.
Image difference_picture(const Image& a, const Image& b, float gain = 1);

}  // namespace burnish
