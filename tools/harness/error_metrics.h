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

/// Whether an error is told apart from the noise of the truth it is against: not below twice the
/// error that a perfect approximation would measure.
inline bool above_noise(double error, double truth_noise) { return error >= 2 * truth_noise; }
inline bool above_noise(const RelativeL2& error) {
  return above_noise(error.value, error.truth_noise);
}

/// Absolute errors as fractions of the reference's mean radiance: of a value (a pixel or vertex)
/// the mean of |a - b| over its channels. All 0 where nothing differs, infinite for a black
/// reference.
struct AbsoluteErrors {
  double mean = 0;
  double percentile_95 = 0;   ///< the smallest error that 95 % of the values do not exceed
  double percentile_999 = 0;  ///< the same of 99.9 %
  double truth_noise = 0;     ///< `mean` of a perfect approximation: the truth's noise, if normal
  double mean_radiance = 0;   ///< of the reference, over values and channels
  size_t count = 0;           ///< values compared
};

/// As relative_l2 compares.
/// @{
AbsoluteErrors absolute_errors(std::span<const Rgb> approximation, std::span<const Rgb> reference,
                               std::span<const Rgb> variance = {});
AbsoluteErrors absolute_errors(const Picture& approximation, const Picture& reference);
/// @}

/// Mean squared difference, 0..1, of the pixels that the mesh fills in both pictures, as tone_map
/// shows them at the reference's exposure; 0 without any. The likeliest meaning of the "L2 error"
/// of xu2013asg's pictures (docs/harness.md).
double display_mse(const Picture& approximation, const Picture& reference);

/// The same as a peak signal-to-noise ratio: -10 log10 of it, dB; infinite where it is 0.
double psnr_db(const Picture& approximation, const Picture& reference);

/// FLIP (flip.h) of both pictures as tone_map shows them at the reference's exposure. The map has
/// all pixels; the mean, unlike the published one, only those that the mesh fills in both, so that
/// it does not depend on how much background there is. 0 without any.
struct FlipError {
  double mean = 0;
  Image map;
};
FlipError flip_error(const Picture& approximation, const Picture& reference);

/// Pictures in a row, top-aligned, `gap` pixels of `fill` between them.
Image side_by_side(std::span<const Image> pictures, int gap = 8, const Rgb& fill = Rgb::Ones());

/// Grey picture of |luminance(a) - luminance(b)| times `gain`. Both have the same size.
Image difference_picture(const Image& a, const Image& b, float gain = 1);

}  // namespace burnish
