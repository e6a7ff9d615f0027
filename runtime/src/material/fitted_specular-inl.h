// The tables of burnish/material/fitted_specular.h on vectors of float or double: one cosine a
// lane.

#if defined(BURNISH_MATERIAL_FITTED_SPECULAR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_MATERIAL_FITTED_SPECULAR_INL_H_
#undef BURNISH_MATERIAL_FITTED_SPECULAR_INL_H_
#else
#define BURNISH_MATERIAL_FITTED_SPECULAR_INL_H_
#endif

#include <array>

#include <hwy/highway.h>

#include "burnish/material/fitted_specular.h"
#include "sphere/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// Factors of the same points, by channel.
template <class V>
using RgbVector = std::array<V, 3>;

/// Where angles fall between the entries of a table, lane by lane: entries are fetched that way.
template <class D>
struct TablePlaces {
  HWY_ALIGN hn::TFromD<D> cell[hn::MaxLanes(D())], fraction[hn::MaxLanes(D())];
};

/// In a table of `size` angles, 2 or more, that divide 0..pi/2 evenly.
template <class D, class V>
HWY_INLINE TablePlaces<D> places_in_table(D d, size_t size, V cosine) {
  const V one = hn::Set(d, 1.0f);
  const V c = hn::Min(hn::Max(cosine, hn::Zero(d)), one);
  const V last = hn::Set(d, static_cast<float>(size - 1));
  const V place = hn::Min(quarter_arccosine(d, c), one) * last;
  const V cell = hn::Min(hn::Floor(place), last - one);
  TablePlaces<D> places;
  hn::Store(cell, d, places.cell);
  hn::Store(place - cell, d, places.fraction);
  return places;
}

/// S of a cosine.
template <class D, class V>
HWY_INLINE V eval_masking(D d, const FittedSpecular& fitted, V cosine) {
  using T = hn::TFromD<D>;
  const TablePlaces<D> places = places_in_table(d, fitted.masking.size(), cosine);
  HWY_ALIGN T low[hn::MaxLanes(d)], high[hn::MaxLanes(d)];
  for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    const float* const entry = fitted.masking.data() + static_cast<int>(places.cell[lane]);
    low[lane] = T(entry[0]);
    high[lane] = T(entry[1]);
  }
  const V a = hn::Load(d, low), b = hn::Load(d, high), t = hn::Load(d, places.fraction);
  return hn::MulAdd(t, b - a, a);
}

/// F of h.o.
template <class D, class V>
HWY_INLINE RgbVector<V> eval_color_by_difference(D d, const FittedSpecular& fitted,
                                                 V cos_difference) {
  using T = hn::TFromD<D>;
  const auto& table = fitted.color_by_difference;
  const TablePlaces<D> places = places_in_table(d, table.size(), cos_difference);
  HWY_ALIGN T value[3][hn::MaxLanes(d)];
  for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    const auto cell = static_cast<size_t>(places.cell[lane]);
    const Rgb &low = table[cell], &high = table[cell + 1];
    for (int channel = 0; channel < 3; ++channel) {
      const T a = T(low[channel]), b = T(high[channel]);
      value[channel][lane] = a + places.fraction[lane] * (b - a);
    }
  }
  return {hn::Load(d, value[0]), hn::Load(d, value[1]), hn::Load(d, value[2])};
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
