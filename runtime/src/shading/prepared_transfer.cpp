#include "burnish/shading/prepared_transfer.h"

#include <algorithm>
#include <cmath>

#include "shading/dense_product.h"
#include "visibility/harmonic_grid.h"

namespace burnish {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

PreparedTransfer::Basis pad(const SsdfBasis& basis) {
  PreparedTransfer::Basis padded;
  padded.mean = basis.mean;
  const size_t terms = static_cast<size_t>(basis.terms), stride = padded_terms(basis.terms);
  padded.eigen.assign(basis.mean.size() * stride, 0.0f);
  for (size_t texel = 0; texel < basis.mean.size(); ++texel)
    std::copy_n(basis.eigen.data() + texel * terms, terms, padded.eigen.data() + texel * stride);
  return padded;
}

PreparedTransfer::Ladder draw(const LadderBasis& basis) {
  const int bands = std::min(basis.bands, kMaxLadderBands);
  const Eigen::Index count = Eigen::Index{bands} * bands, terms = basis.terms;
  const HarmonicGrid& grid = harmonic_grid();
  const Eigen::Map<const RowMajor, 0, Eigen::OuterStride<>> harmonics(
      grid.harmonics.data(), kLadderDirections, count, Eigen::OuterStride<>(kGridHarmonics));
  const Eigen::Map<const RowMajor> eigen(basis.eigen.data(), count, terms);
  const Eigen::Map<const Eigen::VectorXf> mean(basis.mean.data(), count);
  PreparedTransfer::Ladder ladder;
  const size_t width = panel_width(static_cast<size_t>(1 + terms));
  ladder.images.assign(kLadderDirections * width, 0.0f);
  Eigen::Map<RowMajor> images(ladder.images.data(), kLadderDirections,
                              static_cast<Eigen::Index>(width));
  images.leftCols(terms) = harmonics * eigen;
  images.col(terms) = harmonics * mean;
  ladder.harmonics = basis;
  return ladder;
}

bool fits_float16(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](float value) { return std::abs(value) <= 65504; });
}

/// Calls write(index, value) for all coefficients in the order of rows.
template <class Write>
void for_each_coefficient(const Transfer& transfer, const Write& write) {
  const size_t terms = static_cast<size_t>(transfer.terms());
  const size_t ladder_terms = static_cast<size_t>(transfer.ladder_terms());
  size_t index = 0;
  for (size_t vertex = 0; vertex < transfer.vertex_count(); ++vertex) {
    for (size_t k = 0; k < terms; ++k) write(index++, transfer.coefficients[vertex * terms + k]);
    for (size_t k = 0; k < ladder_terms; ++k)
      write(index++, transfer.ladder_coefficients[vertex * ladder_terms + k]);
  }
}

}  // namespace

size_t PreparedTransfer::bytes_per_vertex() const {
  const size_t coefficient = format == RowFormat::float16 ? 2 : 4;
  return 3 * sizeof(Vector3f) + (bases.empty() ? 0 : 1) + coefficient * row_size();
}

PreparedTransfer prepare_transfer(const Transfer& transfer, RowFormat format) {
  PreparedTransfer prepared;
  prepared.positions = transfer.positions;
  prepared.normals = transfer.normals;
  prepared.tangents = transfer.tangents;
  if (transfer.bases.empty()) return prepared;
  prepared.basis_id = transfer.basis_id;
  prepared.terms = transfer.terms();
  prepared.ladder_terms = transfer.ladder_terms();
  prepared.resolution = transfer.bases.front().resolution;
  prepared.amplitude_rad = transfer.bases.front().amplitude_rad;
  prepared.ladder_crossover = transfer.ladder_crossover;
  for (const SsdfBasis& basis : transfer.bases) prepared.bases.push_back(pad(basis));
  for (const LadderBasis& basis : transfer.ladder_bases) prepared.ladders.push_back(draw(basis));
  const size_t count = transfer.vertex_count() * prepared.row_size();
  const bool half = format == RowFormat::float16 && fits_float16(transfer.coefficients) &&
                    fits_float16(transfer.ladder_coefficients);
  prepared.format = half ? RowFormat::float16 : RowFormat::float32;
  if (half) {
    prepared.rows16.resize(count);
    for_each_coefficient(transfer, [&](size_t i, float value) {
      prepared.rows16[i] = Eigen::half_impl::float_to_half_rtne(value).x;
    });
  } else {
    prepared.rows32.resize(count);
    for_each_coefficient(transfer, [&](size_t i, float value) { prepared.rows32[i] = value; });
  }
  return prepared;
}

}  // namespace burnish
