#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/gauss_legendre.h"

/// Exact importance sampling of an ASG by inversion: two uniform numbers, no rejection, so that
/// stratified and quasi-random points keep their structure. For all bandwidths from 0 on.
namespace burnish {

namespace internal {

/// psi (asg_integral.h) with G(psi) = u G(pi / 2), G the integral of g: where a uniform number
/// lands in a quarter turn. g rises with psi, between 1 and the offset, so that G is convex and
/// Newton's method converges from anywhere; from u pi / 2 in 2 to 4 steps.
template <class T>
T sample_asg_azimuth(T large, T small, T squeeze, T offset, T u) {
  const auto density = [&](T psi) {
    const T c = std::cos(psi), s = std::sin(psi);
    const T k = asg_azimuth(large, small, squeeze, c * c, s * s).bandwidth;
    return (k + offset) * one_minus_exp_over(k);
  };
  const auto integral = [&](const auto& rule, T from, T to) {
    T sum = 0;
    for (size_t i = 0; i < rule.node.size(); ++i)
      sum += T(rule.weight[i]) * density(from + (to - from) * T(rule.node[i]));
    return (to - from) * sum;
  };
  // Error of the distribution function, rounding included: 1.3e-6 and 5e-11 for any bandwidths. A
  // step of Newton's method is short, a third of the points does for it.
  constexpr bool is_float = std::is_same_v<T, float>;
  constexpr int kPoints = is_float ? 12 : 24;
  const auto& rule = unit_gauss<kPoints>();
  const auto& step_rule = unit_gauss<kPoints / 3>();
  constexpr T kQuarter = kPi<T> / 2;
  T psi = u * kQuarter, reached = integral(rule, 0, psi);
  const T target = u * integral(rule, 0, kQuarter);
  // The error after a step is below the step's square.
  const T last_step = std::sqrt(std::numeric_limits<T>::epsilon());
  for (int step = 0; step < 8; ++step) {
    const T next = std::clamp(psi + (target - reached) / density(psi), T(0), kQuarter);
    if (std::abs(next - psi) <= last_step) return next;
    reached += integral(step_rule, psi, next);
    psi = next;
  }
  return psi;
}

}  // namespace internal

/// A direction distributed as the lobe, from u and v uniform in [0, 1); 1 counts as its neighbour.
/// Continuous and one to one in both: u is the azimuth, round the axis from the direction of the
/// larger bandwidth (from x toward y, or from y toward x), v the distance from the axis. Density:
/// pdf(lobe, direction).
///
/// The radius given the azimuth inverts in closed form. The azimuth psi is uniform where the disc's
/// edge is out of sight; else its density is the g of asg_integral.h, inverted numerically.
template <class T>
Vector3<T> sample(const AnisotropicGaussian<T>& lobe, T u, T v) {
  const bool x_is_narrow = lobe.bandwidth_x >= lobe.bandwidth_y;
  const T large = x_is_narrow ? lobe.bandwidth_x : lobe.bandwidth_y;
  const T small = x_is_narrow ? lobe.bandwidth_y : lobe.bandwidth_x;
  constexpr T kBelowOne = 1 - std::numeric_limits<T>::epsilon() / 2;
  const T u_azimuth = std::clamp(u, T(0), kBelowOne);
  const T u_radius = std::clamp(v, T(0), kBelowOne);

  // Quarter turns; the second and fourth run backward, so that the azimuth is continuous.
  const int quarter = static_cast<int>(4 * u_azimuth);
  const T along = 4 * u_azimuth - T(quarter);
  const T fraction = quarter % 2 == 0 ? along : 1 - along;
  const bool inside = small > internal::kEdgeOutOfSight<T>;
  const T offset = inside ? T(0) : T(3);
  const T squeeze = (small + offset) / (large + offset);
  const T psi = inside ? fraction * (kPi<T> / 2)
                       : internal::sample_asg_azimuth(large, small, squeeze, offset, fraction);
  const T narrow = std::sqrt(squeeze) * std::max(std::cos(psi), T(0)), wide = std::sin(psi);
  const T length = std::hypot(narrow, wide);
  const T cosine = narrow / length, sine = wide / length;

  // Radius squared, with density exp(-k t) in [0, 1]. Below an epsilon, k does not matter.
  const T k = large * (cosine * cosine) + small * (sine * sine);
  const T t = k > std::numeric_limits<T>::epsilon()
                  ? std::min(std::log1p(u_radius * std::expm1(-k)) / -k, T(1))
                  : u_radius;
  const T r = std::sqrt(t);
  const T x = quarter == 1 || quarter == 2 ? -r * cosine : r * cosine;
  const T y = quarter >= 2 ? -r * sine : r * sine;
  const Vector3<T> local(x_is_narrow ? x : y, x_is_narrow ? y : x, std::sqrt(1 - t));
  return lobe.frame.to_world(local);
}

/// Density of `sample`, per steradian: the lobe over its integral. At most sqrt(bandwidth_x
/// bandwidth_y) / pi for narrow lobes; the amplitude does not matter.
template <class T>
T pdf(const AnisotropicGaussian<T>& lobe, const Vector3<T>& direction) {
  AnisotropicGaussian<T> unit = lobe;
  unit.amplitude = 1;
  return eval(unit, direction) / integral(unit);
}

}  // namespace burnish
