#include "burnish/sphere/batch.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sphere/batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sphere/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

using D = hn::ScalableTag<float>;
using V = hn::VFromD<D>;

/// results[i] = kernel(d, input[i]...). What does not fill a vector goes through a buffer.
template <class Kernel, class... Inputs>
HWY_INLINE void for_each(size_t size, float* results, const Kernel& kernel,
                         const Inputs*... inputs) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= size; i += lanes)
    hn::StoreU(kernel(d, hn::LoadU(d, inputs + i)...), d, results + i);
  if (i == size) return;
  HWY_ALIGN float buffer[hn::MaxLanes(d)] = {};
  const auto load_rest = [&](const float* input) HWY_ATTR {
    std::memcpy(buffer, input + i, (size - i) * sizeof(float));
    return hn::Load(d, buffer);
  };
  const V value = kernel(d, load_rest(inputs)...);
  hn::Store(value, d, buffer);
  std::memcpy(results + i, buffer, (size - i) * sizeof(float));
}

Vector3<V> set(D d, const float* v) {
  return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

void exp_batch(size_t size, const float* x, float* results) {
  for_each(
      size, results, [](D d, V x) HWY_ATTR { return exp(d, x); }, x);
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

void asg_integral_fast_batch(size_t size, const float* bandwidths_x, const float* bandwidths_y,
                             float* results) {
  for_each(
      size, results, [](D d, V x, V y) HWY_ATTR { return asg_integral_fast(d, x, y); },
      bandwidths_x, bandwidths_y);
}

void asg_integral_exact_batch(size_t size, const float* bandwidths_x, const float* bandwidths_y,
                              float* results) {
  for_each(
      size, results, [](D d, V x, V y) HWY_ATTR { return asg_integral_exact(d, x, y); },
      bandwidths_x, bandwidths_y);
}

void directional_batch(size_t size, const float* bandwidths, const float* distances,
                       float* results) {
  for_each(
      size, results,
      [](D d, V bandwidth, V distance)
          HWY_ATTR { return visible_fraction_directional(d, bandwidth, distance); },
      bandwidths, distances);
}

void hemisphere_batch(size_t size, const float* sharpness, const float* distances, float* results) {
  for_each(
      size, results,
      [](D d, V sharpness, V distance)
          HWY_ATTR { return visible_fraction_hemisphere(d, sharpness, distance); },
      sharpness, distances);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(exp_batch);
HWY_EXPORT(sg_eval_batch);
HWY_EXPORT(asg_eval_batch);
HWY_EXPORT(asg_integral_fast_batch);
HWY_EXPORT(asg_integral_exact_batch);
HWY_EXPORT(directional_batch);
HWY_EXPORT(hemisphere_batch);

namespace batch {

void exp(std::span<const float> x, std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(exp_batch)(results.size(), x.data(), results.data());
}

void eval(const SphericalGaussian<float>& lobe, const Directions& directions,
          std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(sg_eval_batch)
  (lobe.axis.data(), lobe.sharpness, lobe.amplitude, results.size(), directions.x.data(),
   directions.y.data(), directions.z.data(), results.data());
}

void eval(const AnisotropicGaussian<float>& lobe, const Directions& directions,
          std::span<float> results) noexcept {
  float frame[9];
  const float root_x = std::sqrt(lobe.bandwidth_x), root_y = std::sqrt(lobe.bandwidth_y);
  for (int i = 0; i < 3; ++i) {
    frame[i] = root_x * lobe.frame.x[i];
    frame[3 + i] = root_y * lobe.frame.y[i];
    frame[6 + i] = lobe.frame.z[i];
  }
  HWY_DYNAMIC_DISPATCH(asg_eval_batch)
  (frame, lobe.amplitude, results.size(), directions.x.data(), directions.y.data(),
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

void asg_integral(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
                  AsgIntegral level, std::span<float> results) noexcept {
  if (level == AsgIntegral::fast) {
    HWY_DYNAMIC_DISPATCH(asg_integral_fast_batch)
    (results.size(), bandwidths_x.data(), bandwidths_y.data(), results.data());
  } else {
    HWY_DYNAMIC_DISPATCH(asg_integral_exact_batch)
    (results.size(), bandwidths_x.data(), bandwidths_y.data(), results.data());
  }
}

void visible_fraction_directional(std::span<const float> bandwidths_across,
                                  std::span<const float> distances,
                                  std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(directional_batch)
  (results.size(), bandwidths_across.data(), distances.data(), results.data());
}

void visible_fraction_hemisphere(std::span<const float> sharpness, std::span<const float> distances,
                                 std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(hemisphere_batch)
  (results.size(), sharpness.data(), distances.data(), results.data());
}

std::vector<std::string_view> instruction_sets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<std::string_view> names;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets())
    names.push_back(hwy::TargetName(target));
  return names;
}

bool use_instruction_set(std::string_view name) {
  hwy::SetSupportedTargetsForTest(0);
  if (name.empty()) return true;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    if (name != hwy::TargetName(target)) continue;
    hwy::SetSupportedTargetsForTest(target);
    return true;
  }
  return false;
}

}  // namespace batch
}  // namespace burnish
#endif
