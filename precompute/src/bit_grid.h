#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace burnish {

/// One bit a texel of a square octahedral map: rows of whole words, the lowest bit first; bits past
/// the end of a row are 0. `size` is a power of two.
struct BitGrid {
  using Word = std::uint64_t;

  int size = 0;
  int words = 0;           ///< in a row
  std::vector<Word> bits;  ///< [size][words]

  BitGrid() = default;
  explicit BitGrid(int size)
      : size(size),
        words(size < 64 ? 1 : size / 64),
        bits(static_cast<std::size_t>(size) * static_cast<std::size_t>(words)) {}

  Word* row(int y) { return bits.data() + static_cast<std::size_t>(y) * word_count(); }
  const Word* row(int y) const { return bits.data() + static_cast<std::size_t>(y) * word_count(); }

  bool get(int x, int y) const { return row(y)[x / 64] >> (x % 64) & 1; }
  void set(int x, int y) { row(y)[x / 64] |= Word{1} << (x % 64); }
  void reset(int x, int y) { row(y)[x / 64] &= ~(Word{1} << (x % 64)); }

 private:
  std::size_t word_count() const { return static_cast<std::size_t>(words); }
};

/// Where a grid's samples lie in the grid of twice its size: sample i of the coarse grid is texel
/// 2 i + (0 or 1) of the fine one, along both axes.
enum class SampleParity { even = 0, odd = 1 };

/// A texel of `fine` (twice the size of `coarse`) is set where any of the coarse samples around it
/// is: the sample itself, the two beside it, or the four about it, depending on where it lies. Over
/// the map's edge samples do not line up; the three nearest are taken.
void gather_coarse_samples(const BitGrid& coarse, SampleParity parity, BitGrid& fine);

/// A cell of `around` is set where any sample in it or at its rim is, where a cell's sample is its
/// first texel (even: the cell's own, the next ones right and below) or its middle one (odd: its
/// own and the eight about it).
void gather_samples_around(const BitGrid& samples, SampleParity parity, BitGrid& around);

/// Sets the texels of `fine`, four times the size, that lie in the cells of `cells`, and no others.
void fill_cells(const BitGrid& cells, BitGrid& fine);

/// Sets the coarse samples' own texels of `fine`, and no others.
void place_coarse_samples(const BitGrid& coarse, SampleParity parity, BitGrid& fine);

/// Row y of the set of texels that have a left, right, upper or lower neighbour in `grid`, with the
/// map's wrap. Writes grid.words words.
void gather_neighbours(const BitGrid& grid, int y, BitGrid::Word* neighbours);

}  // namespace burnish
