#include "dense_products.h"

#include <algorithm>
#include <cstddef>

#include <tbb/parallel_for.h>

// Based on: the blocked matrix product of goto2008anatomy. The left factor is copied, block by
// block, into a buffer that stays in the second-level cache; a tile of the result stays in
// registers while a panel of the right factor, which stays in the first, goes by.

// Sizeless vectors (SVE, RISC-V) cannot be elements of an array.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dense_products.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef BURNISH_PRECOMPUTE_DENSE_PRODUCTS_ONCE_
#define BURNISH_PRECOMPUTE_DENSE_PRODUCTS_ONCE_
namespace burnish {
namespace {

using Eigen::Index;

constexpr Index kPanel = PackedFactor::kPanel;
constexpr Index kDepth = 256;  // of a block
// Rows of the result in a block: of multiply, and of multiply_transposed. Multiples of any tile's.
constexpr Index kRows = 96, kTransposedRows = 192;
// From one row to the next in the buffer: not a power of two, which would fall on few cache sets.
constexpr Index kRowStride = kDepth + 16;
constexpr Index kBufferSize = std::max(kRows * kRowStride, kTransposedRows* kDepth);

// What one thread computes: some rows of the result, all its columns.
struct ProductBlock {
  const float* left;  // the first row's first element; transposed, of the block's columns
  Index left_stride;
  const std::uint32_t* chosen;  // numbers of the rows; null: 0, 1, ...
  const float* centre;          // null: nothing to subtract
  Index rows;
  const PackedFactor& right;
  float* product;
  Index product_stride;
  double* squared_norms;  // null: not wanted

  const float* left_row(Index row) const {
    return left + (chosen ? static_cast<Index>(chosen[row]) : row) * left_stride;
  }
};

}  // namespace
}  // namespace burnish
#endif

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using V = hn::VFromD<D>;
constexpr int kLanes = static_cast<int>(hn::MaxLanes(D()));
// A tile of the result takes 24 of 32 vector registers, or 12 of 16.
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
constexpr int kTileRows = 12, kTileVectors = 2;
#else
constexpr int kTileRows = 3, kTileVectors = 4;
#endif
constexpr int kTileColumns = kTileVectors * kLanes;
static_assert(kPanel % kTileColumns == 0 && kRows % kTileRows == 0 &&
              kTransposedRows % kTileRows == 0);

// product tile += left * right over `depth`; row r of the tile at depth k is left[r * kRowStep + k
// * kDepthStep].
template <Index kRowStep, Index kDepthStep>
HWY_INLINE void add_tile(const float* HWY_RESTRICT left, const float* HWY_RESTRICT right,
                         Index depth, float* HWY_RESTRICT product, Index product_stride) {
  const D d;
  V sum[kTileRows][kTileVectors];
  for (int r = 0; r < kTileRows; ++r)
    for (int c = 0; c < kTileVectors; ++c)
      sum[r][c] = hn::LoadU(d, product + r * product_stride + c * kLanes);
  for (Index k = 0; k < depth; ++k) {
    V b[kTileVectors];
    for (int c = 0; c < kTileVectors; ++c) b[c] = hn::Load(d, right + k * kPanel + c * kLanes);
    for (int r = 0; r < kTileRows; ++r) {
      const V a = hn::Set(d, left[r * kRowStep + k * kDepthStep]);
      for (int c = 0; c < kTileVectors; ++c) sum[r][c] = hn::MulAdd(a, b[c], sum[r][c]);
    }
  }
  for (int r = 0; r < kTileRows; ++r)
    for (int c = 0; c < kTileVectors; ++c)
      hn::StoreU(sum[r][c], d, product + r * product_stride + c * kLanes);
}

// A tile that reaches over the result's edge goes through a buffer.
template <Index kRowStep, Index kDepthStep>
HWY_INLINE void add_partial_tile(const float* left, const float* right, Index depth, float* product,
                                 Index product_stride, Index rows, Index columns) {
  HWY_ALIGN float tile[kTileRows * kTileColumns] = {};
  for (Index r = 0; r < rows; ++r)
    std::copy_n(product + r * product_stride, columns, tile + r * kTileColumns);
  add_tile<kRowStep, kDepthStep>(left, right, depth, tile, kTileColumns);
  for (Index r = 0; r < rows; ++r)
    std::copy_n(tile + r * kTileColumns, columns, product + r * product_stride);
}

// Adds what `depth` rows of the right factor, from `first` on, contribute to the block.
template <Index kRowStep, Index kDepthStep>
void add_depths(const ProductBlock& block, const float* buffer, Index first, Index depth) {
  const Index columns = block.right.columns();
  for (Index c = 0; c < columns; c += kTileColumns) {
    const float* right = block.right.panel(c / kPanel) + first * kPanel + c % kPanel;
    for (Index r = 0; r < block.rows; r += kTileRows) {
      const float* left = buffer + r * kRowStep;
      float* product = block.product + r * block.product_stride + c;
      const Index tile_rows = std::min<Index>(kTileRows, block.rows - r);
      const Index tile_columns = std::min<Index>(kTileColumns, columns - c);
      if (tile_rows == kTileRows && tile_columns == kTileColumns)
        add_tile<kRowStep, kDepthStep>(left, right, depth, product, block.product_stride);
      else
        add_partial_tile<kRowStep, kDepthStep>(left, right, depth, product, block.product_stride,
                                               tile_rows, tile_columns);
    }
  }
}

// to = from - centre (where there is one); returns the sum of squares.
HWY_INLINE float copy_centred(const float* from, const float* centre, Index size, float* to) {
  const D d;
  V squares = hn::Zero(d);
  Index i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    V value = hn::LoadU(d, from + i);
    if (centre) value = hn::Sub(value, hn::LoadU(d, centre + i));
    hn::StoreU(value, d, to + i);
    squares = hn::MulAdd(value, value, squares);
  }
  float sum = hn::GetLane(hn::SumOfLanes(d, squares));
  for (; i < size; ++i) {
    to[i] = from[i] - (centre ? centre[i] : 0);
    sum += to[i] * to[i];
  }
  return sum;
}

void clear(const ProductBlock& block) {
  for (Index r = 0; r < block.rows; ++r)
    std::fill_n(block.product + r * block.product_stride, block.right.columns(), 0.0f);
}

// Rows that only fill up the last tile are zero.
void multiply_block(const ProductBlock& block, float* buffer) {
  clear(block);
  const Index all = block.right.depth();
  const Index filled_rows = (block.rows + kTileRows - 1) / kTileRows * kTileRows;
  for (Index r = block.rows; r < filled_rows; ++r)
    std::fill_n(buffer + r * kRowStride, kDepth, 0.0f);
  for (Index first = 0; first < all; first += kDepth) {
    const Index depth = std::min(kDepth, all - first);
    for (Index r = 0; r < block.rows; ++r) {
      const float squares =
          copy_centred(block.left_row(r) + first, block.centre ? block.centre + first : nullptr,
                       depth, buffer + r * kRowStride);
      if (block.squared_norms) block.squared_norms[r] += static_cast<double>(squares);
    }
    add_depths<kRowStride, 1>(block, buffer, first, depth);
  }
}

void multiply_transposed_block(const ProductBlock& block, float* buffer) {
  clear(block);
  const Index all = block.right.depth();
  const Index filled_rows = (block.rows + kTileRows - 1) / kTileRows * kTileRows;
  for (Index first = 0; first < all; first += kDepth) {
    const Index depth = std::min(kDepth, all - first);
    for (Index k = 0; k < depth; ++k) {
      float* row = buffer + k * kTransposedRows;
      copy_centred(block.left_row(first + k), block.centre, block.rows, row);
      std::fill(row + block.rows, row + filled_rows, 0.0f);
    }
    add_depths<1, kTransposedRows>(block, buffer, first, depth);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(multiply_block);
HWY_EXPORT(multiply_transposed_block);

namespace {

float* block_buffer() {
  static thread_local const hwy::AlignedFreeUniquePtr<float[]> buffer =
      hwy::AllocateAligned<float>(kBufferSize);
  return buffer.get();
}

template <class Body>
void for_blocks(Index size, Index block, const Body& body) {
  tbb::parallel_for(Index{0}, (size + block - 1) / block,
                    [&](Index i) { body(i * block, std::min(block, size - i * block)); });
}

const float* data_or_null(std::span<const float> values) {
  return values.empty() ? nullptr : values.data();
}

}  // namespace

PackedFactor::PackedFactor(const Eigen::Ref<const RowMatrixf>& matrix)
    : depth_(matrix.rows()), columns_(matrix.cols()) {
  const Index panels = (columns_ + kPanel - 1) / kPanel;
  const auto size = static_cast<std::size_t>(panels * depth_ * kPanel);
  if (size == 0) return;
  data_ = hwy::AllocateAligned<float>(size);
  for_blocks(panels, 1, [&](Index panel, Index) {
    const Index first = panel * kPanel, count = std::min(kPanel, columns_ - first);
    float* to = data_.get() + panel * depth_ * kPanel;
    for (Index k = 0; k < depth_; ++k, to += kPanel) {
      std::copy_n(matrix.row(k).data() + first, count, to);
      std::fill(to + count, to + kPanel, 0.0f);
    }
  });
}

void multiply_here(const Eigen::Ref<const RowMatrixf>& left, std::span<const float> centre,
                   const PackedFactor& right, Eigen::Ref<RowMatrixf> product,
                   std::span<double> squared_norms) {
  std::fill(squared_norms.begin(), squared_norms.end(), 0.0);
  for (Index first = 0; first < left.rows(); first += kRows) {
    const Index rows = std::min(kRows, left.rows() - first);
    HWY_DYNAMIC_DISPATCH(multiply_block)
    ({left.row(first).data(), left.outerStride(), nullptr, data_or_null(centre), rows, right,
      product.row(first).data(), product.outerStride(),
      squared_norms.empty() ? nullptr : squared_norms.data() + first},
     block_buffer());
  }
}

RowMatrixf multiply(const CentredRows& left, const PackedFactor& right) {
  RowMatrixf product(left.rows(), right.columns());
  const bool all = left.chosen.empty();
  for_blocks(left.rows(), kRows, [&](Index first, Index rows) {
    HWY_DYNAMIC_DISPATCH(multiply_block)
    ({all ? left.data.row(first).data() : left.data.data(), left.data.outerStride(),
      all ? nullptr : left.chosen.data() + first, data_or_null(left.centre), rows, right,
      product.row(first).data(), product.outerStride(), nullptr},
     block_buffer());
  });
  return product;
}

RowMatrixf multiply_transposed(const CentredRows& left, const PackedFactor& right) {
  RowMatrixf product(left.columns(), right.columns());
  for_blocks(left.columns(), kTransposedRows, [&](Index first, Index rows) {
    HWY_DYNAMIC_DISPATCH(multiply_transposed_block)
    ({left.data.data() + first, left.data.outerStride(),
      left.chosen.empty() ? nullptr : left.chosen.data(),
      left.centre.empty() ? nullptr : left.centre.data() + first, rows, right,
      product.row(first).data(), product.outerStride(), nullptr},
     block_buffer());
  });
  return product;
}

Eigen::MatrixXd gram_matrix(const RowMatrixf& matrix) {
  constexpr Index kBlock = 1024;
  std::vector<Eigen::MatrixXd> parts(
      static_cast<std::size_t>((matrix.rows() + kBlock - 1) / kBlock));
  for_blocks(matrix.rows(), kBlock, [&](Index first, Index rows) {
    const Eigen::MatrixXd block = matrix.middleRows(first, rows).cast<double>();
    Eigen::MatrixXd& part = parts[static_cast<std::size_t>(first / kBlock)];
    part = Eigen::MatrixXd::Zero(block.cols(), block.cols());
    part.selfadjointView<Eigen::Lower>().rankUpdate(block.transpose());
  });
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(matrix.cols(), matrix.cols());
  for (const Eigen::MatrixXd& part : parts) sum += part;
  return sum.selfadjointView<Eigen::Lower>();
}

}  // namespace burnish
#endif
