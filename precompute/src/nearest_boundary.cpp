#include "nearest_boundary.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

// Sizeless vectors cannot be the elements of an array; those machines run the NEON or scalar
// target. To be defined before any header of Highway.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nearest_boundary.cpp"
// foreach_target.h has to be the first.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

// How the nearest points are found: down a quadtree of squares of texels. Let the texels of a
// square lie in a ball of radius r around t, and p0 be a boundary point near them. A point p can be
// the nearest of some texel q only if q.(p0 - p) <= 0 (all are unit vectors), and over the ball the
// left side is never less than t.(p0 - p) - r |p0 - p|. Points come in cells; for a cell inside a
// ball of radius s around its point c, from |t - p| >= |t - c| - s follows t.p <= t.c + s |t - c|,
// and so it can be left out unless
//     t.(p0 - c) - r |p0 - c| <= s (|t - c| + r).
// A square hands only such cells to its four children. The finest squares, of 8 x 8 texels, test
// each point of their cells alike, and compare their texels with all that remain.
//
// The comparison is that of |q' - p'|^2 - |q'|^2 = |p'|^2 - 2 q'.p', with q' and p' relative to t:
// near the boundary these are small, and so is their rounding.

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, 16>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::VFromD<D>;
using Scratch = SphericalDistanceTransform::Scratch;
using Cells = Scratch::Cells;
using Square = SphericalDistanceTransform::Square;

constexpr std::size_t kLanes = hn::MaxLanes(D());
constexpr float kSlack = 2e-6f;  // covers the rounding of dot products and squares

struct Vector {
  V x, y, z;
};

HWY_INLINE Vector broadcast(const Vector3f& v) {
  const D d;
  return {hn::Set(d, v.x()), hn::Set(d, v.y()), hn::Set(d, v.z())};
}
HWY_INLINE Vector load(const float* x, const float* y, const float* z) {
  const D d;
  return {hn::LoadU(d, x), hn::LoadU(d, y), hn::LoadU(d, z)};
}
HWY_INLINE Vector difference(const Vector& a, const Vector& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE V dot(const Vector& a, const Vector& b) {
  return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}
HWY_INLINE V positive_sqrt(V v) { return hn::Sqrt(hn::Max(v, hn::Zero(D()))); }

/// Which of a list has the largest value so far.
struct Largest {
  V value;
  hn::VFromD<DU> index;

  static HWY_INLINE Largest of_none() { return {hn::Set(D(), -10.0f), hn::Zero(DU())}; }

  HWY_INLINE void add(V candidate, std::size_t first) {
    const DU du;
    const auto larger = hn::RebindMask(du, hn::Gt(candidate, value));
    index = hn::IfThenElse(larger, hn::Iota(du, static_cast<std::uint32_t>(first)), index);
    value = hn::Max(value, candidate);
  }
  HWY_INLINE std::size_t where() const {
    const D d;
    const auto is_largest = hn::Eq(value, hn::MaxOfLanes(d, value));
    return hn::ExtractLane(index, hn::FindKnownFirstTrue(d, is_largest));
  }
};

/// Directions of the boundary's points, by octahedral_to_direction().
void place_points(std::size_t size, int resolution, Scratch& scratch) {
  const D d;
  const hn::RebindToSigned<D> di;
  const V one = hn::Set(d, 1.0f), quarter_pi = hn::Set(d, kPi<float> / 4);
  const V scale = hn::Set(d, 1.0f / static_cast<float>(resolution));
  for (std::size_t i = 0; i < size; i += kLanes) {
    const auto place = hn::BitCast(di, hn::LoadU(DU(), &scratch.places[i]));
    const auto x = hn::And(place, hn::Set(di, 0xffff)), y = hn::ShiftRight<16>(place);
    const V s = hn::MulSub(hn::ConvertTo(d, x), scale, one);
    const V t = hn::MulSub(hn::ConvertTo(d, y), scale, one);
    const V up = hn::Abs(s), vp = hn::Abs(t);
    const V signed_distance = hn::Sub(one, hn::Add(up, vp));
    const V r = hn::Sub(one, hn::Abs(signed_distance));
    const V ratio = hn::Div(hn::Sub(vp, up), hn::Max(r, hn::Set(d, 1e-20f)));
    const V phi = hn::MulAdd(ratio, quarter_pi, quarter_pi);
    const V square = hn::Mul(r, r);
    const V radius = hn::Mul(r, hn::Sqrt(hn::Sub(hn::Set(d, 2.0f), square)));
    hn::StoreU(hn::CopySign(hn::Mul(hn::Cos(d, phi), radius), s), d, &scratch.x[i]);
    hn::StoreU(hn::CopySign(hn::Mul(hn::Sin(d, phi), radius), t), d, &scratch.y[i]);
    hn::StoreU(hn::CopySign(hn::Sub(one, square), signed_distance), d, &scratch.z[i]);
  }
  // What is loaded beyond the end is the last point.
  for (float* points : {scratch.x.data(), scratch.y.data(), scratch.z.data()})
    std::fill_n(points + size, kLanes, points[size - 1]);
}

/// Fills the last vector with cells that are nearest to nothing, and never kept.
void pad(Cells& cells) {
  const D d;
  for (std::vector<float>* coordinate : {&cells.x, &cells.y, &cells.z})
    hn::StoreU(hn::Set(d, 0.0f), d, coordinate->data() + cells.size);
  hn::StoreU(hn::Set(d, -10.0f), d, cells.radius.data() + cells.size);
}

void bound_cells(Scratch& scratch) {
  const D d;
  Cells& cells = scratch.levels.front();
  for (std::size_t cell = 0; cell < cells.size; ++cell) {
    const std::size_t begin = scratch.cell_begin[cell], end = scratch.cell_begin[cell + 1];
    const std::size_t middle = (begin + end) / 2;
    cells.x[cell] = scratch.x[middle];
    cells.y[cell] = scratch.y[middle];
    cells.z[cell] = scratch.z[middle];
    const Vector center = broadcast({cells.x[cell], cells.y[cell], cells.z[cell]});
    V farthest = hn::Zero(d);
    for (std::size_t i = begin; i < end; i += kLanes) {
      const Vector away = difference(load(&scratch.x[i], &scratch.y[i], &scratch.z[i]), center);
      farthest = hn::Max(farthest, hn::IfThenElseZero(hn::FirstN(d, end - i), dot(away, away)));
    }
    cells.radius[cell] = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, farthest)));
    cells.index[cell] = static_cast<std::uint32_t>(cell);
  }
  pad(cells);
}

class Search {
 public:
  Search(const TexelTree& tree, Scratch& scratch, float* chords)
      : tree_(tree), scratch_(scratch), chords_(chords) {}

  void descend(std::size_t level, std::size_t x, std::size_t y) {
    const std::size_t across = tree_.root_across << level;
    const Square& square = tree_.levels[level][y * across + x];
    const Vector3f near = keep_cells(square, scratch_.levels[level], scratch_.levels[level + 1]);
    if (level + 1 == tree_.levels.size()) {
      compare(x, y, square, keep_points(square, near, scratch_.levels[level + 1]));
      return;
    }
    for (std::size_t child = 0; child < 4; ++child)
      descend(level + 1, 2 * x + child % 2, 2 * y + child / 2);
  }

 private:
  /// Returns the middle of the cell that is nearest to the square.
  Vector3f keep_cells(const Square& square, const Cells& given, Cells& kept) {
    const D d;
    const DU du;
    const Vector t = broadcast(square.center);
    Largest largest = Largest::of_none();
    float* cosines = scratch_.cosines.data();
    for (std::size_t i = 0; i < given.size; i += kLanes) {
      const V cosine = dot(t, load(&given.x[i], &given.y[i], &given.z[i]));
      hn::StoreU(cosine, d, cosines + i);
      largest.add(hn::Add(cosine, hn::Min(hn::LoadU(d, &given.radius[i]), hn::Zero(d))), i);
    }
    const std::size_t nearest = largest.where();
    const Vector3f near(given.x[nearest], given.y[nearest], given.z[nearest]);
    const Vector p0 = broadcast(near);
    const V r = hn::Set(d, square.radius), two = hn::Set(d, 2.0f), slack = hn::Set(d, kSlack);
    const V limit = hn::Set(d, cosines[nearest] - kSlack);
    // |a - b|^2 = |a|^2 + |b|^2 - 2 a.b
    const V squares = hn::Set(d, 1 + kSlack + square.center.squaredNorm());
    std::size_t size = 0;
    for (std::size_t i = 0; i < given.size; i += kLanes) {
      const Vector c = load(&given.x[i], &given.y[i], &given.z[i]);
      const V radius = hn::LoadU(d, &given.radius[i]), cosine = hn::LoadU(d, cosines + i);
      const V from_p0 = positive_sqrt(hn::NegMulAdd(two, dot(p0, c), hn::Add(two, slack)));
      const V from_t = positive_sqrt(hn::NegMulAdd(two, cosine, squares));
      const V least = hn::NegMulAdd(r, from_p0, hn::Sub(limit, cosine));
      const auto keep = hn::Le(least, hn::Mul(radius, hn::Add(from_t, r)));
      hn::StoreU(hn::Compress(c.x, keep), d, &kept.x[size]);
      hn::StoreU(hn::Compress(c.y, keep), d, &kept.y[size]);
      hn::StoreU(hn::Compress(c.z, keep), d, &kept.z[size]);
      hn::StoreU(hn::Compress(radius, keep), d, &kept.radius[size]);
      const auto index = hn::LoadU(du, &given.index[i]);
      hn::StoreU(hn::Compress(index, hn::RebindMask(du, keep)), du, &kept.index[size]);
      size += hn::CountTrue(d, keep);
    }
    kept.size = size;
    pad(kept);
    return near;
  }

  /// Leaves the points that can be the nearest of some texel, as -2 p' and |p'|^2, in the scratch's
  /// local arrays; returns their number.
  std::size_t keep_points(const Square& square, const Vector3f& near, const Cells& cells) {
    const D d;
    const Vector t = broadcast(square.center);
    const Vector3f local_near = near - square.center;
    const Vector p0 = broadcast(local_near);
    const V limit = hn::Set(d, local_near.squaredNorm() + kSlack);
    const V reach_squared = hn::Set(d, 4 * square.radius * square.radius);
    const V minus_two = hn::Set(d, -2.0f);
    const float *x = scratch_.x.data(), *y = scratch_.y.data(), *z = scratch_.z.data();
    float *kept_x = scratch_.local_x.data(), *kept_y = scratch_.local_y.data();
    float *kept_z = scratch_.local_z.data(), *kept_square = scratch_.local_square.data();
    const std::uint32_t *cell_begin = scratch_.cell_begin.data(), *index = cells.index.data();
    std::size_t size = 0;
    for (std::size_t cell = 0; cell < cells.size; ++cell) {
      const std::size_t end = cell_begin[index[cell] + 1];
      for (std::size_t i = cell_begin[index[cell]]; i < end; i += kLanes) {
        const Vector p = difference(load(x + i, y + i, z + i), t);
        const V length = dot(p, p);
        const Vector from_p0 = difference(p, p0);
        // length - limit <= 2 r |p - p0|, squared
        const V excess = hn::Sub(length, limit);
        const V most = hn::Mul(reach_squared, dot(from_p0, from_p0));
        const auto near_enough = hn::Le(hn::Mul(excess, hn::Abs(excess)), most);
        const auto keep = hn::And(near_enough, hn::FirstN(d, end - i));
        hn::StoreU(hn::Compress(hn::Mul(minus_two, p.x), keep), d, kept_x + size);
        hn::StoreU(hn::Compress(hn::Mul(minus_two, p.y), keep), d, kept_y + size);
        hn::StoreU(hn::Compress(hn::Mul(minus_two, p.z), keep), d, kept_z + size);
        hn::StoreU(hn::Compress(length, keep), d, kept_square + size);
        size += hn::CountTrue(d, keep);
      }
    }
    return size;
  }

  /// Writes the squared chords of 8 x 8 texels.
  void compare(std::size_t x, std::size_t y, const Square& square, std::size_t points) {
    const D d;
    constexpr std::size_t kVectors = 64 / kLanes, kOfTile = 16 / kLanes;
    const auto n = static_cast<std::size_t>(tree_.texels.resolution());
    const Vector t = broadcast(square.center);
    V qx[kVectors], qy[kVectors], qz[kVectors], least[kVectors];
    for (std::size_t k = 0; k < kVectors; ++k) {
      const std::size_t part = k / kOfTile, lane = k % kOfTile * kLanes;
      const DirectionTile& tile =
          tree_.texels.tiles()[(2 * y + part / 2) * (n / 4) + 2 * x + part % 2];
      const Vector q = difference(load(tile.x + lane, tile.y + lane, tile.z + lane), t);
      qx[k] = q.x;
      qy[k] = q.y;
      qz[k] = q.z;
      least[k] = hn::Set(d, 10.0f);
    }
    const float *px = scratch_.local_x.data(), *py = scratch_.local_y.data();
    const float *pz = scratch_.local_z.data(), *squares = scratch_.local_square.data();
    for (std::size_t i = 0; i < points; ++i) {
      const Vector p = broadcast({px[i], py[i], pz[i]});
      const V length = hn::Set(d, squares[i]);
      for (std::size_t k = 0; k < kVectors; ++k) {
        const V value =
            hn::MulAdd(qx[k], p.x, hn::MulAdd(qy[k], p.y, hn::MulAdd(qz[k], p.z, length)));
        least[k] = hn::Min(least[k], value);
      }
    }
    HWY_ALIGN float chords[64];
    for (std::size_t k = 0; k < kVectors; ++k) {
      const V length = dot({qx[k], qy[k], qz[k]}, {qx[k], qy[k], qz[k]});
      hn::Store(hn::Max(hn::Add(least[k], length), hn::Zero(d)), d, chords + k * kLanes);
    }
    for (std::size_t row = 0; row < 16; ++row) {
      const std::size_t part = row / 4;
      std::copy_n(chords + 4 * row, 4,
                  chords_ + (8 * y + part / 2 * 4 + row % 4) * n + 8 * x + part % 2 * 4);
    }
  }

  const TexelTree& tree_;
  Scratch& scratch_;
  float* chords_;
};

/// Turns squared chords into angles of the given signs.
void to_angles(const float* signs, std::size_t size, float* chords) {
  const D d;
  for (std::size_t i = 0; i < size; i += kLanes) {
    const V half = hn::Mul(hn::Set(d, 0.5f), hn::Sqrt(hn::LoadU(d, chords + i)));
    const V angle = hn::Asin(d, hn::Min(half, hn::Set(d, 1.0f)));
    hn::StoreU(hn::Mul(hn::LoadU(d, signs + i), hn::Add(angle, angle)), d, chords + i);
  }
}

void reserve(std::vector<float>& values, std::size_t size) {
  if (values.size() < size) values.resize(size);
}

void reserve(const TexelTree& tree, Scratch& scratch) {
  const std::size_t cells = scratch.cell_begin.size() - 1, points = scratch.cell_begin.back();
  scratch.levels.resize(tree.levels.size() + 1);
  for (Cells& level : scratch.levels) {
    for (std::vector<float>* values : {&level.x, &level.y, &level.z, &level.radius})
      reserve(*values, cells + kLanes);
    if (level.index.size() < cells + kLanes) level.index.resize(cells + kLanes);
  }
  scratch.levels.front().size = cells;
  reserve(scratch.cosines, cells + kLanes);
  for (std::vector<float>* values : {&scratch.x, &scratch.y, &scratch.z, &scratch.local_x,
                                     &scratch.local_y, &scratch.local_z, &scratch.local_square})
    reserve(*values, points + 2 * kLanes);
  if (scratch.places.size() < points + kLanes) scratch.places.resize(points + kLanes);
}

void find_nearest(const TexelTree& tree, int mask_resolution, Scratch& scratch, float* ssdf) {
  reserve(tree, scratch);
  place_points(scratch.cell_begin.back(), mask_resolution, scratch);
  bound_cells(scratch);
  Search search(tree, scratch, ssdf);
  const std::size_t across = tree.root_across;
  for (std::size_t root = 0; root < across * across; ++root)
    search.descend(0, root % across, root / across);
  const auto n = static_cast<std::size_t>(tree.texels.resolution());
  to_angles(scratch.signs.data(), n * n, ssdf);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {

HWY_EXPORT(find_nearest);

void find_nearest_boundary(const TexelTree& tree, int mask_resolution,
                           SphericalDistanceTransform::Scratch& scratch, float* ssdf) {
  HWY_DYNAMIC_DISPATCH(find_nearest)(tree, mask_resolution, scratch, ssdf);
}

}  // namespace burnish
#endif
