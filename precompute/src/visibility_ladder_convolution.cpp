#include "visibility_ladder_convolution.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "burnish/sphere/octahedral_map.h"

namespace burnish {
namespace {

using Eigen::Index;

constexpr Index kRowBlock = 64;

// The row of a map that holds texel (x, y) of its first quadrant, mirrored in x (bit 0 of `mirror`)
// and y (bit 1).
Index mirrored_row(Index texel, int mirror, int resolution) {
  const Index half = resolution / 2;
  Index x = texel % half, y = texel / half;
  if (mirror & 1) x = resolution - 1 - x;
  if (mirror & 2) y = resolution - 1 - y;
  return y * resolution + x;
}

// Whether a map of this parity changes its sign under this mirroring: +-1.
float character(int parity, int mirror) {
  const int odd = parity & mirror;
  return odd == 1 || odd == 2 ? -1.0f : 1.0f;
}

template <class Body>
void for_row_blocks(Index rows, const Body& body) {
  tbb::parallel_for(Index{0}, (rows + kRowBlock - 1) / kRowBlock, [&](Index i) {
    body(i * kRowBlock, std::min(kRowBlock, rows - i * kRowBlock));
  });
}

}  // namespace

SphericalConvolution::SphericalConvolution(int resolution, double bandwidth)
    : resolution_(resolution) {
  const Index quadrant = Index{resolution} * resolution / 4;
  using Directions = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  std::array<Directions, 4> directions;
  for (int mirror = 0; mirror < 4; ++mirror) {
    directions[mirror].resize(3, quadrant);
    for (Index i = 0; i < quadrant; ++i) {
      const auto row = static_cast<int>(mirrored_row(i, mirror, resolution));
      directions[mirror].col(i) =
          octahedral_texel_direction<double>(row % resolution, row / resolution, resolution);
    }
  }
  for (RowMatrixf& block : parity_) block.resize(quadrant, quadrant);
  for_row_blocks(quadrant, [&](Index first, Index count) {
    std::array<Eigen::RowVectorXd, 4> kernel;
    for (Index row = first; row < first + count; ++row) {
      double sum = 0;
      for (int mirror = 0; mirror < 4; ++mirror) {
        kernel[mirror] = directions[0].col(row).transpose() * directions[mirror];
        kernel[mirror] = (2 * bandwidth * (kernel[mirror].array() - 1)).exp();
        sum += kernel[mirror].sum();
      }
      for (int parity = 0; parity < 4; ++parity) {
        Eigen::RowVectorXd total = Eigen::RowVectorXd::Zero(quadrant);
        for (int mirror = 0; mirror < 4; ++mirror)
          total += double(character(parity, mirror)) * kernel[mirror];
        parity_[parity].row(row) = (total / sum).cast<float>();
      }
    }
  });
}

RowMatrixf SphericalConvolution::apply(const RowMatrixf& maps) const {
  const Index quadrant = parity_[0].rows();
  std::array<RowMatrixf, 4> folded;
  for (RowMatrixf& part : folded) part.resize(quadrant, maps.cols());
  for_row_blocks(quadrant, [&](Index first, Index count) {
    for (Index row = first; row < first + count; ++row)
      for (int parity = 0; parity < 4; ++parity) {
        folded[parity].row(row).setZero();
        for (int mirror = 0; mirror < 4; ++mirror)
          folded[parity].row(row) +=
              character(parity, mirror) * maps.row(mirrored_row(row, mirror, resolution_));
      }
  });
  RowMatrixf result(maps.rows(), maps.cols());
  for_row_blocks(quadrant, [&](Index first, Index count) {
    std::array<RowMatrixf, 4> convolved;
    for (int parity = 0; parity < 4; ++parity)
      convolved[parity].noalias() = parity_[parity].middleRows(first, count) * folded[parity];
    for (Index row = 0; row < count; ++row)
      for (int mirror = 0; mirror < 4; ++mirror) {
        auto out = result.row(mirrored_row(first + row, mirror, resolution_));
        out.setZero();
        for (int parity = 0; parity < 4; ++parity)
          out += 0.25f * character(parity, mirror) * convolved[parity].row(row);
      }
  });
  return result;
}

}  // namespace burnish
