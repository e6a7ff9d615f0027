#pragma once

#include <cstddef>

namespace burnish {

/// Rows of matrices that are multiplied start at multiples of this many floats.
inline constexpr size_t kPanel = 32;
inline constexpr size_t panel_width(size_t columns) {
  return (columns + kPanel - 1) / kPanel * kPanel;
}

/// result[i][j] = sum of left[i][k] right[k][j], by the widest instructions: `left` is
/// [rows][inner], the others have rows of panel_width(columns).
void dense_product(const float* left, size_t rows, size_t inner, const float* right, size_t columns,
                   float* result) noexcept;

}  // namespace burnish
