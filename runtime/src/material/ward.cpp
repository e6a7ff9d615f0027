#include "material/ward.h"

namespace burnish::internal {

float eval_ward_lobe(const Material& material, const Vector3f& half) {
  return std::exp(-2 * ellipse(material.alpha_x, material.alpha_y, half) / (1 + half.z()));
}

Rgb ward_smooth_factor(const Material& material, const Vector3f& outgoing,
                       const Vector3f& incoming) {
  const float cos_i = std::max(incoming.z(), kMinCosine);
  const float cos_o = std::max(outgoing.z(), kMinCosine);
  return material.specular /
         (4 * kPi<float> * material.alpha_x * material.alpha_y * std::sqrt(cos_i * cos_o));
}

Vector3f sample_ward_half(const Material& material, float u, float v) {
  // phi by the density 1 / k(phi), k the ellipse of (cos, sin); then cos(theta) given phi exactly.
  const float psi = 2 * kPi<float> * u;
  const float phi = std::atan2(material.alpha_y * std::sin(psi), material.alpha_x * std::cos(psi));
  const float cos_phi = std::cos(phi), sin_phi = std::sin(phi);
  const float k = ellipse(material.alpha_x, material.alpha_y, {cos_phi, sin_phi, 0});
  const float one_minus_cos = -std::log1p(v * std::expm1(-2 * k)) / (2 * k);
  const float sine = std::sqrt(std::max(one_minus_cos * (2 - one_minus_cos), 0.0f));
  return from_sine(sine, 1 - one_minus_cos, cos_phi, sin_phi);
}

float pdf_ward_half(const Material& material, const Vector3f& half) {
  const float area = material.alpha_x * material.alpha_y;
  const float sine2 = half.x() * half.x() + half.y() * half.y();
  const float k = sine2 > 0 ? ellipse(material.alpha_x, material.alpha_y, half) / sine2 : 1 / area;
  return eval_ward_lobe(material, half) / (kPi<float> * area * -std::expm1(-2 * k));
}

}  // namespace burnish::internal
