#include "burnish/precompute/coverage.h"

#include <algorithm>
#include <bit>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/error.h"

namespace burnish {
namespace {

void check(const VisibilityMask& mask, int resolution, std::size_t size) {
  if (resolution < 1 || !std::has_single_bit(static_cast<unsigned>(resolution)) ||
      mask.resolution < resolution || mask.resolution % resolution != 0)
    throw Error(
        ErrorKind::input, "coverage",
        fmt::format("resolution is {}, expected a power of two that divides the visibility's {}",
                    resolution, mask.resolution));
  if (size != static_cast<std::size_t>(resolution) * static_cast<std::size_t>(resolution))
    throw Error(
        ErrorKind::input, "coverage",
        fmt::format("there is room for {} texels, expected {}", size, resolution * resolution));
}

// Counts of set bits in each run of `width` bits, 1..64, a power of two, in place of the runs.
std::uint64_t count_runs(std::uint64_t bits, int width) {
  constexpr std::uint64_t kLow[] = {0x5555555555555555, 0x3333333333333333, 0x0f0f0f0f0f0f0f0f,
                                    0x00ff00ff00ff00ff, 0x0000ffff0000ffff, 0x00000000ffffffff};
  for (int half = 1, i = 0; half < width; half *= 2, ++i)
    bits = (bits & kLow[i]) + (bits >> half & kLow[i]);
  return bits;
}

}  // namespace

void measure_coverage(const VisibilityMask& mask, int resolution,
                      std::span<std::uint8_t> coverage) {
  check(mask, resolution, coverage.size());
  const int side = mask.resolution / resolution;  // of a texel, in directions
  const int width = std::min(side, 64);           // of it within one word
  const std::uint64_t low = width == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
  const auto words = static_cast<std::size_t>(mask.resolution) / 64;
  const auto cells = static_cast<std::uint32_t>(side) * static_cast<std::uint32_t>(side);
  std::vector<std::uint32_t> counts(static_cast<std::size_t>(resolution));
  const auto add_to_texels = [&](std::uint64_t runs, std::size_t word) {
    std::size_t texel = word * 64 / static_cast<std::size_t>(side);
    for (int bit = 0; bit < 64; bit += width, ++texel)
      counts[texel] += static_cast<std::uint32_t>(runs >> bit & low);
  };
  for (int y = 0; y < resolution; ++y) {
    std::fill(counts.begin(), counts.end(), 0u);
    for (std::size_t word = 0; word < words; ++word) {
      const std::uint64_t* rows =
          mask.bits.data() + static_cast<std::size_t>(y * side) * words + word;
      std::uint64_t any = 0;
      for (int row = 0; row < side; ++row) any |= rows[static_cast<std::size_t>(row) * words];
      if (any == 0) continue;  // the most frequent: below the horizon
      std::uint64_t sum = 0;
      for (int row = 0; row < side; ++row) {
        const std::uint64_t runs = count_runs(rows[static_cast<std::size_t>(row) * words], width);
        // Eight bits and more hold the count of a whole texel's rows: up to side^2.
        if (width < 8)
          add_to_texels(runs, word);
        else
          sum += runs;
      }
      if (width >= 8) add_to_texels(sum, word);
    }
    for (std::size_t x = 0; x < counts.size(); ++x)
      coverage[static_cast<std::size_t>(y) * counts.size() + x] =
          static_cast<std::uint8_t>((counts[x] * kFullCoverage + cells / 2) / cells);
  }
}

}  // namespace burnish
