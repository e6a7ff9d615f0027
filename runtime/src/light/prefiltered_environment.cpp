#include "burnish/light/prefiltered_environment.h"

#include <algorithm>
#include <cstring>

#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "light/prefiltered_environment.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "light/prefiltered-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

void eval_prefiltered_block(const PrefilteredEnvironment& environment, size_t count,
                            const BlockLobes<float>& lobes, const BlockArray<float>& active,
                            int max_taps, BlockRgb<float>& result) {
  eval_prefiltered(hn::ScalableTag<float>(), environment, count, lobes, active, max_taps, result);
}

/// In all lanes of the shortest vector.
void eval_prefiltered_one(const PrefilteredEnvironment& environment,
                          const burnish::AnisotropicGaussian<float>& lobe, int max_taps,
                          Rgb& result) {
  const hn::CappedTag<float, 4> d;
  BlockLobes<float> lobes;
  BlockArray<float> active;
  BlockRgb<float> results;
  const auto set = [&](BlockArray<float>& array, float value)
                       HWY_ATTR { hn::Store(hn::Set(d, value), d, array.data()); };
  const auto set_vector = [&](BlockVector3<float>& vectors, const Vector3f& v) HWY_ATTR {
    set(vectors.x, v.x());
    set(vectors.y, v.y());
    set(vectors.z, v.z());
  };
  set_vector(lobes.x, lobe.frame.x);
  set_vector(lobes.z, lobe.frame.z);
  set(lobes.bandwidth_x, lobe.bandwidth_x);
  set(lobes.bandwidth_y, lobe.bandwidth_y);
  set(active, 1);
  eval_prefiltered(d, environment, 1, lobes, active, max_taps, results);
  result = Rgb(results[0][0], results[1][0], results[2][0]);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(eval_prefiltered_block);
HWY_EXPORT(eval_prefiltered_one);

Rgb eval_prefiltered(const PrefilteredEnvironment& environment,
                     const AnisotropicGaussian<float>& lobe, int max_taps) noexcept {
  Rgb result;
  HWY_DYNAMIC_DISPATCH(eval_prefiltered_one)(environment, lobe, max_taps, result);
  return result;
}

namespace batch {

void eval_prefiltered(const PrefilteredEnvironment& environment, const AnisotropicGaussians& lobes,
                      int max_taps, const RgbResults& results) noexcept {
  const size_t size = results.red.size();
  BlockLobes<float> block;
  BlockArray<float> active;
  BlockRgb<float> seen;
  std::fill_n(active.data(), kBlock, 1.0f);
  for (size_t first = 0; first < size; first += kBlock) {
    const size_t count = std::min(size - first, kBlock);
    // Of the last, incomplete block, the rest is a lobe again.
    const auto load = [&](std::span<const float> array, BlockArray<float>& lanes) {
      std::copy_n(array.data() + first, count, lanes.data());
      std::fill(lanes.data() + count, lanes.data() + kBlock, array[first]);
    };
    load(lobes.x.x, block.x.x);
    load(lobes.x.y, block.x.y);
    load(lobes.x.z, block.x.z);
    load(lobes.z.x, block.z.x);
    load(lobes.z.y, block.z.y);
    load(lobes.z.z, block.z.z);
    load(lobes.bandwidth_x, block.bandwidth_x);
    load(lobes.bandwidth_y, block.bandwidth_y);
    HWY_DYNAMIC_DISPATCH(eval_prefiltered_block)(environment, count, block, active, max_taps, seen);
    const std::span<float> channels[3] = {results.red, results.green, results.blue};
    for (size_t c = 0; c < 3; ++c) std::copy_n(seen[c].data(), count, channels[c].data() + first);
  }
}

}  // namespace batch
}  // namespace burnish
#endif
