#include "bit_grid.h"

#include <algorithm>

namespace burnish {
namespace {

using Word = BitGrid::Word;

// Bit i of the lower half goes to bit 2 i.
Word spread(Word word) {
  word &= 0x00000000ffffffff;
  word = (word | word << 16) & 0x0000ffff0000ffff;
  word = (word | word << 8) & 0x00ff00ff00ff00ff;
  word = (word | word << 4) & 0x0f0f0f0f0f0f0f0f;
  word = (word | word << 2) & 0x3333333333333333;
  return (word | word << 1) & 0x5555555555555555;
}

// A row and the bits beyond its two ends.
struct Row {
  std::vector<Word> words;
  bool before = false, after = false;
};

bool any_of_three(const BitGrid& grid, int x, int y) {
  bool any = false;
  for (int k = std::max(0, y - 1); k <= std::min(grid.size - 1, y + 1); ++k) any |= grid.get(x, k);
  return any;
}

// Row y in -1..size of the grid, to be or-ed into `row`.
void add_row(const BitGrid& grid, int y, Row& row) {
  const int n = grid.size;
  if (y >= 0 && y < n) {
    const Word* words = grid.row(y);
    for (int k = 0; k < grid.words; ++k) row.words[static_cast<std::size_t>(k)] |= words[k];
    row.before |= any_of_three(grid, 0, n - 1 - y);
    row.after |= any_of_three(grid, n - 1, n - 1 - y);
    return;
  }
  const int edge = y < 0 ? 0 : n - 1;
  for (int x = 0; x < n; ++x) {
    if (!grid.get(n - 1 - x, edge)) continue;
    for (int k = std::max(0, x - 1); k <= std::min(n - 1, x + 1); ++k)
      row.words[static_cast<std::size_t>(k) / 64] |= Word{1} << (k % 64);
  }
  // Over a corner of the map lies its opposite corner.
  row.before |= grid.get(n - 1, n - 1 - edge);
  row.after |= grid.get(0, n - 1 - edge);
}

}  // namespace

void gather_coarse_samples(const BitGrid& coarse, SampleParity parity, BitGrid& fine) {
  const int odd = static_cast<int>(parity);
  const Word in_row = coarse.size < 64 ? (Word{1} << coarse.size) - 1 : ~Word{0};
  Row row;
  for (int y = 0; y < fine.size; ++y) {
    row.words.assign(static_cast<std::size_t>(coarse.words), 0);
    row.before = row.after = false;
    const int first = (y - odd) >> 1;  // -1 for row 0 of odd parity
    add_row(coarse, first, row);
    if (y % 2 != odd) add_row(coarse, first + 1, row);

    Word* out = fine.row(y);
    for (int k = 0; k < coarse.words; ++k) {
      const auto i = static_cast<std::size_t>(k);
      const Word here = row.words[i];
      Word even_texels = here, odd_texels = here;
      if (parity == SampleParity::even) {
        const bool next = k + 1 < coarse.words ? row.words[i + 1] & 1 : row.after;
        odd_texels |= here >> 1 | Word{next} << (std::min(coarse.size, 64) - 1);
      } else {
        const bool last = k > 0 ? row.words[i - 1] >> 63 : row.before;
        even_texels |= here << 1 | Word{last};
      }
      even_texels &= in_row;
      out[2 * k] = spread(even_texels) | spread(odd_texels) << 1;
      if (coarse.size >= 64)
        out[2 * k + 1] = spread(even_texels >> 32) | spread(odd_texels >> 32) << 1;
    }
  }
}

void place_coarse_samples(const BitGrid& coarse, SampleParity parity, BitGrid& fine) {
  const int odd = static_cast<int>(parity);
  std::fill(fine.bits.begin(), fine.bits.end(), 0);
  for (int y = 0; y < coarse.size; ++y)
    for (int k = 0; k < coarse.words; ++k) {
      const Word word = coarse.row(y)[k];
      Word* out = fine.row(2 * y + odd) + 2 * k;
      out[0] = spread(word) << odd;
      if (coarse.size >= 64) out[1] = spread(word >> 32) << odd;
    }
}

void gather_neighbours(const BitGrid& grid, int y, BitGrid::Word* neighbours) {
  const int n = grid.size;
  const Word* here = grid.row(y);
  const int top = std::min(n, 64) - 1;
  Word carry = Word{grid.get(0, n - 1 - y)};
  for (int k = 0; k < grid.words; ++k) {
    const bool next = k + 1 < grid.words ? here[k + 1] & 1 : grid.get(n - 1, n - 1 - y);
    neighbours[k] = here[k] << 1 | carry | here[k] >> 1 | Word{next} << top;
    carry = here[k] >> 63;
  }
  if (n < 64) neighbours[0] &= (Word{1} << n) - 1;
  for (const int other : {y - 1, y + 1}) {
    if (other >= 0 && other < n) {
      for (int k = 0; k < grid.words; ++k) neighbours[k] |= grid.row(other)[k];
    } else {
      for (int x = 0; x < n; ++x)
        if (grid.get(n - 1 - x, y)) neighbours[x / 64] |= Word{1} << (x % 64);
    }
  }
}

}  // namespace burnish
