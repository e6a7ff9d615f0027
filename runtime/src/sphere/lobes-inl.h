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
HWY_INLINE Vector3<V> cross(const Vector3<V>& a, const Vector3<V>& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
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

/// Integral of a spherical Gaussian of unit amplitude over 2 pi: (1 - exp(-2 L)) / L, at most 2.
template <class D, class V>
HWY_INLINE V sg_mass(D d, V sharpness) {
  const V two = hn::Set(d, 2.0f);
  const V mass = hn::Div(one_minus_exp(d, hn::Mul(two, sharpness)), sharpness);
  return hn::IfThenElse(hn::Gt(sharpness, hn::Zero(d)), mass, two);
}

/// Integral of the product of two spherical Gaussians of unit amplitude; the form of inner_product.
template <class D, class V>
HWY_INLINE V sg_inner_product(D d, const Vector3<V>& axis_a, V sharpness_a,
                              const Vector3<V>& axis_b, V sharpness_b) {
  const V one = hn::Set(d, 1.0f);
  const V narrow = hn::Max(sharpness_a, sharpness_b), wide = hn::Min(sharpness_a, sharpness_b);
  const V ratio = hn::IfThenElseZero(hn::Gt(narrow, hn::Zero(d)), hn::Div(wide, narrow));
  const Vector3<V> difference = minus(axis_a, axis_b);
  const V distance_squared = dot(difference, difference);
  // Of unit vectors, |p + r q| is the same for either order.
  const Vector3<V> weighted = {hn::MulAdd(ratio, axis_b.x, axis_a.x),
                               hn::MulAdd(ratio, axis_b.y, axis_a.y),
                               hn::MulAdd(ratio, axis_b.z, axis_a.z)};
  const V length = hn::Sqrt(dot(weighted, weighted));
  const V exponent = hn::Mul(hn::Div(wide, hn::Add(length, hn::Add(one, ratio))), distance_squared);
  const V mass = hn::Mul(hn::Set(d, 6.28318531f), sg_mass(d, hn::Mul(narrow, length)));
  return hn::Mul(mass, exp(d, hn::Neg(exponent)));
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

/// LobeMoments of one lobe, in all lanes: see burnish/sphere/lobe_moments.h.
template <class V>
struct LobeMoments {
  V mean_z, mean_xx, mean_yy, variance_z, mean_xxz, mean_yyz, mean_zzz, mean_xxxx, mean_yyyy,
      mean_zzzz, mean_xxyy, mean_xxzz, mean_yyzz;
};

/// mean_clamped_cosine.
template <class D, class V>
HWY_INLINE V mean_clamped_cosine(D d, const LobeMoments<V>& m, const Vector3<V>& normal) {
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V z = normal.z;
  const V xx = hn::Mul(normal.x, normal.x), yy = hn::Mul(normal.y, normal.y), zz = hn::Mul(z, z);
  const V mean = hn::Mul(z, m.mean_z);
  const V variance =
      hn::MulAdd(xx, m.mean_xx, hn::MulAdd(yy, m.mean_yy, hn::Mul(zz, m.variance_z)));
  const V deviation = hn::Sqrt(variance);
  const V inverse = hn::Div(hn::Set(d, 1.0f), hn::Max(deviation, hn::Set(d, 1e-12f)));
  const V limit = hn::Set(d, 7.0f);  // from 6 on, r itself does not matter
  const V r = hn::Max(hn::Min(hn::Mul(mean, inverse), limit), hn::Neg(limit));
  const V three = hn::Set(d, 3.0f), six = hn::Set(d, 6.0f);
  const V third_xy = hn::MulAdd(xx, m.mean_xxz, hn::Mul(yy, m.mean_yyz));
  const V third = hn::Mul(z, hn::MulAdd(three, third_xy, hn::Mul(zz, m.mean_zzz)));
  const V fourth_xy = hn::Mul(hn::Mul(xx, yy), m.mean_xxyy);
  const V fourth_z = hn::Mul(zz, hn::MulAdd(xx, m.mean_xxzz, hn::Mul(yy, m.mean_yyzz)));
  const V pure =
      hn::MulAdd(hn::Mul(xx, xx), m.mean_xxxx,
                 hn::MulAdd(hn::Mul(yy, yy), m.mean_yyyy, hn::Mul(hn::Mul(zz, zz), m.mean_zzzz)));
  const V fourth = hn::MulAdd(six, hn::Add(fourth_xy, fourth_z), pure);
  // Divided by one deviation after another: its powers leave the range of float.
  const V g = hn::Mul(hn::Mul(hn::Mul(third, inverse), inverse), inverse);
  const V k = hn::Sub(
      hn::Mul(hn::Mul(hn::Mul(hn::Mul(fourth, inverse), inverse), inverse), inverse), three);
  const V skew = hn::MulAdd(hn::Set(d, 0.1893f), k, hn::Set(d, -0.1722f));
  const V tail = hn::MulAdd(hn::Set(d, 0.036f), k,
                            hn::MulAdd(hn::Mul(hn::Set(d, 0.113f), r), r, hn::Set(d, -0.0291f)));
  const V correction = hn::MulAdd(hn::Mul(g, r), skew, hn::Mul(k, tail));
  const V density =
      hn::Mul(hn::Set(d, 0.398942280f), exp(d, hn::Neg(hn::Mul(half, hn::Mul(r, r)))));
  const V below = hn::Mul(half, erfc(d, hn::Mul(hn::Abs(r), hn::Set(d, 0.707106781f))));
  const V above = hn::IfThenElse(hn::Lt(r, zero), below, hn::Sub(hn::Set(d, 1.0f), below));
  const V value = hn::MulAdd(hn::Mul(deviation, density), hn::Add(hn::Set(d, 1.0f), correction),
                             hn::Mul(mean, above));
  const V highest = hn::Mul(half, hn::Add(mean, hn::Sqrt(hn::MulAdd(mean, mean, variance))));
  const V held = hn::Min(hn::Max(value, hn::Max(mean, zero)), highest);
  return hn::IfThenElse(hn::Lt(hn::Abs(r), six), held, hn::Max(mean, zero));
}

template <class V>
struct Vector2 {
  V x, y;
};

/// direction_to_octahedral.
template <class D, class V>
HWY_INLINE Vector2<V> direction_to_octahedral(D d, const Vector3<V>& direction) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
  const V r = hn::Sqrt(hn::Div(hn::MulAdd(x, x, hn::Mul(y, y)), hn::Add(one, z)));
  const V large = hn::Max(x, y), small = hn::Min(x, y);
  const V slope = hn::IfThenElseZero(hn::Gt(large, zero), hn::Div(small, large));
  const V angle = quarter_arctangent(d, slope);
  const V phi = hn::IfThenElse(hn::Lt(x, y), hn::Sub(one, angle), angle);
  const V v = hn::Mul(phi, r), u = hn::Sub(r, v);
  const auto lower = hn::Lt(direction.z, zero);
  const V folded_u = hn::IfThenElse(lower, hn::Sub(one, v), u);
  const V folded_v = hn::IfThenElse(lower, hn::Sub(one, u), v);
  const auto to_unit = [&](V magnitude, V sign) HWY_ATTR {
    const V signed_value = hn::CopySign(magnitude, sign);
    return hn::Min(hn::Max(hn::MulAdd(half, signed_value, half), zero), one);
  };
  return {to_unit(folded_u, direction.x), to_unit(folded_v, direction.y)};
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
