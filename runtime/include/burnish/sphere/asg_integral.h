#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "burnish/sphere/direction.h"
#include "burnish/sphere/special_functions.h"

/// The integral of a unit-amplitude ASG over the sphere. Since (v . z) dv = dx dy, it is that of a
/// plain 2-D Gaussian over the unit disc. Derivations and error: docs/maths.md, "ASG integral".
namespace burnish {

enum class AsgIntegral {
  fast,    ///< pi / sqrt(bandwidth_x bandwidth_y), xu2013asg Eq. 11: 0.7 % for bandwidths > 5
  series,  ///< xu2013asg Eq. 10: 0.03 % for bandwidths > 5, 5 % > 1; falls back to exact below 1
  exact,   ///< to rounding: 1e-6 in float, 1e-12 in double, bandwidths 0..1e8
};

template <class T>
T asg_integral_fast(T bandwidth_x, T bandwidth_y) {
  return kPi<T> / (std::sqrt(bandwidth_x) * std::sqrt(bandwidth_y));
}

template <class T>
T asg_integral_exact(T bandwidth_x, T bandwidth_y) {
  constexpr bool is_float = std::is_same_v<T, float>;
  // Where each branch takes over, and how long its series is: chosen so that the error stays below
  // 3e-7 (float) and 1e-13 (double) over [0, 1e8]^2.
  constexpr T kAsymptoticFrom = is_float ? T(14) : T(28.5);
  constexpr T kSeriesFrom = is_float ? T(8) : T(25);
  constexpr int kSeriesTerms = is_float ? 5 : 12;
  constexpr int kTrapezoidPoints = is_float ? 9 : 22;

  const T large = std::max(bandwidth_x, bandwidth_y), small = std::min(bandwidth_x, bandwidth_y);
  if (small > kAsymptoticFrom) return asg_integral_fast(large, small);
  const T half_difference = (large - small) / 2;
  if (half_difference > kSeriesFrom) {
    const T root_small = std::sqrt(small), root_difference = std::sqrt(large - small);
    const T erf_over_root = small > 0 ? std::erf(root_small) / root_small : 2 / std::sqrt(kPi<T>);
    const T leading =
        erf_over_root / root_difference -
        root_small / (std::sqrt(large) * root_difference * (std::sqrt(large) + root_difference));
    // Exponential integrals E_{j+1/2}(small), by recurrence from E_{1/2} = sqrt(pi / small)
    // erfc(sqrt(small)).
    const T exp_small = std::exp(-small);
    T e = (exp_small - std::sqrt(kPi<T>) * root_small * std::erfc(root_small)) / T(0.5);  // E_{3/2}
    T coefficient = 1, power = 1, sum = 0;
    for (int j = 1; j <= kSeriesTerms; ++j) {
      const T odd = T(2 * j - 1);
      coefficient *= odd * odd / T(8 * j);
      power /= half_difference;
      sum += coefficient * power * e;
      e = (exp_small - small * e) / (T(j) + T(0.5));
    }
    return kPi<T> * leading - std::sqrt(kPi<T> / (large - small)) * sum;
  }
  T sum = 0;
  for (int i = 0; i < kTrapezoidPoints; ++i) {
    const T phi = kPi<T> / 2 * T(i) / T(kTrapezoidPoints - 1);
    const T c = std::cos(phi), s = std::sin(phi);
    const T value = one_minus_exp_over(large * c * c + small * s * s);
    sum += (i == 0 || i == kTrapezoidPoints - 1) ? value / 2 : value;
  }
  return kPi<T> / T(kTrapezoidPoints - 1) * sum;
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
