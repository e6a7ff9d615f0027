#include "mask_code.h"

#include <bit>

namespace burnish {
namespace {

std::size_t words_in_row(const VisibilityMask& mask) {
  return static_cast<std::size_t>(mask.resolution) / 64;
}

}  // namespace

void encode_mask(const VisibilityMask& mask, ByteWriter& to) {
  const std::size_t row = words_in_row(mask), size = mask.bits.size();
  std::vector<std::uint64_t> changed((size + 63) / 64), changes;
  for (std::size_t i = 0; i < size; ++i) {
    const std::uint64_t change = mask.bits[i] ^ (i < row ? 0 : mask.bits[i - row]);
    if (change == 0) continue;
    changed[i / 64] |= std::uint64_t{1} << (i % 64);
    changes.push_back(change);
  }
  to.put(std::span<const std::uint64_t>(changed));
  to.put(std::span<const std::uint64_t>(changes));
}

void decode_mask(ByteReader& from, VisibilityMask& mask) {
  const std::size_t row = words_in_row(mask), size = mask.bits.size();
  std::vector<std::uint64_t> changed((size + 63) / 64);
  from.get(std::span(changed));
  std::size_t count = 0;
  for (const std::uint64_t word : changed) count += static_cast<std::size_t>(std::popcount(word));
  std::vector<std::uint64_t> changes(count);
  from.get(std::span(changes));
  std::size_t next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    mask.bits[i] = i < row ? 0 : mask.bits[i - row];
    if (changed[i / 64] >> (i % 64) & 1) mask.bits[i] ^= changes[next++];
  }
}

}  // namespace burnish
