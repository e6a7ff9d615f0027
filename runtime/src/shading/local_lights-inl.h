// Lights that have a place in the world, and directional ones: a lobe for each point, one a lane.

#if defined(BURNISH_SHADING_LOCAL_LIGHTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SHADING_LOCAL_LIGHTS_INL_H_
#undef BURNISH_SHADING_LOCAL_LIGHTS_INL_H_
#else
#define BURNISH_SHADING_LOCAL_LIGHTS_INL_H_
#endif

#include <hwy/highway.h>

#include "burnish/light/local_lights.h"
#include "shading/diffuse-inl.h"
#include "shading/ladder_share.h"
#include "shading/specular-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// LightAtPoint of the points of a block; no light where a point does not see it.
template <class T>
struct BlockLight {
  BlockLobes<T> lobes;
  BlockArray<T> integral, cosine_integral;
  BlockRgb<T> color, radiance;
};

template <class T>
void store(const Vector3f& v, size_t i, BlockVector3<T>& vectors) {
  vectors.x[i] = v.x();
  vectors.y[i] = v.y();
  vectors.z[i] = v.z();
}

template <class T>
Vector3f vector_of(const BlockVector3<T>& vectors, size_t i) {
  return {static_cast<float>(vectors.x[i]), static_cast<float>(vectors.y[i]),
          static_cast<float>(vectors.z[i])};
}

/// False if no point sees it.
template <class T, class Light>
bool find_light(const Light& source, const ShadingBlock<T>& block, BlockLight<T>& light) {
  bool reaches = false;
  for (size_t i = 0; i < kBlock; ++i) {
    LightAtPoint at;
    if (i < block.count) at = light_at(source, block.position[i], vector_of(block.normal, i));
    if (!at.reaches) at = {};
    reaches |= at.reaches;
    store(at.lobe.frame.x, i, light.lobes.x);
    store(at.lobe.frame.z, i, light.lobes.z);
    light.lobes.bandwidth_x[i] = at.lobe.bandwidth_x;
    light.lobes.bandwidth_y[i] = at.lobe.bandwidth_y;
    light.integral[i] = at.integral;
    light.cosine_integral[i] = at.cosine_integral;
    for (int c = 0; c < 3; ++c) {
      light.color[static_cast<size_t>(c)][i] = at.color[c];
      light.radiance[static_cast<size_t>(c)][i] = at.radiance[c];
    }
  }
  return reaches;
}

template <class D, class V, class T>
HWY_INLINE void add_light(D d, const BlockRgb<T>& color, V amount, size_t i, BlockRgb<T>& sum) {
  for (size_t c = 0; c < 3; ++c) {
    T* channel = sum[c].data() + i;
    hn::Store(hn::MulAdd(hn::Load(d, color[c].data() + i), amount, hn::Load(d, channel)), d,
              channel);
  }
}

template <class T>
burnish::AnisotropicGaussian<float> lobe_of(const BlockLobes<T>& lobes, size_t i) {
  burnish::AnisotropicGaussian<float> lobe;
  lobe.frame.x = vector_of(lobes.x, i);
  lobe.frame.z = vector_of(lobes.z, i);
  lobe.frame.y = lobe.frame.z.cross(lobe.frame.x);
  lobe.bandwidth_x = static_cast<float>(lobes.bandwidth_x[i]);
  lobe.bandwidth_y = static_cast<float>(lobes.bandwidth_y[i]);
  return lobe;
}

/// The fraction of a lobe that a point of the block sees, by the ladder.
template <class T>
float seen_by_ladder(const PreparedTransfer& transfer, const ShadingBlock<T>& block, size_t point,
                     const burnish::AnisotropicGaussian<float>& lit) {
  float seen = 0, coefficients[kMaxTerms];
  for (size_t r = 0; r < block.row_count; ++r) {
    const VisibilityRow<T>& row = block.row[r];
    if (row.point != point) continue;
    std::copy_n(row.ladder, transfer.ladder_terms, coefficients);
    const auto& ladder = transfer.ladders[static_cast<size_t>(transfer.ladder_of(row.basis))];
    seen += static_cast<float>(row.weight) *
            burnish::seen_by_ladder(ladder.harmonics, coefficients, lit);
  }
  return seen;
}

/// Where the ladder tells more of a lobe than the SSDF, it has its part of the share.
template <class T>
void mix_ladder_shares(const PreparedTransfer& transfer, const ShadingBlock<T>& block,
                       const BlockLobes<T>& lit, const BlockArray<T>& used, BlockArray<T>& share) {
  for (size_t i = 0; i < block.count; ++i) {
    if (!(used[i] > 0)) continue;
    const burnish::AnisotropicGaussian<float> lobe = lobe_of(lit, i);
    const float weight = ladder_weight(ladder_bandwidth(lobe), transfer.ladder_crossover);
    if (!(weight > 0)) continue;
    const float seen = seen_by_ladder(transfer, block, i, lobe);
    const float above = above_horizon(vector_of(block.normal, i), lobe);
    const T by_ladder = seen < above ? seen / above : 1;
    share[i] += static_cast<T>(weight) * (by_ladder - share[i]);
  }
}

template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void add_light_irradiance(D d, const PreparedTransfer& transfer,
                                       const ShadingOptions& options, size_t terms,
                                       ShadingBlock<T>& block, const BlockLight<T>& light,
                                       BlockRgb<T>& irradiance) {
  using V = hn::VFromD<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const bool constant = options.cosine == CosineModel::constant;
  const bool occluded = !transfer.bases.empty();
  BlockLobes<T> lit = light.lobes;
  if (!constant && occluded)
    for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
      const AnisotropicGaussian<V> lobe = load(d, light.lobes, i);
      const Vector3<V> normal = load(d, block.normal, i);
      const AnisotropicGaussian<V> local = lobe_times_cosine(
          d, lobe.bandwidth_x, lobe.bandwidth_y,
          Vector3<V>{dot(normal, lobe.x), dot(normal, lobe.y), dot(normal, lobe.z)});
      const Frame<V> frame = {lobe.x, lobe.y, lobe.z};
      store(d, to_world(frame, local.x), lit.x, i);
      store(d, to_world(frame, local.z), lit.z, i);
      hn::Store(local.bandwidth_x, d, lit.bandwidth_x.data() + i);
      hn::Store(local.bandwidth_y, d, lit.bandwidth_y.data() + i);
    }
  BlockBoundaries<T> boundaries;
  if (occluded) {
    BlockFootprints<T> footprints;
    start_lookups(d, transfer, block, terms, lit.z, footprints);
    find_boundaries(d, transfer, block, terms, lit.z, footprints, boundaries);
  }
  BlockArray<T> share;
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    const AnisotropicGaussian<V> lobe = load(d, lit, i);
    const Vector3<V> normal = load(d, block.normal, i);
    Boundary<V> boundary = horizon(d, normal, lobe.z);
    if (occluded)
      boundary = {hn::Load(d, boundaries.sine.data() + i), load(d, boundaries.gradient, i)};
    V visible = one;
    if (constant)
      visible = visible_fraction(d, options.visibility, lobe, boundary);
    else if (occluded)
      visible = visible_share(d, options.visibility, lobe, boundary, normal);
    hn::Store(visible, d, share.data() + i);
  }
  const bool ladder = !constant && options.ladder && !transfer.ladders.empty();
  if (ladder) mix_ladder_shares(transfer, block, lit, light.cosine_integral, share);
  for (size_t i = 0; i < block.count; i += hn::Lanes(d)) {
    V unshadowed = hn::Load(d, light.cosine_integral.data() + i);
    if (constant)
      unshadowed = hn::Mul(hn::Max(dot(load(d, block.normal, i), load(d, light.lobes.z, i)), zero),
                           hn::Load(d, light.integral.data() + i));
    add_light(d, light.color, hn::Mul(unshadowed, hn::Load(d, share.data() + i)), i, irradiance);
  }
}

/// The Gaussian is brighter than the light at its middle, but no lobe sees more than the light's
/// own radiance.
template <class D, class T = hn::TFromD<D>>
HWY_NOINLINE void reflect_light(D d, size_t count, const BlockLight<T>& light,
                                const SliceBlock<T>& slice, BlockRgb<T>& reflected) {
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto product = asg_inner_product(d, load(d, light.lobes, i), load(d, slice.lobes, i));
    const auto integral = hn::Load(d, slice.integral.data() + i);
    for (size_t c = 0; c < 3; ++c) {
      const auto seen = hn::Min(hn::Mul(hn::Load(d, light.color[c].data() + i), product),
                                hn::Mul(hn::Load(d, light.radiance[c].data() + i), integral));
      T* sum = reflected[c].data() + i;
      hn::Store(hn::MulAdd(hn::Load(d, slice.weight[c].data() + i), seen, hn::Load(d, sum)), d,
                sum);
    }
  }
}

/// Lights of one kind: to the irradiance, if `diffuse`, and to what placed slices reflect.
template <class D, class Light, class T = hn::TFromD<D>>
HWY_INLINE void add_lights(D d, const std::vector<Light>& sources, const PreparedTransfer& transfer,
                           const ShadingOptions& options, size_t terms, ShadingBlock<T>& block,
                           bool diffuse, const SliceBlock<T>* slices, size_t slice_count,
                           BlockRgb<T>& irradiance, BlockRgb<T>& reflected) {
  BlockLight<T> light;
  for (const Light& source : sources) {
    if (!find_light(source, block, light)) continue;
    if (diffuse) add_light_irradiance(d, transfer, options, terms, block, light, irradiance);
    for (size_t k = 0; k < slice_count; ++k)
      reflect_light(d, block.count, light, slices[k], reflected);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
