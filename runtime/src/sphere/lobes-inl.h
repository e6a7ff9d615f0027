// The lobe formulas of burnish/sphere/ on vectors of float: one lobe or direction a lane. No
// branches but where a comment says so. A structure of vectors is named as its scalar counterpart.

#if defined(BURNISH_SPHERE_LOBES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_LOBES_INL_H_
#undef BURNISH_SPHERE_LOBES_INL_H_
#else
#define BURNISH_SPHERE_LOBES_INL_H_
#endif

#include <hwy/highway.h>

#include "sphere/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class V>
struct Vector3 {
  V x, y, z;
};

template <class V>
HWY_INLINE V dot(const Vector3<V>& a, const Vector3<V>& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

template <class V>
HWY_INLINE Vector3<V> minus(const Vector3<V>& a, const Vector3<V>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

/// exp(-sharpness |direction - axis|^2 / 2), half_sharpness = sharpness / 2.
template <class D, class V>
HWY_INLINE V sg_eval(D d, const Vector3<V>& axis, V half_sharpness, const Vector3<V>& direction) {
  const Vector3<V> difference = minus(direction, axis);
  return exp(d, hn::Neg(hn::Mul(half_sharpness, dot(difference, difference))));
}

/// max(z, 0) exp(-x^2 - y^2): x and y are the direction's dot products with the frame's axes, times
/// the roots of the bandwidths.
template <class D, class V>
HWY_INLINE V asg_eval(D d, V x, V y, V z) {
  const V exponent = hn::MulAdd(x, x, hn::Mul(y, y));
  return hn::Mul(hn::Max(z, hn::Zero(d)), exp(d, hn::Neg(exponent)));
}

/// asg_integral_fast.
template <class D, class V>
HWY_INLINE V asg_integral_fast(D d, V bandwidth_x, V bandwidth_y) {
  const V pi = hn::Set(d, 3.14159265f);
  // The product of the roots: a product of bandwidths overflows and underflows. That of the roots
  // of two denormals is normal.
  return hn::Min(hn::Div(pi, hn::Mul(hn::Sqrt(bandwidth_x), hn::Sqrt(bandwidth_y))), pi);
}

/// asg_integral_exact, with 7 midpoints for all bandwidths: relative error 1e-6.
template <class D, class V>
HWY_INLINE V asg_integral_exact(D d, V bandwidth_x, V bandwidth_y) {
  constexpr float kOffset = 12.5f;
  constexpr int kPoints = 7;
  // cos^2((i + 1/2) / 7 pi / 2)
  constexpr float kCosineSquared[kPoints] = {0.987463956f, 0.890915742f, 0.716941870f, 0.5f,
                                             0.283058130f, 0.109084258f, 0.0125360439f};
  const V offset = hn::Set(d, kOffset), one = hn::Set(d, 1.0f);
  const V large = hn::Max(bandwidth_x, bandwidth_y), small = hn::Min(bandwidth_x, bandwidth_y);
  const V large_offset = hn::Add(large, offset), small_offset = hn::Add(small, offset);
  const V squeeze = hn::Div(small_offset, large_offset);
  V sum = hn::Zero(d);
  for (const float cosine_squared : kCosineSquared) {
    const V c = hn::Set(d, cosine_squared), s = hn::Set(d, 1 - cosine_squared);
    const V x = hn::Mul(squeeze, c);
    // k = (large x + small s) / (x + s): the fraction of x first, so that nothing overflows.
    const V scale = hn::Div(one, hn::Add(x, s));
    const V k = hn::MulAdd(large, hn::Mul(x, scale), hn::Mul(small, hn::Mul(s, scale)));
    sum = hn::MulAdd(hn::Add(k, offset), one_minus_exp_over(d, k), sum);
  }
  const V roots = hn::Mul(hn::Sqrt(large_offset), hn::Sqrt(small_offset));
  return hn::Div(hn::Mul(hn::Set(d, 3.14159265f / kPoints), sum), roots);
}

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

/// visible_fraction_hemisphere, fast level.
template <class D, class V>
HWY_INLINE V visible_fraction_hemisphere(D d, V sharpness, V distance) {
  const V half = hn::Mul(hn::Set(d, 0.5f), held_distance(d, distance));
  return hemisphere_fraction(d, prepare_hemisphere(d, sharpness), sine_of_small(d, half));
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
