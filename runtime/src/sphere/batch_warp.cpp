#include <algorithm>
#include <cstddef>

#include "burnish/sphere/batch.h"
#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sphere/batch_warp.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sphere/for_each-inl.h"
#include "sphere/warp-inl.h"
#include "sphere/warp_mean-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

using WarpedValues = Values<10>;

HWY_INLINE WarpedValues values(const WarpedLobe<V>& warped) {
  return {{warped.x.x, warped.x.y, warped.x.z, warped.z.x, warped.z.y, warped.z.z,
           warped.bandwidth_x, warped.bandwidth_y, warped.amplitude, warped.jacobian}};
}

/// kernel(d, frame, outgoing, more...) for every item.
template <class Kernel, class... More>
HWY_INLINE void for_each_view(const batch::Directions& x, const batch::Directions& z,
                              const batch::Directions& outgoing, const batch::WarpedLobes& results,
                              const Kernel& kernel, const More*... more) {
  float* const arrays[] = {results.x.x.data(),         results.x.y.data(),
                           results.x.z.data(),         results.z.x.data(),
                           results.z.y.data(),         results.z.z.data(),
                           results.bandwidth_x.data(), results.bandwidth_y.data(),
                           results.amplitude.data(),   results.jacobian.data()};
  for_each_several(
      results.jacobian.size(), arrays,
      [&](D d, V xx, V xy, V xz, V zx, V zy, V zz, V ox, V oy, V oz, auto... more) HWY_ATTR {
        const Vector3<V> fx = {xx, xy, xz}, fz = {zx, zy, zz};
        return values(kernel(d, Frame<V>{fx, cross(fz, fx), fz}, Vector3<V>{ox, oy, oz}, more...));
      },
      x.x.data(), x.y.data(), x.z.data(), z.x.data(), z.y.data(), z.z.data(), outgoing.x.data(),
      outgoing.y.data(), outgoing.z.data(), more...);
}

void warp_batch(float bandwidth_x, float bandwidth_y, const batch::Frames& frames,
                const batch::Directions& outgoing, const batch::WarpedLobes& results) {
  const D d;
  const V all_x = hn::Set(d, bandwidth_x), all_y = hn::Set(d, bandwidth_y);
  for_each_view(frames.x, frames.z, outgoing, results,
                [&](D d, const Frame<V>& half, const Vector3<V>& o)
                    HWY_ATTR { return warp_to_incoming(d, half, all_x, all_y, o); });
}

void warp_lobes_batch(const batch::AnisotropicGaussians& half_lobes,
                      const batch::Directions& outgoing, const batch::WarpedLobes& results) {
  for_each_view(
      half_lobes.x, half_lobes.z, outgoing, results,
      [](D d, const Frame<V>& half, const Vector3<V>& o, V bandwidth_x, V bandwidth_y, V amplitude)
          HWY_ATTR {
            WarpedLobe<V> warped = warp_to_incoming(d, half, bandwidth_x, bandwidth_y, o);
            warped.amplitude = hn::Mul(amplitude, warped.amplitude);
            return warped;
          },
      half_lobes.bandwidth_x.data(), half_lobes.bandwidth_y.data(), half_lobes.amplitude.data());
}

/// What the steps of the mean form hand on, of as many items as stay close at hand.
constexpr size_t kBlock = 256;
struct MeanWarpBlock {
  float o_x[kBlock], o_y[kBlock], o_z[kBlock], ratio[kBlock], deviation[kBlock];
  float mean[kBlock], weighted_mean[kBlock], weighted_square[kBlock], probability_over_mean[kBlock];
};

/// Items i..i + size.
void see_block(const LobeShape<V>& shape, const batch::Frames& frames,
               const batch::Directions& outgoing, size_t i, size_t size, MeanWarpBlock& block) {
  float* const arrays[] = {block.o_x, block.o_y, block.o_z, block.ratio, block.deviation};
  const batch::Directions &x = frames.x, &z = frames.z;
  for_each_several(
      size, arrays,
      [&](D d, V xx, V xy, V xz, V zx, V zy, V zz, V ox, V oy, V oz) HWY_ATTR {
        const Vector3<V> fx = {xx, xy, xz}, fz = {zx, zy, zz};
        const SeenLobe<V> seen =
            see_lobe(d, Frame<V>{fx, cross(fz, fx), fz}, shape, Vector3<V>{ox, oy, oz});
        return Values<5>{
            {seen.outgoing.x, seen.outgoing.y, seen.outgoing.z, seen.ratio, seen.deviation}};
      },
      x.x.data() + i, x.y.data() + i, x.z.data() + i, z.x.data() + i, z.y.data() + i,
      z.z.data() + i, outgoing.x.data() + i, outgoing.y.data() + i, outgoing.z.data() + i);
}

void cut_block(size_t size, MeanWarpBlock& block) {
  float* const arrays[] = {block.mean, block.weighted_mean, block.weighted_square,
                           block.probability_over_mean};
  for_each_several(
      size, arrays,
      [](D d, V ratio, V deviation) HWY_ATTR {
        const CutNormal<V> cut = cut_normal(d, ratio, deviation);
        return Values<4>{
            {cut.mean, cut.weighted_mean, cut.weighted_square, cut.probability_over_mean}};
      },
      block.ratio, block.deviation);
}

void place_block(V bandwidth_x, V bandwidth_y, const LobeShape<V>& shape,
                 const batch::Frames& frames, const batch::WarpedLobes& results, size_t i,
                 size_t size, const MeanWarpBlock& block) {
  float* const arrays[] = {results.x.x.data() + i,         results.x.y.data() + i,
                           results.x.z.data() + i,         results.z.x.data() + i,
                           results.z.y.data() + i,         results.z.z.data() + i,
                           results.bandwidth_x.data() + i, results.bandwidth_y.data() + i};
  const batch::Directions &x = frames.x, &z = frames.z;
  for_each_several(
      size, arrays,
      [&](D d, V xx, V xy, V xz, V zx, V zy, V zz, V ox, V oy, V oz, V weighted_mean,
          V weighted_square, V probability_over_mean) HWY_ATTR {
        const Vector3<V> fx = {xx, xy, xz}, fz = {zx, zy, zz};
        const CutNormal<V> cut = {hn::Zero(d), weighted_mean, weighted_square,
                                  probability_over_mean};
        const WarpedLobe<V> w = place_lobe(d, Frame<V>{fx, cross(fz, fx), fz}, bandwidth_x,
                                           bandwidth_y, shape, Vector3<V>{ox, oy, oz}, cut);
        return Values<8>{{w.x.x, w.x.y, w.x.z, w.z.x, w.z.y, w.z.z, w.bandwidth_x, w.bandwidth_y}};
      },
      x.x.data() + i, x.y.data() + i, x.z.data() + i, z.x.data() + i, z.y.data() + i,
      z.z.data() + i, block.o_x, block.o_y, block.o_z, block.weighted_mean, block.weighted_square,
      block.probability_over_mean);
}

/// Last: it reads what the others have written, and may write over what they read.
void mass_block(V half_integral, const batch::WarpedLobes& results, size_t i, size_t size,
                const MeanWarpBlock& block) {
  float* const arrays[] = {results.amplitude.data() + i, results.jacobian.data() + i};
  for_each_several(
      size, arrays,
      [&](D d, V warped_x, V warped_y, V mean) HWY_ATTR {
        const V jacobian = hn::Mul(hn::Set(d, 4.0f), mean);
        return Values<2>{
            {mean_amplitude(d, half_integral, warped_x, warped_y, jacobian), jacobian}};
      },
      results.bandwidth_x.data() + i, results.bandwidth_y.data() + i, block.mean);
}

void warp_mean_batch(float bandwidth_x, float bandwidth_y,
                     const burnish::LobeShape<float>& half_shape, const batch::Frames& frames,
                     const batch::Directions& outgoing, const batch::WarpedLobes& results) {
  const D d;
  const V all_x = hn::Set(d, bandwidth_x), all_y = hn::Set(d, bandwidth_y);
  const auto& m = half_shape.moments;
  const LobeShape<V> shape = {hn::Set(d, half_shape.integral),
                              hn::Set(d, m.mean_z),
                              hn::Set(d, m.mean_xx),
                              hn::Set(d, m.mean_yy),
                              hn::Set(d, m.variance_z),
                              hn::Set(d, m.mean_xxz),
                              hn::Set(d, m.mean_yyz),
                              hn::Set(d, m.mean_zzz),
                              hn::Set(d, 1 / half_shape.in_plane_cosine)};
  MeanWarpBlock block;
  for (size_t i = 0; i < results.jacobian.size(); i += kBlock) {
    const size_t size = std::min(kBlock, results.jacobian.size() - i);
    see_block(shape, frames, outgoing, i, size, block);
    cut_block(size, block);
    place_block(all_x, all_y, shape, frames, results, i, size, block);
    mass_block(shape.integral, results, i, size, block);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(warp_batch);
HWY_EXPORT(warp_lobes_batch);
HWY_EXPORT(warp_mean_batch);

namespace batch {

void warp_to_incoming(float bandwidth_x, float bandwidth_y, const Frames& half_frames,
                      const Directions& outgoing, const WarpedLobes& results) noexcept {
  HWY_DYNAMIC_DISPATCH(warp_batch)(bandwidth_x, bandwidth_y, half_frames, outgoing, results);
}

void warp_to_incoming(const AnisotropicGaussians& half_lobes, const Directions& outgoing,
                      const WarpedLobes& results) noexcept {
  HWY_DYNAMIC_DISPATCH(warp_lobes_batch)(half_lobes, outgoing, results);
}

void warp_mean_to_incoming(float bandwidth_x, float bandwidth_y, const LobeShape<float>& shape,
                           const Frames& half_frames, const Directions& outgoing,
                           const WarpedLobes& results) noexcept {
  HWY_DYNAMIC_DISPATCH(warp_mean_batch)
  (bandwidth_x, bandwidth_y, shape, half_frames, outgoing, results);
}

}  // namespace batch
}  // namespace burnish
#endif
