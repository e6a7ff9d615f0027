#include "shading/ring_grid.h"

#include <cmath>

#include "burnish/sphere/gauss_legendre.h"
#include "shading/dense_product.h"

namespace burnish {
namespace {

/// Associated Legendre functions with the harmonics' normalisation, but for the azimuth's root of
/// 2: [kLightBands][kLightBands] by degree and order.
std::vector<double> normalised_legendre(double z) {
  std::vector<double> p(kLightHarmonics, 0.0);
  const auto at = [&](int l, int m) -> double& {
    return p[static_cast<size_t>(l * kLightBands + m)];
  };
  const double sine = std::sqrt(1 - z * z);
  for (int m = 0; m < kLightBands; ++m) {
    at(m, m) = m == 0 ? 1 / std::sqrt(4 * kPi<double>)
                      : at(m - 1, m - 1) * sine * std::sqrt((2 * m + 1) / (2.0 * m));
    const auto step = [m](double l) { return std::sqrt((l * l - m * m) / (4 * l * l - 1)); };
    for (int l = m + 1; l < kLightBands; ++l)
      at(l, m) = (z * at(l - 1, m) - (l > m + 1 ? step(l - 1) * at(l - 2, m) : 0)) / step(l);
  }
  return p;
}

double azimuth_value(int function, double azimuth) {
  const double angle = order_of(function) * azimuth;
  if (function == 0) return 1;
  return std::sqrt(2.0) * (function % 2 == 1 ? std::cos(angle) : std::sin(angle));
}

void add_azimuths(RingGrid& grid) {
  constexpr int kFunctions = azimuth_functions(kLightBands);
  constexpr size_t kWidth = panel_width(kFunctions);
  const auto azimuths = static_cast<size_t>(grid.azimuths);
  const size_t row_width = panel_width(azimuths);
  grid.by_azimuth.assign(azimuths * kWidth, 0.0f);
  grid.azimuth_rows.assign(kFunctions * row_width, 0.0f);
  for (size_t a = 0; a < azimuths; ++a)
    for (int j = 0; j < kFunctions; ++j) {
      const double value = azimuth_value(
          j, 2 * kPi<double> * static_cast<double>(a) / static_cast<double>(azimuths));
      const auto column = static_cast<size_t>(j);
      grid.by_azimuth[a * kWidth + column] = static_cast<float>(value);
      grid.azimuth_rows[column * row_width + a] = static_cast<float>(value);
    }
}

template <int kRings>
RingGrid make_ring_grid(int azimuths) {
  RingGrid grid;
  grid.rings = kRings;
  grid.azimuths = azimuths;
  add_azimuths(grid);
  const auto& rule = internal::unit_gauss<kRings>();
  for (size_t ring = 0; ring < kRings; ++ring) {
    const double z = 2 * rule.node[ring] - 1, radius = std::sqrt(1 - z * z);
    grid.solid_angle.push_back(static_cast<float>(4 * kPi<double> * rule.weight[ring] / azimuths));
    for (int a = 0; a < azimuths; ++a) {
      const double azimuth = 2 * kPi<double> * a / azimuths;
      grid.x.push_back(static_cast<float>(radius * std::cos(azimuth)));
      grid.y.push_back(static_cast<float>(radius * std::sin(azimuth)));
      grid.z.push_back(static_cast<float>(z));
    }
    const std::vector<double> p = normalised_legendre(z);
    for (int l = 0; l < kLightBands; ++l)
      for (int j = 0; j < azimuth_functions(l + 1); ++j)
        grid.by_height.push_back(
            static_cast<float>(p[static_cast<size_t>(l * kLightBands + order_of(j))]));
  }
  return grid;
}

}  // namespace

void eval_light_harmonics(const Vector3d& direction, std::span<float> values) {
  const std::vector<double> p = normalised_legendre(direction.z());
  const double azimuth = std::atan2(direction.y(), direction.x());
  size_t next = 0;
  for (int l = 0; l < kLightBands; ++l)
    for (int j = 0; j < azimuth_functions(l + 1); ++j)
      values[next++] = static_cast<float>(p[static_cast<size_t>(l * kLightBands + order_of(j))] *
                                          azimuth_value(j, azimuth));
}

const RingGrid& light_grid() {
  static const RingGrid grid = make_ring_grid<64>(128);
  return grid;
}

const RingGrid& product_grid() {
  // n rings are exact to degree 2 n - 1, n azimuths to order n - 1; the product has twice the
  // degree of the light's part.
  static const RingGrid grid = make_ring_grid<kLightBands>(2 * kLightBands);
  return grid;
}

}  // namespace burnish
