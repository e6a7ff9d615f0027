#include "sphere_truth.h"

#include <cmath>

#include "burnish/sphere/special_functions.h"

namespace burnish::tools {
namespace {

/// Integral of exp(-k t) over [from, to].
double exponential_over(double k, double from, double to) {
  return std::exp(-k * from) * (to - from) * one_minus_exp_over(k * (to - from));
}

}  // namespace

double asg_half_space_fraction(double bandwidth_x, double bandwidth_y, double distance,
                               double azimuth) {
  // In polar coordinates of the lobe, with t = sin^2 of the polar angle, the lobe times its solid
  // angle is exp(-k t) dt / 2, and the visible part of each meridian is one interval of t. Steps
  // are equal on the ellipse of the lobe, so that they follow a long one.
  constexpr int kSteps = 4096;
  const double root_x = std::sqrt(bandwidth_x + 1), root_y = std::sqrt(bandwidth_y + 1);
  double visible = 0, whole = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double psi = 2 * kPi<double> * (i + 0.5) / kSteps;
    const double x = root_y * std::cos(psi), y = root_x * std::sin(psi);
    const double radius2 = x * x + y * y;
    const double k = (bandwidth_x * x * x + bandwidth_y * y * y) / radius2;
    const double weight = 1 / radius2;  // d phi / d psi, up to a constant
    // The boundary is where tan(polar angle) = -up / along.
    const double along = std::cos(distance) * std::cos(std::atan2(y, x) - azimuth);
    const double up = std::sin(distance);
    const double crossing = up * up / (up * up + along * along);
    const bool axis_is_visible = up > 0, rim_is_visible = along > 0;
    whole += weight * exponential_over(k, 0, 1);
    if (axis_is_visible) visible += weight * exponential_over(k, 0, rim_is_visible ? 1 : crossing);
    if (!axis_is_visible && rim_is_visible) visible += weight * exponential_over(k, crossing, 1);
  }
  return visible / whole;
}

double sg_half_space_fraction(double sharpness, double distance) {
  // The marginal of v . normal, whose mean is sin(distance): the trapezoid rule over the angle from
  // the normal, in units of the lobe's width.
  const double width = std::min(kPi<double>, 40 / std::sqrt(sharpness + 1));
  const double center = kPi<double> / 2 - distance;  // of the lobe, from the normal
  const auto over = [&](double from, double to) {
    from = std::max(from, center - width);
    to = std::min(to, center + width);
    if (!(to > from)) return 0.0;
    constexpr int kSteps = 4000;  // Simpson's rule
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double theta = from + (to - from) * i / kSteps;
      const double half = std::sin((theta - center) / 2);
      const double value = std::exp(-2 * sharpness * half * half) * std::sin(theta) *
                           scaled_bessel_i0(sharpness * std::sin(theta) * std::sin(center));
      sum += value * (i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2);
    }
    return sum * (to - from) / (3 * kSteps);
  };
  const double visible = over(0, kPi<double> / 2), hidden = over(kPi<double> / 2, kPi<double>);
  return visible / (visible + hidden);
}

}  // namespace burnish::tools
