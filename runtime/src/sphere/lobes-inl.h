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

/// Sine of a distance, held to [-pi/2, pi/2].
template <class D, class V>
HWY_INLINE V sine_of_distance(D d, V distance) {
  const V limit = hn::Set(d, 1.57079633f);
  return sine(d, hn::Max(hn::Min(distance, limit), hn::Neg(limit)));
}

/// `hidden` is the fraction for a distance of |sine|: the fraction for `sine`.
template <class D, class V>
HWY_INLINE V visible_from_hidden(D d, V hidden, V sine) {
  return hn::IfThenElse(hn::Lt(sine, hn::Zero(d)), hidden, hn::Sub(hn::Set(d, 1.0f), hidden));
}

/// visible_fraction_directional.
template <class D, class V>
HWY_INLINE V visible_fraction_directional(D d, V bandwidth_across, V distance) {
  const V s = sine_of_distance(d, distance);
  const V root = hn::Max(hn::Sqrt(bandwidth_across), hn::Set(d, 1e-18f));
  return visible_from_hidden(d, gaussian_tail(d, hn::Mul(root, hn::Abs(s)), root), s);
}

/// HemisphereShape, see burnish/sphere/half_space.h.
template <class V>
struct HemisphereShape {
  V opposite, steepness, bend_1, bend_2, far;
};

/// prepare_hemisphere.
template <class D, class V>
HWY_INLINE HemisphereShape<V> prepare_hemisphere(D d, V sharpness) {
  const V one = hn::Set(d, 1.0f), minus_half = hn::Set(d, -0.5f);
  const V s = hn::Min(sharpness, hn::Set(d, 1e6f)), square = hn::Mul(s, s);
  const V e = exp(d, hn::Neg(sharpness));
  HemisphereShape<V> shape;
  shape.opposite = hn::Div(e, hn::Add(one, e));
  const V slope = hn::Div(hn::Mul(s, polynomial(d, s, 7.2287146f, -1.13026233f, 0.5f)),
                          polynomial(d, s, 21.86925514f, 12.03404045f, -1.51052466f, 1.0f));
  shape.steepness = hn::Max(hn::Mul(hn::Sqrt(sharpness), hn::Sqrt(slope)), hn::Set(d, 1e-18f));
  const V fourth = hn::Set(d, 8418.2f);
  shape.bend_1 =
      hn::Div(hn::Mul(minus_half, square), polynomial(d, s, 3.92014157f, 0.21340557f, 1.0f));
  shape.bend_2 = hn::Div(hn::Mul(hn::Mul(minus_half, shape.bend_1), fourth),
                         hn::MulAdd(square, square, fourth));
  shape.far = hn::Div(shape.steepness, hn::Sqrt(hn::Add(one, hn::Add(shape.bend_1, shape.bend_2))));
  return shape;
}

/// hemisphere_fraction.
template <class D, class V>
HWY_INLINE V hemisphere_fraction(D d, const HemisphereShape<V>& shape, V sine) {
  const V one = hn::Set(d, 1.0f);
  const V u = hn::Sub(one, hn::Sqrt(hn::Max(hn::NegMulAdd(sine, sine, one), hn::Zero(d))));
  const V bent = hn::MulAdd(u, hn::MulAdd(u, shape.bend_2, shape.bend_1), one);
  const V x = hn::Div(hn::Mul(shape.steepness, hn::Abs(sine)), hn::Sqrt(bent));
  const V tail = gaussian_tail(d, hn::Min(x, shape.far), shape.far);
  const V reach = hn::NegMulAdd(hn::Set(d, 2.0f), shape.opposite, one);
  return visible_from_hidden(d, hn::MulAdd(reach, tail, shape.opposite), sine);
}

/// visible_fraction_hemisphere, fast level.
template <class D, class V>
HWY_INLINE V visible_fraction_hemisphere(D d, V sharpness, V distance) {
  return hemisphere_fraction(d, prepare_hemisphere(d, sharpness), sine_of_distance(d, distance));
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
