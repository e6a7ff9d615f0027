// What eval_prefiltered does lane by lane: it fetches texels. Each lookup is a sum over 3 x 3
// coefficients of a quadratic B-spline, as differences from a reference, so that a constant map
// stays that constant to the bit.

#if defined(BURNISH_LIGHT_TEXEL_ROWS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_LIGHT_TEXEL_ROWS_INL_H_
#undef BURNISH_LIGHT_TEXEL_ROWS_INL_H_
#else
#define BURNISH_LIGHT_TEXEL_ROWS_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <hwy/highway.h>

#include "burnish/light/prefiltered_environment.h"
#include "light/cube_faces.h"
#include "light/map_pixels.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

inline constexpr size_t kMostLanes = 16;

/// The last level whose bandwidth is at most this, or the first. Levels are a factor of sqrt(2)
/// apart, so that the exponent and the next bit all but tell.
inline size_t level_below(const std::vector<PrefilteredEnvironment::Level>& levels,
                          float bandwidth) {
  const int half_octaves = static_cast<int>(std::bit_cast<std::uint32_t>(bandwidth) >> 22) - 254;
  const int last = static_cast<int>(levels.size()) - 1;
  auto i = static_cast<size_t>(std::clamp(half_octaves, 0, last));
  while (i > 0 && bandwidth < levels[i].bandwidth) --i;
  while (i + 1 < levels.size() && bandwidth >= levels[i + 1].bandwidth) ++i;
  return i;
}

/// Of each lane the two levels that its taps are looked up in: the wider [0], the narrower [1].
template <class T>
struct LaneLevels {
  alignas(64) T share[2][kMostLanes];
  alignas(64) T half_size[2][kMostLanes];  ///< half the texels across a face
  alignas(64) T narrow_variance[kMostLanes];
  const float* texels[2][kMostLanes];  ///< null: the map's pixels
  size_t stride[2][kMostLanes];        ///< floats from row to row

  void set(int l, size_t lane, const PrefilteredEnvironment::Level& level) {
    half_size[l][lane] = T(0.5f) * static_cast<T>(level.resolution);
    texels[l][lane] = reinterpret_cast<const float*>(level.coefficients.data());
    stride[l][lane] = 4 * (static_cast<size_t>(level.resolution) + 2);
  }
};

/// A tap of each lane.
template <class T>
struct LaneTaps {
  alignas(64) T weight[kMostLanes];  ///< 0: not to be fetched
  alignas(64) T direction[3][kMostLanes];
  // By level. The 3 x 3 texels begin at this row and column.
  alignas(64) hwy::MakeSigned<T> row[2][kMostLanes], column[2][kMostLanes];
  alignas(64) T before[2][kMostLanes], after[2][kMostLanes];  ///< weights of the outer rows
  alignas(64) T columns[2][4 * kMostLanes];  ///< of columns, times the tap's and the level's
};

/// sum / (sum of weights) + reference is a lane's mean radiance. The first tap clears its lane.
template <class T>
struct LaneSums {
  alignas(64) T reference[kMostLanes][4];
  alignas(64) T parts[kMostLanes][4][4];  ///< of the sum
  alignas(64) T sum[kMostLanes][4];       ///< of the parts, when all are done

  void clear(size_t lane) {
    for (size_t c = 0; c < 4; ++c) reference[lane][c] = 0;
    for (T(&part)[4] : parts[lane])
      for (T& number : part) number = 0;
  }
};

template <class T>
HWY_INLINE void add_parts(const T (&parts)[4][4], T (&sum)[4]) {
  for (size_t c = 0; c < 4; ++c) sum[c] = (parts[0][c] + parts[1][c]) + (parts[2][c] + parts[3][c]);
}

/// Adds 3 x 3 texels, of which `corner` is the first. In double, which needs not be fast, and
/// where vectors are shorter than a texel.
template <class T>
HWY_INLINE void add_texels(const float* corner, size_t stride, T before, T after, const T* columns,
                           const T* reference, T* sum) {
  for (size_t k = 0; k < 3; ++k)
    for (size_t c = 0; c < 4; ++c) {
      const T middle = corner[stride + 4 * k + c];
      const T row = middle + before * (corner[4 * k + c] - middle) +
                    after * (corner[2 * stride + 4 * k + c] - middle);
      sum[4 * k + c] += columns[k] * (row - reference[c]);
    }
}

#if HWY_TARGET != HWY_SCALAR
/// A vector of texels at a time.
HWY_INLINE void add_texels(const float* corner, size_t stride, float before, float after,
                           const float* columns, const float* reference, float* sum) {
  const hn::CappedTag<float, 16> d;  // a row of up to four texels
  const hn::Repartition<uint8_t, decltype(d)> d8;
  constexpr size_t kTexels = hn::MaxLanes(d) / 4;
  const auto base = hn::LoadDup128(d, reference);
  const auto of_before = hn::Set(d, before), of_after = hn::Set(d, after);
  auto total = hn::Load(d, sum);
  for (size_t k = 0; k < 3; k += kTexels) {
    const auto load = [&](const float* row) HWY_ATTR {
      return k + kTexels <= 3 ? hn::LoadU(d, row + 4 * k)
                              : hn::MaskedLoad(hn::FirstN(d, 12 - 4 * k), d, row + 4 * k);
    };
    const auto middle = load(corner + stride);
    auto rows = hn::MulAdd(of_before, load(corner) - middle, middle);
    rows = hn::MulAdd(of_after, load(corner + 2 * stride) - middle, rows);
    hn::VFromD<decltype(d)> weights;
    if constexpr (kTexels == 1) {
      weights = hn::Set(d, columns[k]);
    } else {
      alignas(64) static constexpr uint8_t kSpread[64] = {
          0,  1,  2,  3,  0,  1,  2,  3,  0,  1,  2,  3,  0,  1,  2,  3,   //
          4,  5,  6,  7,  4,  5,  6,  7,  4,  5,  6,  7,  4,  5,  6,  7,   //
          8,  9,  10, 11, 8,  9,  10, 11, 8,  9,  10, 11, 8,  9,  10, 11,  //
          12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15, 12, 13, 14, 15};
      const auto all = hn::BitCast(d8, hn::LoadDup128(d, columns));
      weights = hn::BitCast(d, hn::TableLookupBytes(all, hn::Load(d8, kSpread + 16 * k)));
    }
    total = hn::MulAdd(weights, rows - base, total);
  }
  hn::Store(total, d, sum);
}
HWY_INLINE void add_parts(const float (&parts)[4][4], float (&sum)[4]) {
  const hn::Full128<float> d;
  const auto first = hn::Load(d, parts[0]) + hn::Load(d, parts[1]);
  hn::Store(first + (hn::Load(d, parts[2]) + hn::Load(d, parts[3])), d, sum);
}
#endif

/// Adds the map's own pixels. The first tap's are the reference.
template <class T>
void add_pixels(const Image& map, const LaneLevels<T>& levels, const LaneTaps<T>& taps, size_t lane,
                bool is_first, LaneSums<T>& sums) {
  const Vector3f direction(static_cast<float>(taps.direction[0][lane]),
                           static_cast<float>(taps.direction[1][lane]),
                           static_cast<float>(taps.direction[2][lane]));
  const Eigen::Array4f seen =
      eval_map_pixels(map, direction, static_cast<float>(levels.narrow_variance[lane]));
  const T weight = taps.weight[lane] * levels.share[1][lane];
  for (size_t c = 0; c < 4; ++c) {
    const T value = static_cast<T>(seen[static_cast<Eigen::Index>(c)]);
    if (is_first) sums.reference[lane][c] = value;
    sums.parts[lane][0][c] += weight * (value - sums.reference[lane][c]);
  }
}

HWY_INLINE void set_reference(const float* texel, double* reference) {
  for (size_t c = 0; c < 4; ++c) reference[c] = texel[c];
}
/// In one piece: a vector that is read right after its parts were written waits for them.
HWY_INLINE void set_reference(const float* texel, float* reference) {
  std::memcpy(reference, texel, 4 * sizeof(float));
}

/// Adds a tap of each lane. The reference is a texel of the first tap's narrower level, or what its
/// pixels show: that is never much brighter than the wider, so that differences keep their digits.
template <class T>
HWY_INLINE void fetch_taps(const PrefilteredEnvironment& environment, const LaneLevels<T>& levels,
                           const LaneTaps<T>& taps, size_t lanes, bool is_first,
                           LaneSums<T>& sums) {
  for (size_t lane = 0; lane < lanes; ++lane) {
    if (is_first) sums.clear(lane);
    if (!(taps.weight[lane] > 0)) continue;
    const auto corner = [&](int l) HWY_ATTR {
      return levels.texels[l][lane] +
             static_cast<size_t>(taps.row[l][lane]) * levels.stride[l][lane] +
             4 * static_cast<size_t>(taps.column[l][lane]);
    };
    const auto add = [&](int l, const float* first) HWY_ATTR {
      add_texels(first, levels.stride[l][lane], taps.before[l][lane], taps.after[l][lane],
                 taps.columns[l] + 4 * lane, sums.reference[lane], sums.parts[lane][0]);
    };
    if (!levels.texels[1][lane]) {
      add_pixels(environment.map, levels, taps, lane, is_first, sums);
      if (levels.share[0][lane] > 0) add(0, corner(0));
      continue;
    }
    const float* narrow = corner(1);
    if (is_first) set_reference(narrow + levels.stride[1][lane] + 4, sums.reference[lane]);
    add(1, narrow);
    add(0, corner(0));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
