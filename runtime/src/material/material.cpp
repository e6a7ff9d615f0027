#include "burnish/material/material.h"

#include "material/ashikhmin.h"
#include "material/fitted_sampling.h"
#include "material/half_vector.h"
#include "material/microfacet.h"
#include "material/ward.h"

namespace burnish {
namespace {

using internal::HalfVector;
using internal::microfacets_of;

Rgb smooth_factor(const Material& material, const Vector3f& outgoing, const Vector3f& incoming,
                  const HalfVector& half) {
  const float cos_d = std::max(half.cos_difference, internal::kMinCosine);
  switch (material.model) {
    case SpecularModel::none:
      break;
    case SpecularModel::ward:
      return internal::ward_smooth_factor(material, outgoing, incoming);
    case SpecularModel::ward_balanced:
      return material.specular * (microfacet_peak(microfacets_of(material)) / (4 * cos_d * cos_d));
    case SpecularModel::ashikhmin_shirley:
      return internal::ashikhmin_smooth_factor(material, outgoing, incoming, half.cos_difference);
    case SpecularModel::cook_torrance: {
      const internal::Microfacets facets = microfacets_of(material);
      return material.specular * eval_fresnel(material.fresnel, half.cos_difference) *
             (microfacet_peak(facets) *
              shadowing_over_cosines(facets, material.shadowing, outgoing, incoming, half));
    }
    case SpecularModel::fitted:
      return material.specular *
             eval_smooth_factor(*material.fitted, outgoing.z(), incoming.z(), half.cos_difference);
  }
  return Rgb::Zero();
}

}  // namespace

float eval_distribution(const Material& material, const Vector3f& half) {
  if (half.z() <= 0) return 0;
  switch (material.model) {
    case SpecularModel::none:
      break;
    case SpecularModel::ward:
      return internal::eval_ward_lobe(material, half);
    case SpecularModel::ashikhmin_shirley:
      return internal::eval_ashikhmin_lobe(material, half);
    case SpecularModel::ward_balanced:
    case SpecularModel::cook_torrance:
      return eval_microfacet_lobe(microfacets_of(material), half);
    case SpecularModel::fitted:
      return eval_distribution(*material.fitted, half);
  }
  return 0;
}

Rgb specular_smooth_factor(const Material& material, const Vector3f& outgoing,
                           const Vector3f& incoming) {
  return smooth_factor(material, outgoing, incoming, internal::half_vector(outgoing, incoming));
}

Rgb eval_specular_brdf(const Material& material, const Vector3f& outgoing,
                       const Vector3f& incoming) {
  if (!material.has_specular() || outgoing.z() <= 0 || incoming.z() <= 0) return Rgb::Zero();
  const HalfVector half = internal::half_vector(outgoing, incoming);
  if (half.cos_difference <= 0) return Rgb::Zero();
  return smooth_factor(material, outgoing, incoming, half) * eval_distribution(material, half.h);
}

Rgb eval_brdf(const Material& material, const Vector3f& outgoing, const Vector3f& incoming) {
  if (outgoing.z() <= 0 || incoming.z() <= 0) return Rgb::Zero();
  return material.diffuse / kPi<float> + eval_specular_brdf(material, outgoing, incoming);
}

Vector3f sample_specular_brdf(const Material& material, const Vector3f& outgoing, float u,
                              float v) {
  Vector3f h = Vector3f::UnitZ();
  switch (material.model) {
    case SpecularModel::none:
      break;
    case SpecularModel::ward:
      h = internal::sample_ward_half(material, u, v);
      break;
    case SpecularModel::ashikhmin_shirley:
      h = internal::sample_ashikhmin_half(material, u, v);
      break;
    case SpecularModel::ward_balanced:
    case SpecularModel::cook_torrance:
      h = sample_microfacet_half(microfacets_of(material), outgoing, u, v);
      break;
    case SpecularModel::fitted:
      h = internal::sample_fitted_half(*material.fitted, u, v);
      break;
  }
  return 2 * outgoing.dot(h) * h - outgoing;
}

float pdf_specular_brdf(const Material& material, const Vector3f& outgoing,
                        const Vector3f& incoming) {
  const HalfVector half = internal::half_vector(outgoing, incoming);
  if (half.cos_difference <= 0 || half.h.z() <= 0) return 0;
  const float jacobian = 4 * half.cos_difference;
  switch (material.model) {
    case SpecularModel::none:
      break;
    case SpecularModel::ward:
      return internal::pdf_ward_half(material, half.h) / jacobian;
    case SpecularModel::ashikhmin_shirley:
      return internal::pdf_ashikhmin_half(material, half.h) / jacobian;
    case SpecularModel::ward_balanced:
    case SpecularModel::cook_torrance:
      return pdf_microfacet_reflection(microfacets_of(material), outgoing, half);
    case SpecularModel::fitted:
      return internal::pdf_fitted_half(*material.fitted, half.h) / jacobian;
  }
  return 0;
}

}  // namespace burnish
