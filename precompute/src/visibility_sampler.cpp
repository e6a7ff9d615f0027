#include "burnish/precompute/visibility_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <fmt/format.h>

#include "bit_grid.h"
#include "burnish/formats/error.h"

namespace burnish {
namespace {

using Word = BitGrid::Word;

constexpr int kBlock = 8;  // texels along a block's side: a byte of a row

// What is known at one resolution. A cell is in neither set where none of its texels is above the
// horizon, and in both where its samples disagree.
struct Level {
  BitGrid visible, occluded;
  BitGrid exact;  // the cell's sample itself was cast, here or at a coarser level
  BitGrid cast;   // or another texel of the cell in its stead
  BitGrid todo;   // to be cast next
  int cell;       // texels of the finest map along a cell's side
  int sample;     // the cell's texel that stands for it, along both axes

  Level(int size, int finest, bool coarsest)
      : visible(size),
        occluded(size),
        exact(size),
        cast(size),
        todo(size),
        cell(finest / size),
        // The coarsest samples lie in the middle of their cells, so that none is far from those
        // beyond the map's edge; the finer ones are where the coarser ones have been.
        sample(coarsest ? cell / 2 : 0) {}

  SampleParity parity() const { return sample == 0 ? SampleParity::even : SampleParity::odd; }
};

// The finest map, cast by whole tiles: sixteen rays so close together cost hardly more than one.
struct Tiles {
  BitGrid above;  // the texels above the horizon; each of them is in one of the next two
  BitGrid visible, occluded;
  BitGrid cast, todo;  // a bit a tile

  explicit Tiles(int finest)
      : above(finest), visible(finest), occluded(finest), cast(finest / 4), todo(finest / 4) {}
};

void clear(BitGrid& grid) { std::fill(grid.bits.begin(), grid.bits.end(), 0); }

// Texels of the finest map.
struct Square {
  int x, y, side;
};

// Cosines of a tile's directions to the normal; returns the lowest that is above zero, or 2.
float lowest_above(const DirectionTile& tile, const Vector3f& normal, float* cosine) {
  for (int i = 0; i < 16; ++i)
    cosine[i] = tile.x[i] * normal.x() + tile.y[i] * normal.y() + tile.z[i] * normal.z();
  float lowest[4] = {2, 2, 2, 2};
  for (int i = 0; i < 16; ++i) {
    const float above = cosine[i] > 0 ? cosine[i] : 2.0f;
    lowest[i % 4] = above < lowest[i % 4] ? above : lowest[i % 4];
  }
  return std::min(std::min(lowest[0], lowest[1]), std::min(lowest[2], lowest[3]));
}

// Calls body(x, y) for the set bits, block by block, so that those called together are close.
template <class Body>
void for_each_set(const BitGrid& grid, const Body& body) {
  constexpr int kSide = 16;
  for (int y = 0; y < grid.size; y += kSide)
    for (int k = 0; k < grid.words; ++k) {
      Word any = 0;
      for (int r = 0; r < kSide; ++r) any |= grid.row(y + r)[k];
      while (any != 0) {
        const int shift = std::countr_zero(any) & ~(kSide - 1);
        any &= ~(Word{0xffff} << shift);
        for (int r = 0; r < kSide; ++r)
          for (Word bits = grid.row(y + r)[k] >> shift & 0xffff; bits != 0; bits &= bits - 1)
            body(64 * k + shift + std::countr_zero(bits), y + r);
      }
    }
}

// Bit i: any of bits 4 i .. 4 i + 3.
Word tiles_of(Word texels) {
  texels |= texels >> 1;
  texels |= texels >> 2;
  texels &= 0x1111111111111111;
  texels = (texels | texels >> 3) & 0x0303030303030303;
  texels = (texels | texels >> 6) & 0x000f000f000f000f;
  texels = (texels | texels >> 12) & 0x000000ff000000ff;
  return (texels | texels >> 24) & 0xffff;
}

}  // namespace

struct VisibilitySampler::Scratch::State {
  Tiles tiles;
  std::vector<Level> levels;  // coarser than the tiles' texels, the last of a cell a tile
  int coarsest;
  std::vector<float> cosine;       // of the blocks
  std::vector<unsigned char> low;  // blocks with texels at the horizon
  std::vector<int> low_blocks;
  std::vector<Word> rows;                     // two rows of neighbours
  std::vector<unsigned char> changed, dirty;  // rows of the level in work

  State(int finest, int coarsest) : tiles(finest), coarsest(coarsest) {
    for (int size = coarsest; size <= finest / 4; size *= 2)
      levels.emplace_back(size, finest, size == coarsest);
    rows.resize(2 * static_cast<std::size_t>(tiles.above.words));
  }
};

VisibilitySampler::Scratch::Scratch() = default;
VisibilitySampler::Scratch::~Scratch() = default;
VisibilitySampler::Scratch::Scratch(Scratch&&) noexcept = default;
VisibilitySampler::Scratch& VisibilitySampler::Scratch::operator=(Scratch&&) noexcept = default;

VisibilitySampler::VisibilitySampler(const RayScene& scene, const DirectionTable& finest,
                                     int coarsest)
    : scene_(scene), finest_(finest), coarsest_(coarsest) {
  const int n = finest.resolution();
  const auto is_power_of_two = [](int value) {
    return value > 0 && std::has_single_bit(static_cast<unsigned>(value));
  };
  if (n < 64 || !is_power_of_two(n))
    throw Error(ErrorKind::input, "visibility sampler",
                fmt::format("has {} directions a side, expected a power of two, at least 64", n));
  if (coarsest < 16 || coarsest > n || !is_power_of_two(coarsest))
    throw Error(
        ErrorKind::input, "visibility sampler",
        fmt::format("coarsest level is {}, expected a power of two in 16..{}", coarsest, n));
  for (int y = 0; y < n; y += kBlock)
    for (int x = 0; x < n; x += kBlock) {
      Vector3f mean = Vector3f::Zero();
      for (int i = 0; i < kBlock * kBlock; ++i)
        mean += finest.direction(x + i % kBlock, y + i / kBlock);
      mean.normalize();
      float radius = 0;
      for (int i = 0; i < kBlock * kBlock; ++i)
        radius = std::max(radius, (finest.direction(x + i % kBlock, y + i / kBlock) - mean).norm());
      blocks_.x.push_back(mean.x());
      blocks_.y.push_back(mean.y());
      blocks_.z.push_back(mean.z());
      for (int i = 0; i < kBlock * (kBlock - 1); ++i) {
        const int along = i % (kBlock - 1), across = i / (kBlock - 1);
        pitch_ = std::max(pitch_, (finest.direction(x + along + 1, y + across) -
                                   finest.direction(x + along, y + across))
                                      .norm());
        pitch_ = std::max(pitch_, (finest.direction(x + across, y + along + 1) -
                                   finest.direction(x + across, y + along))
                                      .norm());
      }
      // |n . d - n . mean| <= |d - mean|, and some float roundings.
      blocks_.margin.push_back(radius + 1e-5f);
    }
}

// The rays of one vertex.
class VisibilitySampler::Pass {
 public:
  Pass(const VisibilitySampler& sampler, const Vector3f& origin, const Vector3f& normal,
       Scratch::State& state)
      : sampler_(sampler),
        origin_(origin),
        normal_(normal),
        state_(state),
        above_(state.tiles.above) {}

  bool find_horizon();
  void sample_coarsest(Level& level);
  void refine(const Level& coarse, Level& fine);
  void cast_all(Tiles& tiles);
  void refine_to_tiles(const Level& level, Tiles& tiles);

  std::uint64_t rays() const { return rays_; }

 private:
  Word block_above(int x, int y) const;
  void cast(Level& level);
  void add(Level& level, int x, int y, int texel_x, int texel_y);
  void add_lowest(Level& level, int x, int y, const Square& square, float limit);
  void flush(Level& level);
  void cast(Tiles& tiles);
  template <class Body>
  void for_dirty_rows(int rows, const Body& body);
  bool find_uncertain(Level& level);
  bool find_uncertain(Tiles& tiles);

  const VisibilitySampler& sampler_;
  Vector3f origin_, normal_;
  Scratch::State& state_;
  BitGrid& above_;
  std::uint64_t rays_ = 0;
  // The rays that wait for a full packet.
  DirectionTile packet_;
  int cell_x_[16], cell_y_[16];
  int lanes_ = 0;
};

// Returns whether any direction is above the horizon.
bool VisibilitySampler::Pass::find_horizon() {
  const Blocks& blocks = sampler_.blocks_;
  const std::size_t count = blocks.x.size();
  state_.cosine.resize(count);
  state_.low.assign(count, 0);
  state_.low_blocks.clear();
  for (std::size_t i = 0; i < count; ++i)
    state_.cosine[i] =
        blocks.x[i] * normal_.x() + blocks.y[i] * normal_.y() + blocks.z[i] * normal_.z();
  const int across = above_.size / kBlock;
  bool any = false;
  for (int y = 0; y < across; ++y)
    for (int k = 0; k < above_.words; ++k) {
      Word rows[kBlock] = {};
      for (int column = 0; column < 64 / kBlock; ++column) {
        const int x = k * (64 / kBlock) + column;
        const auto i = static_cast<std::size_t>(y * across + x);
        const float cosine = state_.cosine[i];
        Word bits = 0;  // also where the normal is NaN
        if (cosine >= blocks.margin[i])
          bits = ~Word{0};
        else if (cosine > -blocks.margin[i])
          bits = block_above(x, y);
        state_.low[i] = bits != 0 && cosine < blocks.margin[i] + sampler_.pitch_;
        if (state_.low[i]) state_.low_blocks.push_back(static_cast<int>(i));
        any |= bits != 0;
        for (int r = 0; r < kBlock; ++r)
          rows[r] |= (bits >> (kBlock * r) & 0xff) << (kBlock * column);
      }
      for (int r = 0; r < kBlock; ++r) above_.row(y * kBlock + r)[k] = rows[r];
    }
  return any;
}

Word VisibilitySampler::Pass::block_above(int x, int y) const {
  const auto tiles = static_cast<std::size_t>(above_.size / 4);
  Word bits = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t column = k % 2, row = k / 2;
    const std::size_t tile =
        (2 * static_cast<std::size_t>(y) + row) * tiles + 2 * static_cast<std::size_t>(x) + column;
    const Word above = above_horizon(sampler_.finest_.tiles()[tile], normal_);
    for (std::size_t r = 0; r < 4; ++r)
      bits |= (above >> (4 * r) & 15) << (kBlock * (4 * row + r) + 4 * column);
  }
  return bits;
}

void VisibilitySampler::Pass::sample_coarsest(Level& level) {
  for (BitGrid* grid : {&level.visible, &level.occluded, &level.exact}) clear(*grid);
  // Tile by tile of cells: first their samples, then what is low, block by block.
  const int size = level.todo.size;
  for (int y = 0; y < size; y += 4)
    for (int x = 0; x < size; x += 4)
      for (int v = y; v < y + 4; ++v)
        for (int u = x; u < x + 4; ++u) {
          const int texel_x = u * level.cell + level.sample,
                    texel_y = v * level.cell + level.sample;
          if (!above_.get(texel_x, texel_y)) continue;
          level.exact.set(u, v);
          add(level, u, v, texel_x, texel_y);
        }
  const int step = std::min(level.cell, kBlock), across = above_.size / kBlock;
  for (const int block : state_.low_blocks) {
    const int first_x = block % across * kBlock, first_y = block / across * kBlock;
    for (int v = first_y; v < first_y + kBlock; v += step)
      for (int u = first_x; u < first_x + kBlock; u += step)
        add_lowest(level, u / level.cell, v / level.cell, {u, v, step}, sampler_.pitch_);
  }
  flush(level);
}

void VisibilitySampler::Pass::refine(const Level& coarse, Level& fine) {
  gather_coarse_samples(coarse.visible, coarse.parity(), fine.visible);
  gather_coarse_samples(coarse.occluded, coarse.parity(), fine.occluded);
  place_coarse_samples(coarse.exact, coarse.parity(), fine.exact);
  for (std::size_t i = 0; i < fine.todo.bits.size(); ++i) {
    fine.todo.bits[i] = fine.visible.bits[i] & fine.occluded.bits[i];
    fine.cast.bits[i] = fine.exact.bits[i];
  }
  state_.changed.assign(static_cast<std::size_t>(fine.todo.size), 1);
  do {
    cast(fine);
  } while (find_uncertain(fine));
}

// Casts level.todo and adds it to level.cast.
void VisibilitySampler::Pass::cast(Level& level) {
  for_each_set(level.todo, [&](int x, int y) {
    level.visible.reset(x, y);
    level.occluded.reset(x, y);
    level.cast.set(x, y);
    state_.changed[static_cast<std::size_t>(y)] = 1;
    const int texel_x = x * level.cell + level.sample, texel_y = y * level.cell + level.sample;
    const bool above = above_.get(texel_x, texel_y);
    if (above) {
      level.exact.set(x, y);
      add(level, x, y, texel_x, texel_y);
    }
    add_lowest(level, x, y, {x * level.cell, y * level.cell, level.cell},
               above ? sampler_.pitch_ : 2);
  });
  flush(level);
}

// Adds, for a cell, the texel of a square in it that is least above the horizon, if its cosine is
// below `limit`: with the pitch of the texels, if the square touches the horizon. Thin slits and
// obstacles lie along it more often than anywhere else.
void VisibilitySampler::Pass::add_lowest(Level& level, int x, int y, const Square& square,
                                         float limit) {
  const int across = above_.size / kBlock;
  float lowest = limit;
  int lowest_x = 0, lowest_y = 0;
  for (int v = square.y; v < square.y + square.side; v += 4)
    for (int u = square.x; u < square.x + square.side; u += 4) {
      if (!state_.low[static_cast<std::size_t>(v / kBlock * across + u / kBlock)]) continue;
      const auto tile = static_cast<std::size_t>(v / 4 * (above_.size / 4) + u / 4);
      float cosine[16];
      const float in_tile = lowest_above(sampler_.finest_.tiles()[tile], normal_, cosine);
      if (in_tile >= lowest) continue;
      lowest = in_tile;
      const int lane = static_cast<int>(std::find(cosine, cosine + 16, in_tile) - cosine);
      lowest_x = u + lane % 4;
      lowest_y = v + lane / 4;
    }
  if (lowest < limit) add(level, x, y, lowest_x, lowest_y);
}

void VisibilitySampler::Pass::add(Level& level, int x, int y, int texel_x, int texel_y) {
  const Vector3f direction = sampler_.finest_.direction(texel_x, texel_y);
  packet_.x[lanes_] = direction.x();
  packet_.y[lanes_] = direction.y();
  packet_.z[lanes_] = direction.z();
  cell_x_[lanes_] = x;
  cell_y_[lanes_] = y;
  if (++lanes_ == 16) flush(level);
}

void VisibilitySampler::Pass::flush(Level& level) {
  if (lanes_ == 0) return;
  const std::uint32_t active = (1u << lanes_) - 1;
  const std::uint32_t hit =
      sampler_.scene_.occluded16(origin_, packet_.x, packet_.y, packet_.z, active);
  for (int i = 0; i < lanes_; ++i)
    (hit >> i & 1 ? level.occluded : level.visible).set(cell_x_[i], cell_y_[i]);
  rays_ += static_cast<std::uint64_t>(lanes_);
  lanes_ = 0;
}

void VisibilitySampler::Pass::cast_all(Tiles& tiles) {
  std::fill(tiles.todo.bits.begin(), tiles.todo.bits.end(), ~Word{0});
  if (tiles.todo.size < 64)
    for (Word& word : tiles.todo.bits) word = (Word{1} << tiles.todo.size) - 1;
  clear(tiles.visible);
  clear(tiles.occluded);
  clear(tiles.cast);
  state_.changed.assign(static_cast<std::size_t>(tiles.todo.size), 0);
  cast(tiles);
}

void VisibilitySampler::Pass::refine_to_tiles(const Level& level, Tiles& tiles) {
  // `cast` serves as a second set at first.
  gather_samples_around(level.visible, level.parity(), tiles.todo);
  gather_samples_around(level.occluded, level.parity(), tiles.cast);
  fill_cells(tiles.todo, tiles.visible);
  for (std::size_t i = 0; i < tiles.todo.bits.size(); ++i) tiles.todo.bits[i] &= tiles.cast.bits[i];
  for (std::size_t i = 0; i < tiles.above.bits.size(); ++i) {
    tiles.visible.bits[i] &= tiles.above.bits[i];
    tiles.occluded.bits[i] = tiles.above.bits[i] & ~tiles.visible.bits[i];
  }
  clear(tiles.cast);
  state_.changed.assign(static_cast<std::size_t>(tiles.todo.size), 1);
  do {
    cast(tiles);
  } while (find_uncertain(tiles));
}

void VisibilitySampler::Pass::cast(Tiles& tiles) {
  for_each_set(tiles.todo, [&](int x, int y) {
    tiles.cast.set(x, y);
    state_.changed[static_cast<std::size_t>(y)] = 1;
    const int word = x / 16, shift = x % 16 * 4;
    std::uint32_t above = 0;
    for (int r = 0; r < 4; ++r)
      above |= static_cast<std::uint32_t>(above_.row(4 * y + r)[word] >> shift & 15) << (4 * r);
    if (above == 0) return;
    const auto index = static_cast<std::size_t>(y * tiles.todo.size + x);
    const DirectionTile& tile = sampler_.finest_.tiles()[index];
    const std::uint32_t hit = sampler_.scene_.occluded16(origin_, tile.x, tile.y, tile.z, above);
    rays_ += static_cast<std::uint64_t>(std::popcount(above));
    for (int r = 0; r < 4; ++r) {
      const auto put = [&](BitGrid& grid, std::uint32_t bits) {
        Word& row = grid.row(4 * y + r)[word];
        row = (row & ~(Word{15} << shift)) | Word{bits >> (4 * r) & 15} << shift;
      };
      put(tiles.visible, above & ~hit);
      put(tiles.occluded, hit);
    }
  });
}

// Calls body(y) for the rows that have changed or touch one that has, and forgets the changes.
template <class Body>
void VisibilitySampler::Pass::for_dirty_rows(int rows, const Body& body) {
  const auto n = static_cast<std::size_t>(rows);
  state_.dirty.assign(n, 0);
  for (std::size_t y = 0; y < n; ++y)
    if (state_.changed[y]) {
      state_.dirty[y] = state_.dirty[n - 1 - y] = 1;  // its ends touch those of the mirrored row
      if (y > 0) state_.dirty[y - 1] = 1;
      if (y + 1 < n) state_.dirty[y + 1] = 1;
    }
  std::fill(state_.changed.begin(), state_.changed.end(), 0);
  for (std::size_t y = 0; y < n; ++y)
    if (state_.dirty[y]) body(static_cast<int>(y));
}

// Sets level.todo to the cells that were not cast and differ from a neighbour.
bool VisibilitySampler::Pass::find_uncertain(Level& level) {
  Word* near_visible = state_.rows.data();
  Word* near_occluded = near_visible + level.todo.words;
  Word any = 0;
  clear(level.todo);
  for_dirty_rows(level.todo.size, [&](int y) {
    gather_neighbours(level.visible, y, near_visible);
    gather_neighbours(level.occluded, y, near_occluded);
    for (int k = 0; k < level.todo.words; ++k) {
      const Word todo = ~level.cast.row(y)[k] & ((near_visible[k] & level.occluded.row(y)[k]) |
                                                 (near_occluded[k] & level.visible.row(y)[k]));
      level.todo.row(y)[k] = todo;
      any |= todo;
    }
  });
  return any != 0;
}

// Sets tiles.todo to the tiles that were not cast and have a texel that differs from a neighbour.
bool VisibilitySampler::Pass::find_uncertain(Tiles& tiles) {
  Word* near_visible = state_.rows.data();
  Word* near_occluded = near_visible + tiles.visible.words;
  Word any = 0;
  clear(tiles.todo);
  for_dirty_rows(tiles.todo.size, [&](int y) {
    for (int r = 4 * y; r < 4 * y + 4; ++r) {
      gather_neighbours(tiles.visible, r, near_visible);
      gather_neighbours(tiles.occluded, r, near_occluded);
      for (int k = 0; k < tiles.visible.words; ++k)
        tiles.todo.row(y)[k / 4] |= tiles_of((near_visible[k] & tiles.occluded.row(r)[k]) |
                                             (near_occluded[k] & tiles.visible.row(r)[k]))
                                    << (k % 4 * 16);
    }
    for (int k = 0; k < tiles.todo.words; ++k) {
      tiles.todo.row(y)[k] &= ~tiles.cast.row(y)[k];
      any |= tiles.todo.row(y)[k];
    }
  });
  return any != 0;
}

std::uint64_t VisibilitySampler::sample(const Vector3f& origin, const Vector3f& normal,
                                        VisibilityMask& mask, Scratch& scratch) const {
  const int n = finest_.resolution();
  if (!scratch.state_ || scratch.state_->tiles.above.size != n ||
      scratch.state_->coarsest != coarsest_)
    scratch.state_ = std::make_unique<Scratch::State>(n, coarsest_);
  Scratch::State& state = *scratch.state_;
  Pass pass(*this, origin, normal, state);
  if (!pass.find_horizon() || scene_.hemisphere_is_empty(origin, normal)) {
    mask.bits = state.tiles.above.bits;
    return 0;
  }
  if (state.levels.empty()) {
    pass.cast_all(state.tiles);
  } else {
    pass.sample_coarsest(state.levels.front());
    for (std::size_t k = 1; k < state.levels.size(); ++k)
      pass.refine(state.levels[k - 1], state.levels[k]);
    pass.refine_to_tiles(state.levels.back(), state.tiles);
  }
  mask.bits = state.tiles.visible.bits;
  return pass.rays();
}

VisibilityCheck& VisibilityCheck::operator+=(const VisibilityCheck& other) {
  directions += other.directions;
  differing += other.differing;
  sampler_rays += other.sampler_rays;
  all_rays += other.all_rays;
  return *this;
}

VisibilityCheck check_visibility(const RayScene& scene, const DirectionTable& finest,
                                 const VisibilitySampler& sampler, const Vector3f& origin,
                                 const Vector3f& normal, VisibilityMask& sampled,
                                 VisibilityMask& truth, VisibilitySampler::Scratch& scratch) {
  VisibilityCheck check;
  check.sampler_rays = sampler.sample(origin, normal, sampled, scratch);
  check.all_rays = sample_visibility_from(scene, finest, origin, normal, truth);
  check.directions = 64 * truth.bits.size();
  for (std::size_t i = 0; i < truth.bits.size(); ++i)
    check.differing += static_cast<std::uint64_t>(std::popcount(sampled.bits[i] ^ truth.bits[i]));
  return check;
}

}  // namespace burnish
