#include "material/ashikhmin.h"

namespace burnish::internal {
namespace {

float exponent(float alpha) { return 2 / (alpha * alpha); }

}  // namespace

float ashikhmin_normalisation(const Material& material) {
  // The product of the exponents has half the range of a float.
  return std::sqrt(exponent(material.alpha_x) + 1) * std::sqrt(exponent(material.alpha_y) + 1);
}

float eval_ashikhmin_lobe(const Material& material, const Vector3f& half) {
  const float sine2 = half.x() * half.x() + half.y() * half.y();
  if (sine2 <= 0) return 1;
  const float e = ellipse(material.alpha_x, material.alpha_y, half);
  return std::exp(2 * e / sine2 * log_cosine(half));
}

Rgb ashikhmin_smooth_factor(const Material& material, const Vector3f& outgoing,
                            const Vector3f& incoming, float cos_difference) {
  const float cos_d = std::max(cos_difference, kMinCosine);
  const float cosine = std::max({incoming.z(), outgoing.z(), kMinCosine});
  return material.specular * eval_fresnel(material.fresnel, cos_d) *
         (ashikhmin_normalisation(material) / (8 * kPi<float> * cos_d * cosine));
}

Vector3f sample_ashikhmin_half(const Material& material, float u, float v) {
  const float n_x = exponent(material.alpha_x), n_y = exponent(material.alpha_y);
  const float psi = 2 * kPi<float> * u;
  const float phi =
      std::atan2(std::sqrt(n_x + 1) * std::sin(psi), std::sqrt(n_y + 1) * std::cos(psi));
  const float cos_phi = std::cos(phi), sin_phi = std::sin(phi);
  const float n = n_x * cos_phi * cos_phi + n_y * sin_phi * sin_phi;
  // cos(theta) = (1 - v)^(1 / (n + 1)); the sine from expm1 keeps its digits for large exponents.
  const float log_cos = std::log1p(-v) / (n + 1);
  const float sine = std::sqrt(std::max(-std::expm1(2 * log_cos), 0.0f));
  return from_sine(sine, std::exp(log_cos), cos_phi, sin_phi);
}

float pdf_ashikhmin_half(const Material& material, const Vector3f& half) {
  return ashikhmin_normalisation(material) / (2 * kPi<float>)*eval_ashikhmin_lobe(material, half);
}

}  // namespace burnish::internal
