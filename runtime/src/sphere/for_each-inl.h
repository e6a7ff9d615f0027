// Loops over arrays, a vector at a time.

#if defined(BURNISH_SPHERE_FOR_EACH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_SPHERE_FOR_EACH_INL_H_
#undef BURNISH_SPHERE_FOR_EACH_INL_H_
#else
#define BURNISH_SPHERE_FOR_EACH_INL_H_
#endif

#include <cstddef>
#include <cstring>

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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

/// As for_each, for kernels that return an x and a y.
template <class Kernel, class... Inputs>
HWY_INLINE void for_each_two(size_t size, float* results_x, float* results_y, const Kernel& kernel,
                             const Inputs*... inputs) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= size; i += lanes) {
    const auto value = kernel(d, hn::LoadU(d, inputs + i)...);
    hn::StoreU(value.x, d, results_x + i);
    hn::StoreU(value.y, d, results_y + i);
  }
  if (i == size) return;
  HWY_ALIGN float buffer[hn::MaxLanes(d)] = {};
  const auto load_rest = [&](const float* input) HWY_ATTR {
    std::memcpy(buffer, input + i, (size - i) * sizeof(float));
    return hn::Load(d, buffer);
  };
  const auto value = kernel(d, load_rest(inputs)...);
  hn::Store(value.x, d, buffer);
  std::memcpy(results_x + i, buffer, (size - i) * sizeof(float));
  hn::Store(value.y, d, buffer);
  std::memcpy(results_y + i, buffer, (size - i) * sizeof(float));
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
