#include "burnish/shading/prepared_transfer.h"

#include <algorithm>
#include <cmath>

#include "shading/dense_product.h"
#include "shading/ring_grid.h"

namespace burnish {
namespace {

using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::uint16_t float16_of(float value) { return Eigen::half_impl::float_to_half_rtne(value).x; }

PreparedTransfer::Basis pad(const SsdfBasis& basis, RowFormat format) {
  PreparedTransfer::Basis padded;
  padded.mean = basis.mean;
  const size_t terms = static_cast<size_t>(basis.terms), stride = padded_terms(basis.terms);
  const auto copy = [&](auto& eigen, const auto& convert) {
    eigen.resize(basis.mean.size() * stride);
    for (size_t texel = 0; texel < basis.mean.size(); ++texel)
      std::transform(basis.eigen.data() + texel * terms, basis.eigen.data() + (texel + 1) * terms,
                     eigen.data() + texel * stride, convert);
  };
  if (format == RowFormat::float16)
    copy(padded.eigen16, float16_of);
  else
    copy(padded.eigen32, [](float value) { return value; });
  return padded;
}

PreparedTransfer::Ladder draw(const LadderBasis& basis) {
  const int bands = std::min(basis.bands, kMaxLadderBands);
  const Eigen::Index count = Eigen::Index{bands} * bands, terms = basis.terms;
  const RingGrid& grid = product_grid();
  const auto directions = static_cast<Eigen::Index>(grid.directions());
  RowMajor harmonics(directions, count);
  for (Eigen::Index i = 0; i < directions; ++i)
    eval_harmonics(bands, {grid.x[i], grid.y[i], grid.z[i]},
                   {harmonics.row(i).data(), static_cast<size_t>(count)});
  const Eigen::Map<const RowMajor> eigen(basis.eigen.data(), count, terms);
  const Eigen::Map<const Eigen::VectorXf> mean(basis.mean.data(), count);
  PreparedTransfer::Ladder ladder;
  const size_t width = panel_width(static_cast<size_t>(1 + terms));
  ladder.images.assign(grid.directions() * width, 0.0f);
  Eigen::Map<RowMajor> images(ladder.images.data(), directions, static_cast<Eigen::Index>(width));
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
  const bool half = format == RowFormat::float16 && fits_float16(transfer.coefficients) &&
                    fits_float16(transfer.ladder_coefficients) &&
                    std::all_of(transfer.bases.begin(), transfer.bases.end(),
                                [](const SsdfBasis& basis) { return fits_float16(basis.eigen); });
  prepared.format = half ? RowFormat::float16 : RowFormat::float32;
  for (const SsdfBasis& basis : transfer.bases)
    prepared.bases.push_back(pad(basis, prepared.format));
  for (const LadderBasis& basis : transfer.ladder_bases) prepared.ladders.push_back(draw(basis));
  const size_t count = transfer.vertex_count() * prepared.row_size();
  if (half) {
    prepared.rows16.resize(count);
    for_each_coefficient(transfer,
                         [&](size_t i, float value) { prepared.rows16[i] = float16_of(value); });
  } else {
    prepared.rows32.resize(count);
    for_each_coefficient(transfer, [&](size_t i, float value) { prepared.rows32[i] = value; });
  }
  return prepared;
}

}  // namespace burnish
