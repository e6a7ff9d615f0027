#include "specular_truth.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/half_space.h"

namespace burnish::tools {
namespace {

void add(const Vector3<double>& direction, double weight,
         std::span<const SphericalGaussian<double>> lights, Reflected& sum) {
  for (size_t l = 0; l < lights.size(); ++l) sum.by_light[l] += weight * eval(lights[l], direction);
  sum.energy += weight;
}

/// Of a bandwidth that may be 0.
double root(float bandwidth) { return std::sqrt(std::max(double(bandwidth), 1e-6)); }

}  // namespace

Reflected integrate_brdf(const Material& material, const Vector3f& outgoing,
                         std::span<const SphericalGaussian<double>> lights) {
  // Midpoints in the slopes of the half vector, in units of alpha: r = s^2 / (1 - s) is dense at
  // the peak and reaches the longest tail.
  constexpr int kRadii = 256, kAzimuths = 192;
  Reflected sum{std::vector<double>(lights.size()), 0};
  const Vector3<double> o = outgoing.cast<double>();
  for (int a = 0; a < kAzimuths; ++a) {
    const double azimuth = 2 * kPi<double> * (a + 0.5) / kAzimuths;
    for (int k = 0; k < kRadii; ++k) {
      const double s = (k + 0.5) / kRadii, radius = s * s / (1 - s);
      const double slope_x = double(material.alpha_x) * radius * std::cos(azimuth);
      const double slope_y = double(material.alpha_y) * radius * std::sin(azimuth);
      const double z = 1 / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
      const Vector3<double> half(slope_x * z, slope_y * z, z);
      const double cosine = o.dot(half);
      const Vector3<double> incoming = 2 * cosine * half - o;
      if (cosine <= 0 || incoming.z() <= 0) continue;
      const double step = (s * (2 - s)) / ((1 - s) * (1 - s)) / kRadii;
      const double solid_angle = double(material.alpha_x) * double(material.alpha_y) * radius *
                                 step * (2 * kPi<double> / kAzimuths) * z * z * z;
      const double f = eval_specular_brdf(material, outgoing, incoming.cast<float>()).mean();
      add(incoming, f * incoming.z() * 4 * cosine * solid_angle, lights, sum);
    }
  }
  return sum;
}

Reflected integrate_slice(std::span<const SliceLobe> slice, SpecularForm form,
                          std::span<const SphericalGaussian<double>> lights) {
  // Strata of equal mass of the Gaussian on each azimuth of its disc.
  constexpr int kRadii = 24, kAzimuths = 16;
  Reflected sum{std::vector<double>(lights.size()), 0};
  for (const SliceLobe& part : slice) {
    const Frame<double> frame = part.lobe.frame.cast<double>();
    double weight = double(part.weight.mean()) * double(part.integral);
    if (form == SpecularForm::peak) {
      const Vector3f up = Vector3f::UnitZ() - part.lobe.frame.z.z() * part.lobe.frame.z;
      const float distance = std::asin(std::clamp(part.lobe.frame.z.z(), -1.0f, 1.0f));
      weight *= double(visible_fraction(VisibilityModel::directional, part.lobe, distance,
                                        up.norm() > 1e-6f ? up.normalized() : Vector3f::Zero()));
    }
    std::vector<std::pair<Vector3<double>, double>> nodes;
    double mass = 0;
    for (int a = 0; a < kAzimuths; ++a) {
      const double azimuth = 2 * kPi<double> * (a + 0.5) / kAzimuths;
      const double x = std::cos(azimuth) / root(part.lobe.bandwidth_x);
      const double y = std::sin(azimuth) / root(part.lobe.bandwidth_y);
      const double top = -std::expm1(-1 / (x * x + y * y));
      for (int k = 0; k < kRadii; ++k) {
        const double r = std::sqrt(-std::log1p(-top * (k + 0.5) / kRadii));
        const double z = std::sqrt(std::max(0.0, 1 - r * r * (x * x + y * y)));
        nodes.emplace_back(frame.to_world({r * x, r * y, z}), top);
        mass += top;
      }
    }
    for (const auto& [direction, share] : nodes) add(direction, weight * share / mass, lights, sum);
  }
  return sum;
}

}  // namespace burnish::tools
