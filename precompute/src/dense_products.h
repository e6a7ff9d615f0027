#pragma once

#include <cstdint>
#include <span>

#include <hwy/aligned_allocator.h>

#include "burnish/precompute/pca.h"

namespace burnish {

/// A right-hand factor [depth][columns], copied into the order in which the products read it.
class PackedFactor {
 public:
  PackedFactor() = default;
  explicit PackedFactor(const Eigen::Ref<const RowMatrixf>& matrix);

  Eigen::Index depth() const { return depth_; }
  Eigen::Index columns() const { return columns_; }

  static constexpr Eigen::Index kPanel = 32;  ///< columns that lie together
  /// [depth][kPanel] from column panel * kPanel on, zeros beyond the last; 64-byte aligned.
  const float* panel(Eigen::Index panel) const { return data_.get() + panel * depth_ * kPanel; }

 private:
  Eigen::Index depth_ = 0, columns_ = 0;
  hwy::AlignedFreeUniquePtr<float[]> data_;
};

/// A left-hand factor: rows of a matrix, less a centre.
struct CentredRows {
  const RowMatrixf& data;
  std::span<const float> centre = {};          ///< [columns], or empty: zero
  std::span<const std::uint32_t> chosen = {};  ///< numbers of rows, or empty: all

  Eigen::Index rows() const {
    return chosen.empty() ? data.rows() : static_cast<Eigen::Index>(chosen.size());
  }
  Eigen::Index columns() const { return data.cols(); }
  Eigen::Index row(Eigen::Index i) const {
    return chosen.empty() ? i : static_cast<Eigen::Index>(chosen[static_cast<std::size_t>(i)]);
  }
};

// Single-precision products with the widest vectors that the processor has. A block of the result
// has a fixed size and is summed by one thread in a fixed order, so that the number of threads
// changes no bit of it; another instruction set may change the last bits.

/// left * right, [left.rows()][right.columns()].
RowMatrixf multiply(const CentredRows& left, const PackedFactor& right);

/// left^T * right, [left.columns()][right.columns()].
RowMatrixf multiply_transposed(const CentredRows& left, const PackedFactor& right);

/// (left - centre) * right on the calling thread alone. `squared_norms`, empty or one a row,
/// receives those of the centred rows.
void multiply_here(const Eigen::Ref<const RowMatrixf>& left, std::span<const float> centre,
                   const PackedFactor& right, Eigen::Ref<RowMatrixf> product,
                   std::span<double> squared_norms = {});

/// Inner products of the columns, in double.
Eigen::MatrixXd gram_matrix(const RowMatrixf& matrix);

}  // namespace burnish
