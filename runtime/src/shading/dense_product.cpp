#include "shading/dense_product.h"

#include <algorithm>

#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/dense_product.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "shading/multiply_rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

void product(const float* left, size_t rows, size_t inner, const float* right, size_t columns,
             float* result, size_t stride) {
  const hn::ScalableTag<float> d;
  const size_t width = panel_width(columns);
  for (size_t i = 0; i < rows; i += 4) {
    // Rows beyond the last are the last again.
    const auto row = [&](size_t n) { return std::min(i + n, rows - 1); };
    multiply_rows(d,
                  {left + row(0) * inner, left + row(1) * inner, left + row(2) * inner,
                   left + row(3) * inner},
                  inner, right, width, columns,
                  {result + row(0) * stride, result + row(1) * stride, result + row(2) * stride,
                   result + row(3) * stride});
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {
namespace {

HWY_EXPORT(product);

}  // namespace

void dense_product(const float* left, size_t rows, size_t inner, const float* right, size_t columns,
                   float* result, size_t result_stride) noexcept {
  HWY_DYNAMIC_DISPATCH(product)(left, rows, inner, right, columns, result, result_stride);
}

}  // namespace burnish
#endif
