// Blocks of vertices: their frames and views, one vertex a lane.

#if defined(BURNISH_SHADING_VERTEX_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_VERTEX_BLOCK_INL_H_
#undef BURNISH_SHADING_VERTEX_BLOCK_INL_H_
#else
#define BURNISH_SHADING_VERTEX_BLOCK_INL_H_
#endif

#include <hwy/highway.h>

#include "burnish/shading/shade.h"
#include "shading/visibility-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class V>
HWY_INLINE Vector3<V> scaled(const Vector3<V>& v, V factor) {
  return {hn::Mul(v.x, factor), hn::Mul(v.y, factor), hn::Mul(v.z, factor)};
}

/// a + b factor.
template <class V>
HWY_INLINE Vector3<V> plus(const Vector3<V>& a, const Vector3<V>& b, V factor) {
  return {hn::MulAdd(b.x, factor, a.x), hn::MulAdd(b.y, factor, a.y), hn::MulAdd(b.z, factor, a.z)};
}

template <class M, class V>
HWY_INLINE Vector3<V> if_then_else(M mask, const Vector3<V>& yes, const Vector3<V>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}

/// A vector of any finite length as a unit one; `other` where it is none.
template <class D, class V>
HWY_INLINE Vector3<V> unit_or(D d, const Vector3<V>& v, const Vector3<V>& other) {
  const V largest = hn::Max(hn::Max(hn::Abs(v.x), hn::Abs(v.y)), hn::Abs(v.z));
  const auto is_some =
      hn::And(hn::Gt(largest, hn::Set(d, 1e-30f)), hn::Lt(largest, hn::Set(d, 1e37f)));
  const V one = hn::Set(d, 1.0f);
  const Vector3<V> small = scaled(v, reciprocal(d, hn::IfThenElse(is_some, largest, one)));
  const V square = hn::IfThenElse(is_some, dot(small, small), one);
  return if_then_else(is_some, scaled(small, reciprocal_root(d, square)), other);
}

/// frame_from_axis(axis).x
template <class D, class V>
HWY_INLINE Vector3<V> across_axis(D d, const Vector3<V>& axis) {
  const V one = hn::Set(d, 1.0f), sign = hn::CopySign(one, axis.z);
  const V a = hn::Neg(reciprocal(d, hn::Add(sign, axis.z)));
  const V x = hn::Mul(sign, axis.x);
  return {hn::MulAdd(hn::Mul(x, axis.x), a, one),
          hn::Mul(sign, hn::Mul(hn::Mul(axis.x, axis.y), a)), hn::Neg(x)};
}

/// Of a block that holds its vertices' normals, their tangents, and, as `outgoing`, their
/// positions: vertex_shading_point's frames, and the views toward an eye, lifted above the horizon,
/// in them.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void find_vertex_views(D d, const Vector3f& eye, ShadingBlock<T>& block) {
  using V = hn::VFromD<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const Vector3<V> up = {zero, zero, one};
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    const Vector3<V> normal = unit_or(d, load(d, block.normal, i), up);
    const Vector3<V> tangent = load(d, block.tangent, i);
    const Vector3<V> projected = plus(tangent, normal, hn::Neg(dot(tangent, normal)));
    const V square = dot(projected, projected);
    const auto has_tangent =
        hn::And(hn::Gt(square, hn::Mul(hn::Set(d, 1e-12f), dot(tangent, tangent))),
                hn::Lt(square, hn::Set(d, 1e36f)));
    const V safe = hn::IfThenElse(has_tangent, hn::Max(square, hn::Set(d, 1e-36f)), one);
    const Vector3<V> x = if_then_else(has_tangent, scaled(projected, reciprocal_root(d, safe)),
                                      across_axis(d, normal));
    const Vector3<V> y = cross(normal, x);
    const Vector3<V> position = load(d, block.outgoing, i);
    const Vector3<V> toward = {hn::Sub(hn::Set(d, eye.x()), position.x),
                               hn::Sub(hn::Set(d, eye.y()), position.y),
                               hn::Sub(hn::Set(d, eye.z()), position.z)};
    Vector3<V> view = unit_or(d, toward, normal);
    const V lack = hn::Max(hn::Sub(hn::Set(d, kMinViewCosine), dot(view, normal)), zero);
    view = plus(view, normal, lack);
    view = scaled(view, reciprocal_root(d, dot(view, view)));
    store(d, normal, block.normal, i);
    store(d, x, block.tangent, i);
    store(d, y, block.bitangent, i);
    store(d, Vector3<V>{dot(view, x), dot(view, y), dot(view, normal)}, block.outgoing, i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
