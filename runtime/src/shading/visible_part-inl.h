// What of a lobe is visible, as a lobe: one point a lane (docs/maths.md, "Visible part").

#if defined(BURNISH_SHADING_VISIBLE_PART_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_VISIBLE_PART_INL_H_
#undef BURNISH_SHADING_VISIBLE_PART_INL_H_
#else
#define BURNISH_SHADING_VISIBLE_PART_INL_H_
#endif

#include <hwy/highway.h>

#include "shading/visibility-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// 1 / (2 variance) of a lobe's sine along an axis, which the unit disc cuts off: within a fifth of
/// the truth for every bandwidth, exact for narrow lobes, and easy to invert.
template <class D, class V>
HWY_INLINE V width_of_bandwidth(D d, V b) {
  const V one = hn::Set(d, 1.0f);
  return hn::MulAdd(hn::Set(d, 2.0f), reciprocal(d, hn::Add(one, b)), b);
}

/// The larger bandwidth of that width, w >= 2 sqrt(2) - 1: b^2 + (1 - w) b + 2 - w = 0.
template <class D, class V>
HWY_INLINE V bandwidth_of_width(D d, V w) {
  const V one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V square = hn::MulAdd(w, hn::Add(w, hn::Set(d, 2.0f)), hn::Set(d, -7.0f));
  return hn::Mul(half, hn::Add(hn::Sub(w, one), root(d, hn::Max(square, hn::Zero(d)))));
}

/// What half a space past a boundary does to a plane's Gaussian of variances (xx, yy): its mean
/// moves by `shift`, and its covariance loses `loss` times the outer product of `across`.
template <class V>
struct PlaneCut {
  V shift_x, shift_y;
  V across_x, across_y;
  V loss;
  V third;       ///< central moment, of a lobe of deviation 1
  V deviations;  ///< of the axis from the boundary
};

/// `x`, `y`: the boundary's gradient in the lobe's frame, of any length; zero: no boundary.
template <class D, class V>
HWY_INLINE PlaneCut<V> cut_plane(D d, V variance_x, V variance_y, V x, V y, V sine) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-12f);
  const V square = hn::MulAdd(x, x, hn::Mul(y, y));
  const V unit =
      hn::IfThenElseZero(hn::Gt(square, tiny), reciprocal_root(d, hn::Max(square, tiny)));
  const V gx = hn::Mul(x, unit), gy = hn::Mul(y, unit);
  const V qx = hn::Mul(variance_x, gx), qy = hn::Mul(variance_y, gy);
  const V variance = hn::Max(hn::MulAdd(qx, gx, hn::Mul(qy, gy)), tiny);
  const V inverse = reciprocal_root(d, variance);
  // Further inside the hidden side nothing is seen that could matter.
  const V t = hn::Max(hn::Min(hn::Mul(sine, inverse), hn::Set(d, 5.0f)), hn::Set(d, -2.5f));
  const V density =
      hn::Mul(hn::Set(d, 0.398942280f), exp(d, hn::Mul(hn::Set(d, -0.5f), hn::Mul(t, t))));
  const V half = hn::Set(d, 0.5f);
  const V tail = hn::CopySign(erf_of_positive(d, hn::Mul(hn::Abs(t), hn::Set(d, 0.707106781f))), t);
  const V hazard = hn::Mul(density, reciprocal(d, hn::MulAdd(half, tail, half)));
  const V loss = hn::Max(hn::Min(hn::Mul(hazard, hn::Add(hazard, t)), one), zero);
  const V along_x = hn::Mul(qx, inverse), along_y = hn::Mul(qy, inverse);
  const V first = hn::Add(hazard, t);
  const V third = hn::Mul(hazard, hn::MulSub(first, hn::Add(hazard, first), one));
  return {hn::Mul(along_x, hazard), hn::Mul(along_y, hazard), along_x, along_y, loss, third, t};
}

/// The skewness of a normal variable that is cut where its mean, after the cut, is so many of its
/// deviations away: within .05 of the truth.
template <class D, class V>
HWY_INLINE V skewness_of_cut(D d, V deviations) {
  const V two = hn::Set(d, 2.0f), one = hn::Set(d, 1.0f);
  return hn::Mul(two, exp(d, hn::Mul(two, hn::Sub(one, hn::Max(deviations, one)))));
}

template <class V>
struct VisiblePart {
  AnisotropicGaussian<V> lobe;  ///< bandwidth_x <= bandwidth_y
  V third;                      ///< central moment along x, rad^3
};

/// The lobe of the mean and the covariance that a lobe has past `boundary`, where its part above
/// the horizon is what it stands for already (`is_cut_at_horizon`), as the mean and covariance of
/// the tangent plane's Gaussian; and the third moment of both cuts.
template <class D, class V>
HWY_INLINE VisiblePart<V> visible_part(D d, const AnisotropicGaussian<V>& lobe,
                                       const Boundary<V>& boundary, const Vector3<V>& normal,
                                       bool is_cut_at_horizon) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V tiny = hn::Set(d, 1e-20f);
  const V width_x = width_of_bandwidth(d, lobe.bandwidth_x),
          width_y = width_of_bandwidth(d, lobe.bandwidth_y);
  const V variance_x = hn::Mul(half, reciprocal(d, width_x)),
          variance_y = hn::Mul(half, reciprocal(d, width_y));
  const PlaneCut<V> cut = cut_plane(d, variance_x, variance_y, dot(boundary.gradient, lobe.x),
                                    dot(boundary.gradient, lobe.y), boundary.sine);
  V shift_x = cut.shift_x, shift_y = cut.shift_y;
  V xx = hn::NegMulAdd(cut.loss, hn::Mul(cut.across_x, cut.across_x), variance_x);
  V yy = hn::NegMulAdd(cut.loss, hn::Mul(cut.across_y, cut.across_y), variance_y);
  V xy = hn::Neg(hn::Mul(cut.loss, hn::Mul(cut.across_x, cut.across_y)));
  V third = cut.third, own_third = zero, own_x = zero, own_y = zero;
  if (is_cut_at_horizon) {
    const PlaneCut<V> own = cut_plane(d, variance_x, variance_y, dot(normal, lobe.x),
                                      dot(normal, lobe.y), dot(normal, lobe.z));
    // What of the cut is the horizon's has been made already.
    const V same = overlap(d, lobe, boundary.gradient, normal), loss = hn::Mul(same, own.loss);
    shift_x = hn::NegMulAdd(same, own.shift_x, shift_x);
    shift_y = hn::NegMulAdd(same, own.shift_y, shift_y);
    xx = hn::MulAdd(loss, hn::Mul(own.across_x, own.across_x), xx);
    yy = hn::MulAdd(loss, hn::Mul(own.across_y, own.across_y), yy);
    xy = hn::MulAdd(loss, hn::Mul(own.across_x, own.across_y), xy);
    own_third = hn::NegMulAdd(same, own.third, skewness_of_cut(d, own.deviations));
    own_x = own.across_x;
    own_y = own.across_y;
  }
  // Axes of the covariance: the larger variance is along (cosine, sine).
  const V mean = hn::Mul(half, hn::Add(xx, yy)), difference = hn::Mul(half, hn::Sub(xx, yy));
  const V radius = root(d, hn::MulAdd(difference, difference, hn::Mul(xy, xy)));
  const V ratio = reciprocal(d, hn::Max(radius, tiny));
  const V cosine2 =
      hn::IfThenElse(hn::Gt(radius, tiny), hn::Min(hn::Abs(hn::Mul(difference, ratio)), one), one);
  // The smaller of the two by the other, so that it does not cancel.
  const V larger = root(d, hn::MulAdd(half, cosine2, half));
  const V smaller = hn::Mul(hn::Mul(half, hn::Mul(xy, ratio)), reciprocal(d, larger));
  const auto is_along_x = hn::Ge(difference, zero);
  const V cosine = hn::IfThenElse(is_along_x, larger, smaller);
  const V sine = hn::IfThenElse(is_along_x, smaller, larger);
  const auto cube = [](V v) HWY_ATTR { return hn::Mul(v, hn::Mul(v, v)); };
  third = hn::Mul(third, cube(hn::MulAdd(cosine, cut.across_x, hn::Mul(sine, cut.across_y))));
  third = hn::MulAdd(own_third, cube(hn::MulAdd(cosine, own_x, hn::Mul(sine, own_y))), third);
  // SSDFs tell of boundaries to a texel, and materials fade toward the horizon: half errs least.
  third = hn::Mul(half, third);
  // No wider than the lobe was, and not a line.
  const V most = hn::Max(variance_x, variance_y);
  const V least = hn::Mul(hn::Set(d, 0.1f), hn::Min(variance_x, variance_y));
  const V large = hn::Max(hn::Min(hn::Add(mean, radius), most), least);
  const V small = hn::Max(hn::Min(hn::Sub(mean, radius), most), least);
  // The tangent plane's point as a direction.
  const V far = hn::MulAdd(shift_x, shift_x, hn::Mul(shift_y, shift_y));
  const V scale = reciprocal_root(d, hn::Add(one, far));
  const auto combine = [&](V a, const Vector3<V>& u, V b, const Vector3<V>& v) HWY_ATTR {
    return Vector3<V>{hn::MulAdd(a, u.x, hn::Mul(b, v.x)), hn::MulAdd(a, u.y, hn::Mul(b, v.y)),
                      hn::MulAdd(a, u.z, hn::Mul(b, v.z))};
  };
  const Vector3<V> moved = combine(shift_x, lobe.x, shift_y, lobe.y);
  const Vector3<V> z = combine(scale, lobe.z, scale, moved);
  const Vector3<V> long_axis = combine(cosine, lobe.x, sine, lobe.y);
  // Orthogonal to the new axis.
  const Vector3<V> flat = combine(one, long_axis, hn::Neg(dot(long_axis, z)), z);
  const V to_unit = reciprocal_root(d, hn::Max(dot(flat, flat), hn::Set(d, 1e-6f)));
  const Vector3<V> x = {hn::Mul(to_unit, flat.x), hn::Mul(to_unit, flat.y),
                        hn::Mul(to_unit, flat.z)};
  return {{x, cross(z, x), z, bandwidth_of_width(d, hn::Mul(half, reciprocal(d, large))),
           bandwidth_of_width(d, hn::Mul(half, reciprocal(d, small)))},
          third};
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
