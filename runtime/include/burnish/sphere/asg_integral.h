#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "burnish/sphere/direction.h"
#include "burnish/sphere/special_functions.h"

/// The integral of a unit-amplitude ASG over the sphere. Since (v . z) dv = dx dy, it is that of a
/// plain 2-D Gaussian over the unit disc: between 0 and pi. Derivations: docs/maths.md, "ASG
/// integral". Every level takes bandwidths from 0 to the largest finite number.
namespace burnish {

enum class AsgIntegral {
  fast,    ///< xu2013asg Eq. 11, at most pi: 0.68 % for bandwidths > 5, 58 % if both are above or
           ///< both below 1; without bound for a long lobe with one below 1
  series,  ///< xu2013asg Eq. 10: 0.027 % for bandwidths > 5, 5.2 % > 1; below 1 it is `exact`
  exact,   ///< to rounding: 5.5e-7 in float, 6e-15 in double, for all bandwidths
};

/// pi / sqrt(bandwidth_x bandwidth_y), the whole plane's integral, held to the disc's area.
template <class T>
T asg_integral_fast(T bandwidth_x, T bandwidth_y) {
  // The product of the roots: a product of bandwidths overflows and underflows.
  return std::min(kPi<T> / (std::sqrt(bandwidth_x) * std::sqrt(bandwidth_y)), kPi<T>);
}

namespace internal {

/// What the disc's edge cuts off an ASG is exp(-bandwidth): below the last bit of T from here on.
template <class T>
inline constexpr T kEdgeOutOfSight = std::is_same_v<T, float> ? T(17) : T(37);

/// A disc Gaussian in polar coordinates whose azimuth psi is that of an ellipse: tan(azimuth) =
/// tan(psi) sqrt((bandwidth_x + offset) / (bandwidth_y + offset)). Equal steps in psi then follow
/// the lobe, however long, and
///   integral = pi / sqrt((bandwidth_x + offset) (bandwidth_y + offset)) * mean of g(psi),
///   g = (k + offset) (1 - exp(-k)) / k, k the bandwidth along the azimuth.
/// g depends on psi through cos(2 psi) only, and is between 1 and max(offset, 1.3).
template <class T>
struct AsgAzimuth {
  T cos_squared, sin_squared;  ///< of the azimuth, measured from x
  T bandwidth;                 ///< k
};

/// The azimuth at psi, for bandwidth_x >= bandwidth_y; squeeze = (bandwidth_y + offset) /
/// (bandwidth_x + offset). Two arguments for psi, because near 0 one cannot be had from the other.
template <class T>
AsgAzimuth<T> asg_azimuth(T bandwidth_x, T bandwidth_y, T squeeze, T cos_squared_psi,
                          T sin_squared_psi) {
  const T x = squeeze * cos_squared_psi, y = sin_squared_psi;
  const T scale = 1 / (x + y);
  return {x * scale, y * scale, bandwidth_x * (x * scale) + bandwidth_y * (y * scale)};
}

/// cos^2 at the midpoints of N equal steps of a quarter turn. In cos(2 psi) they are the nodes of
/// Gauss-Chebyshev quadrature.
template <class T, int N>
const std::array<T, N>& quarter_turn_cosines_squared() {
  static const std::array<T, N> table = [] {
    std::array<T, N> cosines;
    for (int i = 0; i < N; ++i) {
      const double c = std::cos((i + 0.5) / N * kPi<double> / 2);
      cosines[i] = T(c * c);
    }
    return cosines;
  }();
  return table;
}

}  // namespace internal

/// The integral by N midpoints of a quarter turn of psi. The worst relative error over all
/// bandwidths from 0 on falls by seven with each point, because the offset keeps exp(-k) away from
/// its essential singularity: N = 1: 4.4 %, 2: 0.40 %, 3: 0.052 %, 4: 7.4e-5, 5: 9.7e-6, 6: 1.3e-6,
/// 7: 2.6e-7, 8: 4e-8, 18: 3e-15. No branch, one exp a point.
template <int N, class T>
T asg_integral_midpoints(T bandwidth_x, T bandwidth_y) {
  // The offset of the smallest worst error, found by search.
  constexpr T kOffset = N == 1   ? T(2.5)
                        : N == 2 ? T(2.75)
                        : N <= 4 ? T(6)
                        : N <= 6 ? T(9)
                                 : T(12.5);
  const T large = std::max(bandwidth_x, bandwidth_y), small = std::min(bandwidth_x, bandwidth_y);
  const T squeeze = (small + kOffset) / (large + kOffset);
  T sum = 0;
  for (const T cos_squared : internal::quarter_turn_cosines_squared<T, N>()) {
    const T k =
        internal::asg_azimuth(large, small, squeeze, cos_squared, 1 - cos_squared).bandwidth;
    sum += (k + kOffset) * one_minus_exp_over(k);
  }
  return kPi<T> / (std::sqrt(large + kOffset) * std::sqrt(small + kOffset)) * (sum / T(N));
}

template <class T>
T asg_integral_exact(T bandwidth_x, T bandwidth_y) {
  constexpr bool is_float = std::is_same_v<T, float>;
  if (std::min(bandwidth_x, bandwidth_y) > internal::kEdgeOutOfSight<T>)
    return asg_integral_fast(bandwidth_x, bandwidth_y);
  constexpr int kPoints = is_float ? 7 : 18;
  return asg_integral_midpoints<kPoints>(bandwidth_x, bandwidth_y);
}

template <class T>
T asg_integral_series(T bandwidth_x, T bandwidth_y) {
  const T large = std::max(bandwidth_x, bandwidth_y), small = std::min(bandwidth_x, bandwidth_y);
  if (small < 1) return asg_integral_exact(large, small);  // Eq. 10 is 1.5x wrong at (100, .1)
  const T nu = large - small;
  // F(a) = integral of exp(-a cos^2 phi) = 2 pi exp(-a / 2) I0(a / 2)
  const auto f = [](T a) { return 2 * kPi<T> * scaled_bessel_i0(a / 2); };
  return asg_integral_fast(large, small) -
         std::exp(-small) / (2 * large) * (f(nu) + nu / small * f(nu + nu / small));
}

template <class T>
T asg_integral(T bandwidth_x, T bandwidth_y, AsgIntegral level) {
  switch (level) {
    case AsgIntegral::fast:
      return asg_integral_fast(bandwidth_x, bandwidth_y);
    case AsgIntegral::series:
      return asg_integral_series(bandwidth_x, bandwidth_y);
    case AsgIntegral::exact:
      break;
  }
  return asg_integral_exact(bandwidth_x, bandwidth_y);
}

}  // namespace burnish
