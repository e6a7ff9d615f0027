#include "burnish/shading/prepared_lights.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "burnish/light/lobe_split.h"
#include "burnish/light/local_lights.h"
#include "burnish/sphere/lobe_domain.h"
#include "burnish/sphere/octahedral_map.h"
#include "shading/irradiance_table.h"
#include "shading/ladder_share.h"

namespace burnish {
namespace {

void require(const std::string& error, const char* kind, size_t number) {
  if (!error.empty())
    throw std::invalid_argument(std::string(kind) + " " + std::to_string(number) + ": " + error);
}

/// Those that are not black.
template <class Light>
void copy_lit(const std::vector<Light>& lights, const char* kind, Rgb Light::*energy,
              std::vector<Light>& result) {
  result.clear();
  for (size_t i = 0; i < lights.size(); ++i) {
    require(domain_error(lights[i]), kind, i);
    if ((lights[i].*energy > 0).any()) result.push_back(lights[i]);
  }
}

/// Of the lobe and the cosine: a lobe's own curvature, that of its smooth term, and the cosine's.
float lit_bandwidth(const AnisotropicGaussian<float>& lobe) {
  constexpr float kCosine = 1.5f;
  return std::sqrt(lobe.bandwidth_x + kCosine) * std::sqrt(lobe.bandwidth_y + kCosine);
}

float number_of(const PreparedTransfer::Basis& basis, size_t index) {
  if (basis.eigen16.empty()) return basis.eigen32[index];
  Eigen::half_impl::__half_raw half;
  half.x = basis.eigen16[index];
  return Eigen::half_impl::half_to_float(half);
}

void add_boundary(const PreparedTransfer& transfer, const PreparedTransfer::Basis& basis, int terms,
                  const PreparedLobe& light, size_t lights, size_t column,
                  LobeBoundaries& boundaries) {
  const Vector3f& axis = light.lobe.frame.z;
  const Vector2<float> uv = direction_to_octahedral(axis);
  const auto footprint = octahedral_footprint(uv, transfer.resolution);
  const Vector3f by_u = octahedral_gradient(axis, uv, 1.0f, 0.0f);
  const Vector3f by_v = octahedral_gradient(axis, uv, 0.0f, 1.0f);
  const size_t stride = padded_terms(transfer.terms);
  const size_t width = boundary_columns(lights);
  for (int i = 0; i < 4; ++i) {
    const size_t texel = static_cast<size_t>(footprint.texel[i]);
    const Vector3f slope = footprint.weight_u[i] * by_u + footprint.weight_v[i] * by_v;
    const float weight[3] = {footprint.weight[i], slope.dot(light.lobe.frame.x),
                             slope.dot(light.lobe.frame.y)};
    for (size_t j = 0; j < 3; ++j) {
      boundaries.mean[column + j] += weight[j] * basis.mean[texel];
      for (size_t k = 0; k < static_cast<size_t>(terms); ++k)
        boundaries.rows[k * width + column + j] += weight[j] * number_of(basis, texel * stride + k);
    }
  }
}

void make_boundaries(const PreparedTransfer& transfer, const ShadingOptions& options, size_t basis,
                     PreparedLights& lights) {
  const int terms = options.terms > 0 ? std::min(options.terms, transfer.terms) : transfer.terms;
  const size_t count = lights.narrow.size();
  LobeBoundaries& boundaries = lights.boundaries[basis];
  boundaries.mean.assign(3 * count, 0.0f);
  boundaries.rows.assign(static_cast<size_t>(terms) * boundary_columns(count), 0.0f);
  for (size_t i = 0; i < count; ++i)
    add_boundary(transfer, transfer.bases[basis], terms,
                 lights.lobes[static_cast<size_t>(lights.narrow[i])], count, 3 * i, boundaries);
}

}  // namespace

void begin_lights(const LightRig& rig, const PreparedTransfer& transfer,
                  const ShadingOptions& options, PreparedLights& lights) {
  copy_lit(rig.directionals, "directional light", &DirectionalLight::irradiance,
           lights.directionals);
  copy_lit(rig.spheres, "sphere light", &SphereLight::radiance, lights.spheres);
  copy_lit(rig.rectangles, "rectangle light", &RectangleLight::radiance, lights.rectangles);
  for (size_t i = 0; i < rig.lobes.size(); ++i)
    require(domain_error(rig.lobes[i]), "light lobe", i);
  const bool ladder = options.ladder && options.cosine == CosineModel::horizon_normalised &&
                      !transfer.ladders.empty() && transfer.ladder_crossover > 0;
  lights.lobes.clear();
  lights.narrow.clear();
  for (const EnvironmentLobe& light : split_wide_lobes(rig.lobes, options.split_bandwidth)) {
    PreparedLobe lobe;
    lobe.lobe = light.lobe;
    lobe.lobe.amplitude = 1;
    lobe.color = light.color * light.lobe.amplitude;
    if ((lobe.color == 0).all()) continue;
    lobe.integral = integral(lobe.lobe, options.integral);
    lobe.moments = asg_moments(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
    if (ladder)
      lobe.ladder_share =
          ladder_weight(lit_bandwidth(lobe.lobe), options.ladder_reach * transfer.ladder_crossover);
    if (lobe.ladder_share < 1) lights.narrow.push_back(static_cast<int>(lights.lobes.size()));
    lights.lobes.push_back(lobe);
  }
  lights.boundaries.resize(lights.narrow.empty() ? 0 : transfer.bases.size());
  begin_irradiance_tables(transfer, lights);
}

void finish_lights(const PreparedTransfer& transfer, const ShadingOptions& options, size_t basis,
                   PreparedLights& lights) {
  if (basis < lights.boundaries.size()) make_boundaries(transfer, options, basis, lights);
  if (basis < lights.tables.size()) finish_irradiance_table(transfer, basis, lights);
}

void prepare_lights(const LightRig& rig, const PreparedTransfer& transfer,
                    const ShadingOptions& options, PreparedLights& lights) {
  begin_lights(rig, transfer, options, lights);
  for (size_t basis = 0; basis < transfer.bases.size(); ++basis)
    finish_lights(transfer, options, basis, lights);
}

PreparedLights prepare_lights(const LightRig& rig, const PreparedTransfer& transfer,
                              const ShadingOptions& options) {
  PreparedLights lights;
  prepare_lights(rig, transfer, options, lights);
  return lights;
}

}  // namespace burnish
