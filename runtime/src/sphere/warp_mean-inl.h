// The mean form of the warp (warp_mean_to_incoming of burnish/sphere/spherical_warp.h) on vectors
// of float, in steps: one lobe a lane. A structure of vectors is named as its scalar counterpart.

#if defined(BURNISH_SPHERE_WARP_MEAN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_WARP_MEAN_INL_H_
#undef BURNISH_SPHERE_WARP_MEAN_INL_H_
#else
#define BURNISH_SPHERE_WARP_MEAN_INL_H_
#endif

#include <hwy/highway.h>

#include "sphere/lobes-inl.h"
#include "sphere/vector_math-inl.h"
#include "sphere/warp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class V>
struct CutNormal {
  V mean, weighted_mean, weighted_square, probability_over_mean;
};

inline constexpr float kLowestRatio = -4;

/// internal::cut_normal, for a mean of `ratio` deviations, kLowestRatio or more.
template <class D, class V>
HWY_INLINE CutNormal<V> cut_normal(D d, V ratio, V deviation) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  // The density and the tail from one exponential: below 0, where they cancel, its error does, too.
  const V size = hn::Abs(ratio);
  // From 6 on both are out of sight; products of smaller numbers would be denormal, and slow.
  const V y = hn::Min(hn::Mul(size, hn::Set(d, 0.707106781f)), hn::Set(d, 6.0f));
  const ExpParts<V> parts = exp_parts(d, hn::Neg(hn::Mul(y, y)));
  const V e = hn::MulAdd(parts.scale, parts.rest, parts.scale);
  const V t = hn::Div(one, hn::MulAdd(hn::Set(d, 0.4f), y, one));
  const V tail = hn::Mul(half, hn::Mul(t, erfc_curve(d, t)));
  const auto is_negative = hn::Lt(ratio, zero);
  const V probability = hn::Abs(hn::NegMulAdd(e, tail, hn::IfThenZeroElse(is_negative, one)));
  const V lacking = hn::NegMulAdd(size, tail, hn::Set(d, 0.398942280f));
  const V excess = hn::MulAdd(e, lacking, hn::Max(ratio, zero));
  const V third = hn::Div(probability, hn::Mul(excess, deviation));
  const V held_mean = hn::Mul(ratio, deviation), variance = hn::Mul(deviation, deviation);
  CutNormal<V> s;
  s.mean = hn::IfThenElseZero(hn::Gt(ratio, hn::Set(d, kLowestRatio)), hn::Mul(deviation, excess));
  s.weighted_mean = hn::MulAdd(variance, third, held_mean);
  s.weighted_square =
      hn::Max(hn::MulAdd(held_mean, s.weighted_mean, hn::Add(variance, variance)), zero);
  s.probability_over_mean = third;
  return s;
}

/// What warp_mean_to_incoming reads of a LobeShape, in all lanes.
template <class V>
struct LobeShape {
  V integral, mean_z, mean_xx, mean_yy, variance_z, mean_xxz, mean_yyz, mean_zzz;
  V inverse_in_plane_cosine;
};

/// A lobe as a view meets it: the view in the lobe's frame; the deviation of o.h, and its mean over
/// that.
template <class V>
struct SeenLobe {
  Vector3<V> outgoing;
  V ratio, deviation;
};

// warp_mean_to_incoming in four steps. Each waits for few of its own results: as one, most of the
// time the processor would wait for a chain of divisions and roots.

template <class D, class V>
HWY_INLINE SeenLobe<V> see_lobe(D d, const Frame<V>& half, const LobeShape<V>& m,
                                const Vector3<V>& outgoing) {
  const Vector3<V> o = to_local(half, outgoing);
  const V variance = weighted_sum(hn::Mul(o.x, o.x), m.mean_xx, hn::Mul(o.y, o.y), m.mean_yy,
                                  hn::Mul(o.z, o.z), m.variance_z);
  // A least deviation that is out of sight beside any mean that shows. A wider range is not needed:
  // means are at most 1.
  const V deviation = hn::Max(hn::Sqrt(variance), hn::Set(d, 1e-15f));
  const V ratio = hn::Div(hn::Mul(o.z, m.mean_z), deviation);
  return {o, hn::Max(ratio, hn::Set(d, kLowestRatio)), deviation};
}

/// The mean of i, normalised: `z` of the scalar form.
template <class D, class V>
HWY_INLINE Vector3<V> mean_incoming(D d, const LobeShape<V>& m, const Vector3<V>& o,
                                    const CutNormal<V>& s) {
  const V one = hn::Set(d, 1.0f), two = hn::Set(d, 2.0f), four = hn::Set(d, 4.0f);
  const V third = hn::Mul(two, s.probability_over_mean),
          third_z = hn::Mul(two, hn::Mul(third, o.z));
  const V turn_x = hn::MulAdd(third_z, m.mean_xxz, hn::MulSub(four, m.mean_xx, one));
  const V turn_y = hn::MulAdd(third_z, m.mean_yyz, hn::MulSub(four, m.mean_yy, one));
  const V turn_z = hn::MulSub(four, m.variance_z, one);
  const V thirds = weighted_sum(hn::Mul(o.x, o.x), m.mean_xxz, hn::Mul(o.y, o.y), m.mean_yyz,
                                hn::Mul(o.z, o.z), m.mean_zzz);
  Vector3<V> z = {
      hn::Mul(o.x, turn_x), hn::Mul(o.y, turn_y),
      weighted_sum(hn::Mul(two, m.mean_z), s.weighted_mean, third, thirds, o.z, turn_z)};
  V square = dot(z, z);
  // The mean may be none.
  const V other = hn::IfThenElseZero(hn::Lt(square, hn::Set(d, 1e-30f)), one);
  z.z = hn::Add(z.z, other);
  square = hn::Add(square, other);
  const V scale = hn::Div(one, hn::Sqrt(square));
  return {hn::Mul(z.x, scale), hn::Mul(z.y, scale), hn::Mul(z.z, scale)};
}

/// Without amplitude and jacobian.
template <class D, class V>
HWY_INLINE WarpedLobe<V> place_lobe(D d, const Frame<V>& half, V bandwidth_x, V bandwidth_y,
                                    const LobeShape<V>& m, const Vector3<V>& o,
                                    const CutNormal<V>& cut) {
  const V one = hn::Set(d, 1.0f);
  const Vector3<V> z = mean_incoming(d, m, o, cut);
  const AcrossView<V> across = across_view(d, o);
  const V overlap = hn::MulAdd(across.x, z.x, hn::Mul(across.y, z.y));
  const Vector3<V> x = {hn::NegMulAdd(overlap, z.x, across.x),
                        hn::NegMulAdd(overlap, z.y, across.y), hn::Neg(hn::Mul(overlap, z.z))};
  const V cosine = hn::Mul(hn::Sqrt(cut.weighted_square), m.inverse_in_plane_cosine);
  const V c = hn::Min(hn::Max(cosine, hn::Set(d, kMinWarpCosineFloat)), one);
  const V quarter =
      hn::Mul(hn::Set(d, 0.25f), hn::Mul(m.inverse_in_plane_cosine, m.inverse_in_plane_cosine));
  const WarpedAxes<V> axes = warped_axes(d, bandwidth_x, bandwidth_y, across, c, quarter);
  const V x_squared = hn::Max(dot(x, x), hn::Set(d, 1e-14f));
  return {to_world(half, warped_x(d, axes, x, cross(z, x), x_squared)),
          to_world(half, z),
          axes.bandwidth_x,
          axes.bandwidth_y,
          one,
          one};
}

/// For which the lobe of these bandwidths has the mass of the half-vector lobe.
template <class D, class V>
HWY_INLINE V mean_amplitude(D d, V half_integral, V bandwidth_x, V bandwidth_y, V jacobian) {
  const AsgIntegralParts<V> whole = asg_integral_parts(d, bandwidth_x, bandwidth_y);
  const V over_plane =
      hn::Mul(hn::Mul(jacobian, half_integral), hn::Mul(hn::Set(d, 0.318309886f), whole.root));
  return hn::Div(over_plane, whole.mean);
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
