// What the points of a block reflect, by the lobes of their material: one point a lane.

#if defined(BURNISH_SHADING_SPECULAR_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_SPECULAR_INL_H_
#undef BURNISH_SHADING_SPECULAR_INL_H_
#else
#define BURNISH_SHADING_SPECULAR_INL_H_
#endif

#include <hwy/highway.h>

#include "burnish/shading/prepared_lights.h"
#include "light/prefiltered-inl.h"
#include "material/slice_block.h"
#include "material/specular_slice-inl.h"
#include "shading/visibility-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class D, class T = hn::TFromD<D>>
HWY_INLINE AnisotropicGaussian<hn::VFromD<D>> load(D d, const BlockLobes<T>& lobes, size_t i) {
  const auto x = load(d, lobes.x, i), z = load(d, lobes.z, i);
  return {x, cross(z, x), z, hn::Load(d, lobes.bandwidth_x.data() + i),
          hn::Load(d, lobes.bandwidth_y.data() + i)};
}

/// From the points' frames to the world.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE Vector3<hn::VFromD<D>> to_world(D d, const ShadingBlock<T>& block,
                                           const Vector3<hn::VFromD<D>>& v, size_t i) {
  const auto x = load(d, block.tangent, i), y = load(d, block.bitangent, i),
             z = load(d, block.normal, i);
  return {hn::MulAdd(v.x, x.x, hn::MulAdd(v.y, y.x, hn::Mul(v.z, z.x))),
          hn::MulAdd(v.x, x.y, hn::MulAdd(v.y, y.y, hn::Mul(v.z, z.y))),
          hn::MulAdd(v.x, x.z, hn::MulAdd(v.y, y.z, hn::Mul(v.z, z.z)))};
}

/// Turns the lobes of a slice to the world, and takes off their weight what is hidden of each.
/// Whether anything is left.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE bool place_slice(D d, const PreparedTransfer& transfer, SpecularForm form,
                              const ShadingOptions& options, size_t terms,
                              const ShadingBlock<T>& block, SliceBlock<T>& slice) {
  using V = hn::VFromD<D>;
  V most = hn::Zero(d);
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    store(d, to_world(d, block, load(d, slice.lobes.x, i), i), slice.lobes.x, i);
    store(d, to_world(d, block, load(d, slice.lobes.z, i), i), slice.lobes.z, i);
    for (size_t c = 0; c < 3; ++c) most = hn::Max(most, hn::Load(d, slice.weight[c].data() + i));
  }
  if (hn::AllTrue(d, hn::Le(most, hn::Zero(d)))) return false;
  const bool occluded = !transfer.bases.empty();
  BlockBoundaries<T> boundaries;
  if (occluded) find_boundaries(d, transfer, block, terms, slice.lobes.z, boundaries);
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    const AnisotropicGaussian<V> lobe = load(d, slice.lobes, i);
    const Vector3<V> normal = load(d, block.normal, i);
    Boundary<V> boundary = horizon(d, normal, lobe.z);
    if (occluded)
      boundary = {hn::Load(d, boundaries.sine.data() + i), load(d, boundaries.gradient, i)};
    V visible = hn::Set(d, 1.0f);
    if (form == SpecularForm::peak)
      visible = visible_fraction(d, options.visibility, lobe, boundary);
    else if (occluded)
      visible = visible_share(d, options.visibility, lobe, boundary, normal);
    for (size_t c = 0; c < 3; ++c) {
      T* weight = slice.weight[c].data() + i;
      hn::Store(hn::Mul(visible, hn::Load(d, weight)), d, weight);
    }
    if (form == SpecularForm::peak && options.integral == AsgIntegral::fast)
      hn::Store(asg_integral_fast(d, lobe.bandwidth_x, lobe.bandwidth_y), d,
                slice.integral.data() + i);
  }
  return true;
}

/// Integrals of the environment's lobes times the slice's.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void see_lobes(D d, const PreparedLights& lights, size_t count,
                            const BlockLobes<T>& lobes, BlockRgb<T>& seen) {
  using V = hn::VFromD<D>;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const AnisotropicGaussian<V> lobe = load(d, lobes, i);
    V sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (const PreparedLobe& light : lights.lobes) {
      const AnisotropicGaussian<V> other = {
          set(d, light.lobe.frame.x), set(d, light.lobe.frame.y), set(d, light.lobe.frame.z),
          hn::Set(d, light.lobe.bandwidth_x), hn::Set(d, light.lobe.bandwidth_y)};
      const V product = asg_inner_product(d, other, lobe);
      for (int c = 0; c < 3; ++c) sum[c] = hn::MulAdd(hn::Set(d, light.color[c]), product, sum[c]);
    }
    for (size_t c = 0; c < 3; ++c) hn::Store(sum[c], d, seen[c].data() + i);
  }
}

/// Adds what a placed slice reflects of the distant environment.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void reflect_environment(D d, const Lighting& lighting, const ShadingOptions& options,
                                    size_t count, const SliceBlock<T>& slice,
                                    BlockRgb<T>& reflected) {
  BlockRgb<T> seen;
  if (lighting.environment) {
    BlockArray<T> active;
    for (size_t i = 0; i < count; i += hn::Lanes(d))
      hn::Store(hn::Max(hn::Load(d, slice.weight[0].data() + i),
                        hn::Max(hn::Load(d, slice.weight[1].data() + i),
                                hn::Load(d, slice.weight[2].data() + i))),
                d, active.data() + i);
    eval_prefiltered(d, *lighting.environment, count, slice.lobes, active, options.environment_taps,
                     seen);
  } else {
    see_lobes(d, *lighting.lights, count, slice.lobes, seen);
  }
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto integral =
        lighting.environment ? hn::Load(d, slice.integral.data() + i) : hn::Set(d, T(1));
    for (size_t c = 0; c < 3; ++c) {
      T* sum = reflected[c].data() + i;
      const auto light = hn::Mul(integral, hn::Load(d, seen[c].data() + i));
      hn::Store(hn::MulAdd(hn::Load(d, slice.weight[c].data() + i), light, hn::Load(d, sum)), d,
                sum);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
