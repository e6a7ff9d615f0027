#include "shading/irradiance_table.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/sphere/batch.h"
#include "burnish/sphere/gauss_legendre.h"
#include "shading/dense_product.h"
#include "shading/ring_grid.h"

// The irradiance of a light L through a visibility V is the product L V, convolved with the clamped
// cosine. The cosine lets nothing pass of odd degrees above 1 and hardly anything above 6, so that
// 31 harmonics of L V say all of it: for each eigenvector of the ladder in the place of V once per
// light, not once per vertex (docs/maths.md, "Irradiance table").
namespace burnish {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = Eigen::Map<RowMajor>;
using Degrees = std::array<float, kLightBands>;

constexpr int kCosineHarmonics = 1 + 3 + 5 + 9 + 13;
constexpr int kCosineFunctions = azimuth_functions(kCosineBands);
/// Of all channels.
constexpr int kCosineRows = 3 * kCosineFunctions;
constexpr int kNormals = IrradianceTable::kCorners * IrradianceTable::kCorners;
/// Narrower axes than the grid can tell are widened to this; the ladder cannot tell them, either.
constexpr float kNarrowestOnGrid = 250;

/// Legendre polynomials of a light's degrees.
std::array<double, kLightBands> legendre(double t) {
  std::array<double, kLightBands> p = {1, t};
  for (int l = 2; l < kLightBands; ++l)
    p[l] = ((2 * l - 1) * t * p[l - 1] - (l - 1) * p[l - 2]) / l;
  return p;
}

/// By which convolution with function(t), t the cosine from its axis, multiplies harmonics of each
/// degree.
template <class Function>
Degrees zonal_factors(double from, const Function& function) {
  const auto& rule = internal::unit_gauss<30>();
  std::array<double, kLightBands> sum = {};
  for (size_t i = 0; i < rule.node.size(); ++i) {
    const double t = from + (1 - from) * rule.node[i];
    const auto p = legendre(t);
    const double weight = 2 * kPi<double> * (1 - from) * rule.weight[i] * function(t);
    for (int l = 0; l < kLightBands; ++l) sum[l] += weight * p[l];
  }
  Degrees factors;
  std::copy(sum.begin(), sum.end(), factors.begin());
  return factors;
}

/// A function of the cosine from its axis by its zonal factors, of the first `bands` or of the
/// cosine's degrees.
double zonal_value(const Degrees& factors, int degree, double t) {
  return factors[degree] * (2 * degree + 1) / (4 * kPi<double>)*legendre(t)[degree];
}

const Degrees& cosine_factors() {
  static const Degrees factors = zonal_factors(0, [](double t) { return t; });
  return factors;
}

/// Of a bare horizon times the cosine, both as far as the table knows them.
Degrees find_open_factors(int bands) {
  const Degrees half_space = zonal_factors(0, [](double) { return 1; });
  return zonal_factors(-1, [&](double t) {
    double horizon = 0, cosine = 0;
    for (int l = 0; l < bands; ++l) horizon += zonal_value(half_space, l, t);
    for (const int l : kCosineDegrees) cosine += zonal_value(cosine_factors(), l, t);
    return horizon * cosine;
  });
}

/// The normal of a corner.
Vector3d normal_of(int corner) {
  constexpr int kCorners = IrradianceTable::kCorners;
  constexpr double kWidth = 2.0 / IrradianceTable::kCells;
  const double x = corner % kCorners * kWidth - 1, y = corner / kCorners * kWidth - 1;
  const double z = 1 - std::abs(x) - std::abs(y);
  if (z >= 0) return Vector3d(x, y, z).normalized();
  return Vector3d(std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y), z)
      .normalized();
}

const Degrees& open_factors(int bands) {
  static const auto factors = [] {
    std::array<Degrees, kMaxLadderBands + 1> all;
    for (int n = 0; n <= kMaxLadderBands; ++n) all[n] = find_open_factors(n);
    return all;
  }();
  return factors[static_cast<size_t>(std::min(bands, kMaxLadderBands))];
}

/// Of the table's normals: [kLightHarmonics][panel_width(kNormals)].
const RowMajor& normal_harmonics() {
  static const RowMajor harmonics = [] {
    RowMajor result = RowMajor::Zero(kLightHarmonics, Eigen::Index{panel_width(kNormals)});
    std::array<float, kLightHarmonics> values;
    for (int i = 0; i < kNormals; ++i) {
      eval_light_harmonics(normal_of(i), values);
      result.col(i) = Eigen::Map<const Eigen::VectorXf>(values.data(), kLightHarmonics);
    }
    return result;
  }();
  return harmonics;
}

/// The harmonics that the cosine lets pass, in the order of their functions of the azimuth.
struct CosineHarmonics {
  /// By function of the azimuth: the functions of the height, times the cosine's factors, on the
  /// rings of product_grid. [degrees][rings]
  std::array<RowMajor, kCosineFunctions> by_height;
  RowMajor normals{kNormals, kCosineHarmonics};

  CosineHarmonics() {
    const RingGrid& grid = product_grid();
    Eigen::Index column = 0;
    for (int j = 0; j < kCosineFunctions; ++j) {
      const auto passes = [j](int l) { return l >= order_of(j); };
      RowMajor& rows = by_height[static_cast<size_t>(j)];
      rows.resize(std::count_if(kCosineDegrees.begin(), kCosineDegrees.end(), passes), grid.rings);
      Eigen::Index row = 0;
      for (const int l : kCosineDegrees) {
        if (!passes(l)) continue;
        for (int ring = 0; ring < grid.rings; ++ring)
          rows(row, ring) = cosine_factors()[static_cast<size_t>(l)] *
                            grid.by_height[static_cast<size_t>(ring * kLightHarmonics + l * l + j)];
        normals.col(column++) = normal_harmonics().row(l * l + j).head(kNormals);
        ++row;
      }
    }
  }
};

const CosineHarmonics& cosine_harmonics() {
  static const CosineHarmonics harmonics;
  return harmonics;
}

/// left right, the right one's rows being of panel_width(columns).
RowMajor multiply(const Eigen::Ref<const RowMajor>& left, const float* right, size_t columns) {
  RowMajor result(left.rows(), static_cast<Eigen::Index>(panel_width(columns)));
  dense_product(left.data(), static_cast<size_t>(left.rows()), static_cast<size_t>(left.cols()),
                right, columns, result.data());
  return result;
}

/// Radiance of the lobes' ladder shares on light_grid: [3][directions].
RowMajor radiance_of(const std::vector<PreparedLobe>& lobes) {
  const RingGrid& grid = light_grid();
  const auto directions = static_cast<Eigen::Index>(grid.directions());
  RowMajor radiance = RowMajor::Zero(3, directions);
  Eigen::RowVectorXf shape(directions);
  for (const PreparedLobe& light : lobes) {
    if (!(light.ladder_share > 0)) continue;
    AnisotropicGaussian<float> lobe = light.lobe;
    lobe.bandwidth_x = std::min(lobe.bandwidth_x, kNarrowestOnGrid);
    lobe.bandwidth_y = std::min(lobe.bandwidth_y, kNarrowestOnGrid);
    // The wider lobe keeps the energy.
    const float scale = light.ladder_share * light.integral / integral(lobe);
    batch::eval(lobe, {grid.x, grid.y, grid.z}, {shape.data(), grid.directions()});
    for (int channel = 0; channel < 3; ++channel)
      radiance.row(channel) += scale * light.color[channel] * shape;
  }
  return radiance;
}

/// Harmonics of a function on light_grid: [3][kLightHarmonics].
RowMajor harmonics_of(const RowMajor& values) {
  const RingGrid& grid = light_grid();
  const Eigen::Map<const RowMajor> rings(values.data(), 3 * grid.rings, grid.azimuths);
  const RowMajor by_azimuth =
      multiply(rings, grid.by_azimuth.data(), azimuth_functions(kLightBands));
  const Eigen::Map<const RowMajor> by_height(grid.by_height.data(), grid.rings, kLightHarmonics);
  RowMajor harmonics = RowMajor::Zero(3, kLightHarmonics);
  for (int channel = 0; channel < 3; ++channel)
    for (int ring = 0; ring < grid.rings; ++ring)
      for (int l = 0; l < kLightBands; ++l) {
        const int n = azimuth_functions(l + 1);
        harmonics.row(channel).segment(l * l, n).array() +=
            grid.solid_angle[static_cast<size_t>(ring)] *
            by_height.row(ring).segment(l * l, n).array() *
            by_azimuth.row(channel * grid.rings + ring).head(n).array();
      }
  return harmonics;
}

/// A light of harmonics [3][kLightHarmonics] on product_grid, times the cosine's functions of the
/// azimuth and the solid angle: [rings][3][kCosineFunctions][azimuths].
void weigh_light(const RowMajor& harmonics, std::vector<float>& weighed) {
  const RingGrid& grid = product_grid();
  const Eigen::Map<const RowMajor> by_height(grid.by_height.data(), grid.rings, kLightHarmonics);
  RowMajor by_azimuth = RowMajor::Zero(3 * grid.rings, azimuth_functions(kLightBands));
  for (int channel = 0; channel < 3; ++channel)
    for (int ring = 0; ring < grid.rings; ++ring)
      for (int l = 0; l < kLightBands; ++l) {
        const int n = azimuth_functions(l + 1);
        by_azimuth.row(channel * grid.rings + ring).head(n).array() +=
            grid.solid_angle[static_cast<size_t>(ring)] *
            by_height.row(ring).segment(l * l, n).array() *
            harmonics.row(channel).segment(l * l, n).array();
      }
  const auto azimuths = static_cast<size_t>(grid.azimuths);
  const RowMajor values = multiply(by_azimuth, grid.azimuth_rows.data(), azimuths);
  const size_t row_width = panel_width(azimuths);
  weighed.resize(static_cast<size_t>(grid.rings * kCosineRows) * azimuths);
  float* next = weighed.data();
  for (int ring = 0; ring < grid.rings; ++ring)
    for (int channel = 0; channel < 3; ++channel)
      for (size_t j = 0; j < kCosineFunctions; ++j) {
        const auto value = values.row(channel * grid.rings + ring);
        const float* function = grid.azimuth_rows.data() + j * row_width;
        for (size_t a = 0; a < azimuths; ++a)
          *next++ = value(static_cast<Eigen::Index>(a)) * function[a];
      }
}

/// Convolves the first bands of a light of harmonics [3][kLightHarmonics] with zonal functions, for
/// the table's normals: [3] of the first, then of the second.
RowMajor convolve(const RowMajor& light, int bands, const Degrees& first, const Degrees& second) {
  RowMajor scaled(6, Eigen::Index{bands} * bands);
  for (int l = 0; l < bands; ++l) {
    const int n = azimuth_functions(l + 1);
    const auto harmonics = light.middleCols(l * l, n);
    scaled.block(0, l * l, 3, n) = first[static_cast<size_t>(l)] * harmonics;
    scaled.block(3, l * l, 3, n) = second[static_cast<size_t>(l)] * harmonics;
  }
  return multiply(scaled, normal_harmonics().data(), kNormals).leftCols(kNormals);
}

/// What a bare horizon lacks is added to what comes through the ladder, so that all is exact where
/// nothing occludes.
void start_means(const RowMajor& light, int bands, bool is_positive, std::vector<float>& means) {
  // Of a bare horizon times the cosine, higher degrees are .003 of a light's peak for ladders of 13
  // bands, but up to .06 for 16.
  const int light_bands = bands > 13 ? kLightBands : kMaxLadderBands;
  const RowMajor open = convolve(light, light_bands, cosine_factors(), open_factors(bands));
  means.assign(static_cast<size_t>(kNormals) * IrradianceTable::kMeans, 0.0f);
  Rows rows(means.data(), kNormals, IrradianceTable::kMeans);
  auto unshadowed = rows.middleCols(IrradianceTable::kUnshadowed, 3);
  rows.middleCols(IrradianceTable::kMean, 3) = (open.topRows(3) - open.bottomRows(3)).transpose();
  unshadowed = open.topRows(3).transpose();
  // Below the horizon the harmonics ring about zero, which is all that light sends there.
  if (is_positive) unshadowed = unshadowed.cwiseMax(0.0f);
}

/// Of a light times each image of a ladder, the harmonics that the cosine lets pass, times its
/// factors: [3][kCosineHarmonics] rows of the images' width.
RowMajor product_harmonics(const PreparedTransfer::Ladder& ladder,
                           const std::vector<float>& weighed) {
  const RingGrid& grid = product_grid();
  const size_t columns = static_cast<size_t>(1 + ladder.harmonics.terms);
  const size_t width = panel_width(columns);
  const auto rings = static_cast<size_t>(grid.rings), azimuths = static_cast<size_t>(grid.azimuths);
  std::vector<float> by_azimuth(kCosineRows * rings * width);  // [channel, function][ring]
  for (size_t ring = 0; ring < rings; ++ring)
    dense_product(weighed.data() + ring * kCosineRows * azimuths, kCosineRows, azimuths,
                  ladder.images.data() + ring * azimuths * width, columns,
                  by_azimuth.data() + ring * width, rings * width);
  RowMajor harmonics(3 * kCosineHarmonics, static_cast<Eigen::Index>(width));
  float* next = harmonics.data();
  for (size_t i = 0; i < kCosineRows; ++i) {
    const RowMajor& by_height = cosine_harmonics().by_height[i % kCosineFunctions];
    dense_product(by_height.data(), static_cast<size_t>(by_height.rows()), rings,
                  by_azimuth.data() + i * rings * width, columns, next);
    next += static_cast<size_t>(by_height.rows()) * width;
  }
  return harmonics;
}

}  // namespace

void begin_irradiance_tables(const PreparedTransfer& transfer, PreparedLights& lights) {
  const auto is_wide = [](const PreparedLobe& light) { return light.ladder_share > 0; };
  const bool any = std::any_of(lights.lobes.begin(), lights.lobes.end(), is_wide);
  lights.tables.resize(any ? transfer.ladders.size() : 0);
  if (lights.tables.empty()) return;
  const bool is_positive = std::all_of(
      lights.lobes.begin(), lights.lobes.end(),
      [&](const PreparedLobe& light) { return !is_wide(light) || (light.color >= 0).all(); });
  const RowMajor light = harmonics_of(radiance_of(lights.lobes));
  weigh_light(light, lights.scratch);
  for (size_t i = 0; i < lights.tables.size(); ++i) {
    const int bands = transfer.ladders[i].harmonics.bands;
    lights.tables[i].is_positive = is_positive;
    if (i > 0 && bands == transfer.ladders[0].harmonics.bands)
      lights.tables[i].means = lights.tables[0].means;
    else
      start_means(light, bands, is_positive, lights.tables[i].means);
  }
}

void finish_irradiance_table(const PreparedTransfer& transfer, size_t ladder,
                             PreparedLights& lights) {
  IrradianceTable& table = lights.tables[ladder];
  table.terms = transfer.ladders[ladder].harmonics.terms;
  const auto terms = static_cast<size_t>(table.terms), columns = 1 + terms;
  const size_t width = panel_width(columns), padded = padded_terms(table.terms);
  const RowMajor harmonics = product_harmonics(transfer.ladders[ladder], lights.scratch);
  table.entries.assign(kNormals * table.entry_size(), 0.0f);
  constexpr size_t kTogether = 64;  // values of so many normals stay in the nearest cache
  std::vector<float> values(kTogether * width);
  for (size_t first = 0; first < kNormals; first += kTogether) {
    const size_t count = std::min(kTogether, kNormals - first);
    for (size_t channel = 0; channel < 3; ++channel) {
      dense_product(cosine_harmonics().normals.data() + first * kCosineHarmonics, count,
                    kCosineHarmonics, harmonics.data() + channel * kCosineHarmonics * width,
                    columns, values.data());
      for (size_t i = 0; i < count; ++i) {
        const float* value = values.data() + i * width;
        std::copy_n(value, terms,
                    table.entries.data() + (first + i) * table.entry_size() + channel * padded);
        table.means[(first + i) * IrradianceTable::kMeans + IrradianceTable::kMean + channel] +=
            value[terms];
      }
    }
  }
}

}  // namespace burnish
