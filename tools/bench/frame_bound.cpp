#include "frame_bound.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace burnish::tools {
namespace {

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Best of some: a limit is what nothing disturbs.
double best_of(int runs, const auto& work) {
  double best = 1e30;
  for (int i = 0; i < runs; ++i) best = std::min(best, seconds_of(work));
  return best;
}

constexpr int kChains = 12;  // latency times throughput of a multiply-add
constexpr long kSteps = 1 << 20;

typedef float Vector128 __attribute__((vector_size(16)));
typedef float Vector256 __attribute__((vector_size(32)));
typedef float Vector512 __attribute__((vector_size(64)));

/// Independent chains of multiply-adds.
template <class Vector>
[[gnu::always_inline]] inline float multiply_add_chains() {
  Vector sum[kChains] = {};
  const Vector a = Vector{} + 0.999f, b = Vector{} + 1e-3f;
  for (long step = 0; step < kSteps; ++step)
#pragma GCC unroll 12
    for (int i = 0; i < kChains; ++i) sum[i] = sum[i] * a + b;
  float total = 0;
  for (const Vector& s : sum) total += s[0];
  return total;
}

#if defined(__x86_64__)
[[gnu::target("avx512f")]] float chains_512() { return multiply_add_chains<Vector512>(); }
[[gnu::target("avx2,fma")]] float chains_256() { return multiply_add_chains<Vector256>(); }
#endif
float chains_128() { return multiply_add_chains<Vector128>(); }

}  // namespace

MachineLimits measure_limits() {
  const int threads = tbb::this_task_arena::max_concurrency();
  MachineLimits limits;
  const std::size_t bytes = std::size_t{256} << 20;
  std::vector<char> from(bytes, 1), to(bytes, 0);
  const std::size_t part = bytes / static_cast<std::size_t>(threads);
  const double copy_s = best_of(4, [&] {
    tbb::parallel_for(0, threads, [&](int i) {
      std::memcpy(to.data() + static_cast<std::size_t>(i) * part,
                  from.data() + static_cast<std::size_t>(i) * part, part);
    });
  });
  limits.copy_bytes_per_s = 2.0 * static_cast<double>(bytes) / copy_s;

  int width = 4;
  float (*chains)() = chains_128;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) {
    width = 16, chains = chains_512;
  } else if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    width = 8, chains = chains_256;
  }
#endif
  volatile float sink = 0;
  const double chains_s =
      best_of(4, [&] { tbb::parallel_for(0, threads, [&](int) { sink = chains(); }); });
  limits.multiply_adds_per_s =
      static_cast<double>(threads) * width * kChains * static_cast<double>(kSteps) / chains_s;
  return limits;
}

}  // namespace burnish::tools
