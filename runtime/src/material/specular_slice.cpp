#include "burnish/material/specular_slice.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/lobe_moments.h"
#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "material/specular_slice.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "material/specular_slice-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

using Tag = hn::ScalableTag<float>;

void slice_batch(const PreparedMaterial& prepared, int tooth, const batch::Directions& outgoing,
                 const SpecularSlices& results) {
  BlockVector3<float> block;
  SliceBlock<float> slice;
  const BrdfNumbers numbers = internal::brdf_numbers(prepared.material);
  const size_t size = outgoing.x.size();
  for (size_t first = 0; first < size; first += kBlock) {
    const size_t count = std::min(kBlock, size - first);
    const auto load = [&](std::span<const float> from, BlockArray<float>& to) {
      std::copy_n(from.data() + first, count, to.data());
      std::fill(to.data() + count, to.data() + kBlock, from[first]);
    };
    const auto store = [&](const BlockArray<float>& from, std::span<float> to) {
      std::copy_n(from.data(), count, to.data() + first);
    };
    load(outgoing.x, block.x);
    load(outgoing.y, block.y);
    load(outgoing.z, block.z);
    slice_tooth(Tag(), prepared, numbers, tooth, count, block, slice);
    store(slice.lobes.x.x, results.x.x);
    store(slice.lobes.x.y, results.x.y);
    store(slice.lobes.x.z, results.x.z);
    store(slice.lobes.z.x, results.z.x);
    store(slice.lobes.z.y, results.z.y);
    store(slice.lobes.z.z, results.z.z);
    store(slice.lobes.bandwidth_x, results.bandwidth_x);
    store(slice.lobes.bandwidth_y, results.bandwidth_y);
    store(slice.integral, results.integral);
    for (size_t channel = 0; channel < 3; ++channel)
      store(slice.weight[channel], results.weight[channel]);
  }
}

Vector3f first_of(const BlockVector3<float>& v) { return {v.x[0], v.y[0], v.z[0]}; }

/// All teeth of one view, which fills the lanes.
int slice_point(const PreparedMaterial& prepared, const Vector3f& outgoing, SliceLobe* slice) {
  BlockVector3<float> block;
  std::fill_n(block.x.data(), kBlock, outgoing.x());
  std::fill_n(block.y.data(), kBlock, outgoing.y());
  std::fill_n(block.z.data(), kBlock, outgoing.z());
  SliceBlock<float> lobes;
  const BrdfNumbers numbers = internal::brdf_numbers(prepared.material);
  int count = 0;
  for (int k = 0; k < prepared.count; ++k) {
    slice_tooth(Tag(), prepared, numbers, k, 1, block, lobes);
    const Rgb weight(lobes.weight[0][0], lobes.weight[1][0], lobes.weight[2][0]);
    if (!(weight > 0).any()) continue;
    SliceLobe& part = slice[count++];
    const Vector3f x = first_of(lobes.lobes.x), z = first_of(lobes.lobes.z);
    part.lobe.frame = {x, z.cross(x), z};
    part.lobe.bandwidth_x = lobes.lobes.bandwidth_x[0];
    part.lobe.bandwidth_y = lobes.lobes.bandwidth_y[0];
    part.lobe.amplitude = 1;
    part.integral = lobes.integral[0];
    part.weight = weight;
  }
  return count;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {
namespace {

/// A lobe bends by about the square of its longer deviation, in radians. Below this much of the
/// shorter one it is left whole: teeth would only add their ripple.
constexpr float kStraight = 0.04f;
/// Lobes rounder than this ratio of deviations, and wider than this one, are cut in both
/// directions where the number of teeth is a square.
constexpr float kRound = 1.5f, kWideInBoth = 0.15f;

float deviation(float bandwidth) { return 1 / std::sqrt(2 * bandwidth + 1); }

SpecularTooth make_tooth(const AnisotropicGaussian<float>& lobe) {
  const auto moments = asg_second_moments(lobe.bandwidth_x, lobe.bandwidth_y);
  return {lobe, lobe.amplitude * moments.integral, moments.mean_xx, moments.mean_yy};
}

/// Calls add(tooth) for each of `count` parts along a lobe's long axis.
template <class Add>
void cut(const AnisotropicGaussian<float>& lobe, int count, const Add& add) {
  const LobeComb<float> comb = make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, count);
  for (int k = 0; k < count; ++k) add(comb_tooth(comb, lobe, k));
}

void add_teeth(const AnisotropicGaussian<float>& lobe, int taps, PreparedMaterial& prepared) {
  const float wide = deviation(std::min(lobe.bandwidth_x, lobe.bandwidth_y));
  const float narrow = deviation(std::max(lobe.bandwidth_x, lobe.bandwidth_y));
  if (wide * wide < kStraight * narrow) taps = 1;
  const int edge = static_cast<int>(std::lround(std::sqrt(static_cast<float>(taps))));
  const bool both = edge * edge == taps && wide < kRound * narrow && narrow > kWideInBoth;
  const auto add = [&](const AnisotropicGaussian<float>& tooth) {
    prepared.tooth[static_cast<size_t>(prepared.count++)] = make_tooth(tooth);
  };
  if (!both) return cut(lobe, taps, add);
  // A tooth is longer across the first cut.
  cut(lobe, edge, [&](const AnisotropicGaussian<float>& tooth) { cut(tooth, edge, add); });
}

/// D(h) of Ward's and Ashikhmin's models as xu2013asg take it, section 5.2. The paper fits others.
HalfVectorLobes paper_lobes(const Material& material, int max_lobes) {
  if (material.model != SpecularModel::ward && material.model != SpecularModel::ashikhmin_shirley)
    return half_vector_lobes(material, max_lobes);
  HalfVectorLobes lobes;
  lobes.count = 1;
  lobes.lobe[0].bandwidth_x = 1 / (material.alpha_x * material.alpha_x);
  lobes.lobe[0].bandwidth_y = 1 / (material.alpha_y * material.alpha_y);
  return lobes;
}

}  // namespace

PreparedMaterial prepare_material(const Material& material,
                                  const SpecularOptions& options) noexcept {
  PreparedMaterial prepared;
  prepared.material = material;
  prepared.form = options.form;
  if (!material.has_specular()) return prepared;
  prepared.lobes = options.form == SpecularForm::peak ? paper_lobes(material, options.lobes)
                                                      : half_vector_lobes(material, options.lobes);
  const bool has_tail =
      material.model == SpecularModel::cook_torrance && material.distribution == Distribution::ggx;
  prepared.corrects_distribution =
      material.model != SpecularModel::fitted && (!has_tail || options.lobes >= kTailLobes);
  for (int k = 0; k < prepared.lobes.count; ++k)
    add_teeth(prepared.lobes.lobe[static_cast<size_t>(k)], std::clamp(options.taps, 1, kMaxTaps),
              prepared);
  return prepared;
}

HWY_EXPORT(slice_batch);
HWY_EXPORT(slice_point);

int specular_slice(const PreparedMaterial& prepared, const Vector3f& outgoing,
                   std::span<SliceLobe, kMaxSpecularTeeth> slice) noexcept {
  if (outgoing.z() <= 0) return 0;
  return HWY_DYNAMIC_DISPATCH(slice_point)(prepared, outgoing, slice.data());
}

void specular_slices(const PreparedMaterial& prepared, int tooth, const batch::Directions& outgoing,
                     const SpecularSlices& results) noexcept {
  HWY_DYNAMIC_DISPATCH(slice_batch)(prepared, tooth, outgoing, results);
}

}  // namespace burnish
#endif
