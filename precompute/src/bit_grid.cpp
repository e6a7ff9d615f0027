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

// The row moved by one to the left or right, with what lies beyond its end.
Word next_texels(const Row& row, int k, int size) {
  const auto i = static_cast<std::size_t>(k);
  const bool next = i + 1 < row.words.size() ? (row.words[i + 1] & 1) != 0 : row.after;
  return row.words[i] >> 1 | Word{next} << (std::min(size, 64) - 1);
}

Word last_texels(const Row& row, int k) {
  const auto i = static_cast<std::size_t>(k);
  const bool last = k > 0 ? (row.words[i - 1] >> 63) != 0 : row.before;
  return row.words[i] << 1 | Word{last};
}

Word row_mask(int size) { return size < 64 ? (Word{1} << size) - 1 : ~Word{0}; }

}  // namespace

void gather_coarse_samples(const BitGrid& coarse, SampleParity parity, BitGrid& fine) {
  const int odd = static_cast<int>(parity);
  const Word in_row = row_mask(coarse.size);
  Row row;
  for (int y = 0; y < fine.size; ++y) {
    row.words.assign(static_cast<std::size_t>(coarse.words), 0);
    row.before = row.after = false;
    const int first = (y - odd) >> 1;  // -1 for row 0 of odd parity
    add_row(coarse, first, row);
    if (y % 2 != odd) add_row(coarse, first + 1, row);

    Word* out = fine.row(y);
    for (int k = 0; k < coarse.words; ++k) {
      Word even_texels = row.words[static_cast<std::size_t>(k)], odd_texels = even_texels;
      if (parity == SampleParity::even)
        odd_texels |= next_texels(row, k, coarse.size);
      else
        even_texels |= last_texels(row, k);
      even_texels &= in_row;
      out[2 * k] = spread(even_texels) | spread(odd_texels) << 1;
      if (coarse.size >= 64)
        out[2 * k + 1] = spread(even_texels >> 32) | spread(odd_texels >> 32) << 1;
    }
  }
}

void gather_samples_around(const BitGrid& samples, SampleParity parity, BitGrid& around) {
  const bool odd = parity == SampleParity::odd;
  Row row;
  for (int y = 0; y < samples.size; ++y) {
    row.words.assign(static_cast<std::size_t>(samples.words), 0);
    row.before = row.after = false;
    for (int other = odd ? y - 1 : y; other <= y + 1; ++other) add_row(samples, other, row);
    for (int k = 0; k < samples.words; ++k) {
      Word any = row.words[static_cast<std::size_t>(k)] | next_texels(row, k, samples.size);
      if (odd) any |= last_texels(row, k);
      around.row(y)[k] = any & row_mask(samples.size);
    }
  }
}

void fill_cells(const BitGrid& cells, BitGrid& fine) {
  for (int y = 0; y < cells.size; ++y)
    for (int k = 0; k < fine.words; ++k) {
      Word word = spread(spread(cells.row(y)[k / 4] >> (k % 4 * 16) & 0xffff));
      word |= word << 1;
      word |= word << 2;
      for (int r = 0; r < 4; ++r) fine.row(4 * y + r)[k] = word;
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
