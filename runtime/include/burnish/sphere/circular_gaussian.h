#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/sphere/frame.h"
#include "burnish/sphere/gauss_legendre.h"
#include "burnish/sphere/special_functions.h"
#include "burnish/sphere/spherical_gaussian.h"

/// Based on: circular Gaussians (iwasaki2014cloth), the lobes of a fibre: one in the azimuth around
/// it, and a plain Gaussian in the longitudinal angle. Sharpness means the same in both and in a
/// spherical Gaussian: a variance of 1/sharpness, for narrow lobes.
namespace burnish {

/// amplitude * exp(sharpness * (cos(phi - center) - 1)), of period 2 pi.
template <class T>
struct CircularGaussian {
  T center = 0;     ///< radians
  T sharpness = 1;  ///< >= 0
  T amplitude = 1;
};

/// amplitude * exp(-sharpness / 2 * (theta - center)^2).
template <class T>
struct LongitudinalGaussian {
  T center = 0;     ///< radians
  T sharpness = 1;  ///< >= 0, 1 / sigma^2
  T amplitude = 1;
};

template <class T>
T eval(const CircularGaussian<T>& lobe, T phi) {
  const T s = std::sin((phi - lobe.center) / 2);
  return lobe.amplitude * std::exp(-lobe.sharpness * (2 * s * s));
}

template <class T>
T eval(const LongitudinalGaussian<T>& lobe, T theta) {
  const T d = theta - lobe.center;
  return lobe.amplitude * std::exp(-lobe.sharpness * (d * d / 2));
}

/// Integral over the circle, 2 pi exp(-k) I0(k), to 4 (float) or 6 (double) epsilons.
template <class T>
T integral(const CircularGaussian<T>& lobe) {
  return lobe.amplitude * (2 * kPi<T> * scaled_bessel_i0(lobe.sharpness));
}

namespace internal {

/// The product of two lobes but for the amplitudes, as sg_product in the plane: with L the larger
/// sharpness and r the ratio, the unit vectors' sum 1 + r exp(2 i h) for centers 2 h apart.
template <class T>
struct CircularProduct {
  T center, sharpness, exponent;
};

template <class T>
CircularProduct<T> circular_product(const CircularGaussian<T>& a, const CircularGaussian<T>& b) {
  const bool a_larger = a.sharpness >= b.sharpness;
  const CircularGaussian<T>&narrow = a_larger ? a : b, &wide = a_larger ? b : a;
  const T ratio = narrow.sharpness > 0 ? wide.sharpness / narrow.sharpness : T(0);
  const T half = (wide.center - narrow.center) / 2;
  const T c = std::cos(half), s = std::sin(half);
  const T x = (1 - ratio) + 2 * ratio * c * c, y = 2 * ratio * s * c;
  const T length = std::hypot(x, y);
  return {narrow.center + std::atan2(y, x),
          std::min(narrow.sharpness * length, std::numeric_limits<T>::max()),
          -(wide.sharpness / (length + 1 + ratio)) * (4 * s * s)};
}

}  // namespace internal

/// Product of two lobes: exact, again a lobe. Opposite centers of equal sharpness give sharpness 0
/// (to rounding of pi) about the first.
template <class T>
CircularGaussian<T> product(const CircularGaussian<T>& a, const CircularGaussian<T>& b) {
  const internal::CircularProduct<T> p = internal::circular_product(a, b);
  return {p.center, p.sharpness,
          internal::scaled_product(a.amplitude, b.amplitude, std::exp(p.exponent))};
}

/// Integral of the product over the circle, exact.
template <class T>
T inner_product(const CircularGaussian<T>& a, const CircularGaussian<T>& b) {
  const internal::CircularProduct<T> p = internal::circular_product(a, b);
  return internal::scaled_product(
      a.amplitude, b.amplitude, 2 * kPi<T> * scaled_bessel_i0(p.sharpness) * std::exp(p.exponent));
}

/// Product of two Gaussians on the line: exact, again one.
template <class T>
LongitudinalGaussian<T> product(const LongitudinalGaussian<T>& a,
                                const LongitudinalGaussian<T>& b) {
  const bool a_larger = a.sharpness >= b.sharpness;
  const LongitudinalGaussian<T>&narrow = a_larger ? a : b, &wide = a_larger ? b : a;
  const T ratio = narrow.sharpness > 0 ? wide.sharpness / narrow.sharpness : T(0);
  const T d = wide.center - narrow.center, share = ratio / (1 + ratio);
  return {narrow.center + share * d,
          std::min(narrow.sharpness * (1 + ratio), std::numeric_limits<T>::max()),
          internal::scaled_product(a.amplitude, b.amplitude,
                                   std::exp(-(wide.sharpness / (1 + ratio)) * (d * d / 2)))};
}

namespace internal {

/// erf(b) - erf(a) for a <= b, without cancellation in the tails, where both are +-1.
template <class T>
T erf_difference(T a, T b) {
  if (a > T(0.5)) return std::erfc(a) - std::erfc(b);
  if (b < T(-0.5)) return std::erfc(-b) - std::erfc(-a);
  return std::erf(b) - std::erf(a);
}

/// A Gaussian's integrand counts down to exp(-kDecay) of its largest value.
template <class T>
inline constexpr T kDecay = std::numeric_limits<T>::digits > 24 ? T(37) : T(17);

/// Integral of f over [from, to] by Gauss-Legendre with 7 nodes on each panel: relative error 1e-7
/// (float) and 3e-12 (double) for a Gaussian cut off by kDecay, times something smooth.
template <class T, class F>
T integrate_smooth(T from, T to, const F& f) {
  const auto& rule = unit_gauss<7>();
  constexpr int kPanels = std::numeric_limits<T>::digits > 24 ? 18 : 6;
  if (!(from < to)) return 0;
  const T step = (to - from) / kPanels;
  T sum = 0;
  for (int panel = 0; panel < kPanels; ++panel)
    for (int i = 0; i < 7; ++i)
      sum += T(rule.weight[i]) * f(from + step * (T(panel) + T(rule.node[i])));
  return step * sum;
}

/// Least distance of [from, to] from 0.
template <class T>
T distance_from_zero(T from, T to) {
  return std::max({from, -to, T(0)});
}

/// angle - center - 2 pi turns, without the rounding of the difference and of 2 pi: next to the
/// center it has all the digits that the arguments have.
template <class T>
T angle_from_center(T angle, T center, T turns) {
  constexpr T kTurn = 2 * kPi<T>;
  constexpr T kRest =  // 2 pi - kTurn
      std::numeric_limits<T>::digits > 24 ? T(2.4492935982947064e-16) : T(-1.7484555e-7);
  const T difference = angle - center, moved = difference - angle;
  const T lost = (angle - (difference - moved)) - (center + moved);
  return (difference - turns * kTurn) + (lost - turns * kRest);
}

/// Calls visit(from, to) with the parts of an arc, relative to a lobe's center, that lie in each
/// of the lobe's periods.
template <class T, class Visit>
void for_each_period(T center, T from, T to, const Visit& visit) {
  constexpr T pi = kPi<T>;
  const T middle = std::round(((to - from) / 2 + (from - center)) / (2 * pi));
  for (const T turns : {middle - 1, middle, middle + 1}) {
    const T low = std::max(angle_from_center(from, center, turns), -pi);
    const T high = std::min(angle_from_center(to, center, turns), pi);
    if (low < high) visit(low, high);
  }
}

}  // namespace internal

/// Integral over the arc from <= phi <= to, at most 2 pi long, anywhere on the circle. Relative
/// error 1e-6 (float), 3e-12 (double), in the tails four epsilons more for each unit of the
/// exponent at the nearer end; and what the rounding of the ends' distances from the center does to
/// arcs shorter than the distance. 2 pi is that of the real numbers: an angle that was rounded near
/// it is as far off as it was rounded, which moves a lobe of sharpness k by sqrt(k) times that.
template <class T>
T integral_over_arc(const CircularGaussian<T>& lobe, T from, T to) {
  T sum = 0;
  internal::for_each_period(lobe.center, from, to, [&](T low, T high) {
    const T s = std::sin(internal::distance_from_zero(low, high) / 2);
    const T end = s * s + internal::kDecay<T> / 2 / lobe.sharpness;
    const T reach = end < 1 ? 2 * std::asin(std::sqrt(end)) : kPi<T>;
    sum += internal::integrate_smooth(std::max(low, -reach), std::min(high, reach), [&](T x) {
      const T sine = std::sin(x / 2);
      return std::exp(-lobe.sharpness * (2 * sine * sine));
    });
  });
  return lobe.amplitude * sum;
}

/// As integral_over_arc, by erf from sharpness 5: error relative to the whole circle 9.3e-4 at
/// 5, 8.7e-5 at 10, 1e-5 at 20, falling with its cube, where the usual sqrt(pi / (2 k))
/// erf(sqrt(k / 2) x) errs by 2.8, 1.3, .64 %. Below 5, integral_over_arc itself.
///
/// With s = sqrt(2 k) sin(x / 2) the integrand is exp(-s^2) / sqrt(1 - s^2 / (2 k)), of which the
/// root's series is kept to its third term.
template <class T>
T integral_over_arc_fast(const CircularGaussian<T>& lobe, T from, T to) {
  if (!(lobe.sharpness >= 5)) return integral_over_arc(lobe, from, to);
  const T root = std::sqrt(lobe.sharpness) * T(std::sqrt(2.0)), inverse = 1 / (8 * lobe.sharpness);
  const auto rest = [&](T s, T sine) {
    return s * std::exp(-s * s) * inverse * (1 + T(4.5) * inverse + T(0.75) * sine * sine);
  };
  T sum = 0;
  internal::for_each_period(lobe.center, from, to, [&](T low, T high) {
    const T sine_a = std::sin(low / 2), sine_b = std::sin(high / 2);
    const T a = root * sine_a, b = root * sine_b;
    sum += (1 + inverse * (1 + T(4.5) * inverse)) * (std::sqrt(kPi<T>) / 2) *
               internal::erf_difference(a, b) +
           rest(a, sine_a) - rest(b, sine_b);
  });
  return lobe.amplitude * std::max(sum * 2 / root, T(0));
}

/// Integral over from <= theta <= to, exact, also in the tails.
template <class T>
T integral(const LongitudinalGaussian<T>& lobe, T from, T to) {
  const T root = std::sqrt(lobe.sharpness / 2);
  if (!(root * std::max(std::abs(from - lobe.center), std::abs(to - lobe.center)) >
        std::numeric_limits<T>::epsilon()))
    return lobe.amplitude * (to - from);
  return lobe.amplitude * (std::sqrt(kPi<T>) / 2) / root *
         internal::erf_difference(root * (from - lobe.center), root * (to - lobe.center));
}

/// Integral of lobe(theta) cos(theta) over [from, to] within [-pi/2, pi/2]: a function of the
/// latitude over the sphere. Errors as integral_over_arc.
template <class T>
T integral_times_cosine(const LongitudinalGaussian<T>& lobe, T from, T to) {
  // Relative to the center, whose own digits a narrow lobe does not have to spare.
  const T low = from - lobe.center, high = to - lobe.center;
  const T nearest = internal::distance_from_zero(low, high);
  const T reach = std::sqrt(nearest * nearest + 2 * internal::kDecay<T> / lobe.sharpness);
  const T c = std::cos(lobe.center), s = std::sin(lobe.center);
  return lobe.amplitude *
         internal::integrate_smooth(std::max(low, -reach), std::min(high, reach), [&](T x) {
           const T cosine = c * std::cos(x) - s * std::sin(x);  // of the latitude
           return std::exp(-(lobe.sharpness * x) * x / 2) * std::max(cosine, T(0));
         });
}

/// A spherical Gaussian at latitude theta (from the xy plane of `frame` toward z) and azimuth phi
/// is exactly longitudinal(theta) * azimuthal(phi) with these two: the exponent is
/// L (cos(theta - theta_p) - 1) + L cos(theta) cos(theta_p) (cos(phi - phi_p) - 1).
/// @{
template <class T>
CircularGaussian<T> longitudinal_factor(const SphericalGaussian<T>& lobe, const Frame<T>& frame) {
  const Vector3<T> p = frame.to_local(lobe.axis);
  return {std::atan2(p.z(), std::hypot(p.x(), p.y())), lobe.sharpness, lobe.amplitude};
}
template <class T>
CircularGaussian<T> azimuthal_factor(const SphericalGaussian<T>& lobe, const Frame<T>& frame,
                                     T theta) {
  const Vector3<T> p = frame.to_local(lobe.axis);
  return {std::atan2(p.y(), p.x()),
          lobe.sharpness * std::max(std::cos(theta), T(0)) * std::hypot(p.x(), p.y()), T(1)};
}
/// @}

}  // namespace burnish
