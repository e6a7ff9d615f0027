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

/// What a kernel with several results returns: one vector for each array of results.
template <int N>
struct Values {
  V value[N];
};

/// As for_each, for kernels that return Values.
template <int N, class Kernel, class... Inputs>
HWY_INLINE void for_each_several(size_t size, float* const (&results)[N], const Kernel& kernel,
                                 const Inputs*... inputs) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  size_t i = 0;
  for (; i + lanes <= size; i += lanes) {
    const Values<N> values = kernel(d, hn::LoadU(d, inputs + i)...);
    for (int k = 0; k < N; ++k) hn::StoreU(values.value[k], d, results[k] + i);
  }
  if (i == size) return;
  HWY_ALIGN float buffer[hn::MaxLanes(d)] = {};
  const auto load_rest = [&](const float* input) HWY_ATTR {
    std::memcpy(buffer, input + i, (size - i) * sizeof(float));
    return hn::Load(d, buffer);
  };
  const Values<N> values = kernel(d, load_rest(inputs)...);
  for (int k = 0; k < N; ++k) {
    hn::Store(values.value[k], d, buffer);
    std::memcpy(results[k] + i, buffer, (size - i) * sizeof(float));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
