#include "burnish/material/fresnel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burnish {
namespace {

float schlick(float normal_reflectance, float cosine) {
  const float m = 1 - cosine;
  return normal_reflectance + (1 - normal_reflectance) * (m * m) * (m * m) * m;
}

/// cook1982's form of Fresnel's equations, with g = sqrt(eta^2 - 1 + c^2); g - c from the
/// difference of the squares, which keeps its digits for eta near 1.
float dielectric(float eta, float c) {
  const float contrast = (eta - 1) * (eta + 1);
  const float g2 = contrast + c * c;
  if (g2 <= 0) return contrast < 0 ? 1.0f : 0.0f;  // total reflection; or no interface
  const float g = std::sqrt(g2), sum = g + c, difference = contrast / sum;
  const float perpendicular = difference / sum;
  const float ratio = (c * sum - 1) / (c * difference + 1);
  return std::min(perpendicular * perpendicular * (1 + ratio * ratio) / 2, 1.0f);
}

/// The same for a complex index: a + i b = sqrt((eta + i k)^2 - sin^2). All terms are positive.
float conductor(float eta, float k, float c) {
  const float sine2 = (1 - c) * (1 + c);
  const float real = (eta - 1) * (eta + 1) - k * k + c * c, imaginary = 2 * eta * k;
  const float length = std::hypot(real, imaginary);
  // a^2 and b^2; the smaller from their product, (eta k)^2, since the difference would cancel.
  const float large = (length + std::abs(real)) / 2;
  const float small = large > 0 ? imaginary * imaginary / (4 * large) : 0.0f;
  const float a = std::sqrt(real > 0 ? large : small), b2 = real > 0 ? small : large;
  const auto ratio = [](float numerator, float denominator) {
    // No interface (eta = 1, k = 0) at the horizon: 0 / 0.
    return numerator / std::max(denominator, std::numeric_limits<float>::min());
  };
  const float perpendicular = ratio((a - c) * (a - c) + b2, (a + c) * (a + c) + b2);
  const float ac = a * c, bc2 = b2 * (c * c);
  const float parallel_to_it =
      ratio((ac - sine2) * (ac - sine2) + bc2, (ac + sine2) * (ac + sine2) + bc2);
  return std::min(perpendicular * (1 + parallel_to_it) / 2, 1.0f);
}

}  // namespace

Rgb eval_fresnel(const Fresnel& fresnel, float cos_difference) {
  const float c = std::clamp(cos_difference, 0.0f, 1.0f);
  Rgb reflectance;
  for (int channel = 0; channel < 3; ++channel) {
    const float eta = fresnel.eta[channel];
    reflectance[channel] =
        fresnel.model == FresnelModel::schlick ? schlick(fresnel.normal_reflectance[channel], c)
        : fresnel.model == FresnelModel::dielectric ? dielectric(eta, c)
                                                    : conductor(eta, fresnel.k[channel], c);
  }
  return reflectance;
}

}  // namespace burnish
