// eval_prefiltered of a block of points, see burnish/light/prefiltered_environment.h: one lobe a
// lane, but for the texels, which are fetched lane by lane. A lobe's mean radiance is a 2-D
// Gaussian average over the unit disc of the orthographic plane, because (v . z) dv = dx dy.

#if defined(BURNISH_LIGHT_PREFILTERED_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_LIGHT_PREFILTERED_INL_H_
#undef BURNISH_LIGHT_PREFILTERED_INL_H_
#else
#define BURNISH_LIGHT_PREFILTERED_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>  // exp of double lanes
#include <hwy/highway.h>

#include "burnish/light/prefiltered_environment.h"
#include "light/texel_rows-inl.h"
#include "sphere/block.h"
#include "sphere/lobes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// Mean square of a sine from the axis in one direction, for a lobe that the unit disc cuts off:
/// (1 - b / (exp(b) - 1)) / (2 b).
template <class D, class V>
HWY_INLINE V disc_variance(D d, V bandwidth) {
  const V one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const auto is_narrow = hn::Gt(bandwidth, hn::Set(d, 16.0f));
  const V narrow = half / hn::Max(bandwidth, half);
  if (hn::AllTrue(d, is_narrow)) return narrow;
  const V b = hn::Min(bandwidth, hn::Set(d, 16.0f));
  const V e = exp(d, hn::Neg(b));
  const V cut = hn::NegMulAdd(b, e / hn::Max(one - e, hn::Set(d, 0.1f)), one) * narrow;
  const V series = hn::MulAdd(b, hn::MulAdd(b * b, hn::Set(d, 1.0f / 1440), hn::Set(d, -1.0f / 24)),
                              hn::Set(d, 0.25f));
  return hn::IfThenElse(is_narrow, narrow, hn::IfThenElse(hn::Lt(b, half), series, cut));
}

/// A lobe as a row of round taps of equal angles. One tap: a round lobe.
template <class V>
struct TapRow {
  V taps;
  V bandwidth;    ///< of a tap
  V spacing;      ///< rad
  V variance;     ///< of the taps' angles, rad^2
  V lean;         ///< 1/rad: see lean_row
  V slope;        ///< a tap's weight falls as exp(-slope sine^2)
  V narrow_root;  ///< root of the lobe's larger bandwidth
};

/// The bandwidth k for which round lobes of bandwidth `round`, spread by exp(-k sine^2) along an
/// axis, make the lobe (round, wide): that of planes, 1 / k = 1 / wide - 1 / round, and what the
/// disc's edge adds (half of what would keep the variance: the form by that, the half by the
/// error).
template <class D, class V>
HWY_INLINE V spread_bandwidth(D d, V round, V wide) {
  const V one = hn::Set(d, 1.0f);
  const V planar = round * wide / hn::Max(round - wide, hn::Set(d, 1e-6f));
  // Of lobes so narrow that the disc's edge is out of sight it adds nothing in float.
  if (hn::AllTrue(d, hn::Gt(wide, hn::Set(d, 22.0f)))) return planar;
  const V w = hn::Min(wide, hn::Set(d, 30.0f));
  const V edge =
      hn::Set(d, 1.15f) * hn::Sqrt(w * hn::Sqrt(w)) * exp(d, hn::Neg(hn::Set(d, 0.04f) * w * w));
  const V inverse = one / hn::Max(round, hn::Set(d, 2.0f));
  const V falloff = hn::MulAdd(edge * inverse, hn::MulAdd(hn::Set(d, 4.0f), inverse, one), planar);
  return hn::Max(falloff, hn::Set(d, 1e-3f));
}

/// How far the taps reach, in deviations of the lobe's spread. The forms and numbers of this and of
/// plan_taps are fits to the least error (docs/lights.md, "Filtered maps").
template <class D, class V>
HWY_INLINE V tap_reach(D d, V taps, V taps_over_root) {
  const V of_two = hn::MulAdd(hn::Set(d, 0.3f), taps_over_root, hn::Set(d, 1.5f));
  const V of_more = hn::Min(hn::MulAdd(hn::Set(d, 0.5f), taps_over_root, hn::Set(d, 1.75f)),
                            hn::MulAdd(hn::Set(d, 0.4f), taps, hn::Set(d, 1.2f)));
  const V two = hn::Set(d, 2.0f);
  return hn::IfThenElse(hn::Lt(taps, hn::Set(d, 2.5f)), hn::Min(of_two, two),
                        hn::Max(hn::Min(of_more, hn::Set(d, 3.3f)), two));
}

/// Taps as narrow as the lobe, spread along its long axis by a Gaussian of the variance that is
/// missing. Where they are too few to meet they are wider than the lobe is narrow.
template <class D, class V>
HWY_INLINE TapRow<V> plan_taps(D d, V bandwidth_x, V bandwidth_y, int max_taps) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), least = hn::Set(d, 1e-3f);
  const V narrow = hn::Max(hn::Max(bandwidth_x, bandwidth_y), least);
  const V wide = hn::Max(hn::Min(bandwidth_x, bandwidth_y), least);
  TapRow<V> row = {one, zero, zero, zero, zero, zero, hn::Sqrt(narrow)};
  row.bandwidth = row.narrow_root * hn::Sqrt(wide);
  if (max_taps <= 1) return row;
  const V ratio = hn::Min(narrow / wide, hn::Set(d, 1e15f)), root = hn::Sqrt(ratio);
  const V wanted = hn::Ceil(
      hn::MulAdd(hn::Set(d, 3.0f), hn::Sqrt(hn::Max(ratio - one, zero)), hn::Set(d, 0.9f)));
  const V most = hn::Set(d, static_cast<hn::TFromD<D>>(max_taps));
  row.taps = hn::IfThenElse(hn::Lt(ratio, hn::Set(d, 1.03f)), one, hn::Min(wanted, most));
  const auto is_single = hn::Lt(row.taps, hn::Set(d, 1.5f));
  if (hn::AllTrue(d, is_single)) return row;
  const V lack = root / row.taps;
  const V widening =
      hn::Sqrt(hn::Max(hn::MulAdd(hn::Set(d, 1.4f) * lack, lack * lack, hn::Set(d, 0.7f)), one));
  const V round = narrow / hn::Min(widening, root);
  const V falloff = spread_bandwidth(d, round, wide);
  const V edge = exp(d, hn::Max(hn::Set(d, -0.6f) * wide, hn::Set(d, -80.0f)));
  row.bandwidth =
      hn::IfThenElse(is_single, row.bandwidth, hn::MulAdd(hn::Set(d, 0.55f), edge, round));
  const V reach = tap_reach(d, row.taps, one / lack);
  row.variance = hn::Set(d, 0.5f) / falloff;
  const V angle = reach * hn::Sqrt(row.variance);
  const V quarter_turn = hn::Set(d, 1.57079633f);
  row.spacing = hn::Set(d, 2.0f) * hn::Min(angle, quarter_turn) / row.taps;
  // What the taps do not reach, the disc's edge apart, is made up for by higher weights far out.
  const V missing = hn::Set(d, 0.49f) * exp(d, hn::Set(d, -2.95f) * (reach - hn::Set(d, 2.0f)));
  row.slope = hn::IfThenElse(hn::Gt(angle, quarter_turn), falloff,
                             hn::NegMulAdd(falloff, missing, falloff));
  return row;
}

/// Turns each pair of taps, at angles +-a, by lean (a^2 - variance): the mean stays, and the third
/// moment becomes `third`, or as much of it as keeps the taps in their order.
template <class D, class V>
HWY_INLINE void lean_row(D d, V third, TapRow<V>& row) {
  const V one = hn::Set(d, 1.0f), tiny = hn::Set(d, 1e-12f);
  const V wanted = third / hn::Max(hn::Set(d, 6.0f) * row.variance * row.variance, tiny);
  const V most = one / hn::Max(row.spacing * (row.taps - one), tiny);
  row.lean = hn::IfThenElseZero(hn::Gt(row.taps, hn::Set(d, 1.5f)),
                                hn::Max(hn::Min(wanted, most), hn::Neg(most)));
}

/// Where a row lies in the environment, and how far above a horizon: the sines at its ends.
template <class V>
struct RowPlace {
  Vector3<V> axis, along;
  bool has_horizon = false;
  V height_at_axis, height_along;
};

/// Finds the two levels whose lobes are next to each lane's bandwidth, the narrower made of the
/// map's own pixels beyond the last level, and the share of each.
template <class D, class V, class T>
HWY_INLINE void find_levels(D d, const PrefilteredEnvironment& environment, V bandwidth,
                            LaneLevels<T>& lanes) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const auto& levels = environment.levels;
  alignas(64) T bandwidths[kMostLanes], wide_variance[kMostLanes], narrow_variance[kMostLanes];
  hn::Store(bandwidth, d, bandwidths);
  for (size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    const auto* level = &levels[level_below(levels, static_cast<float>(bandwidths[lane]))];
    const bool is_last = level + 1 == levels.data() + levels.size();
    wide_variance[lane] = static_cast<T>(level->variance);
    narrow_variance[lane] = is_last ? T(-1) : static_cast<T>(level[1].variance);
    lanes.set(0, lane, *level);
    lanes.set(1, lane, is_last ? *level : level[1]);
    if (is_last) lanes.texels[1][lane] = nullptr;
  }
  const V variance = disc_variance(d, bandwidth);
  const V of_wide = hn::Load(d, wide_variance);
  V of_narrow = hn::Load(d, narrow_variance);
  of_narrow = hn::IfThenElse(hn::Lt(of_narrow, zero), hn::Min(hn::Set(d, 0.7f) * of_wide, variance),
                             of_narrow);
  hn::Store(of_narrow, d, lanes.narrow_variance);
  // Blurring adds to what is seen in proportion to the variance added, where it adds little.
  V share = hn::Min(hn::Max((of_wide - variance) / (of_wide - of_narrow), zero), one);
  // Between two deviations of a factor of 2^(1/4) the narrower adds less than that.
  share = hn::NegMulAdd(hn::Set(d, 0.22f) * share, one - share, share);
  hn::Store(one - share, d, lanes.share[0]);
  hn::Store(share, d, lanes.share[1]);
}

/// cube_from_direction, and the weights of the texels about it in both levels, times `weight`.
template <class D, class V, class T>
HWY_INLINE void place_tap(D d, const LaneLevels<T>& levels, const Vector3<V>& direction, V weight,
                          LaneTaps<T>& taps) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  hn::Store(weight, d, taps.weight);
  hn::Store(direction.x, d, taps.direction[0]);
  hn::Store(direction.y, d, taps.direction[1]);
  hn::Store(direction.z, d, taps.direction[2]);
  const V x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
  const auto is_x = hn::And(hn::Ge(x, y), hn::Ge(x, z));
  const auto is_z = hn::AndNot(is_x, hn::Lt(y, z));
  const auto pick = [&](V of_x, V of_y, V of_z) HWY_ATTR {
    return hn::IfThenElse(is_x, of_x, hn::IfThenElse(is_z, of_z, of_y));
  };
  const V outward = pick(direction.x, direction.y, direction.z);
  const V s = pick(direction.y, direction.z, direction.x);
  const V t = pick(direction.z, direction.x, direction.y);
  const V face = pick(zero, hn::Set(d, 2.0f), hn::Set(d, 4.0f)) +
                 hn::IfThenElseZero(hn::Lt(outward, zero), one);
  const V stretch = hn::Set(d, kCubeStretch), tiny = hn::Set(d, 1e-30f);
  const V square = hn::Max(outward * outward, tiny);
  const V scale = hn::Set(d, 1 + kCubeStretch) * hn::Abs(outward);
  const V u = hn::MulAdd(scale * s, one / hn::MulAdd(stretch * s, s, square), one);
  const V v = hn::MulAdd(scale * t, one / hn::MulAdd(stretch * t, t, square), one);
  const hn::RebindToSigned<D> di;
  for (int l = 0; l < 2; ++l) {
    const V size = hn::Load(d, levels.half_size[l]), last = size + size - one;
    const V texel_u = hn::Max(u * size, zero), texel_v = hn::Max(v * size, zero);
    const V column = hn::Min(hn::Floor(texel_u), last), row = hn::Min(hn::Floor(texel_v), last);
    const V stored_row = hn::MulAdd(face, last + hn::Set(d, 3.0f), row);
    hn::Store(hn::ConvertTo(di, column), di, taps.column[l]);
    hn::Store(hn::ConvertTo(di, stored_row), di, taps.row[l]);
    const V tu = texel_u - column, tv = texel_v - row;
    // Weights of a quadratic B-spline.
    const V before_u = half * (one - tu) * (one - tu), after_u = half * tu * tu;
    const V before_v = half * (one - tv) * (one - tv), after_v = half * tv * tv;
    const V share = weight * hn::Load(d, levels.share[l]);
    hn::Store(before_v, d, taps.before[l]);
    hn::Store(after_v, d, taps.after[l]);
    hn::StoreInterleaved4(share * before_u, share * (one - before_u - after_u), share * after_u,
                          zero, d, taps.columns[l]);
  }
}

template <class D, class V>
HWY_INLINE Vector3<V> rotated(D d, const Eigen::Matrix3f& m, const Vector3<V>& v) {
  const auto row = [&](int i) HWY_ATTR {
    return hn::MulAdd(hn::Set(d, m(i, 0)), v.x,
                      hn::MulAdd(hn::Set(d, m(i, 1)), v.y, hn::Set(d, m(i, 2)) * v.z));
  };
  return {row(0), row(1), row(2)};
}

/// The share of a tap that is above the horizon. Never 0, so that there is always a mean.
template <class D, class V>
HWY_INLINE V share_above(D d, V bandwidth_root, V height) {
  const V half = hn::Set(d, 0.5f), one = hn::Set(d, 1.0f), far = hn::Set(d, 3.0f);
  const V deviations = bandwidth_root * height;
  const auto is_whole = hn::Gt(deviations, far);
  if (hn::AllTrue(d, is_whole)) return one;
  const V tail = erf_of_positive(d, hn::Min(hn::Abs(deviations), far));
  const V share = hn::MulAdd(half, hn::CopySign(tail, deviations), half);
  return hn::IfThenElse(is_whole, one, hn::Max(share, hn::Set(d, 1e-3f)));
}

/// Looks up the rows of all lanes, the taps to both sides of the middle at once. Returns the sum of
/// weights. `steps`: pairs of taps, 0 where nothing is wanted.
template <class D, class V, class T>
HWY_INLINE V sum_rows(D d, const PrefilteredEnvironment& environment, const LaneLevels<T>& levels,
                      const TapRow<V>& row, const RowPlace<V>& place, V steps, LaneSums<T>& sums) {
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  const V three = hn::Set(d, 3.0f);
  const V pairs = half * row.taps;
  // An odd row's first pair is one tap in the middle.
  const V start = hn::IfThenZeroElse(hn::Lt(hn::Floor(pairs), pairs), half);
  const T last = hn::GetLane(hn::MaxOfLanes(d, steps));
  const V bandwidth_root = hn::Sqrt(row.bandwidth);
  LaneTaps<T> taps;
  V weight_sum = zero;
  // At cos axis + sin along.
  const auto look_up = [&](V cosine, V sine, V weight, bool is_first) HWY_ATTR {
    if (place.has_horizon) {
      const V height = hn::MulAdd(cosine, place.height_at_axis, sine * place.height_along);
      weight = weight * share_above(d, bandwidth_root, height);
    }
    weight_sum = weight_sum + weight;
    const Vector3<V>&x = place.along, &z = place.axis;
    const Vector3<V> direction = {hn::MulAdd(sine, x.x, cosine * z.x),
                                  hn::MulAdd(sine, x.y, cosine * z.y),
                                  hn::MulAdd(sine, x.z, cosine * z.z)};
    place_tap(d, levels, direction, weight, taps);
    fetch_taps(environment, levels, taps, hn::Lanes(d), is_first, sums);
  };
  for (T step = 0; step < last; ++step) {
    const V count = hn::Set(d, step), angle = row.spacing * (count + start);
    const V s = sine(d, angle);
    const V c = hn::IfThenElse(hn::Eq(angle, zero), one, sine(d, hn::Set(d, 1.57079633f) - angle));
    // The Gaussian along the axis, and the share of its slab that lies inside the disc.
    V weight = exp(d, hn::Neg(row.slope * s * s)) * c;
    const V edge = row.narrow_root * c;
    // By lane, so that what a point sees is the same to the bit whoever its neighbours are.
    const auto is_whole = hn::Or(hn::Eq(row.taps, one), hn::Gt(edge, three));
    if (!hn::AllTrue(d, is_whole))
      weight = weight * hn::IfThenElse(is_whole, one, erf_of_positive(d, hn::Min(edge, three)));
    weight = hn::IfThenElseZero(hn::Lt(count, steps), weight);
    // The turn, by the tangent of its half, for which the half is near enough.
    const V tangent = half * row.lean * hn::MulSub(angle, angle, row.variance);
    const V scale = one / hn::MulAdd(tangent, tangent, one);
    const V turn_s = scale * (tangent + tangent);
    const V turn_c = scale * hn::NegMulAdd(tangent, tangent, one);
    const V cc = c * turn_c, cs = c * turn_s, sc = s * turn_c, ss = s * turn_s;
    look_up(cc - ss, cs + sc, weight, step == 0);
    const V other = hn::IfThenElseZero(hn::Gt(angle, zero), weight);
    if (hn::AllTrue(d, hn::Eq(other, zero))) continue;
    look_up(cc + ss, cs - sc, other, false);
  }
  return weight_sum;
}

/// Of a vector of points, from `first` on.
template <class D, class T>
HWY_INLINE void eval_vector(D d, const PrefilteredEnvironment& environment, size_t first,
                            const BlockLobes<T>& lobes, const BlockCuts<T>* cuts,
                            hn::Mask<D> is_active, int max_taps, BlockRgb<T>& result) {
  using V = hn::VFromD<D>;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
  const auto load = [&](const BlockArray<T>& array)
                        HWY_ATTR { return hn::Load(d, array.data() + first); };
  const V bandwidth_x = load(lobes.bandwidth_x), bandwidth_y = load(lobes.bandwidth_y);
  TapRow<V> row = plan_taps(d, bandwidth_x, bandwidth_y, max_taps);
  if (cuts) lean_row(d, load(cuts->third), row);
  // A row of few taps blurs along its axis: the map's own pixels, at ten times the cost, would not
  // make it exact across it.
  constexpr int kFew = 15;
  const V widest = hn::Set(d, static_cast<T>(0.98f * environment.levels.back().bandwidth));
  if (max_taps <= kFew)
    row.bandwidth =
        hn::IfThenElse(hn::Gt(row.taps, one), hn::Min(row.bandwidth, widest), row.bandwidth);
  LaneLevels<T> levels;
  find_levels(d, environment, row.bandwidth, levels);
  const Vector3<V> z = {load(lobes.z.x), load(lobes.z.y), load(lobes.z.z)};
  RowPlace<V> place;
  place.axis = rotated(d, environment.environment_from_world, z);
  LaneSums<T> sums;
  V weight_sum = hn::IfThenElseZero(is_active, one);
  const V steps = hn::IfThenElseZero(is_active, hn::Ceil(hn::Set(d, 0.5f) * row.taps));
  if (hn::AllTrue(d, hn::Or(hn::Eq(row.taps, one), hn::Not(is_active)))) {
    LaneTaps<T> taps;
    place_tap(d, levels, place.axis, weight_sum, taps);
    fetch_taps(environment, levels, taps, hn::Lanes(d), true, sums);
  } else {
    const Vector3<V> x = {load(lobes.x.x), load(lobes.x.y), load(lobes.x.z)}, y = cross(z, x);
    const auto x_is_long = hn::Le(bandwidth_x, bandwidth_y);
    const Vector3<V> long_axis = {hn::IfThenElse(x_is_long, x.x, y.x),
                                  hn::IfThenElse(x_is_long, x.y, y.y),
                                  hn::IfThenElse(x_is_long, x.z, y.z)};
    place.along = rotated(d, environment.environment_from_world, long_axis);
    if (cuts) {
      const Vector3<V> normal = {load(cuts->normal.x), load(cuts->normal.y), load(cuts->normal.z)};
      place.has_horizon = true;
      place.height_at_axis = dot(normal, z);
      place.height_along = dot(normal, long_axis);
    }
    weight_sum = sum_rows(d, environment, levels, row, place, steps, sums);
  }
  const V inverse = one / hn::Max(weight_sum, hn::Set(d, 1e-30f));
  V reference[4], sum[4];
  hn::LoadInterleaved4(d, sums.reference[0], reference[0], reference[1], reference[2],
                       reference[3]);
  for (size_t lane = 0; lane < hn::Lanes(d); ++lane) add_parts(sums.parts[lane], sums.sum[lane]);
  hn::LoadInterleaved4(d, sums.sum[0], sum[0], sum[1], sum[2], sum[3]);
  for (size_t c = 0; c < 3; ++c) {
    const V mean = hn::MulAdd(sum[c], inverse, reference[c]);
    hn::Store(hn::IfThenElseZero(is_active, hn::Max(mean, zero)), d, result[c].data() + first);
  }
}

/// Mean radiance of the environment under the lobe of each of `count` points (1..kBlock; lanes up
/// to the next whole vector are valid): eval_prefiltered of each. Points whose weight is 0 in
/// `active` are skipped (result 0). `cuts`: null where the lobes are Gaussians.
template <class D, class T = hn::TFromD<D>>
void eval_prefiltered(D d, const PrefilteredEnvironment& environment, size_t count,
                      const BlockLobes<T>& lobes, const BlockArray<T>& active, int max_taps,
                      BlockRgb<T>& result, const BlockCuts<T>* cuts = nullptr) {
  for (size_t first = 0; first < count; first += hn::Lanes(d)) {
    const auto is_active = hn::And(hn::Ne(hn::Load(d, active.data() + first), hn::Zero(d)),
                                   hn::FirstN(d, count - first));
    if (hn::AllFalse(d, is_active)) {
      for (auto& channel : result) hn::Store(hn::Zero(d), d, channel.data() + first);
      continue;
    }
    eval_vector(d, environment, first, lobes, cuts, is_active, max_taps, result);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
