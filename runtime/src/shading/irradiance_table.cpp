#include "shading/irradiance_table.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/sphere/batch.h"
#include "burnish/sphere/gauss_legendre.h"
#include "shading/dense_product.h"
#include "visibility/harmonic_grid.h"

// The irradiance of a light L through a visibility V is the product L V, convolved with the clamped
// cosine. The cosine lets nothing pass of odd degrees above 1 and hardly anything above 6, so that
// 31 harmonics of L V say all of it: for each eigenvector of the ladder in the place of V once per
// light, not once per vertex (docs/maths.md, "Irradiance table").
namespace burnish {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Rows = Eigen::Map<RowMajor>;
using Degrees = std::array<float, kMaxLadderBands>;

constexpr std::array<int, 5> kCosineDegrees = {0, 1, 2, 4, 6};
constexpr int kCosineHarmonics = 1 + 3 + 5 + 9 + 13;
constexpr int kNormals = IrradianceTable::kCorners * IrradianceTable::kCorners;
/// Narrower axes than the grid can tell are widened to this; the ladder cannot tell them, either.
constexpr float kNarrowestOnGrid = 250;

/// Legendre polynomials of degrees 0..15.
std::array<double, kMaxLadderBands> legendre(double t) {
  std::array<double, kMaxLadderBands> p = {1, t};
  for (int l = 2; l < kMaxLadderBands; ++l)
    p[l] = ((2 * l - 1) * t * p[l - 1] - (l - 1) * p[l - 2]) / l;
  return p;
}

/// By which convolution with function(t), t the cosine from its axis, multiplies harmonics of each
/// degree.
template <class Function>
Degrees zonal_factors(double from, const Function& function) {
  const auto& rule = internal::unit_gauss<30>();
  std::array<double, kMaxLadderBands> sum = {};
  for (size_t i = 0; i < rule.node.size(); ++i) {
    const double t = from + (1 - from) * rule.node[i];
    const auto p = legendre(t);
    const double weight = 2 * kPi<double> * (1 - from) * rule.weight[i] * function(t);
    for (int l = 0; l < kMaxLadderBands; ++l) sum[l] += weight * p[l];
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
Vector3f normal_of(int corner) {
  constexpr int kCorners = IrradianceTable::kCorners;
  constexpr float kWidth = 2.0f / IrradianceTable::kCells;
  const float x = static_cast<float>(corner % kCorners) * kWidth - 1;
  const float y = static_cast<float>(corner / kCorners) * kWidth - 1;
  const float z = 1 - std::abs(x) - std::abs(y);
  if (z >= 0) return Vector3f(x, y, z).normalized();
  return Vector3f(std::copysign(1 - std::abs(y), x), std::copysign(1 - std::abs(x), y), z)
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

/// The harmonics of the directions of the table's normals: [kNormals][kGridHarmonics].
const RowMajor& normal_harmonics() {
  static const RowMajor harmonics = [] {
    RowMajor result(kNormals, static_cast<Eigen::Index>(kGridHarmonics));
    for (int i = 0; i < kNormals; ++i)
      eval_harmonics(kMaxLadderBands, normal_of(i), {result.row(i).data(), kGridHarmonics});
    return result;
  }();
  return harmonics;
}

/// Calls visit(row, harmonic, factor) for the harmonics that the cosine lets pass.
template <class Visit>
void for_each_cosine_harmonic(const Visit& visit) {
  int row = 0;
  for (const int l : kCosineDegrees)
    for (int m = 0; m < 2 * l + 1; ++m) visit(row++, l * l + m, cosine_factors()[l]);
}

/// Harmonics of the grid's directions, transposed: [kCosineHarmonics][kLadderDirections], times the
/// cosine's factors and a direction's solid angle; and of the normals.
struct CosineHarmonics {
  RowMajor grid, normals;
  CosineHarmonics() {
    grid.resize(kCosineHarmonics, kLadderDirections);
    normals.resize(kNormals, kCosineHarmonics);
    const HarmonicGrid& all = harmonic_grid();
    for_each_cosine_harmonic([&](int row, int harmonic, float factor) {
      for (size_t i = 0; i < kLadderDirections; ++i)
        grid(row, static_cast<Eigen::Index>(i)) =
            all.harmonics[i * kGridHarmonics + static_cast<size_t>(harmonic)] * factor *
            HarmonicGrid::kSolidAngle;
      normals.col(row) = normal_harmonics().col(harmonic);
    });
  }
};

const CosineHarmonics& cosine_harmonics() {
  static const CosineHarmonics harmonics;
  return harmonics;
}

/// Radiance of the lobes' ladder shares on the grid: [3][kLadderDirections].
void add_radiance(const PreparedLobe& light, Rows radiance, std::span<float> values) {
  const HarmonicGrid& grid = harmonic_grid();
  AnisotropicGaussian<float> lobe = light.lobe;
  lobe.bandwidth_x = std::min(lobe.bandwidth_x, kNarrowestOnGrid);
  lobe.bandwidth_y = std::min(lobe.bandwidth_y, kNarrowestOnGrid);
  // The wider lobe keeps the energy.
  const float scale = light.ladder_share * light.integral / integral(lobe);
  batch::eval(lobe, {grid.x, grid.y, grid.z}, values);
  const Eigen::Map<const Eigen::RowVectorXf> shape(values.data(), kLadderDirections);
  for (int channel = 0; channel < 3; ++channel)
    radiance.row(channel) += scale * light.color[channel] * shape;
}

/// left right, the right one's rows being of panel_width(columns).
RowMajor multiply(const RowMajor& left, const float* right, size_t columns) {
  RowMajor result(left.rows(), static_cast<Eigen::Index>(panel_width(columns)));
  dense_product(left.data(), static_cast<size_t>(left.rows()), static_cast<size_t>(left.cols()),
                right, columns, result.data());
  return result;
}

/// Convolves radiance of harmonics `light` [3][kGridHarmonics] with zonal functions: [kNormals][3]
/// of the first, then of the second.
RowMajor convolve(const RowMajor& light, const Degrees& first, const Degrees& second) {
  RowMajor scaled = RowMajor::Zero(kGridHarmonics, kPanel);
  for (int l = 0; l < kMaxLadderBands; ++l) {
    const auto band = light.leftCols(kGridHarmonics).middleCols(l * l, 2 * l + 1).transpose();
    scaled.block(l * l, 0, 2 * l + 1, 3) = first[l] * band;
    scaled.block(l * l, 3, 2 * l + 1, 3) = second[l] * band;
  }
  return multiply(normal_harmonics(), scaled.data(), 6);
}

void fill(const PreparedTransfer::Ladder& ladder, const Rows& radiance, const RowMajor& light,
          IrradianceTable& table) {
  const int terms = ladder.harmonics.terms;
  const size_t columns = static_cast<size_t>(1 + terms);
  table.terms = terms;
  const Eigen::Index size = static_cast<Eigen::Index>(table.entry_size());
  table.entries.assign(static_cast<size_t>(kNormals * size), 0.0f);
  Rows entries(table.entries.data(), kNormals, size);
  // What a bare horizon lacks is added, so that all is exact where nothing occludes.
  const RowMajor open = convolve(light, cosine_factors(), open_factors(ladder.harmonics.bands));
  RowMajor weighted(kCosineHarmonics, kLadderDirections);
  for (int channel = 0; channel < 3; ++channel) {
    weighted.array() = cosine_harmonics().grid.array().rowwise() * radiance.row(channel).array();
    const RowMajor product = multiply(weighted, ladder.images.data(), columns);
    const RowMajor values = multiply(cosine_harmonics().normals, product.data(), columns);
    entries.col(IrradianceTable::kMean + channel) =
        values.col(terms) + open.col(channel) - open.col(3 + channel);
    entries.middleCols(
        IrradianceTable::kTerms + channel * static_cast<Eigen::Index>(padded_terms(terms)), terms) =
        values.leftCols(terms);
    // Below the horizon the harmonics ring about zero, which is all that light sends there.
    auto unshadowed = entries.col(IrradianceTable::kUnshadowed + channel);
    unshadowed = open.col(channel);
    if ((radiance.row(channel).array() >= 0).all()) unshadowed = unshadowed.cwiseMax(0.0f);
  }
}

}  // namespace

void make_irradiance_tables(const PreparedTransfer& transfer, PreparedLights& lights) {
  lights.tables.resize(0);
  const bool any = std::any_of(lights.lobes.begin(), lights.lobes.end(),
                               [](const PreparedLobe& light) { return light.ladder_share > 0; });
  if (!any || transfer.ladders.empty()) return;
  lights.scratch.assign(4 * kLadderDirections, 0.0f);
  Rows radiance(lights.scratch.data(), 3, kLadderDirections);
  for (const PreparedLobe& light : lights.lobes)
    if (light.ladder_share > 0)
      add_radiance(light, radiance,
                   std::span(lights.scratch).subspan(3 * kLadderDirections, kLadderDirections));
  const HarmonicGrid& grid = harmonic_grid();
  const RowMajor light =
      multiply(radiance, grid.harmonics.data(), kGridHarmonics) * HarmonicGrid::kSolidAngle;
  lights.tables.resize(transfer.ladders.size());
  for (size_t i = 0; i < transfer.ladders.size(); ++i)
    fill(transfer.ladders[i], radiance, light, lights.tables[i]);
}

}  // namespace burnish
