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
        // The coarsest samples lie in the middle of their cells, so that none is near the map's
        // edge; the finer ones are where the coarser ones have been.
        sample(coarsest ? cell / 2 : 0) {}
};

}  // namespace

struct VisibilitySampler::Scratch::State {
  BitGrid above;  // the finest texels above the horizon
  std::vector<Level> levels;
  std::vector<float> cosine;  // of the blocks
  std::vector<Word> rows;     // two rows of neighbours
  std::vector<unsigned char> dirty, changed;

  State(int finest, int coarsest) : above(finest) {
    for (int size = coarsest; size <= finest; size *= 2)
      levels.emplace_back(size, finest, size == coarsest);
    rows.resize(2 * static_cast<std::size_t>(above.words));
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
      // |n . d - n . mean| <= |d - mean|, and some float roundings.
      blocks_.margin.push_back(radius + 1e-5f);
    }
}

// The rays of one vertex.
class VisibilitySampler::Pass {
 public:
  Pass(const VisibilitySampler& sampler, const Vector3f& origin, const Vector3f& normal,
       Scratch::State& state)
      : sampler_(sampler), origin_(origin), normal_(normal), state_(state) {}

  // Whether any direction is above the horizon.
  bool find_horizon() {
    const Blocks& blocks = sampler_.blocks_;
    const std::size_t count = blocks.x.size();
    state_.cosine.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      state_.cosine[i] =
          blocks.x[i] * normal_.x() + blocks.y[i] * normal_.y() + blocks.z[i] * normal_.z();
    const int across = state_.above.size / kBlock;
    bool any = false;
    for (int y = 0; y < across; ++y)
      for (int x = 0; x < across; ++x) {
        const auto i = static_cast<std::size_t>(y * across + x);
        const float cosine = state_.cosine[i];
        Word bits = 0;  // also where the normal is NaN
        if (cosine >= blocks.margin[i])
          bits = ~Word{0};
        else if (cosine > -blocks.margin[i])
          bits = block_above(x, y);
        any |= bits != 0;
        for (int row = 0; row < kBlock; ++row) {
          Word& word = state_.above.row(y * kBlock + row)[x / 8];
          const int shift = x % 8 * 8;
          word = (word & ~(Word{0xff} << shift)) | (bits >> (8 * row) & 0xff) << shift;
        }
      }
    return any;
  }

  void sample_coarsest() {
    Level& level = state_.levels.front();
    for (auto* grid : {&level.visible, &level.occluded, &level.exact})
      std::fill(grid->bits.begin(), grid->bits.end(), 0);
    for (int y = 0; y < level.todo.size; y += 4)
      for (int x = 0; x < level.todo.size; x += 4)
        for (int i = 0; i < 16; ++i) sample_coarsest(level, x + i % 4, y + i / 4);
    flush(level);
  }

  void refine(const Level& coarse, Level& fine) {
    const SampleParity parity = coarse.sample == 0 ? SampleParity::even : SampleParity::odd;
    gather_coarse_samples(coarse.visible, parity, fine.visible);
    gather_coarse_samples(coarse.occluded, parity, fine.occluded);
    place_coarse_samples(coarse.exact, parity, fine.exact);
    for (std::size_t i = 0; i < fine.todo.bits.size(); ++i) {
      fine.todo.bits[i] = fine.visible.bits[i] & fine.occluded.bits[i];
      fine.exact.bits[i] &= ~fine.todo.bits[i];
      fine.cast.bits[i] = fine.exact.bits[i];
    }
    const auto rows = static_cast<std::size_t>(fine.todo.size);
    state_.changed.assign(rows, 1);
    do {
      cast(fine);
    } while (find_uncertain(fine));
  }

  std::uint64_t rays() const { return rays_; }

 private:
  Word block_above(int x, int y) const {
    const auto tiles = static_cast<std::size_t>(state_.above.size / 4);
    Word bits = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t column = k % 2, row = k / 2;
      const std::size_t tile = (2 * static_cast<std::size_t>(y) + row) * tiles +
                               2 * static_cast<std::size_t>(x) + column;
      const Word above = above_horizon(sampler_.finest_.tiles()[tile], normal_);
      for (std::size_t r = 0; r < 4; ++r)
        bits |= (above >> (4 * r) & 15) << (8 * (4 * row + r) + 4 * column);
    }
    return bits;
  }

  void sample_coarsest(Level& level, int x, int y) {
    const int size = level.cell;
    const int middle_x = x * size + level.sample, middle_y = y * size + level.sample;
    const bool middle = state_.above.get(middle_x, middle_y);
    if (middle) {
      level.exact.set(x, y);
      add(level, x, y, middle_x, middle_y);
    }
    if (crosses_horizon(x * size, y * size, size)) add_lowest(level, x, y);
  }

  // Whether some texels of a cell are above the horizon and some are not.
  bool crosses_horizon(int x, int y, int size) const {
    const int width = std::min(size, 64);
    const Word mask = width == 64 ? ~Word{0} : (Word{1} << width) - 1;
    Word any = 0, all = mask;
    for (int k = y; k < y + size; ++k)
      for (int i = x; i < x + size; i += width) {
        const Word bits = state_.above.row(k)[i / 64] >> (i % 64) & mask;
        any |= bits;
        all &= bits;
      }
    return any != 0 && all != mask;
  }

  // Adds the cell's texel nearest to the horizon, if any is above it: what lies low over a surface
  // is met there.
  void add_lowest(Level& level, int x, int y) {
    const int size = level.cell;
    float lowest = 2;
    int best_x = 0, best_y = 0;
    for (int v = y * size; v < (y + 1) * size; ++v)
      for (int u = x * size; u < (x + 1) * size; ++u) {
        if (!state_.above.get(u, v)) continue;
        const float cosine = sampler_.finest_.direction(u, v).dot(normal_);
        if (cosine >= lowest) continue;
        lowest = cosine;
        best_x = u;
        best_y = v;
      }
    if (lowest < 2) add(level, x, y, best_x, best_y);
  }

  void add(Level& level, int x, int y, int texel_x, int texel_y) {
    const Vector3f direction = sampler_.finest_.direction(texel_x, texel_y);
    packet_.x[lanes_] = direction.x();
    packet_.y[lanes_] = direction.y();
    packet_.z[lanes_] = direction.z();
    cell_x_[lanes_] = x;
    cell_y_[lanes_] = y;
    if (++lanes_ == 16) flush(level);
  }

  void flush(Level& level) {
    if (lanes_ == 0) return;
    const std::uint32_t active = (1u << lanes_) - 1;
    const std::uint32_t hit =
        sampler_.scene_.occluded16(origin_, packet_.x, packet_.y, packet_.z, active);
    for (int i = 0; i < lanes_; ++i)
      (hit >> i & 1 ? level.occluded : level.visible).set(cell_x_[i], cell_y_[i]);
    rays_ += static_cast<std::uint64_t>(lanes_);
    lanes_ = 0;
  }

  // Casts level.todo, a tile at a time, and moves it to level.cast.
  void cast(Level& level) {
    for (int y = 0; y < level.todo.size; y += 4)
      for (int k = 0; k < level.todo.words; ++k) {
        Word rows[4];
        for (int r = 0; r < 4; ++r) rows[r] = level.todo.row(y + r)[k];
        Word any = rows[0] | rows[1] | rows[2] | rows[3];
        while (any != 0) {
          const int shift = std::countr_zero(any) & ~3;
          any &= ~(Word{15} << shift);
          for (int r = 0; r < 4; ++r)
            for (Word bits = rows[r] >> shift & 15; bits != 0; bits &= bits - 1)
              cast(level, 64 * k + shift + std::countr_zero(bits), y + r);
        }
        for (int r = 0; r < 4; ++r) {
          if (rows[r] == 0) continue;
          level.cast.row(y + r)[k] |= rows[r];
          state_.changed[static_cast<std::size_t>(y + r)] = 1;
        }
      }
    flush(level);
  }

  void cast(Level& level, int x, int y) {
    level.visible.reset(x, y);
    level.occluded.reset(x, y);
    const int sample_x = x * level.cell + level.sample, sample_y = y * level.cell + level.sample;
    if (state_.above.get(sample_x, sample_y)) {
      level.exact.set(x, y);
      add(level, x, y, sample_x, sample_y);
    } else {
      add_lowest(level, x, y);
    }
  }

  // Fills level.todo with the cells that were not cast and differ from a neighbour.
  bool find_uncertain(Level& level) {
    const auto n = static_cast<std::size_t>(level.todo.size);
    std::vector<unsigned char>& dirty = state_.dirty;
    dirty.assign(n, 0);
    for (std::size_t y = 0; y < n; ++y)
      if (state_.changed[y]) {
        dirty[y] = dirty[n - 1 - y] = 1;  // its ends touch those of the mirrored row
        if (y > 0) dirty[y - 1] = 1;
        if (y + 1 < n) dirty[y + 1] = 1;
      }
    std::fill(state_.changed.begin(), state_.changed.end(), 0);
    Word* near_visible = state_.rows.data();
    Word* near_occluded = near_visible + level.todo.words;
    Word any = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const int y = static_cast<int>(i);
      Word* todo = level.todo.row(y);
      if (!dirty[i]) {
        std::fill_n(todo, level.todo.words, 0);
        continue;
      }
      gather_neighbours(level.visible, y, near_visible);
      gather_neighbours(level.occluded, y, near_occluded);
      for (int k = 0; k < level.todo.words; ++k) {
        todo[k] = ~level.cast.row(y)[k] & ((near_visible[k] & level.occluded.row(y)[k]) |
                                           (near_occluded[k] & level.visible.row(y)[k]));
        any |= todo[k];
      }
    }
    return any != 0;
  }

  const VisibilitySampler& sampler_;
  Vector3f origin_, normal_;
  Scratch::State& state_;
  std::uint64_t rays_ = 0;
  DirectionTile packet_;
  int cell_x_[16], cell_y_[16];
  int lanes_ = 0;
};

std::uint64_t VisibilitySampler::sample(const Vector3f& origin, const Vector3f& normal,
                                        VisibilityMask& mask, Scratch& scratch) const {
  const int n = finest_.resolution();
  if (!scratch.state_ || scratch.state_->above.size != n ||
      scratch.state_->levels.front().todo.size != coarsest_)
    scratch.state_ = std::make_unique<Scratch::State>(n, coarsest_);
  Scratch::State& state = *scratch.state_;
  Pass pass(*this, origin, normal, state);
  if (!pass.find_horizon() || scene_.hemisphere_is_empty(origin, normal)) {
    mask.bits = state.above.bits;
    return 0;
  }
  pass.sample_coarsest();
  for (std::size_t k = 1; k < state.levels.size(); ++k)
    pass.refine(state.levels[k - 1], state.levels[k]);
  const BitGrid& visible = state.levels.back().visible;
  for (std::size_t i = 0; i < mask.bits.size(); ++i)
    mask.bits[i] = visible.bits[i] & state.above.bits[i];
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
