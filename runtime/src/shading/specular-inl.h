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
#include "shading/visible_part-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

template <class D, class T = hn::TFromD<D>>
HWY_INLINE AnisotropicGaussian<hn::VFromD<D>> load(D d, const BlockLobes<T>& lobes, size_t i) {
  const auto x = load(d, lobes.x, i), z = load(d, lobes.z, i);
  return {x, cross(z, x), z, hn::Load(d, lobes.bandwidth_x.data() + i),
          hn::Load(d, lobes.bandwidth_y.data() + i)};
}

template <class D, class V, class T = hn::TFromD<D>>
HWY_INLINE void store(D d, const AnisotropicGaussian<V>& lobe, BlockLobes<T>& lobes, size_t i) {
  store(d, lobe.x, lobes.x, i);
  store(d, lobe.z, lobes.z, i);
  hn::Store(lobe.bandwidth_x, d, lobes.bandwidth_x.data() + i);
  hn::Store(lobe.bandwidth_y, d, lobes.bandwidth_y.data() + i);
}

/// The visible parts of a slice's lobes.
template <class T>
struct BlockParts {
  BlockLobes<T> lobes;
  BlockCuts<T> cuts;
};

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

/// Turns the lobes of a slice to the world. Whether any point reflects anything.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE bool turn_slice(D d, const ShadingBlock<T>& block, SliceBlock<T>& slice) {
  auto most = hn::Zero(d);
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    store(d, to_world(d, block, load(d, slice.lobes.x, i), i), slice.lobes.x, i);
    store(d, to_world(d, block, load(d, slice.lobes.z, i), i), slice.lobes.z, i);
    for (size_t c = 0; c < 3; ++c) most = hn::Max(most, hn::Load(d, slice.weight[c].data() + i));
  }
  return !hn::AllTrue(d, hn::Le(most, hn::Zero(d)));
}

/// Takes off the weight of a turned slice's lobes what is hidden of each, and tells in `parts`,
/// where the options want it, what is left of it; footprints are those of start_lookups.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void hide_slice(D d, const PreparedTransfer& transfer, SpecularForm form,
                             const ShadingOptions& options, size_t terms, ShadingBlock<T>& block,
                             const BlockFootprints<T>& footprints, SliceBlock<T>& slice,
                             BlockParts<T>& parts) {
  using V = hn::VFromD<D>;
  const bool occluded = !transfer.bases.empty();
  const bool by_parts = options.highlight_lobe == HighlightLobe::visible_part;
  BlockBoundaries<T> boundaries;
  if (occluded) find_boundaries(d, transfer, block, terms, slice.lobes.z, footprints, boundaries);
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
    if (by_parts) {
      const VisiblePart<V> part =
          visible_part(d, lobe, boundary, normal, form == SpecularForm::moments);
      store(d, part.lobe, parts.lobes, i);
      hn::Store(part.third, d, parts.cuts.third.data() + i);
      store(d, normal, parts.cuts.normal, i);
    }
    for (size_t c = 0; c < 3; ++c) {
      T* weight = slice.weight[c].data() + i;
      hn::Store(hn::Mul(visible, hn::Load(d, weight)), d, weight);
    }
  }
}

/// Integrals of the environment's lobes times the slice's. It reads hardly any memory, and so is
/// the time to have other memory on its way.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void see_lobes(D d, const PreparedLights& lights, size_t count,
                            const BlockLobes<T>& lobes, Fetcher& fetcher, BlockRgb<T>& seen) {
  using V = hn::VFromD<D>;
  const size_t steps = std::max<size_t>(count / hn::Lanes(d) * lights.lobes.size(), 1);
  const size_t fetched = fetcher.waiting() / steps + 1;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const AnisotropicGaussian<V> lobe = load(d, lobes, i);
    V sum[3] = {hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (const PreparedLobe& light : lights.lobes) {
      const AnisotropicGaussian<V> other = {
          set(d, light.lobe.frame.x), set(d, light.lobe.frame.y), set(d, light.lobe.frame.z),
          hn::Set(d, light.lobe.bandwidth_x), hn::Set(d, light.lobe.bandwidth_y)};
      fetcher.fetch(fetched);
      const V product = asg_inner_product(d, other, lobe);
      for (int c = 0; c < 3; ++c) sum[c] = hn::MulAdd(hn::Set(d, light.color[c]), product, sum[c]);
    }
    for (size_t c = 0; c < 3; ++c) hn::Store(sum[c], d, seen[c].data() + i);
  }
}

/// The filtered map under the slice's lobes, or what is visible of them, where they weigh anything:
/// the integral of the product.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void see_map(D d, const PrefilteredEnvironment& environment,
                          const ShadingOptions& options, size_t count, const SliceBlock<T>& slice,
                          const BlockParts<T>& parts, BlockRgb<T>& seen) {
  const bool by_parts = options.highlight_lobe == HighlightLobe::visible_part;
  BlockArray<T> active = {};
  for (size_t i = 0; i < count; i += hn::Lanes(d))
    hn::Store(hn::Max(hn::Load(d, slice.weight[0].data() + i),
                      hn::Max(hn::Load(d, slice.weight[1].data() + i),
                              hn::Load(d, slice.weight[2].data() + i))),
              d, active.data() + i);
  eval_prefiltered(d, environment, count, by_parts ? parts.lobes : slice.lobes, active,
                   options.environment_taps, seen, by_parts ? &parts.cuts : nullptr);
  for (size_t i = 0; i < count; i += hn::Lanes(d))
    for (BlockArray<T>& channel : seen)
      hn::Store(hn::Mul(hn::Load(d, channel.data() + i), hn::Load(d, slice.integral.data() + i)), d,
                channel.data() + i);
}

/// Adds what a turned slice reflects of the distant environment, and takes off its weight what is
/// hidden.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void reflect_environment(D d, const PreparedTransfer& transfer, SpecularForm form,
                                    const Lighting& lighting, const ShadingOptions& options,
                                    size_t terms, ShadingBlock<T>& block, SliceBlock<T>& slice,
                                    BlockRgb<T>& reflected) {
  if (form == SpecularForm::peak && options.integral == AsgIntegral::fast)
    for (size_t i = 0; i < block.count; i += hn::Lanes(d))
      hn::Store(asg_integral_fast(d, hn::Load(d, slice.lobes.bandwidth_x.data() + i),
                                  hn::Load(d, slice.lobes.bandwidth_y.data() + i)),
                d, slice.integral.data() + i);
  BlockFootprints<T> footprints;
  if (!transfer.bases.empty()) start_lookups(d, transfer, block, terms, slice.lobes.z, footprints);
  BlockRgb<T> seen;
  if (!lighting.environment)
    see_lobes(d, *lighting.lights, block.count, slice.lobes, block.fetcher, seen);
  BlockParts<T> parts;
  hide_slice(d, transfer, form, options, terms, block, footprints, slice, parts);
  if (lighting.environment)
    see_map(d, *lighting.environment, options, block.count, slice, parts, seen);
  for (size_t i = 0; i < block.count; i += hn::Lanes(d))
    for (size_t c = 0; c < 3; ++c) {
      T* sum = reflected[c].data() + i;
      hn::Store(hn::MulAdd(hn::Load(d, slice.weight[c].data() + i), hn::Load(d, seen[c].data() + i),
                           hn::Load(d, sum)),
                d, sum);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
