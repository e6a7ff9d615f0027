#pragma once

#include <cstdint>

namespace burnish {

/// Two uniform numbers, each in [0, 1).
struct Uniform2 {
  double u, v;
};

/// Mixes two numbers into a seed that looks independent of those of other pairs (the finaliser of
/// SplitMix64).
constexpr std::uint64_t mix_seed(std::uint64_t seed, std::uint64_t value) {
  std::uint64_t z = seed + 0x9e3779b97f4a7c15u * (value + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// A randomised low-discrepancy sequence of points, as independent pairs of dimensions: Sobol's
/// first two dimensions, shuffled and Owen-scrambled by hashes (burley2020owen). Every point is
/// uniform by itself, so estimates are unbiased; points of one sequence are dependent, so an error
/// estimate takes several sequences of different seeds.
class SampleSequence {
 public:
  explicit SampleSequence(std::uint64_t seed) : seed_(seed) {}

  /// Point `index` in the pair of dimensions `pair`.
  Uniform2 operator()(std::uint32_t index, std::uint32_t pair) const {
    const std::uint64_t a = mix_seed(seed_, 2 * std::uint64_t(pair));
    const std::uint64_t b = mix_seed(seed_, 2 * std::uint64_t(pair) + 1);
    const std::uint32_t shuffled =
        reverse(permute(reverse(index), static_cast<std::uint32_t>(a >> 32)));
    // van der Corput's radical inverse is the reversed index: its two reversals cancel.
    return {unit(reverse(permute(shuffled, static_cast<std::uint32_t>(b)))),
            unit(reverse(permute(reverse(second_dimension(shuffled)),
                                 static_cast<std::uint32_t>(b >> 32))))};
  }

 private:
  static constexpr std::uint32_t reverse(std::uint32_t x) {
    x = (x << 16) | (x >> 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
  }
  /// A random permutation in which each bit depends on lower bits only: Owen's nested scramble of
  /// the reversed number.
  static constexpr std::uint32_t permute(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
  }
  static constexpr std::uint32_t second_dimension(std::uint32_t index) {
    std::uint32_t result = 0;
    for (std::uint32_t column = 1u << 31; index; index >>= 1, column ^= column >> 1)
      if (index & 1u) result ^= column;
    return result;
  }
  static constexpr double unit(std::uint32_t x) { return (x + 0.5) * 0x1p-32; }

  std::uint64_t seed_;
};

}  // namespace burnish
