#pragma once

#include <array>
#include <cstdint>

#include "burnish/shading/prepared_transfer.h"
#include "shading/fetcher.h"
#include "sphere/block.h"

/// What the frame's kernels share of the points of a block.
namespace burnish {

/// Numbers of the coefficients of a block's points, at most: their rows stay in the near caches.
/// Transfers of very many terms are shaded by fewer points at a time.
inline constexpr size_t kBlockCoefficients = 16384;
inline constexpr size_t kBlockRows = 3 * kBlock;
/// Of a transfer, and of its ladder.
inline constexpr int kMaxTerms = 1024;

/// What a point sees: the weighted sum of one or more rows, each of a basis of its own.
template <class T>
struct VisibilityRow {
  size_t point = 0;  ///< in the block
  std::uint8_t basis = 0;
  T weight = 1;
  int vertex_count = 0;  ///< of those whose mean the coefficients are
  std::array<std::uint32_t, 3> vertex = {};
  std::array<T, 3> vertex_weight = {};
  T* ssdf = nullptr;    ///< [padded_terms(terms)], zeros beyond the terms in use
  T* ladder = nullptr;  ///< [padded_terms(ladder terms)]
};

template <class T>
struct ShadingBlock {
  size_t count = 0;
  Vector3f position[kBlock];
  BlockVector3<T> tangent, bitangent, normal;  ///< the points' frames
  BlockVector3<T> outgoing;                    ///< in the points' frames
  size_t row_count = 0;
  VisibilityRow<T> row[kBlockRows];
  alignas(64) T coefficients[kBlockCoefficients];
  Fetcher fetcher;  ///< of what the block reads later, and the next one
};

}  // namespace burnish
