#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "burnish/sphere/spherical_gaussian.h"

/// The fraction of a spherical Gaussian that is visible past a boundary at a signed angular
/// distance from its axis (radians, positive: the axis is visible). Derivations and errors:
/// docs/maths.md, "Visible fraction". Every function takes a sharpness from 0 to the largest finite
/// number. Distances beyond +-pi/2 count as +-pi/2 (pi in `cap`). For a half-space P(d) + P(-d) =
/// 1, and the small one of the two keeps its digits.
namespace burnish {

/// How accurately the hemisphere model is evaluated.
enum class HemisphereLevel {
  fast,   ///< one erf: absolute error 4.1e-4; hidden tails above 1e-14 within a factor 1.6
  exact,  ///< to rounding, relative in the hidden tail: 1e-6 in float, 1e-12 in double
};

/// Fraction of a spherical Gaussian inside a cap of radius `distance` around its axis.
template <class T>
T visible_fraction_cap(T sharpness, T distance) {
  if (distance <= 0) return 0;
  const T half_sine = std::sin(std::min(distance, kPi<T>) / 2);
  const T height = 2 * half_sine * half_sine;  // 1 - cos without its cancellation
  if (sharpness > 1) return -std::expm1(-sharpness * height) / -std::expm1(-2 * sharpness);
  return std::min(
      height * one_minus_exp_over(sharpness * height) / (2 * one_minus_exp_over(2 * sharpness)),
      T(1));
}

namespace internal {

/// (erf(far) - erf(x)) / (2 erf(far)) for 0 <= x <= far: the tail beyond x of a Gaussian that is
/// cut off at +-far. A difference of erfs for a wide Gaussian, of erfcs for a narrow one, so that
/// neither cancels.
template <class T>
T gaussian_tail(T x, T far) {
  const T whole = std::erf(far);
  const T tail = far < 1 ? whole - std::erf(x) : std::erfc(x) - std::erfc(far);
  return std::max(tail / (2 * whole), T(0));
}

/// Below any bandwidth's root that makes a difference: keeps 0 / 0 out of gaussian_tail.
template <class T>
inline constexpr T kSmallestRoot = T(1e-18);

}  // namespace internal

/// What the fast hemisphere level needs of a sharpness: computed once per lobe shape.
template <class T>
struct HemisphereShape {
  T opposite;        ///< the fraction for a boundary at -pi/2, exact
  T steepness;       ///< k
  T bend_1, bend_2;  ///< w_1, w_2
  T far;             ///< erf's argument for a boundary at pi/2
};

/// Hidden fraction: opposite + (1 - 2 opposite) (erf(far) - erf(x)) / (2 erf(far)) with x = k sin /
/// sqrt(1 + w_1 u + w_2 u^2), u = 1 - cos. Its limits are exact: 1/2 for sharpness 0; for a large
/// one x = sqrt(2 sharpness) sin(distance / 2), the true exponent. Between them k, w_1 and w_2 are
/// rational functions, fitted (minimax) over sharpness 0.1..1000.
template <class T>
HemisphereShape<T> prepare_hemisphere(T sharpness) {
  // From 1e4 on the rational functions are at their limits; their powers would overflow.
  const T s = std::min(sharpness, T(1e4)), square = s * s;
  HemisphereShape<T> shape;
  const T e = std::exp(-sharpness);
  shape.opposite = e / (1 + e);
  const T slope = s * (square / 2 + T(0.13600136) * s + T(7.45753026)) /
                  (square * s + T(1.02200273) * square + T(14.3527802) * s + T(26.1523456));
  shape.steepness = std::max(std::sqrt(sharpness) * std::sqrt(slope), internal::kSmallestRoot<T>);
  shape.bend_1 = square / (-2 * (square - T(0.26223606) * s + T(5.17400423)));
  shape.bend_2 = shape.bend_1 / (-2 * (1 + square * s / T(1208.6)));
  shape.far = shape.steepness / std::sqrt(1 + shape.bend_1 + shape.bend_2);
  return shape;
}

/// Visible fraction of a prepared sharpness, fast level; sine and cosine of a distance in
/// [-pi/2, pi/2].
template <class T>
T hemisphere_fraction(const HemisphereShape<T>& shape, T sine, T cosine) {
  const T u = 1 - cosine;
  const T x =
      shape.steepness * std::abs(sine) / std::sqrt(1 + u * (shape.bend_1 + u * shape.bend_2));
  const T hidden = shape.opposite + (1 - 2 * shape.opposite) *
                                        internal::gaussian_tail(std::min(x, shape.far), shape.far);
  return sine >= 0 ? 1 - hidden : hidden;
}

namespace internal {

/// Cosines at the midpoints of N equal steps of a half turn that are positive.
template <int N>
inline constexpr std::array<double, N / 2> kHalfTurnCosines = {};
template <>
inline constexpr std::array<double, 4> kHalfTurnCosines<8> = {
    0.980785280403230449, 0.831469612302545237, 0.555570233019602225, 0.195090322016128268};
template <>
inline constexpr std::array<double, 6> kHalfTurnCosines<12> = {
    0.991444861373810411, 0.923879532511286756, 0.793353340291235165,
    0.608761429008720640, 0.382683432365089772, 0.130526192220051592};

/// Hidden fraction of a lobe of sharpness L whose axis is at a distance >= 0 inside the half-space.
///
/// Along the boundary, a great circle, at the angle alpha from its point nearest to the axis, the
/// distance from the axis is beta with cos beta = cos(distance) cos alpha, and the mass beyond it
/// in that azimuth is elementary:
///   hidden = 1/(2 pi) integral over alpha in [-pi, pi] of m sin(distance) / (1 - cos^2 beta),
///   m = (exp(-L (1 - cos beta)) - exp(-2 L)) / (1 - exp(-2 L)).
/// The trapezoid rule converges exponentially but for the pole at cos beta = 1, where m = 1: its
/// share of the rule's error is known in closed form, and added. Every term is positive, so the
/// tail keeps its digits. A wide lobe takes equal steps of an angle psi with tan(alpha / 2) = kappa
/// tan(psi / 2), a narrow one equal steps in sin(alpha / 2), in which it is a Gaussian. Steps and
/// their number were chosen for the smallest worst error.
///
/// In double for a float's precision, too: rounding, not the rule, would rule its error.
template <bool is_float>
double hemisphere_hidden_exact(double sharpness, double sine, double cosine) {
  using T = double;
  constexpr T kNarrowFrom = 20;
  const T along = sharpness * cosine;
  const T toward = sine * sine / (1 + cosine);  // 1 - cos(distance)
  const T exponent = sharpness * toward;
  T sum = 0, pole = 0;
  if (along > kNarrowFrom) {
    constexpr int kPoints = is_float ? 5 : 10;
    constexpr T kStep = is_float ? T(0.75) : T(0.55);  // in units of the Gaussian's width
    constexpr T kPoleUntil = is_float ? 18 : 22;       // beyond it the pole does not matter
    for (int i = 0; i < kPoints; ++i) {
      const T square = (T(i) + T(0.5)) * (T(i) + T(0.5)) * kStep * kStep;
      const T depth = exponent + square;  // L (1 - cos beta)
      sum +=
          std::exp(-depth) / (depth * (2 - depth / sharpness) * std::sqrt(1 - square / along / 2));
    }
    sum *= std::sqrt(sharpness) * (sine / std::sqrt(cosine)) * (std::sqrt(T(2)) * kStep / kPi<T>);
    if (exponent < kPoleUntil) pole = 1 / (1 + std::exp(2 * kPi<T> / kStep * std::sqrt(exponent)));
    return sum + pole;
  }
  constexpr int kSteps = is_float ? 8 : 12;  // of a half turn
  constexpr T kSqueeze = is_float ? T(0.15) : T(0.05);
  constexpr T kPoleUntil = is_float ? 10 : 14;
  const T kappa = 1 / std::sqrt(1 + kSqueeze * along);
  // Where it is larger, exp(-2 L) has no digits in the result.
  const T mild = std::min(sharpness, T(80));
  for (const double node : kHalfTurnCosines<kSteps>) {
    for (const T c : {T(node), T(-node)}) {
      const T scale = 1 / ((1 + c) + kappa * kappa * (1 - c));  // d alpha / d psi = 2 kappa scale
      const T away = 2 * kappa * kappa * (1 - c) * scale;       // 1 - cos alpha
      const T depth = toward + cosine * away;                   // 1 - cos beta
      sum += std::exp(-exponent - along * away) * one_minus_exp_over(mild * (2 - depth)) * scale /
             depth;
    }
  }
  sum *= sine * kappa / (T(kSteps) * one_minus_exp_over(2 * mild));
  if (exponent < kPoleUntil) {
    const T ratio = sine / ((1 + cosine) * kappa);  // tan(distance / 2) / kappa
    T power = (1 - ratio) / (1 + ratio);
    power *= power;
    power = kSteps == 8 ? power * power : power * power * power;
    power *= power;
    power *= power;  // to the number of steps of a full turn, 16 or 24
    pole = power / (1 + power);
  }
  return sum + pole;
}

}  // namespace internal

/// Fraction of a spherical Gaussian on the visible side of a great circle.
template <class T>
T visible_fraction_hemisphere(T sharpness, T distance,
                              HemisphereLevel level = HemisphereLevel::fast) {
  const T theta = std::clamp(distance, -kPi<T> / 2, kPi<T> / 2);
  const T sine = std::sin(theta), cosine = std::max(std::cos(theta), T(0));
  if (level == HemisphereLevel::fast)
    return hemisphere_fraction(prepare_hemisphere(sharpness), sine, cosine);
  const T hidden = T(internal::hemisphere_hidden_exact<std::is_same_v<T, float>>(
      double(sharpness), std::abs(std::sin(double(theta))),
      std::max(std::cos(double(theta)), 0.0)));
  return sine >= 0 ? 1 - hidden : hidden;
}

/// Integral of a spherical Gaussian over the half-space whose boundary is at `distance`.
template <class T>
T hemisphere_integral(const SphericalGaussian<T>& lobe, T distance,
                      HemisphereLevel level = HemisphereLevel::exact) {
  return integral(lobe) * visible_fraction_hemisphere(lobe.sharpness, distance, level);
}

}  // namespace burnish
