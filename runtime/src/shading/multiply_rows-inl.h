// Products of rows with a matrix.

#if defined(BURNISH_SHADING_MULTIPLY_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_MULTIPLY_ROWS_INL_H_
#undef BURNISH_SHADING_MULTIPLY_ROWS_INL_H_
#else
#define BURNISH_SHADING_MULTIPLY_ROWS_INL_H_
#endif

#include <cstdint>
#include <type_traits>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Floats as lanes of D.
template <class D>
HWY_INLINE hn::VFromD<D> load_floats(D d, const float* values) {
  if constexpr (std::is_same_v<hn::TFromD<D>, float>) {
    return hn::LoadU(d, values);
  } else {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, D>(), values));
  }
}

/// The same of numbers of IEEE 754 binary16.
template <class D>
HWY_INLINE hn::VFromD<D> load_floats(D d, const std::uint16_t* values) {
  const hn::Rebind<float, D> df;
  const hn::Rebind<hwy::float16_t, D> dh;
  const auto floats =
      hn::PromoteTo(df, hn::LoadU(dh, reinterpret_cast<const hwy::float16_t*>(values)));
  if constexpr (std::is_same_v<hn::TFromD<D>, float>) {
    return floats;
  } else {
    return hn::PromoteTo(d, floats);
  }
}

/// Products of four rows of `inner` numbers with a matrix of [inner][width], sums[row][column], two
/// vectors of columns at a time: of both, what is beyond `columns` up to there is read and written.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void multiply_rows(D d, const T* const (&rows)[4], size_t inner, const float* matrix,
                              size_t width, size_t columns, T* const (&sums)[4]) {
  using V = hn::VFromD<D>;
  const size_t lanes = hn::Lanes(d);
  for (size_t j = 0; j < columns; j += 2 * lanes) {
    V left[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    V right[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (size_t k = 0; k < inner; ++k) {
      const V a = load_floats(d, matrix + k * width + j);
      const V b = load_floats(d, matrix + k * width + j + lanes);
      for (int r = 0; r < 4; ++r) {
        const V factor = hn::Set(d, rows[r][k]);
        left[r] = hn::MulAdd(factor, a, left[r]);
        right[r] = hn::MulAdd(factor, b, right[r]);
      }
    }
    for (int r = 0; r < 4; ++r) {
      hn::StoreU(left[r], d, sums[r] + j);
      hn::StoreU(right[r], d, sums[r] + j + lanes);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
