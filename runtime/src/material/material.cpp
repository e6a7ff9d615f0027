#include "burnish/material/material.h"

#include <algorithm>
#include <cmath>

namespace burnish {
namespace {

// Ward's 1/sqrt(i.z o.z) and Ashikhmin's 1/(h.i) have poles at the horizon; the cosine below which
// they are held. The exact BRDF and the smooth factor share it.
constexpr float kMinCosine = 1e-4f;

struct HalfVector {
  Vector3f h;
  float cos_difference;  // h . i = h . o
};

HalfVector half_vector(const Vector3f& outgoing, const Vector3f& incoming) {
  const Vector3f sum = incoming + outgoing;
  const float length = sum.norm();
  if (length < 1e-6f) return {Vector3f::UnitZ(), 0};  // exactly opposite: h is undefined
  const Vector3f h = sum / length;
  return {h, std::max(h.dot(incoming), 0.0f)};
}

/// Exponent of Ashikhmin-Shirley with the same ASG as Ward's of this alpha.
float phong_exponent(float alpha) { return 2 / (alpha * alpha); }

/// (h.x / alpha_x)^2 + (h.y / alpha_y)^2
float ellipse(const Material& material, const Vector3f& h) {
  const float x = h.x() / material.alpha_x, y = h.y() / material.alpha_y;
  return x * x + y * y;
}

/// D(h), with peak 1.
float distribution(const Material& material, const Vector3f& h) {
  if (h.z() <= 0) return 0;
  if (material.model == SpecularModel::ward)
    return std::exp(-2 * ellipse(material, h) / (1 + h.z()));
  // (h.z)^((n_u h.x^2 + n_v h.y^2) / (1 - h.z^2)) with the logarithm of h.z from the sine, which
  // keeps its digits near the axis.
  const float sine2 = h.x() * h.x() + h.y() * h.y();
  if (sine2 <= 0) return 1;
  const float log_z = 0.5f * std::log1p(-std::min(sine2, 1.0f - 1e-7f));
  return std::exp(2 * ellipse(material, h) / sine2 * log_z);
}

Rgb smooth_factor(const Material& material, const Vector3f& outgoing, const Vector3f& incoming,
                  float cos_difference) {
  const float cos_i = std::max(incoming.z(), kMinCosine),
              cos_o = std::max(outgoing.z(), kMinCosine);
  if (material.model == SpecularModel::ward) {
    return material.specular /
           (4 * kPi<float> * material.alpha_x * material.alpha_y * std::sqrt(cos_i * cos_o));
  }
  const float cos_d = std::max(cos_difference, kMinCosine);
  const float n_u = phong_exponent(material.alpha_x), n_v = phong_exponent(material.alpha_y);
  return material.specular * eval_fresnel(material.fresnel, cos_d) *
         (std::sqrt(n_u + 1) * std::sqrt(n_v + 1) /
          (8 * kPi<float> * cos_d * std::max(cos_i, cos_o)));
}

Vector3f sample_ward_half(const Material& material, float u, float v) {
  // phi by the density 1/k(phi), k = cos^2/alpha_x^2 + sin^2/alpha_y^2; then cos(theta) given phi
  // exactly.
  const float psi = 2 * kPi<float> * u;
  const float phi = std::atan2(material.alpha_y * std::sin(psi), material.alpha_x * std::cos(psi));
  const float cos_phi = std::cos(phi), sin_phi = std::sin(phi);
  const float k = ellipse(material, {cos_phi, sin_phi, 0});
  const float one_minus_cos = -std::log1p(v * std::expm1(-2 * k)) / (2 * k);
  const float sine = std::sqrt(std::max(one_minus_cos * (2 - one_minus_cos), 0.0f));
  return {sine * cos_phi, sine * sin_phi, 1 - one_minus_cos};
}

float pdf_ward_half(const Material& material, const Vector3f& h) {
  const float sine2 = h.x() * h.x() + h.y() * h.y();
  const float k =
      sine2 > 0 ? ellipse(material, h) / sine2 : 1 / (material.alpha_x * material.alpha_y);
  return distribution(material, h) /
         (kPi<float> * material.alpha_x * material.alpha_y * -std::expm1(-2 * k));
}

Vector3f sample_ashikhmin_half(const Material& material, float u, float v) {
  const float n_u = phong_exponent(material.alpha_x), n_v = phong_exponent(material.alpha_y);
  const float psi = 2 * kPi<float> * u;
  const float phi =
      std::atan2(std::sqrt(n_u + 1) * std::sin(psi), std::sqrt(n_v + 1) * std::cos(psi));
  const float cos_phi = std::cos(phi), sin_phi = std::sin(phi);
  const float exponent = n_u * cos_phi * cos_phi + n_v * sin_phi * sin_phi;
  // cos(theta) = (1 - v)^(1 / (exponent + 1)); the sine from expm1 keeps its digits for large
  // exponents.
  const float log_cos = std::log1p(-v) / (exponent + 1);
  const float sine = std::sqrt(std::max(-std::expm1(2 * log_cos), 0.0f));
  return {sine * cos_phi, sine * sin_phi, std::exp(log_cos)};
}

float pdf_ashikhmin_half(const Material& material, const Vector3f& h) {
  const float n_u = phong_exponent(material.alpha_x), n_v = phong_exponent(material.alpha_y);
  const float peak = std::sqrt(n_u + 1) * std::sqrt(n_v + 1) / (2 * kPi<float>);
  return peak * distribution(material, h);
}

}  // namespace

Rgb eval_specular_brdf(const Material& material, const Vector3f& outgoing,
                       const Vector3f& incoming) {
  if (!material.has_specular() || outgoing.z() <= 0 || incoming.z() <= 0) return Rgb::Zero();
  const HalfVector half = half_vector(outgoing, incoming);
  if (half.cos_difference <= 0) return Rgb::Zero();
  return smooth_factor(material, outgoing, incoming, half.cos_difference) *
         distribution(material, half.h);
}

Rgb eval_brdf(const Material& material, const Vector3f& outgoing, const Vector3f& incoming) {
  if (outgoing.z() <= 0 || incoming.z() <= 0) return Rgb::Zero();
  return material.diffuse / kPi<float> + eval_specular_brdf(material, outgoing, incoming);
}

Vector3f sample_specular_brdf(const Material& material, const Vector3f& outgoing, float u,
                              float v) {
  const Vector3f h = material.model == SpecularModel::ward ? sample_ward_half(material, u, v)
                                                           : sample_ashikhmin_half(material, u, v);
  return 2 * outgoing.dot(h) * h - outgoing;
}

float pdf_specular_brdf(const Material& material, const Vector3f& outgoing,
                        const Vector3f& incoming) {
  const HalfVector half = half_vector(outgoing, incoming);
  if (half.cos_difference <= 0 || half.h.z() <= 0) return 0;
  const float pdf_half = material.model == SpecularModel::ward
                             ? pdf_ward_half(material, half.h)
                             : pdf_ashikhmin_half(material, half.h);
  return pdf_half / (4 * half.cos_difference);
}

float eval_distribution(const Material& material, const Vector3f& half) {
  return distribution(material, half);
}

HalfVectorLobes half_vector_lobes(const Material& material, int) {
  HalfVectorLobes lobes;
  lobes.count = 1;
  lobes.lobe[0].bandwidth_x = 1 / (material.alpha_x * material.alpha_x);
  lobes.lobe[0].bandwidth_y = 1 / (material.alpha_y * material.alpha_y);
  return lobes;
}

Rgb specular_smooth_factor(const Material& material, const Vector3f& outgoing,
                           const Vector3f& incoming) {
  return smooth_factor(material, outgoing, incoming,
                       half_vector(outgoing, incoming).cos_difference);
}

}  // namespace burnish
