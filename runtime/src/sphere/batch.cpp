#include "burnish/sphere/batch.h"

#include <cstddef>
#include <cstdint>

#include "sphere/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sphere/batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sphere/for_each-inl.h"
#include "sphere/half_space-inl.h"
#include "sphere/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

void exp_batch(size_t size, const float* x, float* results) {
  for_each(
      size, results, [](D d, V x) HWY_ATTR { return exp(d, x); }, x);
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

void directional_bandwidth_batch(size_t size, const float* bandwidths_x, const float* bandwidths_y,
                                 const float* x, const float* y, float* results) {
  for_each(
      size, results,
      [](D d, V bandwidth_x, V bandwidth_y, V x, V y)
          HWY_ATTR { return directional_bandwidth(d, bandwidth_x, bandwidth_y, x, y); },
      bandwidths_x, bandwidths_y, x, y);
}

void hemisphere_batch(size_t size, const float* sharpness, const float* distances, float* results) {
  for_each(
      size, results,
      [](D d, V sharpness, V distance)
          HWY_ATTR { return visible_fraction_hemisphere(d, sharpness, distance); },
      sharpness, distances);
}

void hemisphere_of_one_batch(size_t size, float sharpness, const float* distances, float* results) {
  const D d;
  const HemisphereShape<V> shape = prepare_hemisphere(d, hn::Set(d, sharpness));
  for_each(
      size, results,
      [&](D d, V distance) HWY_ATTR { return visible_fraction_hemisphere(d, shape, distance); },
      distances);
}

void hemisphere_exact_batch(size_t size, const float* sharpness, const float* distances,
                            float* results) {
  for_each(
      size, results,
      [](D d, V sharpness, V distance)
          HWY_ATTR { return visible_fraction_hemisphere_exact(d, sharpness, distance); },
      sharpness, distances);
}

void sg_integral_batch(size_t size, const float* sharpness, float* results) {
  for_each(
      size, results,
      [](D d, V sharpness)
          HWY_ATTR { return hn::Mul(hn::Set(d, 6.28318531f), sg_mass(d, sharpness)); },
      sharpness);
}

HWY_INLINE Values<3> values(const ConvolvedLobe<V>& lobe) {
  return {{lobe.bandwidth_x, lobe.bandwidth_y, lobe.amplitude}};
}

void convolve_batch(size_t size, const float* bandwidths_x, const float* bandwidths_y,
                    float kernel_sharpness, float* const (&results)[3]) {
  const D d;
  const V sharpness = hn::Set(d, kernel_sharpness);
  for_each_several(
      size, results, [&](D d, V x, V y) HWY_ATTR { return values(convolve(d, x, y, sharpness)); },
      bandwidths_x, bandwidths_y);
}

void convolve_pairs_batch(size_t size, const float* bandwidths_x, const float* bandwidths_y,
                          const float* kernels_sharpness, float* const (&results)[3]) {
  for_each_several(
      size, results,
      [](D d, V x, V y, V sharpness) HWY_ATTR { return values(convolve(d, x, y, sharpness)); },
      bandwidths_x, bandwidths_y, kernels_sharpness);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(exp_batch);
HWY_EXPORT(asg_integral_fast_batch);
HWY_EXPORT(asg_integral_exact_batch);
HWY_EXPORT(directional_batch);
HWY_EXPORT(directional_bandwidth_batch);
HWY_EXPORT(hemisphere_batch);
HWY_EXPORT(hemisphere_of_one_batch);
HWY_EXPORT(hemisphere_exact_batch);
HWY_EXPORT(sg_integral_batch);
HWY_EXPORT(convolve_batch);
HWY_EXPORT(convolve_pairs_batch);

namespace batch {

void exp(std::span<const float> x, std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(exp_batch)(results.size(), x.data(), results.data());
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

void directional_bandwidth(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
                           std::span<const float> gradients_x, std::span<const float> gradients_y,
                           std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(directional_bandwidth_batch)
  (results.size(), bandwidths_x.data(), bandwidths_y.data(), gradients_x.data(), gradients_y.data(),
   results.data());
}

void visible_fraction_hemisphere(std::span<const float> sharpness, std::span<const float> distances,
                                 std::span<float> results, HemisphereLevel level) noexcept {
  if (level == HemisphereLevel::fast) {
    HWY_DYNAMIC_DISPATCH(hemisphere_batch)
    (results.size(), sharpness.data(), distances.data(), results.data());
  } else {
    HWY_DYNAMIC_DISPATCH(hemisphere_exact_batch)
    (results.size(), sharpness.data(), distances.data(), results.data());
  }
}

void visible_fraction_hemisphere(float sharpness, std::span<const float> distances,
                                 std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(hemisphere_of_one_batch)
  (results.size(), sharpness, distances.data(), results.data());
}

void sg_integral(std::span<const float> sharpness, std::span<float> results) noexcept {
  HWY_DYNAMIC_DISPATCH(sg_integral_batch)(results.size(), sharpness.data(), results.data());
}

void convolve(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
              float kernel_sharpness, const ConvolvedLobes& results) noexcept {
  float* const arrays[] = {results.bandwidth_x.data(), results.bandwidth_y.data(),
                           results.amplitude.data()};
  HWY_DYNAMIC_DISPATCH(convolve_batch)
  (results.amplitude.size(), bandwidths_x.data(), bandwidths_y.data(), kernel_sharpness, arrays);
}

void convolve(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
              std::span<const float> kernels_sharpness, const ConvolvedLobes& results) noexcept {
  float* const arrays[] = {results.bandwidth_x.data(), results.bandwidth_y.data(),
                           results.amplitude.data()};
  HWY_DYNAMIC_DISPATCH(convolve_pairs_batch)
  (results.amplitude.size(), bandwidths_x.data(), bandwidths_y.data(), kernels_sharpness.data(),
   arrays);
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
