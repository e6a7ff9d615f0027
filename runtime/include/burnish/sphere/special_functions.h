#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <unsupported/Eigen/SpecialFunctions>

#include "burnish/sphere/direction.h"

/// The special functions that lobes on the sphere need and <cmath> lacks. Errors are relative, the
/// worst that was measured; they are asserted by SpecialFunctions.* in tests/sphere.
namespace burnish {

/// (1 - exp(-x)) / x for x >= 0, accurate near zero: 1.5 epsilons.
template <class T>
T one_minus_exp_over(T x) {
  return x > 0 ? -std::expm1(-x) / x : T(1);
}

/// exp(-|x|) I0(x), I0 the modified Bessel function: 5e-7 in float, 1e-15 in double, for every
/// finite x. Stays finite where I0 overflows (x > 88 in float).
template <class T>
T scaled_bessel_i0(T x) {
  return Eigen::numext::bessel_i0e(x);
}

/// exp(-|x|) I1(x), an odd function: 1.3e-6 in float, 2e-15 in double, for every finite x.
template <class T>
T scaled_bessel_i1(T x) {
  return Eigen::numext::bessel_i1e(x);
}

/// The x with erf(x) = y: two epsilons of x, for y as small as the smallest normal number and as
/// close to +-1 as T allows. y = +-1 counts as its neighbour toward 0, so that a sampler that draws
/// it stays finite: the result is at most 3.84 in float and 5.87 in double.
///
/// Based on: giles2012erfinv, whose polynomial gives six digits; a step of Halley's method triples
/// that. The tails (0.3 % of all y) start from erfc's asymptote. There the steps are on erfc, since
/// erf is 1 to all digits.
template <class T>
T inverse_erf(T y) {
  const T limit = 1 - std::numeric_limits<T>::epsilon() / 2;
  const T magnitude = std::min(std::abs(y), limit);
  const T rest = 1 - magnitude;  // exact where magnitude >= 1/2
  const T w = -std::log(rest * (1 + magnitude));
  const bool tail = w > 5;
  T x;
  if (tail) {
    x = std::sqrt(w + T(std::log(2.0)) - std::log(kPi<T> * w) / 2);
  } else {
    x = T(2.81022636e-08);
    for (const double c : {3.43273939e-07, -3.5233877e-06, -4.39150654e-06, 0.00021858087,
                           -0.00125372503, -0.00417768164, 0.246640727, 1.50140941})
      x = T(c) + x * (w - T(2.5));
    x *= magnitude;
  }
  for (int step = 0; step < (tail ? 3 : 1); ++step) {
    const T excess = magnitude < T(0.5) ? std::erf(x) - magnitude : rest - std::erfc(x);
    const T newton = excess * (std::sqrt(kPi<T>) / 2) * std::exp(x * x);
    x -= newton / (1 + x * newton);
  }
  return std::copysign(x, y);
}

}  // namespace burnish
