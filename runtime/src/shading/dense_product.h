#pragma once

#include <cstddef>

namespace burnish {

/// Rows of matrices that are multiplied start at multiples of this many floats.
inline constexpr size_t kPanel = 32;
inline constexpr size_t panel_width(size_t columns) {
  return (columns + kPanel - 1) / kPanel * kPanel;
}

/// result[i][j] = sum of left[i][k] right[k][j], by the widest instructions: `left` is
/// [rows][inner], `right` has rows of panel_width(columns), and so has the result, of which they
/// start `result_stride` numbers apart.
void dense_product(const float* left, size_t rows, size_t inner, const float* right, size_t columns,
                   float* result, size_t result_stride) noexcept;
inline void dense_product(const float* left, size_t rows, size_t inner, const float* right,
                          size_t columns, float* result) noexcept {
  dense_product(left, rows, inner, right, columns, result, panel_width(columns));
}

}  // namespace burnish
