#include "visibility_boundary.h"

#include <algorithm>
#include <bit>

namespace burnish {
namespace {

using Scratch = SphericalDistanceTransform::Scratch;

constexpr std::uint32_t place(std::uint32_t x, std::uint32_t y) { return y << 16 | x; }

// Appends places to the scratch, cell by cell.
class CellWriter {
 public:
  explicit CellWriter(Scratch& scratch) : scratch_(scratch) { scratch_.cell_begin.assign(1, 0); }

  // Room for a cell's places.
  std::uint32_t* open() {
    constexpr std::size_t kMost = 128;
    if (scratch_.places.size() < size_ + kMost) scratch_.places.resize(2 * (size_ + kMost));
    return scratch_.places.data() + size_;
  }

  void close(const std::uint32_t* end) {
    const auto size = static_cast<std::size_t>(end - scratch_.places.data());
    if (size == size_) return;
    size_ = size;
    scratch_.cell_begin.push_back(static_cast<std::uint32_t>(size));
  }

 private:
  Scratch& scratch_;
  std::size_t size_ = 0;
};

// Eight rows of 64 texels: bit x of row y is set where the texel differs from its right neighbour,
// and from the one below.
struct Strip {
  std::uint64_t right[8], below[8];
  std::uint64_t any = 0;
};

// `row`: a word of the strip's first row.
Strip strip_of(const std::uint64_t* row, std::size_t words, bool last_word, bool last_rows) {
  constexpr std::uint64_t kHighBit = std::uint64_t{1} << 63;
  Strip strip;
  for (int y = 0; y < 8; ++y, row += words) {
    const std::uint64_t next = last_word ? *row & kHighBit : row[1] << 63;
    strip.right[y] = *row ^ (*row >> 1 | next);
    strip.below[y] = last_rows && y == 7 ? 0 : *row ^ row[words];
    strip.any |= strip.right[y] | strip.below[y];
  }
  return strip;
}

// Of each of eight rows the same byte.
std::uint64_t square_of(const std::uint64_t (&rows)[8], int byte) {
  std::uint64_t square = 0;
  for (int y = 0; y < 8; ++y) square |= (rows[y] >> (8 * byte) & 255) << (8 * y);
  return square;
}

// `first`: place of the upper left texel's edge.
std::uint32_t* write_places(std::uint64_t square, std::uint32_t first, std::uint32_t* out) {
  for (; square; square &= square - 1) {
    const auto i = static_cast<std::uint32_t>(std::countr_zero(square));
    *out++ = first + place(i % 8 * 2, i / 8 * 2);
  }
  return out;
}

// Over the map's edges: each edge meets its own mirror image, so half of it names every pair.
void collect_wrap(const VisibilityMask& mask, CellWriter& writer) {
  const int n = mask.resolution;
  for (const int edge : {0, n - 1})
    for (const bool horizontal : {false, true})
      for (int first = 0; first < n / 2; first += 8) {
        std::uint32_t* out = writer.open();
        for (int i = first; i < first + 8; ++i) {
          const bool differs = horizontal ? mask.visible(i, edge) != mask.visible(n - 1 - i, edge)
                                          : mask.visible(edge, i) != mask.visible(edge, n - 1 - i);
          if (!differs) continue;
          const auto along = 2 * static_cast<std::uint32_t>(i) + 1;
          const auto at = edge == 0 ? 0 : 2 * static_cast<std::uint32_t>(n);
          *out++ = horizontal ? place(along, at) : place(at, along);
        }
        writer.close(out);
      }
}

}  // namespace

void collect_boundary(const VisibilityMask& mask, Scratch& scratch) {
  CellWriter writer(scratch);
  const int n = mask.resolution;
  const std::size_t words = static_cast<std::size_t>(n) / 64;
  for (int y = 0; y < n; y += 8)
    for (std::size_t word = 0; word < words; ++word) {
      const Strip strip = strip_of(mask.bits.data() + static_cast<std::size_t>(y) * words + word,
                                   words, word + 1 == words, y + 8 == n);
      if (strip.any == 0) continue;
      for (int byte = 0; byte < 8; ++byte) {
        if ((strip.any >> (8 * byte) & 255) == 0) continue;
        const auto left =
            static_cast<std::uint32_t>(word * 128) + static_cast<std::uint32_t>(byte) * 16;
        const auto top = static_cast<std::uint32_t>(y) * 2;
        std::uint32_t* out = writer.open();
        out = write_places(square_of(strip.right, byte), place(left + 2, top + 1), out);
        out = write_places(square_of(strip.below, byte), place(left + 1, top + 2), out);
        writer.close(out);
      }
    }
  collect_wrap(mask, writer);
}

void boundary_signs(const VisibilityMask& mask, int resolution, float* signs) {
  const int ratio = mask.resolution / resolution, texels_a_word = 64 / ratio;
  const std::size_t words = static_cast<std::size_t>(mask.resolution) / 64;
  // The texel's centre lies in one texel of the mask, or between four: bits 0 and 1 of the row
  // above, 2 and 3 of the row below.
  const int before = ratio == 1 ? 0 : ratio / 2 - 1;
  constexpr float kOfOne[2] = {-1, 1};
  constexpr float kOfFour[16] = {-1, -1, -1, 0, -1, 0, 0, 1, -1, 0, 0, 1, 0, 1, 1, 1};
  for (int y = 0; y < resolution; ++y) {
    const std::uint64_t* above =
        mask.bits.data() + static_cast<std::size_t>(y * ratio + before) * words;
    const std::uint64_t* below = ratio == 1 ? above : above + words;
    for (std::size_t word = 0; word < words; ++word, signs += texels_a_word) {
      const std::uint64_t a = above[word], b = below[word];
      if (a == b && (a == 0 || ~a == 0)) {
        std::fill_n(signs, texels_a_word, kOfOne[a & 1]);
        continue;
      }
      for (int i = 0; i < texels_a_word; ++i) {
        const int bit = i * ratio + before;
        signs[i] =
            ratio == 1 ? kOfOne[a >> bit & 1] : kOfFour[(a >> bit & 3) | (b >> bit & 3) << 2];
      }
    }
  }
}

}  // namespace burnish
