#include "burnish/material/specular_slice.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/lobe_moments.h"
#include "burnish/sphere/spherical_warp.h"

// Based on: xu2013asg, section 5.2. Where we differ: a lobe is cut into teeth, and their moments
// are matched instead of their second derivatives (docs/maths.md, "Specular slice").
namespace burnish {
namespace {

/// A lobe bends by about the square of its longer deviation, in radians. Below this much of the
/// shorter one it is left whole: teeth would only add their ripple.
constexpr float kStraight = 0.04f;
/// Lobes rounder than this ratio of deviations, and wider than this one, are cut in both
/// directions where the number of teeth is a square.
constexpr float kRound = 1.5f, kWideInBoth = 0.15f;

float deviation(float bandwidth) { return 1 / std::sqrt(2 * bandwidth + 1); }

SpecularTooth make_tooth(const AnisotropicGaussian<float>& lobe) {
  const auto moments = asg_second_moments(lobe.bandwidth_x, lobe.bandwidth_y);
  return {lobe, lobe.amplitude * moments.integral, moments.mean_xx, moments.mean_yy};
}

/// Calls add(tooth) for each of `count` parts along a lobe's long axis.
template <class Add>
void cut(const AnisotropicGaussian<float>& lobe, int count, const Add& add) {
  const LobeComb<float> comb = make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, count);
  for (int k = 0; k < count; ++k) add(comb_tooth(comb, lobe, k));
}

void add_teeth(const AnisotropicGaussian<float>& lobe, int taps, PreparedMaterial& prepared) {
  const float wide = deviation(std::min(lobe.bandwidth_x, lobe.bandwidth_y));
  const float narrow = deviation(std::max(lobe.bandwidth_x, lobe.bandwidth_y));
  if (wide * wide < kStraight * narrow) taps = 1;
  const int edge = static_cast<int>(std::lround(std::sqrt(static_cast<float>(taps))));
  const bool both = edge * edge == taps && wide < kRound * narrow && narrow > kWideInBoth;
  const auto add = [&](const AnisotropicGaussian<float>& tooth) {
    prepared.tooth[static_cast<size_t>(prepared.count++)] = make_tooth(tooth);
  };
  if (!both) return cut(lobe, taps, add);
  // A tooth is longer across the first cut.
  cut(lobe, edge, [&](const AnisotropicGaussian<float>& tooth) { cut(tooth, edge, add); });
}

/// Three points that stand for a normal variable where it is positive: its probability to be, and
/// the points, in deviations from the mean of the uncut one, with their weights.
struct CutRule {
  float probability;
  std::array<float, 3> point, weight;
};

/// The rule of a distribution in units of its deviation, of its mean, variance and skewness. Of the
/// fourth moment it takes pi / 2 + skewness^2, with which the mean of |x| is that of a normal
/// variable: BRDFs have kinks.
CutRule three_points(float mean, float spread, float skewness, float probability) {
  const float root = std::sqrt(2 * kPi<float> + skewness * skewness);
  const float low = (skewness - root) / 2, high = (skewness + root) / 2;
  const float low_weight = -1 / (low * root), high_weight = 1 / (high * root);
  return {probability,
          {mean + spread * low, mean, mean + spread * high},
          {low_weight, 1 - low_weight - high_weight, high_weight}};
}

CutRule cut_rule(float mean, float deviation) {
  constexpr float kUncut = 6;  // deviations
  if (mean >= kUncut * deviation) return three_points(0, 1, 0, 1);
  const float ratio = mean / deviation;
  if (ratio <= -kUncut) return {0, {}, {}};
  const float density = std::exp(-ratio * ratio / 2) / std::sqrt(2 * kPi<float>);
  const float probability = std::erfc(-ratio / std::sqrt(2.0f)) / 2;
  // Of variable / deviation, where it is positive: mean first, then variance and third moment.
  const float hazard = density / probability;
  const float first = ratio + hazard;
  const float variance = std::max(1 - hazard * first, 1e-3f);
  const float third = hazard * (first * (2 * hazard + ratio) - 1);
  const float spread = std::sqrt(variance);
  return three_points(hazard, spread, third / (variance * spread), probability);
}

/// A half vector that stands for a part of a tooth, and the incoming direction it reflects from.
struct Node {
  Vector3f half, incoming;  ///< in the local frame
  Vector3f offset;          ///< of `incoming` from the reflection at the tooth's axis
  float cos_difference;     ///< o.h
};

/// The half vector at (x, y) of a tooth's disc. The offset is formed without differences of unit
/// vectors, of which narrow teeth would leave no digits.
Node make_node(const Frame<float>& tooth, const Vector3f& local_outgoing, const Vector3f& outgoing,
               float x, float y) {
  constexpr float kEdge =
      0.95f;  // of the disc's radius squared: beyond, a tooth has no normal part
  float square = x * x + y * y;
  if (square > kEdge) {
    const float scale = std::sqrt(kEdge / square);
    x *= scale, y *= scale, square = kEdge;
  }
  const float z = std::sqrt(1 - square);
  const Vector3f step(x, y, -square / (1 + z));  // from the axis
  const float along = local_outgoing.dot(step);
  const Vector3f offset = 2 * (local_outgoing.z() * step + along * Vector3f(step.x(), step.y(), z));
  Node node;
  node.half = tooth.to_world({x, y, z});
  node.offset = tooth.to_world(offset);
  node.cos_difference = local_outgoing.z() + along;
  node.incoming = 2 * node.cos_difference * node.half - outgoing;
  return node;
}

/// D(h) over the lobes that stand for it: 1 where they are exact.
float distribution_over_lobes(const PreparedMaterial& prepared, const Vector3f& half) {
  if (!prepared.corrects_distribution) return 1;
  float sum = 0;
  for (int k = 0; k < prepared.lobes.count; ++k)
    sum += eval(prepared.lobes.lobe[static_cast<size_t>(k)], half);
  constexpr float kMost = 10;  // where the lobes have vanished and D has not
  const float exact = eval_distribution(prepared.material, half);
  return exact < kMost * sum ? exact / sum : kMost;
}

/// The rule for n.i is exact where that is linear; where it is not, a node may be just below the
/// horizon.
void hold_above_horizon(Node& node) {
  constexpr float kLowest = 1e-3f;
  if (node.incoming.z() >= kLowest) return;
  Vector3f lifted = node.incoming;
  lifted.z() = kLowest;
  lifted.normalize();
  node.offset += lifted - node.incoming;
  node.incoming = lifted;
}

/// f cos over the lobes' sum, times the solid angle of incoming directions per half vector.
Rgb node_weight(const PreparedMaterial& prepared, const Vector3f& outgoing, const Node& node) {
  if (node.cos_difference <= 0 || node.half.z() <= 0) return Rgb::Zero();
  return specular_smooth_factor(prepared.material, outgoing, node.incoming) *
         (distribution_over_lobes(prepared, node.half) * node.incoming.z() * 4 *
          node.cos_difference);
}

/// A lobe of unit amplitude of a mean direction and a covariance in its tangent plane.
AnisotropicGaussian<float> lobe_from_covariance(const Frame<float>& frame, float xx, float xy,
                                                float yy) {
  const float half_difference = (xx - yy) / 2, radius = std::hypot(half_difference, xy);
  const float wide = (xx + yy) / 2 + radius;
  constexpr float kThinnest = 1e-4f;  // ratio of variances that a few nodes can tell
  const float narrow = std::max((xx * yy - xy * xy) / wide, kThinnest * wide);
  const float angle = 0.5f * std::atan2(xy, half_difference);
  const Vector3f major = std::cos(angle) * frame.x + std::sin(angle) * frame.y;
  AnisotropicGaussian<float> lobe;
  lobe.frame = {major.cross(frame.z), major, frame.z};
  // Of a narrow lobe the variance is 1 / (2 bandwidth + 1), to first order.
  constexpr float kWidest = 0.05f;
  lobe.bandwidth_x = std::max((1 / narrow - 1) / 2, kWidest);
  lobe.bandwidth_y = std::max((1 / wide - 1) / 2, kWidest);
  return lobe;
}

/// Where the nodes of a tooth lie: points of its half vectors for the rule along the direction of
/// the disc in which n.i changes, which is where the horizon cuts, and for two across.
struct NodePlan {
  Eigen::Vector2f along, across;  ///< a deviation each
  CutRule rule;
};

NodePlan plan_nodes(const SpecularTooth& tooth, const Vector3f& o, const Vector3f& n) {
  const float xx = tooth.mean_xx, yy = tooth.mean_yy, zz = 1 - xx - yy;
  // n.i = 2 (o.h) (n.h) - o.n: its exact mean, and its slope at the axis.
  const float mean = 2 * (o.x() * n.x() * xx + o.y() * n.y() * yy + o.z() * n.z() * zz) - o.dot(n);
  const Eigen::Vector2f slope = 2 * (n.z() * o.head<2>() + o.z() * n.head<2>());
  const float steepness = slope.norm();
  const Eigen::Vector2f direction =
      steepness > 1e-6f ? Eigen::Vector2f(slope / steepness) : Eigen::Vector2f::UnitX();
  const Eigen::Vector2f spread(xx * direction.x(), yy * direction.y());
  const float deviation = std::sqrt(spread.dot(direction));
  NodePlan plan;
  plan.along = spread / deviation;
  plan.across = Eigen::Vector2f(-direction.y(), direction.x()) * (std::sqrt(xx * yy) / deviation);
  plan.rule = cut_rule(mean, deviation * steepness);
  return plan;
}

constexpr size_t kMaxNodes = 9;

/// Points across, in deviations, with their weights: two, or where a tooth is wide three.
struct AcrossRule {
  size_t count;
  std::array<float, 3> point, weight;
};

AcrossRule across_rule(float deviation) {
  constexpr float kWide = 0.12f;  // radians of half vectors: below, a third point tells nothing new
  if (deviation < kWide) return {2, {-1, 1, 0}, {0.5f, 0.5f, 0}};
  const CutRule rule = three_points(0, 1, 0, 1);
  return {3, rule.point, rule.weight};
}

SliceLobe match_moments(const PreparedMaterial& prepared, const SpecularTooth& tooth,
                        const Vector3f& outgoing) {
  const Frame<float>& frame = tooth.lobe.frame;
  const Vector3f o = frame.to_local(outgoing);
  const NodePlan plan = plan_nodes(tooth, o, frame.to_local(Vector3f::UnitZ()));
  SliceLobe result;
  if (plan.rule.probability <= 0) return result;
  const AcrossRule across = across_rule(plan.across.norm());
  std::array<Vector3f, kMaxNodes> offset;
  std::array<float, kMaxNodes> share;
  Vector3f mean = Vector3f::Zero();
  float total = 0;
  const size_t count = 3 * across.count;
  for (size_t j = 0; j < count; ++j) {
    const Eigen::Vector2f place =
        plan.rule.point[j % 3] * plan.along + across.point[j / 3] * plan.across;
    Node node = make_node(frame, o, outgoing, place.x(), place.y());
    hold_above_horizon(node);
    const Rgb weight =
        plan.rule.weight[j % 3] * across.weight[j / 3] * node_weight(prepared, outgoing, node);
    offset[j] = node.offset;
    share[j] = weight.sum();
    result.weight += weight;
    total += share[j];
    mean += share[j] * node.offset;
  }
  if (!(total > 0)) return {};
  mean /= total;
  const Vector3f axis = (2 * o.z() * frame.z - outgoing + mean).normalized();
  const Frame<float> tangent = frame_from_axis(axis);
  // A share that all nodes have alike: a width, where all but one of them weigh nothing.
  constexpr float kEven = 0.02f;
  float xx = 0, xy = 0, yy = 0;
  for (size_t j = 0; j < count; ++j) {
    const Vector3f from_mean = offset[j] - mean;
    const float x = from_mean.dot(tangent.x), y = from_mean.dot(tangent.y);
    const float w =
        (1 - kEven) * share[j] / total + kEven * plan.rule.weight[j % 3] * across.weight[j / 3];
    xx += w * x * x, xy += w * x * y, yy += w * y * y;
  }
  result.lobe = lobe_from_covariance(tangent, xx, xy, yy);
  result.integral = asg_integral_exact(result.lobe.bandwidth_x, result.lobe.bandwidth_y);
  result.weight *= plan.rule.probability * tooth.integral / result.integral;
  return result;
}

/// Eq. 23-30.
SliceLobe at_peak(const PreparedMaterial& prepared, const SpecularTooth& tooth,
                  const Vector3f& outgoing) {
  SliceLobe result;
  result.lobe = warp_to_incoming(tooth.lobe, outgoing).lobe;
  const Vector3f& axis = result.lobe.frame.z;
  if (result.lobe.amplitude <= 0 || axis.z() <= 0) return result;
  result.weight = specular_smooth_factor(prepared.material, outgoing, axis) *
                  (axis.z() * result.lobe.amplitude);
  result.lobe.amplitude = 1;
  result.integral = asg_integral_exact(result.lobe.bandwidth_x, result.lobe.bandwidth_y);
  return result;
}

/// D(h) of Ward's and Ashikhmin's models as xu2013asg take it, section 5.2. The paper fits others.
HalfVectorLobes paper_lobes(const Material& material, int max_lobes) {
  if (material.model != SpecularModel::ward && material.model != SpecularModel::ashikhmin_shirley)
    return half_vector_lobes(material, max_lobes);
  HalfVectorLobes lobes;
  lobes.count = 1;
  lobes.lobe[0].bandwidth_x = 1 / (material.alpha_x * material.alpha_x);
  lobes.lobe[0].bandwidth_y = 1 / (material.alpha_y * material.alpha_y);
  return lobes;
}

}  // namespace

PreparedMaterial prepare_material(const Material& material,
                                  const SpecularOptions& options) noexcept {
  PreparedMaterial prepared;
  prepared.material = material;
  prepared.form = options.form;
  if (!material.has_specular()) return prepared;
  prepared.lobes = options.form == SpecularForm::peak ? paper_lobes(material, options.lobes)
                                                      : half_vector_lobes(material, options.lobes);
  const bool has_tail =
      material.model == SpecularModel::cook_torrance && material.distribution == Distribution::ggx;
  prepared.corrects_distribution =
      material.model != SpecularModel::fitted && (!has_tail || options.lobes >= kTailLobes);
  for (int k = 0; k < prepared.lobes.count; ++k)
    add_teeth(prepared.lobes.lobe[static_cast<size_t>(k)], std::clamp(options.taps, 1, kMaxTaps),
              prepared);
  return prepared;
}

int specular_slice(const PreparedMaterial& prepared, const Vector3f& outgoing,
                   std::span<SliceLobe, kMaxSpecularTeeth> slice) noexcept {
  if (outgoing.z() <= 0) return 0;
  int count = 0;
  for (int k = 0; k < prepared.count; ++k) {
    const SpecularTooth& tooth = prepared.tooth[static_cast<size_t>(k)];
    const SliceLobe lobe = prepared.form == SpecularForm::moments
                               ? match_moments(prepared, tooth, outgoing)
                               : at_peak(prepared, tooth, outgoing);
    if ((lobe.weight > 0).any()) slice[static_cast<size_t>(count++)] = lobe;
  }
  return count;
}

}  // namespace burnish
