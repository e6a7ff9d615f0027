#include <algorithm>
#include <cmath>
#include <cstddef>

#include "burnish/sphere/batch.h"
#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sphere/batch_lobes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sphere/for_each-inl.h"
#include "sphere/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

Vector3<V> set(D d, const float* v) {
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

/// axis: three floats.
void sg_eval_batch(const float* axis, float sharpness, float amplitude, size_t size, const float* x,
                   const float* y, const float* z, float* results) {
  const D d;
  const Vector3<V> p = set(d, axis);
  const V half_sharpness = hn::Set(d, sharpness / 2), scale = hn::Set(d, amplitude);
  for_each(
      size, results,
      [&](D d, V x, V y, V z) HWY_ATTR {
        return hn::Mul(scale, sg_eval(d, p, half_sharpness, {x, y, z}));
      },
      x, y, z);
}

/// frame: x, y and z axis; x and y scaled by the roots of the bandwidths.
void asg_eval_batch(const float* frame, float amplitude, size_t size, const float* x,
                    const float* y, const float* z, float* results) {
  const D d;
  const Vector3<V> fx = set(d, frame), fy = set(d, frame + 3), fz = set(d, frame + 6);
  const V scale = hn::Set(d, amplitude);
  for_each(
      size, results,
      [&](D d, V x, V y, V z) HWY_ATTR {
        const Vector3<V> v = {x, y, z};
        return hn::Mul(scale, asg_eval(d, dot(v, fx), dot(v, fy), dot(v, fz)));
      },
      x, y, z);
}

void asg_eval_pairs_batch(const batch::AnisotropicGaussians& lobes,
                          const batch::Directions& directions, size_t size, float* results) {
  for_each(
      size, results,
      [](D d, V xx, V xy, V xz, V zx, V zy, V zz, V bandwidth_x, V bandwidth_y, V amplitude, V x,
         V y, V z) HWY_ATTR {
        const Vector3<V> fx = {xx, xy, xz}, fz = {zx, zy, zz}, v = {x, y, z};
        const V along_x = hn::Mul(dot(v, fx), hn::Sqrt(bandwidth_x));
        const V along_y = hn::Mul(dot(v, cross(fz, fx)), hn::Sqrt(bandwidth_y));
        return hn::Mul(amplitude, asg_eval(d, along_x, along_y, dot(v, fz)));
      },
      lobes.x.x.data(), lobes.x.y.data(), lobes.x.z.data(), lobes.z.x.data(), lobes.z.y.data(),
      lobes.z.z.data(), lobes.bandwidth_x.data(), lobes.bandwidth_y.data(), lobes.amplitude.data(),
      directions.x.data(), directions.y.data(), directions.z.data());
}

void sg_inner_product_batch(const float* axis, float sharpness, float amplitude,
                            const batch::SphericalGaussians& others, size_t size, float* results) {
  const D d;
  const Vector3<V> p = set(d, axis);
  const V width = hn::Set(d, sharpness), scale = hn::Set(d, amplitude);
  for_each(
      size, results,
      [&](D d, V x, V y, V z, V other_width, V other_scale) HWY_ATTR {
        const V value = sg_inner_product(d, p, width, {x, y, z}, other_width);
        return hn::Mul(scale, hn::Mul(other_scale, value));
      },
      others.axis.x.data(), others.axis.y.data(), others.axis.z.data(), others.sharpness.data(),
      others.amplitude.data());
}

void asg_inner_product_batch(const float* frame, float bandwidth_x, float bandwidth_y,
                             float amplitude, const batch::AnisotropicGaussians& others,
                             size_t size, float* results) {
  const D d;
  const AnisotropicGaussian<V> a = {set(d, frame), set(d, frame + 3), set(d, frame + 6),
                                    hn::Set(d, bandwidth_x), hn::Set(d, bandwidth_y)};
  const V scale = hn::Set(d, amplitude);
  for_each(
      size, results,
      [&](D d, V xx, V xy, V xz, V zx, V zy, V zz, V bandwidth_x, V bandwidth_y, V other_scale)
          HWY_ATTR {
            const Vector3<V> x = {xx, xy, xz}, z = {zx, zy, zz};
            const AnisotropicGaussian<V> b = {x, cross(z, x), z, bandwidth_x, bandwidth_y};
            return hn::Mul(scale, hn::Mul(other_scale, asg_inner_product(d, a, b)));
          },
      others.x.x.data(), others.x.y.data(), others.x.z.data(), others.z.x.data(), others.z.y.data(),
      others.z.z.data(), others.bandwidth_x.data(), others.bandwidth_y.data(),
      others.amplitude.data());
}

void dot_batch(const float* vector, size_t size, const float* x, const float* y, const float* z,
               float* results) {
  const D d;
  const Vector3<V> w = set(d, vector);
  for_each(
      size, results,
      [&](D, V x, V y, V z) HWY_ATTR {
        return dot(w, Vector3<V>{x, y, z});
      },
      x, y, z);
}

/// frame: as of asg_eval_batch, not scaled.
void mean_clamped_cosine_batch(const burnish::LobeMoments<float>& moments, const float* frame,
                               size_t size, const float* x, const float* y, const float* z,
                               float* results) {
  const D d;
  const auto all = [&](float value) HWY_ATTR { return hn::Set(d, value); };
  const LobeMoments<V> m = {all(moments.mean_z),     all(moments.mean_xx),   all(moments.mean_yy),
                            all(moments.variance_z), all(moments.mean_xxz),  all(moments.mean_yyz),
                            all(moments.mean_zzz),   all(moments.mean_xxxx), all(moments.mean_yyyy),
                            all(moments.mean_zzzz),  all(moments.mean_xxyy), all(moments.mean_xxzz),
                            all(moments.mean_yyzz)};
  const Vector3<V> fx = set(d, frame), fy = set(d, frame + 3), fz = set(d, frame + 6);
  for_each(
      size, results,
      [&](D d, V x, V y, V z) HWY_ATTR {
        const Vector3<V> n = {x, y, z};
        return mean_clamped_cosine(d, m, Vector3<V>{dot(n, fx), dot(n, fy), dot(n, fz)});
      },
      x, y, z);
}

void clamped_cosine_integral_batch(const burnish::PreparedClampedCosine<float>& prepared,
                                   size_t size, const float* x, const float* y, const float* z,
                                   float* results) {
  const D d;
  const PreparedClampedCosine<V> lobe = {hn::Set(d, prepared.slope),  hn::Set(d, prepared.bump),
                                         hn::Set(d, prepared.spread), hn::Set(d, prepared.end),
                                         hn::Set(d, prepared.behind), hn::Set(d, prepared.mean)};
  const Vector3<V> axis = set(d, prepared.axis.data());
  for_each(
      size, results,
      [&](D d, V x, V y, V z) HWY_ATTR {
        return clamped_cosine_integral(d, lobe, dot(axis, Vector3<V>{x, y, z}));
      },
      x, y, z);
}

void octahedral_batch(size_t size, const float* x, const float* y, const float* z, float* u,
                      float* v) {
  float* const results[] = {u, v};
  for_each_several(
      size, results,
      [](D d, V x, V y, V z) HWY_ATTR {
        const Vector2<V> point = direction_to_octahedral(d, Vector3<V>{x, y, z});
        return Values<2>{{point.x, point.y}};
      },
      x, y, z);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(sg_eval_batch);
HWY_EXPORT(asg_eval_batch);
HWY_EXPORT(asg_eval_pairs_batch);
HWY_EXPORT(sg_inner_product_batch);
HWY_EXPORT(asg_inner_product_batch);
HWY_EXPORT(dot_batch);
HWY_EXPORT(mean_clamped_cosine_batch);
HWY_EXPORT(clamped_cosine_integral_batch);
HWY_EXPORT(octahedral_batch);

namespace batch {
namespace {

/// x, y and z of a frame, one after another.
struct FrameArray {
  explicit FrameArray(const Frame<float>& frame, float scale_x = 1, float scale_y = 1) {
    for (int i = 0; i < 3; ++i) {
      axes[i] = scale_x * frame.x[i];
      axes[3 + i] = scale_y * frame.y[i];
      axes[6 + i] = frame.z[i];
    }
  }
  float axes[9];
};

}  // namespace

void eval(const SphericalGaussian<float>& lobe, const Directions& directions,
          std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(sg_eval_batch)
  (lobe.axis.data(), lobe.sharpness, lobe.amplitude, results.size(), directions.x.data(),
   directions.y.data(), directions.z.data(), results.data());
}

void eval(const AnisotropicGaussian<float>& lobe, const Directions& directions,
          std::span<float> results) noexcept {
  const FrameArray frame(lobe.frame, std::sqrt(lobe.bandwidth_x), std::sqrt(lobe.bandwidth_y));
  HWY_DYNAMIC_DISPATCH(asg_eval_batch)
  (frame.axes, lobe.amplitude, results.size(), directions.x.data(), directions.y.data(),
   directions.z.data(), results.data());
}

namespace {

/// Row by row, in blocks of directions that stay in the first-level cache.
template <class Lobe>
void eval_all(std::span<const Lobe> lobes, const Directions& directions,
              std::span<float> results) noexcept {
  constexpr size_t kBlock = 1024;
  const size_t size = directions.x.size();
  for (size_t first = 0; first < size; first += kBlock) {
    const size_t count = std::min(kBlock, size - first);
    const Directions block = {directions.x.subspan(first, count),
                              directions.y.subspan(first, count),
                              directions.z.subspan(first, count)};
    for (size_t l = 0; l < lobes.size(); ++l)
      eval(lobes[l], block, results.subspan(l * size + first, count));
  }
}

}  // namespace

void eval(std::span<const SphericalGaussian<float>> lobes, const Directions& directions,
          std::span<float> results) noexcept {
  eval_all(lobes, directions, results);
}

void eval(std::span<const AnisotropicGaussian<float>> lobes, const Directions& directions,
          std::span<float> results) noexcept {
  eval_all(lobes, directions, results);
}

void eval(const AnisotropicGaussians& lobes, const Directions& directions,
          std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(asg_eval_pairs_batch)(lobes, directions, results.size(), results.data());
}

void inner_product(const SphericalGaussian<float>& lobe, const SphericalGaussians& others,
                   std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(sg_inner_product_batch)
  (lobe.axis.data(), lobe.sharpness, lobe.amplitude, others, results.size(), results.data());
}

void inner_product(const AnisotropicGaussian<float>& lobe, const AnisotropicGaussians& others,
                   std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(asg_inner_product_batch)
  (FrameArray(lobe.frame).axes, lobe.bandwidth_x, lobe.bandwidth_y, lobe.amplitude, others,
   results.size(), results.data());
}

void dot(const Vector3f& vector, const Directions& directions, std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(dot_batch)
  (vector.data(), results.size(), directions.x.data(), directions.y.data(), directions.z.data(),
   results.data());
}

void mean_clamped_cosine(const LobeMoments<float>& moments, const Frame<float>& frame,
                         const Directions& normals, std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(mean_clamped_cosine_batch)
  (moments, FrameArray(frame).axes, results.size(), normals.x.data(), normals.y.data(),
   normals.z.data(), results.data());
}

void clamped_cosine_integral(const PreparedClampedCosine<float>& lobe, const Directions& normals,
                             std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(clamped_cosine_integral_batch)
  (lobe, results.size(), normals.x.data(), normals.y.data(), normals.z.data(), results.data());
}

void direction_to_octahedral(const Directions& directions, std::span<float> u,
                             std::span<float> v) noexcept {
  HWY_DYNAMIC_DISPATCH(octahedral_batch)
  (u.size(), directions.x.data(), directions.y.data(), directions.z.data(), u.data(), v.data());
}

}  // namespace batch
}  // namespace burnish
#endif
