// The half vectors of a tooth that stand for it, and the incoming directions that they reflect to
// (docs/maths.md, "Specular slice"): one view a lane.

#if defined(BURNISH_MATERIAL_SLICE_NODES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BURNISH_MATERIAL_SLICE_NODES_INL_H_
#undef BURNISH_MATERIAL_SLICE_NODES_INL_H_
#else
#define BURNISH_MATERIAL_SLICE_NODES_INL_H_
#endif

#include <cmath>

#include <hwy/highway.h>

#include "burnish/material/specular_slice.h"
#include "sphere/lobes-inl.h"
#include "sphere/vector_math-inl.h"
#include "sphere/warp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {

/// Three points that stand for a normal variable where it is positive: its probability to be, and
/// the points, in deviations from the mean of the uncut one, with their weights.
template <class V>
struct CutRule {
  V probability;
  V point[3], weight[3];
};

/// Of a distribution in units of its deviation, of its mean, deviation and skewness. Of the fourth
/// moment it takes pi / 2 + skewness^2, with which the mean of |x| is that of a normal variable:
/// BRDFs have kinks.
template <class D, class V>
HWY_INLINE CutRule<V> three_points(D d, V mean, V deviation, V skewness, V probability) {
  const V root = hn::Sqrt(hn::MulAdd(skewness, skewness, hn::Set(d, 6.28318531f)));
  const V reach = hn::Set(d, 0.5f) * deviation;
  // The middle one has 1 - 2 / pi, the others share the rest.
  const V third = hn::Set(d, 0.318309886f), lean = third * (skewness / root);
  return {
      probability,
      {hn::MulAdd(reach, skewness - root, mean), mean, hn::MulAdd(reach, skewness + root, mean)},
      {third + lean, hn::Set(d, 0.363380228f), third - lean}};
}

/// Of a mean of `ratio` deviations.
template <class D, class V>
HWY_INLINE CutRule<V> cut_rule(D d, V ratio) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const V uncut = hn::Set(d, 6.0f);  // deviations
  const auto is_uncut = hn::Ge(ratio, uncut);
  if (hn::AllTrue(d, is_uncut)) return three_points(d, zero, one, zero, one);  // common, and faster
  const V held = hn::Max(hn::Min(ratio, uncut), hn::Neg(uncut));
  // Density over probability; below 0 both have the same exponential, which is left out.
  const V y = hn::Abs(held) * hn::Set(d, 0.707106781f);
  const V e = exp(d, hn::Neg(y * y));
  const V t = one / hn::MulAdd(hn::Set(d, 0.4f), y, one);
  const V tail = hn::Set(d, 0.5f) * (t * erfc_curve(d, t));
  const auto is_negative = hn::Lt(held, zero);
  const V above = hn::NegMulAdd(e, tail, one);
  const V density = hn::Set(d, 0.398942280f) * hn::IfThenElse(is_negative, one, e);
  const V hazard = density / hn::IfThenElse(is_negative, tail, above);
  // Of variable / deviation, where it is positive: mean first, then variance and third moment.
  const V first = held + hazard;
  const V variance = hn::Max(hn::NegMulAdd(hazard, first, one), hn::Set(d, 1e-3f));
  const V third = hazard * hn::MulSub(first, hazard + hazard + held, one);
  const V spread = hn::Sqrt(variance);
  const V probability = hn::IfThenElseZero(hn::Gt(ratio, hn::Neg(uncut)),
                                           hn::IfThenElse(is_negative, e * tail, above));
  return three_points(d, hn::IfThenZeroElse(is_uncut, hazard),
                      hn::IfThenElse(is_uncut, one, spread),
                      hn::IfThenZeroElse(is_uncut, third / (variance * spread)),
                      hn::IfThenElse(is_uncut, one, probability));
}

/// Where the nodes of a tooth lie: points of its half vectors for the rule along the direction of
/// the disc in which n.i changes, which is where the horizon cuts, and for two across, or where the
/// tooth is wide three.
template <class V>
struct NodePlan {
  Vector2<V> along, across;  ///< a deviation each
  CutRule<V> rule;
  int rows;
  V row_point[3], row_weight[3];
};

/// `o` and `n`: view and normal in the tooth's frame.
template <class D, class V>
HWY_INLINE NodePlan<V> plan_nodes(D d, const SpecularTooth& tooth, const Vector3<V>& o,
                                  const Vector3f& n) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  const float xx = tooth.mean_xx, yy = tooth.mean_yy, zz = 1 - xx - yy;
  // n.i = 2 (o.h) (n.h) - o.n: its exact mean, and its slope at the axis.
  const V mean =
      weighted_sum(o.x, hn::Set(d, n.x() * (2 * xx - 1)), o.y, hn::Set(d, n.y() * (2 * yy - 1)),
                   o.z, hn::Set(d, n.z() * (2 * zz - 1)));
  V slope_x = hn::MulAdd(o.z, hn::Set(d, 2 * n.x()), o.x * hn::Set(d, 2 * n.z()));
  V slope_y = hn::MulAdd(o.z, hn::Set(d, 2 * n.y()), o.y * hn::Set(d, 2 * n.z()));
  const V steepness_squared = hn::MulAdd(slope_x, slope_x, slope_y * slope_y);
  const auto is_flat = hn::Lt(steepness_squared, hn::Set(d, 1e-12f));
  slope_x = hn::IfThenElse(is_flat, one, slope_x);
  slope_y = hn::IfThenZeroElse(is_flat, slope_y);
  const V spread_x = hn::Set(d, xx) * slope_x, spread_y = hn::Set(d, yy) * slope_y;
  // Of n.i.
  const V deviation = hn::Sqrt(hn::MulAdd(spread_x, slope_x, spread_y * slope_y));
  const V inverse = one / deviation;
  const V across = hn::Set(d, std::sqrt(xx) * std::sqrt(yy)) * inverse;
  NodePlan<V> plan;
  plan.along = {spread_x * inverse, spread_y * inverse};
  plan.across = {hn::Neg(slope_y * across), slope_x * across};
  const V sure = hn::CopySign(hn::Set(d, 7.0f), mean);
  plan.rule = cut_rule(d, hn::IfThenElse(is_flat, sure, mean * inverse));
  constexpr float kWide = 0.12f;  // radians of half vectors: below, a third point tells nothing new
  const V width_squared = hn::MulAdd(plan.across.x, plan.across.x, plan.across.y * plan.across.y);
  const auto is_wide = hn::Ge(width_squared, hn::Set(d, kWide * kWide));
  plan.rows = hn::AllFalse(d, is_wide) ? 2 : 3;
  const V reach = hn::IfThenElse(is_wide, hn::Set(d, 1.25331414f), one);
  const V weight = hn::IfThenElse(is_wide, hn::Set(d, 0.318309886f), hn::Set(d, 0.5f));
  plan.row_point[0] = hn::Neg(reach);
  plan.row_weight[0] = weight;
  plan.row_point[1] = zero;
  plan.row_weight[1] = hn::IfThenElseZero(is_wide, hn::Set(d, 0.363380228f));
  plan.row_point[plan.rows - 1] = reach;
  plan.row_weight[plan.rows - 1] = weight;
  return plan;
}

constexpr int kMaxNodes = 9;

/// Half vectors that stand for parts of a tooth, and the incoming directions they reflect from.
template <class V>
struct SliceNodes {
  Vector3<V> half[kMaxNodes], incoming[kMaxNodes];  ///< in the local frame
  Vector3<V> offset[kMaxNodes];  ///< of `incoming` from the reflection at the tooth's axis, in the
                                 ///< tooth's frame
  V cos_difference[kMaxNodes];   ///< o.h of h half way to `incoming`
  V part[kMaxNodes];             ///< the rules' weight
  /// First `part` times the solid angle of incoming directions per half vector, then also times the
  /// cosine and f over the lobes' sum, without colour and BrdfNumbers::scale. 0: not seen.
  V share[kMaxNodes];
  int count;
};

/// A view in the tooth's frame, and in the material's local one.
template <class V>
struct SeenTooth {
  Vector3<V> local, outgoing;
};

/// Node j, of the half vector at (x, y) of the tooth's disc. The offset is formed without
/// differences of unit vectors, of which narrow teeth would leave no digits.
template <class D, class V>
HWY_INLINE void add_node(D d, const Frame<V>& frame, const SeenTooth<V>& seen, V x, V y, V part,
                         SliceNodes<V>& nodes, int j) {
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d), two = hn::Set(d, 2.0f);
  // Of the disc's radius squared: beyond, a tooth has no normal part.
  const V edge = hn::Set(d, 0.95f);
  V square = hn::MulAdd(x, x, y * y);
  const auto is_beyond = hn::Gt(square, edge);
  if (!hn::AllFalse(d, is_beyond)) {
    const V scale = hn::IfThenElse(is_beyond, hn::Sqrt(edge / square), one);
    x = x * scale;
    y = y * scale;
    square = hn::Min(square, edge);
  }
  const V z = hn::Sqrt(one - square);
  const V step_z = hn::Neg(square / (one + z));  // from the axis
  const Vector3<V>& o = seen.local;
  const V along = weighted_sum(o.x, x, o.y, y, o.z, step_z);
  const V cos_difference = o.z + along, twice = two * cos_difference;
  nodes.offset[j] = {twice * x, twice * y, two * hn::MulAdd(o.z, step_z, along * z)};
  const Vector3<V> half = to_world(frame, Vector3<V>{x, y, z});
  nodes.half[j] = half;
  nodes.incoming[j] = {hn::MulSub(twice, half.x, seen.outgoing.x),
                       hn::MulSub(twice, half.y, seen.outgoing.y),
                       hn::MulSub(twice, half.z, seen.outgoing.z)};
  nodes.cos_difference[j] = cos_difference;
  nodes.part[j] = part;
  const auto is_seen = hn::Gt(hn::Min(cos_difference, half.z), zero);
  nodes.share[j] = hn::IfThenElseZero(is_seen, part * (twice + twice));
}

/// The rule for n.i is exact where that is linear; where it is not, a node may be just below the
/// horizon.
template <class D, class V>
HWY_INLINE void hold_above_horizon(D d, const Frame<V>& frame, const SeenTooth<V>& seen,
                                   SliceNodes<V>& nodes) {
  const V lowest = hn::Set(d, 1e-3f), one = hn::Set(d, 1.0f), half = hn::Set(d, 0.5f);
  V lowest_of_all = one;
  for (int j = 0; j < nodes.count; ++j) lowest_of_all = hn::Min(lowest_of_all, nodes.incoming[j].z);
  if (hn::AllFalse(d, hn::Lt(lowest_of_all, lowest))) return;
  for (int j = 0; j < nodes.count; ++j) {
    const Vector3<V> i = nodes.incoming[j], o = seen.outgoing;
    const auto is_low = hn::Lt(i.z, lowest);
    const V square = weighted_sum(i.x, i.x, i.y, i.y, lowest, lowest);
    const V scale = hn::IfThenElse(is_low, one / hn::Sqrt(square), one);
    const Vector3<V> lifted = {i.x * scale, i.y * scale,
                               hn::IfThenElse(is_low, lowest * scale, i.z)};
    const Vector3<V> step = to_local(frame, minus(lifted, i)), offset = nodes.offset[j];
    nodes.offset[j] = {offset.x + step.x, offset.y + step.y, offset.z + step.z};
    nodes.incoming[j] = lifted;
    const Vector3<V> sum = {o.x + lifted.x, o.y + lifted.y, o.z + lifted.z};
    const V between = half * hn::Sqrt(dot(sum, sum));
    nodes.cos_difference[j] = hn::IfThenElse(is_low, between, nodes.cos_difference[j]);
  }
}

/// All nodes of a plan.
template <class D, class V>
HWY_INLINE void add_nodes(D d, const Frame<V> frame, const SeenTooth<V> seen,
                          const NodePlan<V>& plan, SliceNodes<V>& nodes) {
  nodes.count = 3 * plan.rows;
  for (int row = 0; row < plan.rows; ++row) {
    const V across_x = plan.row_point[row] * plan.across.x;
    const V across_y = plan.row_point[row] * plan.across.y;
    for (int k = 0; k < 3; ++k)
      add_node(d, frame, seen, hn::MulAdd(plan.rule.point[k], plan.along.x, across_x),
               hn::MulAdd(plan.rule.point[k], plan.along.y, across_y),
               plan.rule.weight[k] * plan.row_weight[row], nodes, 3 * row + k);
  }
  hold_above_horizon(d, frame, seen, nodes);
}

}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#endif
