#include "harness/round_lobe_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "burnish/sphere/gauss_legendre.h"

namespace burnish {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// A half vector: `along` the longer axis and `up` the normal, for a weight in sr.
struct Node {
  double along, across, up, weight;
};

/// Of a quarter of the hemisphere: even along, for lobes of the shorter alpha's width; across,
/// dense about the longer axis, since a few lobes are wider than D there.
std::vector<Node> quarter_nodes(double long_alpha, double short_alpha) {
  constexpr double kRightAngle = kPi<double> / 2;
  const auto& panel_rule = internal::unit_gauss<16>();
  const auto& across_rule = internal::unit_gauss<28>();
  const double end = std::min(kRightAngle, 4.5 * long_alpha);
  const int panels = static_cast<int>(std::ceil(end / (4 * short_alpha)));
  const double stretch = std::asinh(kRightAngle / short_alpha);
  std::vector<Node> nodes;
  for (int panel = 0; panel < panels; ++panel) {
    for (size_t i = 0; i < panel_rule.node.size(); ++i) {
      const double latitude = (panel + panel_rule.node[i]) * end / panels;
      const double cosine = std::cos(latitude), width = panel_rule.weight[i] * end / panels;
      for (size_t j = 0; j < across_rule.node.size(); ++j) {
        const double t = stretch * across_rule.node[j], longitude = short_alpha * std::sinh(t);
        const double height = across_rule.weight[j] * stretch * short_alpha * std::cosh(t);
        nodes.push_back({std::sin(latitude), cosine * std::sin(longitude),
                         cosine * std::cos(longitude), cosine * width * height});
      }
    }
  }
  return nodes;
}

/// D at the nodes, and what lobes leave of it. The lobes as parameters: of each pair the angle from
/// the normal and the logarithms of sharpness and amplitude; then those two of the single lobe at
/// the normal, if the count is odd.
class Problem {
 public:
  explicit Problem(const HalfVectorDistribution& d)
      : x_is_long_(d.alpha_x >= d.alpha_y),
        long_alpha_(std::max(d.alpha_x, d.alpha_y)),
        short_alpha_(std::min(d.alpha_x, d.alpha_y)),
        nodes_(quarter_nodes(long_alpha_, short_alpha_)) {
    const auto count = static_cast<Eigen::Index>(nodes_.size());
    root_weights_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) root_weights_[i] = std::sqrt(node(i).weight);
    target_ = weighted(d.value);
  }

  double relative_l2(const HalfVectorFunction& approximation) const {
    return (weighted(approximation) - target_).norm() / target_.norm();
  }

  Vector start(int count, double reach, double sharpness_factor) const;
  /// Improves the parameters; returns the squared error.
  double search(Vector& parameters, int steps) const;
  RoundLobeFit fit(const Vector& parameters, double squared_error) const;

 private:
  const Node& node(Eigen::Index i) const { return nodes_[static_cast<size_t>(i)]; }
  Vector weighted(const HalfVectorFunction& f) const {
    Vector values(root_weights_.size());
    for (Eigen::Index i = 0; i < values.size(); ++i)
      values[i] = root_weights_[i] * f(local(node(i).along, node(i).across, node(i).up));
    return values;
  }
  Vector3<double> local(double along, double across, double up) const {
    return x_is_long_ ? Vector3<double>(along, across, up) : Vector3<double>(across, along, up);
  }
  /// Adds a lobe's weighted values, and its derivatives in the columns from `column` on.
  void add_lobe(double angle, double log_sharpness, double log_amplitude, bool is_mirrored,
                Eigen::Index column, bool is_single, Vector& values, Matrix& derivatives) const;
  /// Lobes minus D.
  Vector residual(const Vector& parameters, Matrix& derivatives) const;

  bool x_is_long_;
  double long_alpha_, short_alpha_;
  std::vector<Node> nodes_;
  Vector root_weights_, target_;
};

Vector Problem::start(int count, double reach, double sharpness_factor) const {
  const int pairs = count / 2;
  Vector p(3 * pairs + 2 * (count % 2));
  const double log_sharpness = std::log(sharpness_factor * 2 / (short_alpha_ * short_alpha_));
  const double step = 2 * reach * std::min(long_alpha_, 0.7) / count;
  for (int k = 0; k < pairs; ++k) {
    const double angle = (k + (count % 2 ? 1.0 : 0.5)) * step, distance = angle / long_alpha_;
    p.segment<3>(3 * k) << angle, log_sharpness, std::log(0.5) - distance * distance;
  }
  if (count % 2) p.tail<2>() << log_sharpness, std::log(0.5);
  return p;
}

void Problem::add_lobe(double angle, double log_sharpness, double log_amplitude, bool is_mirrored,
                       Eigen::Index column, bool is_single, Vector& values,
                       Matrix& derivatives) const {
  const double side = is_mirrored ? -1 : 1, sine = side * std::sin(angle), cosine = std::cos(angle);
  const double sharpness = std::exp(log_sharpness), amplitude = std::exp(log_amplitude);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const Node& n = node(i);
    const double along = n.along - sine, up = n.up - cosine;
    const double exponent = -0.5 * sharpness * (along * along + n.across * n.across + up * up);
    if (exponent < -40) continue;
    const double value = amplitude * root_weights_[i] * std::exp(exponent);
    values[i] += value;
    if (!is_single)
      derivatives(i, column) +=
          value * sharpness * (side * cosine * n.along - std::sin(angle) * n.up);
    const Eigen::Index next = is_single ? column : column + 1;
    derivatives(i, next) += value * exponent;
    derivatives(i, next + 1) += value;
  }
}

Vector Problem::residual(const Vector& p, Matrix& derivatives) const {
  Vector values = -target_;
  derivatives.setZero(target_.size(), p.size());
  const Eigen::Index pairs = p.size() / 3;
  for (Eigen::Index k = 0; k < 3 * pairs; k += 3)
    for (const bool is_mirrored : {false, true})
      add_lobe(p[k], p[k + 1], p[k + 2], is_mirrored, k, false, values, derivatives);
  if (p.size() % 3 == 2)
    add_lobe(0, p[3 * pairs], p[3 * pairs + 1], false, 3 * pairs, true, values, derivatives);
  return values;
}

/// Levenberg-Marquardt with Marquardt's scaling.
double Problem::search(Vector& parameters, int steps) const {
  Matrix derivatives, tried_derivatives;
  Vector missing = residual(parameters, derivatives);
  double error = missing.squaredNorm(), damping = 1e-2;
  for (int step = 0; step < steps && damping < 1e8; ++step) {
    Matrix normal = derivatives.transpose() * derivatives;
    normal.diagonal().array() *= 1 + damping;
    normal.diagonal().array() += std::numeric_limits<double>::min();
    const Vector change = normal.ldlt().solve(derivatives.transpose() * missing);
    const Vector tried = parameters - change;
    const bool is_sane = tried.allFinite() && change.cwiseAbs().maxCoeff() < 3;
    const Vector tried_missing = is_sane ? residual(tried, tried_derivatives) : missing;
    const double tried_error = tried_missing.squaredNorm();
    if (!is_sane || !(tried_error < error)) {
      damping *= 4;
      continue;
    }
    damping = std::max(damping / 3, 1e-9);
    const bool is_done = tried_error > (1 - 1e-7) * error;
    parameters = tried;
    missing = tried_missing;
    error = tried_error;
    derivatives.swap(tried_derivatives);
    if (is_done) break;
  }
  return error;
}

RoundLobeFit Problem::fit(const Vector& p, double squared_error) const {
  RoundLobeFit result;
  std::vector<std::array<double, 3>> lobes;
  const Eigen::Index pairs = p.size() / 3;
  for (Eigen::Index k = 0; k < 3 * pairs; k += 3)
    for (const double side : {-1.0, 1.0}) lobes.push_back({side * p[k], p[k + 1], p[k + 2]});
  if (p.size() % 3 == 2) lobes.push_back({0, p[3 * pairs], p[3 * pairs + 1]});
  std::sort(lobes.begin(), lobes.end());
  for (const auto& [angle, log_sharpness, log_amplitude] : lobes) {
    result.lobes.push_back({local(std::sin(angle), 0, std::cos(angle)).cast<float>(),
                            static_cast<float>(std::exp(log_sharpness)),
                            static_cast<float>(std::exp(log_amplitude))});
  }
  result.relative_l2 = std::sqrt(squared_error) / target_.norm();
  return result;
}

}  // namespace

HalfVectorDistribution distribution_of(const Material& material) {
  return {[material](const Vector3<double>& half) {
            return double(eval_distribution(material, half.cast<float>()));
          },
          material.alpha_x, material.alpha_y};
}

double relative_l2(const HalfVectorDistribution& distribution,
                   const HalfVectorFunction& approximation) {
  return Problem(distribution).relative_l2(approximation);
}

RoundLobeFit fit_round_lobes(const HalfVectorDistribution& distribution, int count) {
  const Problem problem(distribution);
  Vector best;
  double least = std::numeric_limits<double>::infinity();
  for (const double reach : {0.5, 0.9, 1.3, 1.8}) {
    for (const double sharpness_factor : {1.0, 0.3}) {
      Vector parameters = problem.start(count, reach, sharpness_factor);
      const double error = problem.search(parameters, 40);
      if (error >= least) continue;
      least = error;
      best = parameters;
    }
  }
  least = problem.search(best, 200);
  return problem.fit(best, least);
}

}  // namespace burnish
