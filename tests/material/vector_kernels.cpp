#include "material/vector_kernels.h"

#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "material/vector_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "material/specular_slice-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

using Tag = hn::ScalableTag<float>;
using Vec = hn::VFromD<Tag>;

Vector3<Vec> load(const BlockVector3<float>& v, size_t i) {
  const Tag d;
  return {hn::Load(d, v.x.data() + i), hn::Load(d, v.y.data() + i), hn::Load(d, v.z.data() + i)};
}

void smooth_factor_batch(const Material& material, const BlockVector3<float>& outgoing,
                         const BlockVector3<float>& incoming, BlockRgb<float>& result) {
  const Tag d;
  const BrdfNumbers n = internal::brdf_numbers(material);
  for (size_t k = 0; k < kBlock; k += hn::Lanes(d)) {
    const Vector3<Vec> o = load(outgoing, k), i = load(incoming, k);
    const Vector3<Vec> sum = {o.x + i.x, o.y + i.y, o.z + i.z};
    const Vec cos_difference = hn::Set(d, 0.5f) * hn::Sqrt(dot(sum, sum));
    Vec factor = hn::Set(d, n.scale);
    with_kind(n.kind, [&](auto kind) HWY_ATTR {
      const auto view = view_brdf<decltype(kind)::value>(d, n, o);
      const auto m = smooth_factor<decltype(kind)::value>(d, n, view, i, cos_difference);
      factor = factor * m.over / m.under;
    });
    const RgbVector<Vec> color = eval_color(d, n, cos_difference);
    for (size_t channel = 0; channel < 3; ++channel)
      hn::Store(color[channel] * factor * hn::Set(d, n.specular[static_cast<int>(channel)]), d,
                result[channel].data() + k);
  }
}

void distribution_batch(const Material& material, const BlockVector3<float>& half,
                        BlockArray<float>& result) {
  const Tag d;
  const BrdfNumbers n = internal::brdf_numbers(material);
  for (size_t k = 0; k < kBlock; k += hn::Lanes(d))
    with_kind(n.kind, [&](auto kind) HWY_ATTR {
      if constexpr (decltype(kind)::value != BrdfKind::fitted) {
        const auto value = distribution<decltype(kind)::value>(d, n, load(half, k));
        hn::Store(exp(d, value.exponent) * value.factor.over / value.factor.under, d,
                  result.data() + k);
      }
    });
}

void slice_float(const PreparedMaterial& prepared, int tooth, const BlockVector3<float>& outgoing,
                 SliceBlock<float>& result) {
  slice_tooth(Tag(), prepared, tooth, kBlock, outgoing, result);
}

void slice_double(const PreparedMaterial& prepared, int tooth, const BlockVector3<double>& outgoing,
                  SliceBlock<double>& result) {
  slice_tooth(hn::ScalableTag<double>(), prepared, tooth, kBlock, outgoing, result);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(smooth_factor_batch);
HWY_EXPORT(distribution_batch);
HWY_EXPORT(slice_float);
HWY_EXPORT(slice_double);

namespace test {

void vector_smooth_factor(const Material& material, const BlockVector3<float>& outgoing,
                          const BlockVector3<float>& incoming, BlockRgb<float>& result) {
  HWY_DYNAMIC_DISPATCH(smooth_factor_batch)(material, outgoing, incoming, result);
}

void vector_distribution(const Material& material, const BlockVector3<float>& half,
                         BlockArray<float>& result) {
  HWY_DYNAMIC_DISPATCH(distribution_batch)(material, half, result);
}

void slice_in_float(const PreparedMaterial& prepared, int tooth,
                    const BlockVector3<float>& outgoing, SliceBlock<float>& result) {
  HWY_DYNAMIC_DISPATCH(slice_float)(prepared, tooth, outgoing, result);
}

void slice_in_double(const PreparedMaterial& prepared, int tooth,
                     const BlockVector3<double>& outgoing, SliceBlock<double>& result) {
  HWY_DYNAMIC_DISPATCH(slice_double)(prepared, tooth, outgoing, result);
}

}  // namespace test
}  // namespace burnish
#endif
