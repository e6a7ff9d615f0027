#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/material/material.h"
#include "burnish/sphere/asg_integral.h"
#include "material/half_vector_tables.h"
#include "material/microfacet.h"

namespace burnish {
namespace {

using internal::kTableSteps;
using internal::TabulatedLobe;

struct Table {
  const TabulatedLobe* lobes;
  int lobes_per_node;
};

Table table_of(const Material& material, int max_lobes) {
  switch (material.model) {
    case SpecularModel::ward:
      return {internal::kWardLobes[0], 1};
    case SpecularModel::ashikhmin_shirley:
      return {internal::kAshikhminLobes[0], 1};
    case SpecularModel::cook_torrance:
      if (material.distribution == Distribution::blinn_phong)
        return {internal::kBlinnPhongLobes[0], 1};
      if (material.distribution != Distribution::ggx) break;
      if (max_lobes <= 1) return {internal::kGgxLobes1[0], 1};
      if (max_lobes == 2) return {internal::kGgxLobes2[0], 2};
      return {internal::kGgxLobes3[0], 3};
    case SpecularModel::none:
    case SpecularModel::ward_balanced:
    case SpecularModel::fitted:
      break;
  }
  return {internal::kBeckmannLobes[0], 1};
}

void add(TabulatedLobe& sum, const TabulatedLobe& lobe, float weight) {
  sum.bandwidth_x += weight * lobe.bandwidth_x;
  sum.bandwidth_y += weight * lobe.bandwidth_y;
  sum.amplitude += weight * lobe.amplitude;
}

/// An alpha's place among the nodes.
struct Place {
  int cell;
  float fraction;
  explicit Place(float alpha) {
    const float scaled = alpha * float(kTableSteps);
    cell = std::clamp(static_cast<int>(scaled), 0, kTableSteps - 1);
    fraction = scaled - float(cell);
  }
};

/// Lobe k by bilinear interpolation. Where alpha_x < alpha_y the axes change places.
TabulatedLobe interpolate(const Table& table, float alpha_x, float alpha_y, int k) {
  const Place x(alpha_x), y(alpha_y);
  TabulatedLobe sum{0, 0, 0};
  for (const int i : {0, 1}) {
    for (const int j : {0, 1}) {
      const int column = x.cell + i, row = y.cell + j;
      const int low = std::min(column, row), high = std::max(column, row);
      TabulatedLobe node = table.lobes[(high * (high + 1) / 2 + low) * table.lobes_per_node + k];
      if (column < row) std::swap(node.bandwidth_x, node.bandwidth_y);
      add(sum, node,
          (i == 1 ? x.fraction : 1 - x.fraction) * (j == 1 ? y.fraction : 1 - y.fraction));
    }
  }
  return sum;
}

TabulatedLobe interpolate_round(const Table& table, float alpha) {
  const Place place(alpha);
  TabulatedLobe sum{0, 0, 0};
  add(sum, table.lobes[place.cell], 1 - place.fraction);
  add(sum, table.lobes[place.cell + 1], place.fraction);
  return sum;
}

/// Integral over 0..1 of sqrt(1 - t) exp(-k t): 8e-5.
float half_ball_integral(float k) {
  const float above = ((k + 4.60347431f) * k + 20.7575601f) * k + 59.5338790f;
  const float below = (((k + 5.10347431f) * k + 23.8038575f) * k + 66.7576877f) * k + 89.3008185f;
  return above / below;
}

/// Integral of a unit-amplitude ASG times its own cosine, by asg_integral.h's azimuths.
float projected_integral(float bandwidth_x, float bandwidth_y) {
  constexpr float kOffset = 1.5f;  // g then is between 1 and 1.1
  constexpr int kPoints = 4;
  const auto [small, large] = std::minmax(bandwidth_x, bandwidth_y);
  const float squeeze = (small + kOffset) / (large + kOffset);
  float sum = 0;
  for (const float cos_squared : internal::quarter_turn_cosines_squared<float, kPoints>()) {
    const float k =
        internal::asg_azimuth(large, small, squeeze, cos_squared, 1 - cos_squared).bandwidth;
    sum += (k + kOffset) * half_ball_integral(k);
  }
  return kPi<float> / (std::sqrt(large + kOffset) * std::sqrt(small + kOffset)) * sum / kPoints;
}

/// Integral of Ward's D h.z. With psi, tan(azimuth) = tan(psi) alpha_y / alpha_x, and 1 / k =
/// (alpha_x cos psi)^2 + (alpha_y sin psi)^2, it is alpha_x alpha_y times the integral over psi of
/// 1/2 - (1 - exp(-2 k)) / (4 k).
float ward_energy(float alpha_x, float alpha_y) {
  constexpr int kPoints = 4;
  float sum = 0;
  for (const float cos_squared : internal::quarter_turn_cosines_squared<float, kPoints>()) {
    const float over_k = alpha_x * alpha_x * cos_squared + alpha_y * alpha_y * (1 - cos_squared);
    sum += 1 + std::expm1(-2 / over_k) * over_k / 2;
  }
  return kPi<float> * alpha_x * alpha_y * sum / kPoints;
}

/// Integral of D h.z, D with peak 1.
float distribution_energy(const Material& material) {
  const float alpha_x = material.alpha_x, alpha_y = material.alpha_y;
  const float area = kPi<float> * alpha_x * alpha_y;
  if (material.model == SpecularModel::ward) return ward_energy(alpha_x, alpha_y);
  if (material.model == SpecularModel::ashikhmin_shirley)  // 2 pi / sqrt((n_x + 2) (n_y + 2))
    return area / (std::sqrt(1 + alpha_x * alpha_x) * std::sqrt(1 + alpha_y * alpha_y));
  return area;
}

}  // namespace

HalfVectorLobes half_vector_lobes(const Material& material, int max_lobes) {
  HalfVectorLobes result;
  const auto append = [&](const AnisotropicGaussian<float>& lobe) {
    result.lobe[static_cast<size_t>(result.count++)] = lobe;
  };
  if (material.model == SpecularModel::none) return result;
  if (material.model == SpecularModel::fitted) {
    for (const AnisotropicGaussian<float>& lobe : material.fitted->lobes)
      if (result.count < kMaxFittedLobes) append(lobe);
    return result;
  }
  const Table table = table_of(material, max_lobes);
  const internal::Microfacets facets = internal::microfacets_of(material);
  const bool round = material.model == SpecularModel::cook_torrance &&
                     facets.distribution == Distribution::blinn_phong;
  const float alpha_x = facets.alpha_x, alpha_y = facets.alpha_y;
  float energy = 0;
  for (int k = 0; k < table.lobes_per_node; ++k) {
    const TabulatedLobe fit =
        round ? interpolate_round(table, alpha_x) : interpolate(table, alpha_x, alpha_y, k);
    if (fit.amplitude <= 0) continue;
    AnisotropicGaussian<float> lobe;
    lobe.bandwidth_x = fit.bandwidth_x / (alpha_x * alpha_x);
    lobe.bandwidth_y = fit.bandwidth_y / (alpha_y * alpha_y);
    lobe.amplitude = fit.amplitude;
    energy += lobe.amplitude * projected_integral(lobe.bandwidth_x, lobe.bandwidth_y);
    append(lobe);
  }
  // Interpolation leaves up to 1 % of error, and more for wide lobes of GGX.
  const float scale = distribution_energy(material) / energy;
  for (int k = 0; k < result.count; ++k) result.lobe[static_cast<size_t>(k)].amplitude *= scale;
  return result;
}

}  // namespace burnish
