#include "material/microfacet.h"

#include <limits>

namespace burnish::internal {
namespace {

float beckmann_lobe(const Microfacets& facets, const Vector3f& half) {
  const float cos2 = half.z() * half.z();
  const float sine2 = half.x() * half.x() + half.y() * half.y();
  const float e = ellipse(facets.alpha_x, facets.alpha_y, half);
  // exp(-80) is nothing, and beyond it the tangent's square might overflow: e >= sine2.
  if (e > 80 * cos2) return 0;
  const float square = 1 + sine2 / cos2;
  return std::exp(-e / cos2) * (square * square);
}

float ggx_lobe(const Microfacets& facets, const Vector3f& half) {
  const float q = ellipse(facets.alpha_x, facets.alpha_y, half) + half.z() * half.z();
  return 1 / (q * q);
}

/// Exponent of Blinn-Phong.
float exponent(const Microfacets& facets) { return 2 / (facets.alpha_x * facets.alpha_x) - 2; }

/// The slope's standard deviation toward a direction times its sine (and times sqrt 2).
float slope_width(const Microfacets& facets, const Vector3f& direction) {
  const float x = facets.alpha_x * direction.x(), y = facets.alpha_y * direction.y();
  return std::sqrt(x * x + y * y);
}

Vector3f sample_beckmann_half(const Microfacets& facets, float u, float v) {
  // The slopes are a Gaussian.
  const float radius = std::sqrt(-std::log1p(-v)), phi = 2 * kPi<float> * u;
  return Vector3f(facets.alpha_x * radius * std::cos(phi), facets.alpha_y * radius * std::sin(phi),
                  1)
      .normalized();
}

Vector3f sample_blinn_phong_half(const Microfacets& facets, float u, float v) {
  // cos(theta) = (1 - v)^(1 / (exponent + 2))
  const float log_cos = std::log1p(-v) * (facets.alpha_x * facets.alpha_x) / 2;
  const float sine = std::sqrt(-std::expm1(2 * log_cos)), phi = 2 * kPi<float> * u;
  return from_sine(sine, std::exp(log_cos), std::cos(phi), std::sin(phi));
}

/// dupuy2023: a GGX surface, squeezed by its alphas, is a hemisphere, and the half vectors that a
/// view sees of it reflect to a cap of the sphere, evenly.
Vector3f sample_ggx_half(const Microfacets& facets, const Vector3f& outgoing, float u, float v) {
  const Vector3f view =
      Vector3f(facets.alpha_x * outgoing.x(), facets.alpha_y * outgoing.y(), outgoing.z())
          .normalized();
  // z of the point on the cap is 1 - v (1 + view.z).
  const float drop = v * (1 + view.z());
  const float sine = std::sqrt(std::max(drop * (2 - drop), 0.0f)), phi = 2 * kPi<float> * u;
  const Vector3f h(sine * std::cos(phi) + view.x(), sine * std::sin(phi) + view.y(),
                   (1 - v) * (1 + view.z()));
  return Vector3f(facets.alpha_x * h.x(), facets.alpha_y * h.y(), h.z()).normalized();
}

}  // namespace

Microfacets microfacets_of(const Material& material) {
  const bool cook_torrance = material.model == SpecularModel::cook_torrance;
  Microfacets facets{cook_torrance ? material.distribution : Distribution::beckmann,
                     material.alpha_x, material.alpha_y};
  if (facets.distribution == Distribution::blinn_phong)
    facets.alpha_x = facets.alpha_y = std::sqrt(material.alpha_x * material.alpha_y);
  return facets;
}

float microfacet_peak(const Microfacets& facets) {
  return 1 / (kPi<float> * facets.alpha_x * facets.alpha_y);
}

float eval_microfacet_lobe(const Microfacets& facets, const Vector3f& half) {
  switch (facets.distribution) {
    case Distribution::beckmann:
      return beckmann_lobe(facets, half);
    case Distribution::ggx:
      return ggx_lobe(facets, half);
    case Distribution::blinn_phong:
      break;
  }
  return std::exp(exponent(facets) * log_cosine(half));
}

float facing_area(const Microfacets& facets, const Vector3f& direction) {
  const float cosine = direction.z(), width = slope_width(facets, direction);
  if (facets.distribution == Distribution::ggx)
    return (cosine + std::sqrt(cosine * cosine + width * width)) / 2;
  // cos (1 + Lambda) with Lambda's difference of exp and erfc written as a sum.
  const float a = cosine / std::max(width, std::numeric_limits<float>::min());
  return cosine * (1 + std::erf(a)) / 2 + width * std::exp(-a * a) / (2 * std::sqrt(kPi<float>));
}

float shadowing_over_cosines(const Microfacets& facets, Shadowing shadowing,
                             const Vector3f& outgoing, const Vector3f& incoming,
                             const HalfVector& half) {
  const float cos_o = std::max(outgoing.z(), kMinCosine);
  const float cos_i = std::max(incoming.z(), kMinCosine);
  if (shadowing == Shadowing::v_cavity) {
    const float cos_d = std::max(half.cos_difference, kMinCosine);
    const float g = std::min(1.0f, 2 * half.h.z() * std::min(cos_o, cos_i) / cos_d);
    return g / (4 * cos_o * cos_i);
  }
  const float area_o = std::max(facing_area(facets, outgoing), cos_o);
  const float area_i = std::max(facing_area(facets, incoming), cos_i);
  if (shadowing == Shadowing::smith_separable) return 1 / (4 * area_o * area_i);
  // 4 cos cos (1 + Lambda + Lambda); each area is at least its cosine.
  return 1 / (4 * (cos_o * area_i + cos_i * area_o - cos_o * cos_i));
}

Vector3f sample_microfacet_half(const Microfacets& facets, const Vector3f& outgoing, float u,
                                float v) {
  switch (facets.distribution) {
    case Distribution::beckmann:
      return sample_beckmann_half(facets, u, v);
    case Distribution::ggx:
      return sample_ggx_half(facets, outgoing, u, v);
    case Distribution::blinn_phong:
      break;
  }
  return sample_blinn_phong_half(facets, u, v);
}

float pdf_microfacet_reflection(const Microfacets& facets, const Vector3f& outgoing,
                                const HalfVector& half) {
  const float d = microfacet_peak(facets) * eval_microfacet_lobe(facets, half.h);
  if (facets.distribution == Distribution::ggx) return d / (4 * facing_area(facets, outgoing));
  return d * half.h.z() / (4 * half.cos_difference);
}

}  // namespace burnish::internal
