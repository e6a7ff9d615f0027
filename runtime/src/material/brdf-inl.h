// The specular models of burnish/material/material.h on vectors of float or double: one pair of
// directions a lane. What a function is of, the scalar form in src/material/ says. A smooth factor
// here is without its Fresnel factor, its colour and BrdfNumbers::scale.

#if defined(BURNISH_MATERIAL_BRDF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_MATERIAL_BRDF_INL_H_
#undef BURNISH_MATERIAL_BRDF_INL_H_
#else
#define BURNISH_MATERIAL_BRDF_INL_H_
#endif

#include <limits>
#include <type_traits>

#include <hwy/highway.h>

#include "material/brdf_numbers.h"
#include "material/fitted_specular-inl.h"
#include "material/half_vector.h"
#include "sphere/lobes-inl.h"
#include "sphere/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

using internal::BrdfKind;
using internal::BrdfNumbers;
using internal::FresnelKind;

/// exp(exponent) over / under: quotients are not divided where they are formed, so that several of
/// them may share a division.
template <class V>
struct Quotient {
  V over, under;
};
template <class V>
struct ScaledExp {
  V exponent;
  Quotient<V> factor;
};

/// eval_distribution of a half vector above the horizon; not of `fitted`.
template <BrdfKind kKind, class D, class V>
HWY_INLINE ScaledExp<V> distribution(D d, const BrdfNumbers& n, const Vector3<V>& half) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const V e = hn::MulAdd(half.x * half.x, hn::Set(d, n.inverse_xx),
                         half.y * half.y * hn::Set(d, n.inverse_yy));
  const V square = half.z * half.z;
  if constexpr (kKind == BrdfKind::ward) {
    return {hn::Div(e, hn::MulAdd(hn::Set(d, -0.5f), half.z, hn::Set(d, -0.5f))), {one, one}};
  } else if constexpr (kKind == BrdfKind::ashikhmin) {
    // With the exponents' 2 and the root's 1/2.
    return {e * log_over_gap(d, hn::Max(square, hn::Set(d, 1e-30f))), {one, one}};
  } else if constexpr (kKind == BrdfKind::blinn_phong) {
    const V sine_squared = hn::MulAdd(half.x, half.x, half.y * half.y);
    const V logarithm = sine_squared * log_over_gap(d, hn::Max(square, hn::Set(d, 1e-30f)));
    return {hn::Set(d, 0.5f * n.exponent) * logarithm, {one, one}};
  } else if constexpr (kKind == BrdfKind::ggx) {
    const V q = e + square;
    return {zero, {one, q * q}};
  } else {
    // Below a cosine^2 of 1/81, D is less than exp(-80).
    const V held = hn::Max(square, hn::Set(d, 0.01f));
    return {hn::Neg(hn::Div(e, held)), {one, held * held}};
  }
}

/// facing_area.
template <BrdfKind kKind, class D, class V>
HWY_INLINE V facing_area(D d, const BrdfNumbers& n, const Vector3<V>& direction) {
  const V x = hn::Set(d, n.alpha_x) * direction.x, y = hn::Set(d, n.alpha_y) * direction.y;
  const V width_squared = hn::MulAdd(x, x, y * y), cosine = direction.z, half = hn::Set(d, 0.5f);
  if constexpr (kKind == BrdfKind::ggx) {
    return half * (cosine + hn::Sqrt(hn::MulAdd(cosine, cosine, width_squared)));
  } else {
    // cos (1 + erf(a)) / 2 + width exp(-a^2) / (2 sqrt(pi)), a = cos / width, with one division.
    // From a = 9 on, all but the cosine is out of sight.
    const V width = hn::Max(hn::Sqrt(width_squared), hn::Set(d, 1.0f / 9) * cosine);
    const V below_t = hn::MulAdd(hn::Set(d, 0.4f), cosine, width), square = width * width;
    const V inverse = hn::Set(d, 1.0f) / (below_t * square);
    const V t = width * square * inverse, exponent = cosine * cosine * (below_t * inverse);
    const V tail = half * (t * erfc_curve(d, t));
    const V rest = hn::NegMulAdd(cosine, tail, width * hn::Set(d, 0.282094792f));
    return hn::MulAdd(exp(d, hn::Neg(exponent)), rest, cosine);
  }
}

/// A view and what of the smooth factor depends on it only.
template <class V>
struct BrdfView {
  Vector3<V> outgoing;
  V cosine;  ///< held above 0
  V area;    ///< facing_area, where Smith's shadowing needs it; of `fitted`, its masking
};

inline constexpr bool has_microfacets(BrdfKind kind) {
  return kind == BrdfKind::beckmann || kind == BrdfKind::ggx || kind == BrdfKind::blinn_phong;
}

template <BrdfKind kKind, class D, class V>
HWY_INLINE BrdfView<V> view_brdf(D d, const BrdfNumbers& n, const Vector3<V>& outgoing) {
  BrdfView<V> view = {outgoing, hn::Max(outgoing.z, hn::Set(d, internal::kMinCosine)), hn::Zero(d)};
  if constexpr (has_microfacets(kKind))
    if (n.shadowing != Shadowing::v_cavity)
      view.area = hn::Max(facing_area<kKind>(d, n, outgoing), view.cosine);
  if constexpr (kKind == BrdfKind::fitted) view.area = eval_masking(d, *n.fitted, outgoing.z);
  return view;
}

/// specular_smooth_factor, see above.
template <BrdfKind kKind, class D, class V>
HWY_INLINE Quotient<V> smooth_factor(D d, const BrdfNumbers& n, const BrdfView<V>& view,
                                     const Vector3<V>& incoming, V cos_difference) {
  const V one = hn::Set(d, 1.0f), least = hn::Set(d, internal::kMinCosine);
  const V cos_d = hn::Max(cos_difference, least), cos_i = hn::Max(incoming.z, least);
  const V cos_o = view.cosine;
  if constexpr (kKind == BrdfKind::ward) {
    return {one, hn::Sqrt(cos_i * cos_o)};
  } else if constexpr (kKind == BrdfKind::ward_balanced) {
    return {one, cos_d * cos_d};
  } else if constexpr (kKind == BrdfKind::ashikhmin) {
    return {one, cos_d * hn::Max(cos_i, cos_o)};
  } else if constexpr (has_microfacets(kKind)) {
    if (n.shadowing == Shadowing::v_cavity) {
      // n.h = (n.i + n.o) / (2 h.o)
      const V square = cos_d * cos_d;
      const V cavity = (incoming.z + view.outgoing.z) * hn::Min(cos_i, cos_o);
      return {hn::Min(square, cavity), square * (cos_i * cos_o)};
    }
    const V area = hn::Max(facing_area<kKind>(d, n, incoming), cos_i);
    if (n.shadowing == Shadowing::smith_separable) return {one, area * view.area};
    return {one, hn::MulAdd(cos_o, area, cos_i * (view.area - cos_o))};
  } else {
    return {view.area * eval_masking(d, *n.fitted, incoming.z), one};
  }
}

/// Calls f with the kind as a constant, so that code within is straight.
template <class F>
HWY_INLINE void with_kind(BrdfKind kind, const F& f) {
  switch (kind) {
    case BrdfKind::ward:
      return f(std::integral_constant<BrdfKind, BrdfKind::ward>());
    case BrdfKind::ward_balanced:
      return f(std::integral_constant<BrdfKind, BrdfKind::ward_balanced>());
    case BrdfKind::ashikhmin:
      return f(std::integral_constant<BrdfKind, BrdfKind::ashikhmin>());
    case BrdfKind::beckmann:
      return f(std::integral_constant<BrdfKind, BrdfKind::beckmann>());
    case BrdfKind::ggx:
      return f(std::integral_constant<BrdfKind, BrdfKind::ggx>());
    case BrdfKind::blinn_phong:
      return f(std::integral_constant<BrdfKind, BrdfKind::blinn_phong>());
    case BrdfKind::fitted:
      return f(std::integral_constant<BrdfKind, BrdfKind::fitted>());
  }
}

/// (1 - c)^5
template <class D, class V>
HWY_INLINE V schlick_rise(D d, V c) {
  const V m = hn::Set(d, 1.0f) - c, square = m * m;
  return square * square * m;
}

/// The functions of the same names of fresnel.cpp.
template <class D, class V>
HWY_INLINE V dielectric(D d, float eta, V c) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const float step = (eta - 1) * (eta + 1);
  const V contrast = hn::Set(d, step);
  const V square = hn::MulAdd(c, c, contrast);
  const V sum = hn::Sqrt(hn::Max(square, zero)) + c;
  const V inverse = one / sum;
  const V difference = contrast * inverse, perpendicular = difference * inverse;
  const V ratio = hn::MulSub(c, sum, one) / hn::MulAdd(c, difference, one);
  const V both = hn::Set(d, 0.5f) * (perpendicular * perpendicular);
  const V value = hn::Min(hn::MulAdd(both, ratio * ratio, both), one);
  return hn::IfThenElse(hn::Gt(square, zero), value, hn::Set(d, step < 0 ? 1.0f : 0.0f));
}

template <class D, class V>
HWY_INLINE V conductor(D d, float eta, float k, V c) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V tiny = hn::Set(d, std::numeric_limits<float>::min());
  const V cc = c * c, sine_squared = (one - c) * (one + c);
  const V real = cc + hn::Set(d, (eta - 1) * (eta + 1) - k * k);
  const float product = eta * k;
  const V square = hn::Set(d, product * product);
  const V length = hn::Sqrt(hn::MulAdd(real, real, hn::Set(d, 4 * product * product)));
  const V large = half * (length + hn::Abs(real));
  const V small = hn::IfThenElseZero(hn::Gt(large, zero), square / large);
  const auto is_real = hn::Gt(real, zero);
  const V a = hn::Sqrt(hn::IfThenElse(is_real, large, small));
  const V bb = hn::IfThenElse(is_real, small, large);
  const auto ratio = [&](V x, V y, V more) HWY_ATTR {
    const V below = x - y, above = x + y;
    return hn::MulAdd(below, below, more) / hn::Max(hn::MulAdd(above, above, more), tiny);
  };
  const V perpendicular = ratio(a, c, bb), parallel_to_it = ratio(a * c, sine_squared, bb * cc);
  return hn::Min(half * hn::MulAdd(perpendicular, parallel_to_it, perpendicular), one);
}

/// eval_fresnel of one channel.
template <class D, class V>
HWY_INLINE V eval_fresnel(D d, const BrdfNumbers& n, int channel, V cos_difference) {
  const V one = hn::Set(d, 1.0f);
  const V c = hn::Min(hn::Max(cos_difference, hn::Zero(d)), one);
  switch (n.fresnel_kind) {
    case FresnelKind::schlick: {
      const V normal = hn::Set(d, n.fresnel.normal_reflectance[channel]);
      return hn::MulAdd(one - normal, schlick_rise(d, c), normal);
    }
    case FresnelKind::dielectric:
      return dielectric(d, n.fresnel.eta[channel], c);
    case FresnelKind::conductor:
      return conductor(d, n.fresnel.eta[channel], n.fresnel.k[channel], c);
    case FresnelKind::none:
    case FresnelKind::table:
      break;
  }
  return one;
}

/// The Fresnel factor, or what stands for it in `fitted`.
template <class D, class V>
HWY_INLINE RgbVector<V> eval_color(D d, const BrdfNumbers& n, V cos_difference) {
  if (n.fresnel_kind == FresnelKind::table)
    return eval_color_by_difference(d, *n.fitted, cos_difference);
  const V first = eval_fresnel(d, n, 0, cos_difference);
  if (n.is_grey) return {first, first, first};
  return {first, eval_fresnel(d, n, 1, cos_difference), eval_fresnel(d, n, 2, cos_difference)};
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
