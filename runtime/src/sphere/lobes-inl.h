// The lobe formulas of burnish/sphere/ on vectors of float or double: one lobe or direction a lane.
// No branches but where a comment says so. A structure of vectors is named as its scalar
// counterpart.

#if defined(BURNISH_SPHERE_LOBES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_LOBES_INL_H_
#undef BURNISH_SPHERE_LOBES_INL_H_
#else
#define BURNISH_SPHERE_LOBES_INL_H_
#endif

#include <limits>

#include <hwy/highway.h>

#include "sphere/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class V>
struct Vector2 {
  V x, y;
};

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

/// asg_integral_exact is pi mean / root, see burnish/sphere/asg_integral.h.
template <class V>
struct AsgIntegralParts {
  V mean, root;
};

/// The mean of (1 + o / k)(1 - exp(-k)) over a quarter turn of psi, for o = 12 and
/// 1 / (k + o) = cos^2(psi) / (large + o) + sin^2(psi) / (small + o): that factor is a polynomial
/// of degree 13 in 1 / (k + o) (minimax, 4e-7), which leaves one in its mean, `a`, and the square,
/// `bb`, of its amplitude, both for 1 / (k + o) from 0 to 1 / o as -1 to 1.
template <class D, class V>
HWY_INLINE V asg_integral_mean(D d, V a, V bb) {
  // By Horner's rule in `a`: its coefficients, short polynomials, do not wait for each other.
  V sum = hn::Set(d, -0.0258181174f);
  const auto add = [&](auto... coefficients)
                       HWY_ATTR { sum = hn::MulAdd(sum, a, polynomial(d, bb, coefficients...)); };
  add(-0.0197828696f);
  add(0.123686044f, -1.00690658f);
  add(0.125915978f, -0.652834697f);
  add(-0.253863748f, 3.40136621f, -6.92248274f);
  add(-0.443784905f, 2.8331095f, -3.67219517f);
  add(0.0887823168f, -4.56954746f, 15.306148f, -13.8449655f);
  add(0.960257158f, -6.21298867f, 9.91588323f, -5.7123036f);
  add(1.59298124f, 0.932214327f, -11.9950621f, 17.8571726f, -9.08575859f);
  add(1.88103051f, 7.20192869f, -11.6493537f, 8.26323603f, -2.67764231f);
  add(1.97453133f, 7.96490621f, 1.16526791f, -6.66392337f, 5.58036644f, -1.81715172f);
  add(1.99637611f, 5.64309153f, 5.40144652f, -3.88311792f, 1.54935676f, -0.321317078f);
  add(1.99970085f, 2.96179699f, 2.98683983f, 0.194211318f, -0.624742816f, 0.334821986f,
      -0.0757146549f);
  add(1.99998833f, 0.998188054f, 0.705386441f, 0.300080362f, -0.121347435f, 0.0309871351f,
      -0.00446273719f);
  return sum;
}

/// The quotient's relative error is 1e-6.
template <class D, class V>
HWY_INLINE AsgIntegralParts<V> asg_integral_parts(D d, V bandwidth_x, V bandwidth_y) {
  constexpr float kOffset = 12;
  const V one = hn::Set(d, 1.0f);
  const V large = hn::Max(bandwidth_x, bandwidth_y), small = hn::Min(bandwidth_x, bandwidth_y);
  // Lobes that the disc's edge does not cut: the whole plane's integral.
  const auto is_whole = hn::Gt(small, hn::Set(d, 17.0f));
  const V offset = hn::IfThenZeroElse(is_whole, hn::Set(d, kOffset));
  const V large_offset = hn::Add(large, offset), small_offset = hn::Add(small, offset);
  // Scaled so that the product, of numbers from 12 to the largest, is neither denormal nor
  // infinite.
  const V root = hn::Mul(hn::Sqrt(hn::Mul(hn::Mul(large_offset, hn::Set(d, 0x1p-66f)),
                                          hn::Mul(small_offset, hn::Set(d, 0x1p-64f)))),
                         hn::Set(d, 0x1p65f));
  if (hn::AllTrue(d, is_whole)) return {one, root};  // common, and faster
  const V low = hn::Div(hn::Set(d, kOffset), large_offset);
  const V high = hn::Div(hn::Set(d, kOffset), small_offset);
  const V b = hn::Sub(high, low);
  const V mean = asg_integral_mean(d, hn::Sub(hn::Add(low, high), one), hn::Mul(b, b));
  return {hn::IfThenElse(is_whole, one, mean), root};
}

/// asg_integral_exact.
template <class D, class V>
HWY_INLINE V asg_integral_exact(D d, V bandwidth_x, V bandwidth_y) {
  const AsgIntegralParts<V> parts = asg_integral_parts(d, bandwidth_x, bandwidth_y);
  return hn::Div(hn::Mul(hn::Set(d, 3.14159265f), parts.mean), parts.root);
}

/// An ASG of unit amplitude.
template <class V>
struct AnisotropicGaussian {
  Vector3<V> x, y, z;
  V bandwidth_x, bandwidth_y;
};

/// Products of lobes further apart than e^-75, 3e-33 of those in line, are 0.
inline constexpr float kFarExponent = 75;

/// inner_product_closed_form, see burnish/sphere/asg_product.h.
template <class D, class V>
HWY_INLINE V asg_inner_product(D d, const AnisotropicGaussian<V>& a,
                               const AnisotropicGaussian<V>& b) {
  const V one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f), zero = hn::Zero(d);
  // Over the largest bandwidth: determinants would overflow.
  const V scale = hn::Max(
      hn::Max(hn::Max(a.bandwidth_x, a.bandwidth_y), hn::Max(b.bandwidth_x, b.bandwidth_y)), one);
  const V inverse = hn::Div(one, scale);
  const V ax = hn::Mul(a.bandwidth_x, inverse), ay = hn::Mul(a.bandwidth_y, inverse);
  const V bx = hn::Mul(b.bandwidth_x, inverse), by = hn::Mul(b.bandwidth_y, inverse);
  const V cosine = dot(a.z, b.z);
  const Vector3<V> between = minus(b.z, a.z);
  const V dax = dot(between, a.x), day = dot(between, a.y);
  const V dbx = hn::Neg(dot(between, b.x)), dby = hn::Neg(dot(between, b.y));
  // The axes of b, turned to a's tangent plane.
  const V turn = reciprocal(d, hn::Max(hn::Add(one, cosine), hn::Set(d, 1e-6f)));
  const V turned_x = hn::Mul(dbx, turn), turned_y = hn::Mul(dby, turn);
  const V xx = hn::NegMulAdd(turned_x, dax, dot(b.x, a.x));
  const V xy = hn::NegMulAdd(turned_x, day, dot(b.x, a.y));
  const V yx = hn::NegMulAdd(turned_y, dax, dot(b.y, a.x));
  const V yy = hn::NegMulAdd(turned_y, day, dot(b.y, a.y));
  const V b_xx = hn::MulAdd(bx, hn::Mul(xx, xx), hn::Mul(by, hn::Mul(yx, yx)));
  const V b_yy = hn::MulAdd(bx, hn::Mul(xy, xy), hn::Mul(by, hn::Mul(yy, yy)));
  const V det_a = hn::Mul(ax, ay), det_b = hn::Mul(bx, by);
  const V det = hn::Add(hn::Add(det_a, det_b), hn::MulAdd(ay, b_xx, hn::Mul(ax, b_yy)));
  const V along_a = hn::MulAdd(ax, hn::Mul(dax, dax), hn::Mul(ay, hn::Mul(day, day)));
  const V along_b = hn::MulAdd(bx, hn::Mul(dbx, dbx), hn::Mul(by, hn::Mul(dby, dby)));
  const V exponent = hn::Mul(
      scale, hn::IfThenElseZero(hn::Gt(det, zero),
                                hn::Div(hn::MulAdd(det_b, along_a, hn::Mul(det_a, along_b)), det)));
  // Most lobes of a scene are nowhere near.
  const auto is_far = hn::Gt(exponent, hn::Set(d, kFarExponent));
  if (hn::AllTrue(d, is_far)) return zero;
  const V along = hn::Add(along_a, along_b);
  const V q = hn::Mul(hn::Sub(along_b, along_a), reciprocal(d, hn::Max(along, hn::Set(d, 1e-36f))));
  const V smooth =
      hn::Mul(half, hn::NegMulAdd(hn::Sub(one, cosine), hn::Mul(q, q), hn::Add(one, cosine)));
  const V mean = hn::Mul(half, hn::Add(hn::Add(ax, ay), hn::Add(bx, by)));
  const V large = hn::Add(mean, hn::Sqrt(hn::Max(hn::MulSub(mean, mean, det), zero)));
  const V small = hn::Mul(det, reciprocal(d, hn::Max(large, hn::Set(d, 1e-3f))));
  const V whole =
      asg_integral_exact(d, hn::MulAdd(large, scale, half), hn::MulAdd(small, scale, half));
  return hn::IfThenZeroElse(
      is_far, hn::Mul(hn::Mul(hn::Max(smooth, zero), whole), exp(d, hn::Neg(exponent))));
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
  const V deviation = root(d, variance);
  const V inverse = reciprocal(d, hn::Max(deviation, hn::Set(d, 1e-12f)));
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
  const V highest = hn::Mul(half, hn::Add(mean, root(d, hn::MulAdd(mean, mean, variance))));
  const V held = hn::Min(hn::Max(value, hn::Max(mean, zero)), highest);
  return hn::IfThenElse(hn::Lt(hn::Abs(r), six), held, hn::Max(mean, zero));
}

/// PreparedClampedCosine without its axis, in all lanes.
template <class V>
struct PreparedClampedCosine {
  V slope, bump, spread, end, behind, mean;
};

/// clamped_cosine_integral for a normal of this `cosine` with the axis.
template <class D, class V>
HWY_INLINE V clamped_cosine_integral(D d, const PreparedClampedCosine<V>& lobe, V cosine) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const V c = hn::Max(hn::Min(cosine, one), hn::Neg(one)), size = hn::Abs(c);
  const V rest = hn::NegMulAdd(c, c, one);
  const V x = hn::Mul(lobe.slope, size), square = hn::Mul(x, x);
  const V slope_rest = hn::Mul(lobe.slope, rest);
  const V gap = hn::Mul(hn::Mul(hn::Set(d, 0.282094792f), slope_rest),
                        one_minus_exp_over(d, hn::Mul(lobe.slope, slope_rest)));
  const V bump = hn::Mul(hn::Mul(lobe.bump, rest), hn::MulAdd(lobe.spread, square, one));
  const V middle = hn::Mul(exp(d, hn::Neg(square)), hn::Add(gap, bump));
  const V sides = hn::Mul(hn::Set(d, 0.5f), hn::NegMulAdd(size, erfc(d, x), lobe.end));
  const V even = hn::Max(hn::Add(sides, middle), zero);
  return hn::MulAdd(lobe.mean, hn::Add(hn::Max(c, zero), even), lobe.behind);
}

template <class V>
struct ConvolvedLobe {
  V bandwidth_x, bandwidth_y, amplitude;
};

/// convolve of an ASG and an SG of unit amplitudes.
template <class D, class V>
HWY_INLINE ConvolvedLobe<V> convolve(D d, V bandwidth_x, V bandwidth_y, V sharpness) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), nu = hn::Mul(hn::Set(d, 0.5f), sharpness);
  const V largest = hn::Set(d, std::numeric_limits<float>::max());
  // a nu / (a + nu), without overflow.
  const auto blurred = [&](V a) HWY_ATTR {
    const V low = hn::Min(a, nu), high = hn::Max(a, nu);
    return hn::IfThenElseZero(hn::Gt(low, zero), hn::Div(low, hn::Add(one, hn::Div(low, high))));
  };
  return {blurred(bandwidth_x), blurred(bandwidth_y),
          asg_integral_exact(d, hn::Min(hn::Add(bandwidth_x, nu), largest),
                             hn::Min(hn::Add(bandwidth_y, nu), largest))};
}

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
