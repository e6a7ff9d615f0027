// The visible fractions of burnish/sphere/half_space.h on vectors of float or double: one lobe a
// lane.

#if defined(BURNISH_SPHERE_HALF_SPACE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_HALF_SPACE_INL_H_
#undef BURNISH_SPHERE_HALF_SPACE_INL_H_
#else
#define BURNISH_SPHERE_HALF_SPACE_INL_H_
#endif

#include <hwy/highway.h>

#include "sphere/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// A distance, held to [-pi/2, pi/2].
template <class D, class V>
HWY_INLINE V held_distance(D d, V distance) {
  const V limit = hn::Set(d, 1.57079633f);
  return hn::Max(hn::Min(distance, limit), hn::Neg(limit));
}

/// `hidden` is the fraction for a distance of |sine|: the fraction for `sine`.
template <class D, class V>
HWY_INLINE V visible_from_hidden(D d, V hidden, V sine) {
  return hn::IfThenElse(hn::Lt(sine, hn::Zero(d)), hidden, hn::Sub(hn::Set(d, 1.0f), hidden));
}

/// visible_fraction_directional.
template <class D, class V>
HWY_INLINE V visible_fraction_directional(D d, V bandwidth_across, V distance) {
  const V s = sine(d, held_distance(d, distance));
  const V root = hn::Max(hn::Sqrt(bandwidth_across), hn::Set(d, 1e-18f));
  return visible_from_hidden(d, gaussian_tail(d, hn::Mul(root, hn::Abs(s)), root), s);
}

/// directional_bandwidth of a gradient (x, y) in the lobe's frame.
template <class D, class V>
HWY_INLINE V directional_bandwidth(D d, V bandwidth_x, V bandwidth_y, V x, V y) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto x_is_wide = hn::Lt(bandwidth_x, bandwidth_y);
  const V large = hn::Max(bandwidth_x, bandwidth_y), low = hn::Min(bandwidth_x, bandwidth_y);
  const V below_low = hn::Add(one, low), below_large = hn::Add(one, large);
  const V shift = hn::Div(hn::Div(hn::Sub(large, low), below_large), below_low);
  const V small = hn::MulAdd(hn::Set(d, 2.0f / 3), shift, low);
  const V ratio = hn::IfThenElse(hn::Gt(large, zero), hn::Div(small, large), one);
  const V norm = hn::Max(hn::Abs(x), hn::Abs(y));
  const auto is_flat = hn::Eq(norm, zero);
  const V inverse = hn::Div(one, hn::IfThenElse(is_flat, one, norm));
  const V along_wide = hn::Mul(hn::IfThenElse(x_is_wide, x, y), inverse);
  const V along_narrow = hn::Mul(hn::IfThenElse(x_is_wide, y, x), inverse);
  const V wide = hn::Mul(along_wide, along_wide), narrow = hn::Mul(along_narrow, along_narrow);
  const V square = hn::Mul(small, hn::Add(wide, narrow));
  const V mean = hn::Mul(hn::Sqrt(small), hn::Sqrt(large));
  const V across = hn::IfThenElse(is_flat, mean,
                                  hn::Min(hn::Div(square, hn::MulAdd(narrow, ratio, wide)), large));
  const V along = hn::IfThenElse(is_flat, mean,
                                 hn::Min(hn::Div(square, hn::MulAdd(wide, ratio, narrow)), large));
  const V bend = hn::Div(one, hn::MulAdd(hn::Set(d, 2.0f), along, hn::Set(d, 2.5f)));
  return hn::NegMulAdd(across, bend, across);
}

/// HemisphereShape, see burnish/sphere/half_space.h; squares of two of its members.
template <class V>
struct HemisphereShape {
  V opposite, steepness_squared, bend_1, bend_2, far_squared;
};

/// prepare_hemisphere.
template <class D, class V>
HWY_INLINE HemisphereShape<V> prepare_hemisphere(D d, V sharpness) {
  const V one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V s = hn::Min(sharpness, hn::Set(d, 1e4f));
  const V half_square = hn::Mul(half, hn::Mul(s, s));
  const V e = exp(d, hn::Neg(sharpness));
  HemisphereShape<V> shape;
  shape.opposite = hn::Div(e, hn::Add(one, e));
  // Three quotients with one division.
  const V below_slope = polynomial(d, s, 26.1523456f, 14.3527802f, 1.02200273f, 1.0f);
  const V below_1 = polynomial(d, s, 5.17400423f, -0.26223606f, 1.0f);
  const V below_2 = hn::MulAdd(hn::Mul(half_square, s), hn::Set(d, 2 / 1208.6f), one);
  const V below_both = hn::Mul(below_1, below_2);
  const V inverse = hn::Div(one, hn::Mul(below_slope, below_both));
  const V slope = hn::Mul(hn::Mul(s, polynomial(d, s, 7.45753026f, 0.13600136f, 0.5f)),
                          hn::Mul(inverse, below_both));
  shape.steepness_squared = hn::Max(hn::Mul(sharpness, slope), hn::Set(d, 1e-36f));
  const V bend = hn::Mul(half_square, hn::Mul(inverse, below_slope));
  shape.bend_1 = hn::Neg(hn::Mul(bend, below_2));
  shape.bend_2 = hn::Mul(half, bend);
  shape.far_squared =
      hn::Div(shape.steepness_squared, hn::Add(one, hn::Add(shape.bend_1, shape.bend_2)));
  return shape;
}

/// hemisphere_fraction for a distance in [-pi/2, pi/2], given the sine of half of it.
template <class D, class V>
HWY_INLINE V hemisphere_fraction(D d, const HemisphereShape<V>& shape, V half_sine) {
  const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  const V u = hn::Mul(two, hn::Mul(half_sine, half_sine));
  const V bent = hn::MulAdd(u, hn::MulAdd(u, shape.bend_2, shape.bend_1), one);
  const V sine_squared = hn::Mul(u, hn::Sub(two, u));
  const V x_squared = hn::Div(hn::Mul(shape.steepness_squared, sine_squared), bent);
  // gaussian_tail of the roots. A wide lobe's cancels, but has a weight that vanishes with it.
  const V p = hn::Set(d, 0.4f), limit = hn::Set(d, 1e4f);
  const V below_x = hn::MulAdd(p, hn::Sqrt(hn::Min(x_squared, limit)), one);
  const V below_far = hn::MulAdd(p, hn::Sqrt(hn::Min(shape.far_squared, limit)), one);
  const V inverse = hn::Div(one, hn::Mul(below_x, below_far));
  const V t_x = hn::Mul(inverse, below_far), t_far = hn::Mul(inverse, below_x);
  const V erfc_x = hn::Mul(exp(d, hn::Neg(x_squared)), hn::Mul(t_x, erfc_curve(d, t_x)));
  const V erfc_far =
      hn::Mul(exp(d, hn::Neg(shape.far_squared)), hn::Mul(t_far, erfc_curve(d, t_far)));
  const V whole = hn::Max(hn::Sub(one, erfc_far), hn::Set(d, 1e-6f));
  const V tail = hn::Max(hn::Div(hn::Sub(erfc_x, erfc_far), hn::Add(whole, whole)), hn::Zero(d));
  const V reach = hn::NegMulAdd(two, shape.opposite, one);
  return visible_from_hidden(d, hn::MulAdd(reach, tail, shape.opposite), half_sine);
}

/// visible_fraction_hemisphere, fast level, of a prepared sharpness and of any.
template <class D, class V>
HWY_INLINE V visible_fraction_hemisphere(D d, const HemisphereShape<V>& shape, V distance) {
  const V half = hn::Mul(hn::Set(d, 0.5f), held_distance(d, distance));
  return hemisphere_fraction(d, shape, sine_of_small(d, half));
}
template <class D, class V>
HWY_INLINE V visible_fraction_hemisphere(D d, V sharpness, V distance) {
  return visible_fraction_hemisphere(d, prepare_hemisphere(d, sharpness), distance);
}

/// visible_fraction_hemisphere, exact level: absolute error 6e-7. See half_space.h. Both of its
/// sums are computed only if a lane needs them.
template <class D, class V>
HWY_INLINE V visible_fraction_hemisphere_exact(D d, V sharpness, V distance) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f);
  const V half_sine = sine_of_small(d, hn::Mul(hn::Set(d, 0.5f), held_distance(d, distance)));
  const V square = hn::Mul(half_sine, half_sine);
  const V toward = hn::Mul(two, square), cosine = hn::Max(hn::Sub(one, toward), zero);
  const V half_cosine = hn::Sqrt(hn::Sub(one, square));
  const V sine = hn::Mul(hn::Abs(hn::Mul(two, half_sine)), half_cosine);
  const V along = hn::Mul(sharpness, cosine), exponent = hn::Mul(sharpness, toward);
  const auto is_narrow = hn::Gt(along, hn::Set(d, 20.0f));
  V hidden = zero;
  if (!hn::AllFalse(d, is_narrow)) {
    constexpr float kStep = 0.75f;
    const V inverse = hn::Div(one, sharpness),
            half_inverse_along = hn::Div(hn::Set(d, 0.5f), along);
    V sum = zero;
    for (const float i : {0.5f, 1.5f, 2.5f, 3.5f, 4.5f}) {
      const V step = hn::Set(d, i * i * kStep * kStep);
      const V depth = hn::Add(exponent, step);
      const V flat = hn::Sqrt(hn::NegMulAdd(step, half_inverse_along, one));
      const V below = hn::Mul(hn::Mul(depth, hn::NegMulAdd(depth, inverse, two)), flat);
      sum = hn::Add(sum, hn::Div(exp(d, hn::Neg(depth)), below));
    }
    const V scale = hn::Mul(hn::Mul(hn::Sqrt(sharpness), hn::Div(sine, hn::Sqrt(cosine))),
                            hn::Set(d, 1.41421356f * kStep / 3.14159265f));
    const V e = exp(d, hn::Mul(hn::Set(d, -6.28318531f / kStep), hn::Sqrt(exponent)));
    const V pole =
        hn::IfThenElseZero(hn::Lt(exponent, hn::Set(d, 18.0f)), hn::Div(e, hn::Add(one, e)));
    hidden = hn::MulAdd(sum, scale, pole);
  }
  if (!hn::AllTrue(d, is_narrow)) {
    const V kappa_squared = hn::Div(one, hn::MulAdd(hn::Set(d, 0.15f), along, one));
    const V mild = hn::Min(sharpness, hn::Set(d, 40.0f));
    V sum = zero;
    for (const float c :
         {0.965925826f, 0.707106781f, 0.258819045f, -0.258819045f, -0.707106781f, -0.965925826f}) {
      const V squeezed = hn::Mul(kappa_squared, hn::Set(d, 1 - c));
      const V scale = hn::Div(one, hn::Add(squeezed, hn::Set(d, 1 + c)));
      const V away = hn::Mul(two, hn::Mul(squeezed, scale));
      const V depth = hn::MulAdd(cosine, away, toward);
      const V e = exp(d, hn::Neg(hn::MulAdd(along, away, exponent)));
      const V rest = one_minus_exp_over(d, hn::Mul(mild, hn::Max(hn::Sub(two, depth), zero)));
      sum = hn::MulAdd(hn::Mul(e, rest), hn::Div(scale, depth), sum);
    }
    const V kappa = hn::Sqrt(kappa_squared);
    const V scale = hn::Div(hn::Mul(hn::Mul(sine, kappa), hn::Set(d, 1.0f / 6)),
                            one_minus_exp_over(d, hn::Mul(two, mild)));
    const V tangent = hn::Div(hn::Abs(half_sine), hn::Mul(half_cosine, kappa));
    V power = hn::Div(hn::Sub(one, tangent), hn::Add(one, tangent));
    power = hn::Mul(power, power);
    power = hn::Mul(hn::Mul(power, power), power);
    power = hn::Mul(power, power);  // to the 12 steps of a full turn
    const V pole = hn::IfThenElseZero(hn::Lt(exponent, hn::Set(d, 14.0f)),
                                      hn::Div(power, hn::Add(one, power)));
    hidden = hn::IfThenElse(is_narrow, hidden, hn::MulAdd(sum, scale, pole));
  }
  return visible_from_hidden(d, hidden, half_sine);
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
