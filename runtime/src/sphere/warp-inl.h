// The warps of burnish/sphere/spherical_warp.h on vectors of float or double: one lobe a lane. A
// structure of vectors is named as its scalar counterpart.

#if defined(BURNISH_SPHERE_WARP_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_WARP_INL_H_
#undef BURNISH_SPHERE_WARP_INL_H_
#else
#define BURNISH_SPHERE_WARP_INL_H_
#endif

#include <limits>

#include <hwy/highway.h>

#include "sphere/lobes-inl.h"
#include "sphere/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class V>
struct Frame {
  Vector3<V> x, y, z;
};

template <class V>
HWY_INLINE Vector3<V> to_local(const Frame<V>& frame, const Vector3<V>& v) {
  return {dot(v, frame.x), dot(v, frame.y), dot(v, frame.z)};
}

template <class V>
HWY_INLINE V weighted_sum(V a, V wa, V b, V wb, V c, V wc) {
  return hn::MulAdd(a, wa, hn::MulAdd(b, wb, hn::Mul(c, wc)));
}

template <class V>
HWY_INLINE Vector3<V> to_world(const Frame<V>& frame, const Vector3<V>& v) {
  return {weighted_sum(frame.x.x, v.x, frame.y.x, v.y, frame.z.x, v.z),
          weighted_sum(frame.x.y, v.x, frame.y.y, v.y, frame.z.y, v.z),
          weighted_sum(frame.x.z, v.x, frame.y.z, v.y, frame.z.z, v.z)};
}

/// x' of internal::across_view, not normalised, whose z is 0; and products of its components if it
/// were.
template <class V>
struct AcrossView {
  V x, y, length_squared;
  V xx, yy, xy;
};

/// bandwidth_x and bandwidth_y of internal::WarpedAxes. The axis of the larger one has the
/// components (cosine, sine) / sqrt(length_squared).
template <class V>
struct WarpedAxes {
  V bandwidth_x, bandwidth_y;
  V cosine, sine, length_squared;
};

/// The eigenvector of the larger eigenvalue of a symmetric matrix of 2 x 2: (cosine, sine) /
/// sqrt(length_squared).
template <class V>
struct MajorAxis {
  V cosine, sine, length_squared;
};

/// Of half the difference of its diagonal, and radius = sqrt(half_difference^2 + xy^2). Any axis
/// where that is below 1e-12.
template <class D, class V>
HWY_INLINE MajorAxis<V> major_axis(D d, V half_difference, V xy, V radius) {
  // It is along (radius + half_difference, xy), or, where that would cancel, (xy, radius -
  // half_difference).
  const V zero = hn::Zero(d);
  const V other = hn::IfThenElseZero(hn::Lt(radius, hn::Set(d, 1e-12f)), hn::Set(d, 1.0f));
  const V longer = hn::Add(hn::Add(radius, hn::Abs(half_difference)), other);
  const V shorter = hn::Abs(xy);
  const V swap = hn::IfThenElseZero(hn::Lt(half_difference, zero), hn::Xor(longer, shorter));
  return {hn::Xor(longer, swap), hn::CopySign(hn::Xor(shorter, swap), xy),
          hn::MulAdd(longer, longer, hn::Mul(xy, xy))};
}

/// internal::warped_axes.
template <class D, class V>
HWY_INLINE WarpedAxes<V> warped_axes(D d, V bandwidth_x, V bandwidth_y, const AcrossView<V>& across,
                                     V c, V quarter) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), half = hn::Set(d, 0.5f);
  const V large = hn::Max(bandwidth_x, bandwidth_y), small = hn::Min(bandwidth_x, bandwidth_y);
  const V ratio = hn::IfThenElse(hn::Gt(large, zero), hn::Div(small, large), one);
  const auto x_is_narrow = hn::Ge(bandwidth_x, bandwidth_y);
  const V lambda = hn::IfThenElse(x_is_narrow, one, ratio);
  const V mu = hn::IfThenElse(x_is_narrow, ratio, one);
  // The matrix times 4 c^2.
  const V cc = hn::Mul(c, c);
  const V m_xx = hn::MulAdd(lambda, across.xx, hn::Mul(mu, across.yy));
  const V m_xy = hn::Mul(hn::Sub(mu, lambda), hn::Mul(across.xy, c));
  const V m_yy = hn::Mul(cc, hn::MulAdd(lambda, across.yy, hn::Mul(mu, across.xx)));
  const V half_difference = hn::Mul(half, hn::Sub(m_xx, m_yy)), square_xy = hn::Mul(m_xy, m_xy);
  const V radius = hn::Sqrt(hn::MulAdd(half_difference, half_difference, square_xy));
  const V larger = hn::MulAdd(half, hn::Add(m_xx, m_yy), radius);
  // 1 / larger and 1 / c^2 with one division.
  const V inverse = hn::Div(quarter, hn::Mul(larger, cc));
  WarpedAxes<V> result;
  result.bandwidth_x = hn::Min(hn::Mul(large, hn::Mul(larger, hn::Mul(larger, inverse))),
                               hn::Set(d, std::numeric_limits<float>::max()));
  result.bandwidth_y = hn::Mul(small, hn::Mul(cc, inverse));
  // `larger` is at least 5e-5: a lobe of a radius of nothing is round, and any axis will do.
  const MajorAxis<V> axis = major_axis(d, half_difference, m_xy, radius);
  result.cosine = axis.cosine;
  result.sine = axis.sine;
  result.length_squared = axis.length_squared;
  return result;
}

template <class D, class V>
HWY_INLINE AcrossView<V> across_view(D d, const Vector3<V>& local_outgoing) {
  const V x = local_outgoing.x, y = local_outgoing.y, one = hn::Set(d, 1.0f);
  const V square = hn::MulAdd(x, x, hn::Mul(y, y));
  // There any direction will do: about (1, 0).
  const V other = hn::IfThenElseZero(hn::Lt(square, hn::Set(d, 1e-14f)), one);
  AcrossView<V> across;
  across.x = hn::Sub(other, y);
  across.y = x;
  across.length_squared = hn::Add(square, other);
  const V inverse = hn::Div(one, across.length_squared);
  const V scaled_x = hn::Mul(across.x, inverse), scaled_y = hn::Mul(across.y, inverse);
  across.xx = hn::Mul(across.x, scaled_x);
  across.yy = hn::Mul(across.y, scaled_y);
  across.xy = hn::Mul(across.x, scaled_y);
  return across;
}

/// The unit axis of the larger bandwidth. x and y: x' and z x x', of the squared length
/// `length_squared`.
template <class D, class V>
HWY_INLINE Vector3<V> warped_x(D d, const WarpedAxes<V>& axes, const Vector3<V>& x,
                               const Vector3<V>& y, V length_squared) {
  // Its roots are above 1e-19.
  const V scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Mul(axes.length_squared, length_squared)));
  const V cosine = hn::Mul(axes.cosine, scale), sine = hn::Mul(axes.sine, scale);
  return {hn::MulAdd(cosine, x.x, hn::Mul(sine, y.x)), hn::MulAdd(cosine, x.y, hn::Mul(sine, y.y)),
          hn::MulAdd(cosine, x.z, hn::Mul(sine, y.z))};
}

/// Without the y axis; `amplitude` is a factor for that of the half-vector lobe.
template <class V>
struct WarpedLobe {
  Vector3<V> x, z;
  V bandwidth_x, bandwidth_y, amplitude, jacobian;
};

inline constexpr float kMinWarpCosineFloat = 0.01f;

/// warp_to_incoming.
template <class D, class V>
HWY_INLINE WarpedLobe<V> warp_to_incoming(D d, const Frame<V>& half, V bandwidth_x, V bandwidth_y,
                                          const Vector3<V>& outgoing) {
  const V zero = hn::Zero(d);
  const Vector3<V> o = to_local(half, outgoing);
  const Vector3<V> z = {hn::Neg(o.x), hn::Neg(o.y), o.z};
  const AcrossView<V> across = across_view(d, o);
  const Vector3<V> x = {across.x, across.y, zero};
  const V c = hn::Max(o.z, hn::Set(d, kMinWarpCosineFloat));
  const WarpedAxes<V> axes = warped_axes(d, bandwidth_x, bandwidth_y, across, c, hn::Set(d, 0.25f));
  const Vector3<V> axis = warped_x(d, axes, x, cross(z, x), across.length_squared);
  return {to_world(half, axis),
          to_world(half, z),
          axes.bandwidth_x,
          axes.bandwidth_y,
          hn::IfThenElseZero(hn::Gt(o.z, zero), hn::Set(d, 1.0f)),
          hn::Mul(hn::Set(d, 4.0f), c)};
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
