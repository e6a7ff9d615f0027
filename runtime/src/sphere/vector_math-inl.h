// Elementary functions on vectors of float, without branches. Errors are relative and were measured
// over every target; tests/sphere/batch_test.cpp asserts them. A NaN gives some number or NaN. On
// vectors of double they have the same ranges and approximations, and show the rounding of float.

#if defined(BURNISH_SPHERE_VECTOR_MATH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_VECTOR_MATH_INL_H_
#undef BURNISH_SPHERE_VECTOR_MATH_INL_H_
#else
#define BURNISH_SPHERE_VECTOR_MATH_INL_H_
#endif

#include <cstdint>

#include <hwy/highway.h>

#ifdef BURNISH_FEW_TARGETS
// What sanitizers add to a function is no longer linear in its size when all is inlined in it.
#undef HWY_INLINE
#define HWY_INLINE inline
#endif

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// c0 + c1 x + c2 x^2 + ... by Horner's rule: what calls this has enough to do meanwhile, and
/// Estrin's scheme, with its additional multiplications, was slower.
template <class D, class V>
HWY_INLINE V polynomial(D d, V, float last) {
  return hn::Set(d, last);
}
template <class D, class V, class... More>
HWY_INLINE V polynomial(D d, V x, float first, More... more) {
  return hn::MulAdd(polynomial(d, x, more...), x, hn::Set(d, first));
}

template <class D>
inline constexpr bool kIsFloat = sizeof(hn::TFromD<D>) == 4;

/// The whole number nearest to an x of at most 1000, and 2 to its power, which must be a normal
/// number.
template <class V>
struct WholePower {
  V exponent, power;
};
template <class D, class V>
HWY_INLINE WholePower<V> nearest_power(D d, V x) {
  if constexpr (kIsFloat<D>) {
    const hn::RebindToSigned<D> di;
    const auto exponent = hn::NearestInt(x);
    return {hn::ConvertTo(d, exponent),
            hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(exponent, hn::Set(di, 127))))};
  } else {
    // The last bits of such a sum are the exponent and its bias.
    const hn::RebindToUnsigned<D> du;
    const V shift = hn::Set(d, 0x1.8p52 + 1023), sum = hn::Add(x, shift);
    return {hn::Sub(sum, shift), hn::BitCast(d, hn::ShiftLeft<52>(hn::BitCast(du, sum)))};
  }
}

/// 1 / x for |x| in [1e-37, 1e37]: 2 ulp. A third of a division's time.
template <class D, class V>
HWY_INLINE V reciprocal(D d, V x) {
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
    const V two = hn::Set(d, 2.0f);
    V y = hn::ApproximateReciprocal(x);
#if !HWY_ARCH_X86 || HWY_TARGET == HWY_SCALAR || \
    HWY_TARGET == HWY_EMU128  // where the estimate has 8 bits instead of 12
    y = hn::Mul(y, hn::NegMulAdd(x, y, two));
#endif
    return hn::Mul(y, hn::NegMulAdd(x, y, two));
  } else {
    return hn::Div(hn::Set(d, 1.0f), x);
  }
}

/// 1 / sqrt(x) for x in [1e-36, 1e36]: 3 ulp.
template <class D, class V>
HWY_INLINE V reciprocal_root(D d, V x) {
  if constexpr (sizeof(hn::TFromD<D>) == sizeof(float)) {
    const V half = hn::Mul(hn::Set(d, 0.5f), x), three_halves = hn::Set(d, 1.5f);
    V y = hn::ApproximateReciprocalSqrt(x);
#if !HWY_ARCH_X86 || HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_EMU128
    y = hn::Mul(y, hn::NegMulAdd(half, hn::Mul(y, y), three_halves));
#endif
    return hn::Mul(y, hn::NegMulAdd(half, hn::Mul(y, y), three_halves));
  } else {
    return hn::Div(hn::Set(d, 1.0f), hn::Sqrt(x));
  }
}

/// sqrt(x) for x in [0, 1e36]: 3 ulp from 1e-36 on.
template <class D, class V>
HWY_INLINE V root(D d, V x) {
  return hn::Mul(x, reciprocal_root(d, hn::Max(x, hn::Set(d, 1e-36f))));
}

/// exp(x) = scale (1 + rest): scale is a power of 2, and |rest| < 0.42.
template <class V>
struct ExpParts {
  V scale, rest;
};

/// Of exp(x + correction) for x in [-87.3, 88], |correction| < 0.1; the correction may be left out.
template <class D, class V, class... Correction>
HWY_INLINE ExpParts<V> exp_parts(D d, V x, Correction... correction) {
  const WholePower<V> nearest = nearest_power(d, hn::Mul(x, hn::Set(d, 1.44269504f)));
  const V q = nearest.exponent;
  // ln 2 in two parts, of which the first has so few digits that q times it is exact.
  V r = hn::NegMulAdd(q, hn::Set(d, 0.693359375f), x);
  r = hn::NegMulAdd(q, hn::Set(d, -2.12194440e-4f), r);
  if constexpr (sizeof...(correction) > 0) r = hn::Add(r, correction...);
  const V curve = polynomial(d, r, 0.499999934f, 0.166665206f, 0.0416683879f, 0.00836871541f,
                             0.00138145999f);  // minimax, 3e-9
  return {nearest.power, hn::MulAdd(hn::Mul(r, r), curve, r)};
}

/// exp(x) for x <= 88: 1 ulp; 0 for x < -85, where the result would be below 1.3e-37. (Its factors
/// stay clear of denormal numbers, which cost a hundred cycles each.)
template <class D, class V>
HWY_INLINE V exp(D d, V x) {
  const V floor = hn::Set(d, -85.0f);
  const ExpParts<V> e = exp_parts(d, hn::Max(x, floor));
  return hn::IfThenElseZero(hn::Ge(x, floor), hn::MulAdd(e.scale, e.rest, e.scale));
}

/// 1 - exp(-x) for x >= 0: 3 ulp, as small as x may be.
template <class D, class V>
HWY_INLINE V one_minus_exp(D d, V x) {
  // From 18 on the result is 1.
  const ExpParts<V> e = exp_parts(d, hn::Neg(hn::Min(x, hn::Set(d, 18.0f))));
  return hn::NegMulAdd(e.scale, e.rest, hn::Sub(hn::Set(d, 1.0f), e.scale));
}

/// (1 - exp(-x)) / x for x >= 0; 1 at 0.
template <class D, class V>
HWY_INLINE V one_minus_exp_over(D d, V x) {
  const V one = hn::Set(d, 1.0f);
  return hn::IfThenElse(hn::Gt(x, hn::Zero(d)), hn::Div(one_minus_exp(d, x), x), one);
}

/// log(x) = exponent ln 2 + fraction slope, |fraction| < 0.42, for normal x > 0: 1e-7 of log(x).
template <class V>
struct LogParts {
  V exponent, fraction, slope;
};
template <class D, class V>
HWY_INLINE LogParts<V> log_parts(D d, V x) {
  const hn::RebindToSigned<D> di;
  using Int = hn::TFromD<decltype(di)>;
  constexpr int kDigits = kIsFloat<D> ? 23 : 52;
  const auto root_half =
      hn::Set(di, static_cast<Int>(kIsFloat<D> ? 0x3F3504F3ll : 0x3FE6A09E667F3BCDll));
  const auto bits = hn::BitCast(di, x);
  const auto exponent = hn::ShiftRight<kDigits>(hn::Sub(bits, root_half));
  const V fraction =
      hn::Sub(hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<kDigits>(exponent))), hn::Set(d, 1.0f));
  const V slope = polynomial(d, fraction, 1.0f, -0.499999881f, 0.333333254f, -0.250015855f,
                             0.200019673f, -0.166090131f, 0.141818449f, -0.132434681f, 0.129046082f,
                             -0.0762103796f);  // minimax, 5e-9
  return {hn::ConvertTo(d, exponent), fraction, slope};
}

/// log(x) / (1 - x) for normal x > 0; -1 at 1: 1e-7. A lane's value does not depend on the others.
template <class D, class V>
HWY_INLINE V log_over_gap(D d, V x) {
  const V gap = hn::Set(d, 1.0f) - x;
  // Minimax for 1/2 to 1, 7e-9.
  const V near_one =
      polynomial(d, gap, -1.0f, -0.500001371f, -0.333245367f, -0.252162367f, -0.173287943f,
                 -0.353380084f, 0.633551657f, -2.04687119f, 2.55274606f, -1.77568722f);
  const auto is_near = hn::Ge(x, hn::Set(d, 0.5f));
  if (hn::AllTrue(d, is_near)) return near_one;
  const LogParts<V> log = log_parts(d, x);
  const V value = hn::MulAdd(log.exponent, hn::Set(d, 0.693147181f), log.fraction * log.slope);
  return hn::IfThenElse(is_near, near_one, value / gap);
}

/// exp(-x^2) for 0 <= x <= 9.3. The square's rounding error, which the exponential would magnify by
/// x^2, is kept, with or without fused multiply-add.
template <class D, class V>
HWY_INLINE V exp_minus_square(D d, V x) {
  const hn::RebindToUnsigned<D> du;
  using Bits = hn::TFromD<decltype(du)>;
  // All but the last half of the digits: the head's square is exact.
  const auto mask = hn::Set(du, static_cast<Bits>(kIsFloat<D> ? ~0xFFFull : ~0x7FFFFFFull));
  const V head = hn::BitCast(d, hn::And(hn::BitCast(du, x), mask));
  const V rest = hn::Mul(hn::Sub(head, x), hn::Add(head, x));  // at most 2^-11 x^2
  const ExpParts<V> e = exp_parts(d, hn::Neg(hn::Mul(head, head)), rest);
  return hn::MulAdd(e.scale, e.rest, e.scale);
}

/// erf(x) for |x| <= 1: 2 ulp.
template <class D, class V>
HWY_INLINE V erf_of_small(D d, V x) {
  return hn::Mul(x, polynomial(d, hn::Mul(x, x), 1.12837912f, -0.376123265f, 0.112801820f,
                               -0.0267113549f, 0.00491759456f, -5.63157761e-4f));
}

/// erfc(x) exp(x^2) / t as a function of t = 1 / (1 + 0.4 x), x >= 0: minimax, 1.3e-7.
template <class D, class V>
HWY_INLINE V erfc_curve(D d, V t) {
  return polynomial(d, t, 0.225675863f, 0.225669520f, 0.207843929f, 0.168533419f, 0.141462614f,
                    -0.00567126998f, 0.169158942f, -0.182946104f, 0.0502732114f);
}

inline constexpr float kErfcIsZeroFrom = 9.0f;  // below 5e-37 from there on

/// erfc(x) for x >= 0: 5e-7, also in the tail; 0 from kErfcIsZeroFrom on.
template <class D, class V>
HWY_INLINE V erfc(D d, V x) {
  const V limit = hn::Set(d, kErfcIsZeroFrom), one = hn::Set(d, 1.0f);
  const V y = hn::Min(x, limit);
  const V t = reciprocal(d, hn::MulAdd(hn::Set(d, 0.4f), y, one));
  const V value = hn::Mul(exp_minus_square(d, y), hn::Mul(t, erfc_curve(d, t)));
  return hn::IfThenElseZero(hn::Lt(x, limit), value);
}

/// (erf(far) - erf(x)) / (2 erf(far)) for 0 <= x <= far: the tail beyond x of a Gaussian that is
/// cut off at +-far. Relative error 1e-6 but next to far, where it is 1e-7 absolute.
template <class D, class V>
HWY_INLINE V gaussian_tail(D d, V x, V far) {
  const V one = hn::Set(d, 1.0f), limit = hn::Set(d, kErfcIsZeroFrom);
  // erfc of both, with one division.
  const V near_x = hn::Min(x, limit), near_far = hn::Min(far, limit);
  const V p = hn::Set(d, 0.4f);
  const V below_x = hn::MulAdd(p, near_x, one), below_far = hn::MulAdd(p, near_far, one);
  const V inverse = reciprocal(d, hn::Mul(below_x, below_far));
  const V t_x = hn::Mul(inverse, below_far), t_far = hn::Mul(inverse, below_x);
  const V erfc_x = hn::IfThenElseZero(
      hn::Lt(x, limit), hn::Mul(exp_minus_square(d, near_x), hn::Mul(t_x, erfc_curve(d, t_x))));
  const V erfc_far = hn::IfThenElseZero(
      hn::Lt(far, limit),
      hn::Mul(exp_minus_square(d, near_far), hn::Mul(t_far, erfc_curve(d, t_far))));
  // A difference of erfs for a wide Gaussian, of erfcs for a narrow one, so that neither cancels.
  const auto is_small = hn::Lt(far, one);
  const V small_far = erf_of_small(d, hn::Min(far, one));
  const V numerator = hn::IfThenElse(is_small, hn::Sub(small_far, erf_of_small(d, hn::Min(x, one))),
                                     hn::Sub(erfc_x, erfc_far));
  const V whole = hn::IfThenElse(is_small, small_far, hn::Sub(one, erfc_far));
  return hn::Max(hn::Div(numerator, hn::Add(whole, whole)), hn::Zero(d));
}

/// erf(x) for x >= 0: 2e-7 of 1. Without the tail's digits, in half the time of erfc.
template <class D, class V>
HWY_INLINE V erf_of_positive(D d, V x) {
  const V one = hn::Set(d, 1.0f), y = hn::Min(x, hn::Set(d, 4.0f));
  const V t = reciprocal(d, hn::MulAdd(hn::Set(d, 0.3275911f), y, one));
  const V curve = polynomial(d, t, 0.254829592f, -0.284496736f, 1.421413741f, -1.453152027f,
                             1.061405429f);  // abramowitz1964, 7.1.26
  return hn::NegMulAdd(hn::Mul(t, curve), exp(d, hn::Neg(hn::Mul(y, y))), one);
}

/// sin(x) for |x| <= pi / 2: 2 ulp.
template <class D, class V>
HWY_INLINE V sine(D d, V x) {
  const V square = hn::Mul(x, x);
  const V curve = polynomial(d, square, -0.166666666f, 0.00833333111f, -1.98408682e-4f,
                             2.75253846e-6f, -2.38889115e-8f);
  return hn::MulAdd(hn::Mul(x, square), curve, x);
}

/// sin(x) for |x| <= pi / 4: 1 ulp.
template <class D, class V>
HWY_INLINE V sine_of_small(D d, V x) {
  const V square = hn::Mul(x, x);
  const V curve = polynomial(d, square, -0.166666546f, 0.00833216077f, -1.95152838e-4f);
  return hn::MulAdd(hn::Mul(x, square), curve, x);
}

/// atan(x) * 2 / pi for x in [0, 1]: 2 ulp.
template <class D, class V>
HWY_INLINE V quarter_arctangent(D d, V x) {
  return hn::Mul(
      x, polynomial(d, hn::Mul(x, x), 0.636619763f, -0.212204937f, 0.127276984f, -0.0904233084f,
                    0.0677426212f, -0.0477744490f, 0.0271789395f, -0.0102299920f, 0.00181438666f));
}

/// acos(x) * 2 / pi for x in [0, 1]: 1e-7.
template <class D, class V>
HWY_INLINE V quarter_arccosine(D d, V x) {
  return hn::Sqrt(hn::Set(d, 1.0f) - x) *
         polynomial(d, x, 1.0f, -0.13661778f, 0.0566447154f, -0.031935513f, 0.0196478348f,
                    -0.0108512435f, 0.00422627153f, -0.000797974237f);  // minimax, 3e-8
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
