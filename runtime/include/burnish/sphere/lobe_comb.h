#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/special_functions.h"

/// An anisotropic lobe as a row of narrower ones along its long axis. The long lobe bends when it
/// is warped, and one lobe cannot; each of a row can be warped, shaded and shadowed on its own
/// (docs/maths.md, "Lobe comb"). A row is prepared once per pair of bandwidths.
namespace burnish {

inline constexpr int kMaxTaps = 9;

/// A place on a lobe's long axis that stands for a part of the lobe.
template <class T>
struct LobeTap {
  T sine = 0;       ///< of the angle from the lobe's axis, toward the positive end of the long axis
  T bandwidth = 1;  ///< of the part, along the long axis, in the part's own frame
  T weight = 1;     ///< the part's share of the lobe's integral; all shares sum to one
};

template <class T>
struct LobeTaps {
  std::array<LobeTap<T>, kMaxTaps> tap;
  int count = 1;
};

/// The long axis is y, as in the result of the warp, unless x has the smaller bandwidth.
template <class T>
bool is_long_along_x(const AnisotropicGaussian<T>& lobe) {
  return lobe.bandwidth_x < lobe.bandwidth_y;
}

/// A tap of a lobe as a lobe: the frame is turned along the long axis, the narrow bandwidth and the
/// amplitude are the lobe's.
template <class T>
AnisotropicGaussian<T> tap_lobe(const AnisotropicGaussian<T>& lobe, const LobeTap<T>& tap) {
  const T sine = tap.sine, cosine = std::sqrt(std::max((1 - sine) * (1 + sine), T(0)));
  AnisotropicGaussian<T> part = lobe;
  const bool along_x = is_long_along_x(lobe);
  const Vector3<T>& axis = along_x ? lobe.frame.x : lobe.frame.y;
  (along_x ? part.frame.x : part.frame.y) = cosine * axis - sine * lobe.frame.z;
  part.frame.z = sine * axis + cosine * lobe.frame.z;
  (along_x ? part.bandwidth_x : part.bandwidth_y) = tap.bandwidth;
  return part;
}

/// A lobe of given bandwidths as a row of `taps.count` teeth.
template <class T>
struct LobeComb {
  LobeTaps<T> taps;
  std::array<T, kMaxTaps> amplitude;  ///< of a tooth, for a lobe of amplitude one
};

/// A tooth of a lobe that has the bandwidths that the comb was made for.
template <class T>
AnisotropicGaussian<T> comb_tooth(const LobeComb<T>& comb, const AnisotropicGaussian<T>& lobe,
                                  int index) {
  AnisotropicGaussian<T> tooth = tap_lobe(lobe, comb.taps.tap[index]);
  tooth.amplitude *= comb.amplitude[index];
  return tooth;
}

namespace internal {

/// The unit normal density as a row of narrower ones, two of their deviations apart.
struct NormalComb {
  double deviation;
  std::array<double, 5> weight;  ///< from the middle outward; the row is symmetric
};

/// For 2..kMaxTaps teeth. The weights are the least-squares ones of those that keep the mass and
/// the variance: a smooth light sees little else. At two deviations apart the sum ripples by
/// 2 exp(-pi^2 / 2) = 1.4 %. The deviation weighs the tails that a short row misses against the
/// bending of a wide tooth, by the error of shaded lobes (docs/maths.md, "Lobe comb").
inline constexpr std::array<NormalComb, kMaxTaps - 1> kNormalCombs = {{
    {0.70710678118654752, {0.5}},
    {0.60, {0.555556, 0.222222}},
    {0.53, {0.402501, 0.097499}},
    {0.48, {0.430453, 0.240519, 0.044254}},
    {0.43, {0.337709, 0.136927, 0.025365}},
    {0.39, {0.336214, 0.236183, 0.080149, 0.015561}},
    {0.355, {0.281194, 0.158528, 0.049755, 0.010523}},
    {0.33, {0.278413, 0.218202, 0.105087, 0.030826, 0.006679}},
}};

}  // namespace internal

/// A comb of `count` teeth, 1..kMaxTaps (others are clamped to that), for lobes of these
/// bandwidths. The teeth's integrals sum to the lobe's. One tooth is the lobe itself. The sum
/// departs from the lobe by a relative L2 of .11, .050, .045, .033, .026, .022, .019, .018 for 2..9
/// teeth; its mass and variance, while the lobe is narrow, are exact.
template <class T>
LobeComb<T> make_lobe_comb(T bandwidth_x, T bandwidth_y, int count) {
  const double narrow = std::max(bandwidth_x, bandwidth_y);
  const double wide = std::min(bandwidth_x, bandwidth_y);
  LobeComb<T> comb;
  comb.taps.count = std::clamp(count, 1, kMaxTaps);
  double total = 0;
  const double integral = asg_integral_exact(narrow, wide);
  for (int k = 0; k < comb.taps.count; ++k) {
    double sine = 0, along = wide, weight = 1;
    if (comb.taps.count > 1) {
      const internal::NormalComb& normal = internal::kNormalCombs[comb.taps.count - 2];
      const int twice_place = 2 * k - (comb.taps.count - 1);
      weight = normal.weight[std::abs(twice_place) / 2];
      // A place of the normal density becomes the place of the same quantile on the disc's
      // diameter, so that wide lobes keep to the disc; a deviation follows the slope.
      const double place = twice_place * normal.deviation;
      const double quantile = std::erf(place / std::sqrt(2.0));
      const double root = std::sqrt(wide);
      const bool flat = root < 1e-8;  // erf is linear to rounding
      const double root_over_erf = flat ? std::sqrt(kPi<double>) / 2 : root / std::erf(root);
      const double stretched = flat ? 0 : inverse_erf(quantile * std::erf(root));
      sine = flat ? quantile : stretched / root;
      const double inverse_slope =
          root_over_erf * std::exp(place * place / 2 - stretched * stretched);
      along = (1 - sine * sine) * std::pow(inverse_slope / normal.deviation, 2);
    }
    const T bandwidth = T(std::min<double>(along, std::numeric_limits<T>::max()));
    comb.taps.tap[k] = {T(sine), bandwidth, T(weight)};
    comb.amplitude[k] = T(weight * integral / asg_integral_exact<double>(narrow, bandwidth));
    total += weight;
  }
  for (int k = 0; k < comb.taps.count; ++k) {
    comb.taps.tap[k].weight /= T(total);
    comb.amplitude[k] /= T(total);
  }
  return comb;
}

}  // namespace burnish
