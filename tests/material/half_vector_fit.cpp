#include "material/half_vector_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>

#include "material/published_distributions.h"

namespace burnish::test {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// D at nodes of a quarter of the hemisphere, and what a set of lobes leaves of it.
class FitProblem {
 public:
  explicit FitProblem(const Material& material)
      : alpha_x_(material.alpha_x), alpha_y_(material.alpha_y) {
    for (const Node& node : hemisphere_nodes(alpha_x_, alpha_y_)) {
      if (node.direction.x() < 0 || node.direction.y() < 0) continue;
      nodes_.push_back(node);
    }
    const auto count = static_cast<Eigen::Index>(nodes_.size());
    values_.resize(count);
    root_weights_.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Node& node = nodes_[static_cast<size_t>(i)];
      values_[i] = published_distribution(material, node.direction);
      root_weights_[i] = std::sqrt(node.weight * node.direction.z());
    }
    energy_ = values_.dot(root_weights_.cwiseAbs2());
    values_.array() *= root_weights_.array();
    values_squared_ = values_.squaredNorm();
  }

  /// Squared relative error of lobes with these roots of scaled bandwidths (x, y of each), with
  /// their best amplitudes.
  double error(const Vector& roots, Vector& amplitudes) const {
    const Eigen::Index count = roots.size() / 2;
    Matrix columns(values_.size(), count);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double x = roots[2 * k] / alpha_x_, y = roots[2 * k + 1] / alpha_y_;
      for (Eigen::Index i = 0; i < columns.rows(); ++i) {
        const Vector3d& h = nodes_[static_cast<size_t>(i)].direction;
        const double u = x * h.x(), v = y * h.y();
        columns(i, k) = root_weights_[i] * h.z() * std::exp(-u * u - v * v);
      }
    }
    return best_amplitudes(columns, amplitudes) / values_squared_;
  }

 private:
  /// Least squares with amplitudes >= 0 and the energy given: the best of all subsets of lobes,
  /// each by a Lagrange multiplier. Returns the squared error.
  double best_amplitudes(const Matrix& columns, Vector& amplitudes) const {
    const Matrix gram = columns.transpose() * columns;
    const Vector right = columns.transpose() * values_;
    const Vector energies = columns.transpose() * root_weights_;
    const Eigen::Index count = columns.cols();
    double best = std::numeric_limits<double>::infinity();
    for (int subset = 1; subset < 1 << count; ++subset) {
      std::vector<Eigen::Index> members;
      for (Eigen::Index k = 0; k < count; ++k)
        if (subset >> k & 1) members.push_back(k);
      const auto size = static_cast<Eigen::Index>(members.size());
      Matrix system = Matrix::Zero(size + 1, size + 1);
      Vector target(size + 1);
      system.topLeftCorner(size, size) = gram(members, members);
      system.block(0, size, size, 1) = energies(members);
      system.block(size, 0, 1, size) = energies(members).transpose();
      target << right(members), energy_;
      const Vector solution = system.fullPivLu().solve(target).head(size);
      if (!(solution.array() >= 0).all()) continue;
      Vector all = Vector::Zero(count);
      all(members) = solution;
      const double error = all.dot(gram * all) - 2 * all.dot(right) + values_squared_;
      if (error >= best) continue;
      best = error;
      amplitudes = all;
    }
    return best;
  }

  double alpha_x_, alpha_y_;
  std::vector<Node> nodes_;
  Vector values_, root_weights_;
  double energy_ = 0, values_squared_ = 0;
};

/// The simplex method of Nelder and Mead.
template <class F>
Vector minimise(const F& f, const Vector& start, double step) {
  using Corner = std::pair<double, Vector>;
  std::vector<Corner> simplex{{f(start), start}};
  const auto dimensions = static_cast<size_t>(start.size());
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    Vector corner = start;
    corner[i] += step;
    simplex.emplace_back(f(corner), corner);
  }
  const auto lower = [](const Corner& a, const Corner& b) { return a.first < b.first; };
  const auto at = [&](const Vector& x) { return Corner(f(x), x); };
  for (int iteration = 0; iteration < 2000; ++iteration) {
    std::sort(simplex.begin(), simplex.end(), lower);
    Corner& worst = simplex.back();
    const Corner& best = simplex.front();
    if ((worst.second - best.second).norm() < 1e-6) break;
    Vector middle = Vector::Zero(start.size());
    for (size_t i = 0; i < dimensions; ++i) middle += simplex[i].second / double(dimensions);
    const Corner reflected = at(2 * middle - worst.second);
    if (reflected.first < best.first) {
      worst = std::min(reflected, at(3 * middle - 2 * worst.second), lower);
    } else if (reflected.first < simplex[dimensions - 1].first) {
      worst = reflected;
    } else {
      const Corner inner = at((middle + std::min(reflected, worst, lower).second) / 2);
      if (inner.first < std::min(reflected.first, worst.first)) {
        worst = inner;
      } else {
        for (size_t i = 1; i <= dimensions; ++i)
          simplex[i] = at((simplex[i].second + best.second) / 2);
      }
    }
  }
  return std::min_element(simplex.begin(), simplex.end(), lower)->second;
}

}  // namespace

LobeFitResult fit_half_vector_lobes(const Material& material, const LobeFit& start) {
  const FitProblem problem(material);
  // Round lobes have one parameter each.
  const bool round = material.alpha_x == material.alpha_y;
  const auto count = static_cast<Eigen::Index>(start.size());
  const auto both = [&](const Vector& x) {
    Vector roots(2 * count);
    for (Eigen::Index i = 0; i < roots.size(); ++i) roots[i] = x[round ? i / 2 : i];
    return roots;
  };
  Vector x(round ? count : 2 * count), amplitudes;
  for (size_t k = 0; k < start.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (!round) x[2 * i] = std::sqrt(start[k].scaled_bandwidth_x);
    x[round ? i : 2 * i + 1] = std::sqrt(start[k].scaled_bandwidth_y);
  }
  // The step changes its sign and size, since a simplex may collapse.
  for (const double step : {0.1, -0.05, 0.02, -0.02})
    x = minimise([&](const Vector& y) { return problem.error(both(y), amplitudes); }, x, step);
  const Vector roots = both(x);
  LobeFitResult result{start, std::sqrt(problem.error(roots, amplitudes))};
  for (Eigen::Index k = 0; k < count; ++k) {
    FitLobe& lobe = result.lobes[static_cast<size_t>(k)];
    lobe.amplitude = amplitudes[k];
    if (lobe.amplitude <= 0) {  // any bandwidth does: near its neighbour's, for interpolation
      if (round) lobe.scaled_bandwidth_x = lobe.scaled_bandwidth_y;
      continue;
    }
    lobe.scaled_bandwidth_x = roots[2 * k] * roots[2 * k];
    lobe.scaled_bandwidth_y = roots[2 * k + 1] * roots[2 * k + 1];
  }
  return result;
}

std::vector<LobeFit> fit_half_vector_table(const Material& model, const LobeFit& start, int steps) {
  std::vector<LobeFit> table;
  const auto at = [&](int i, int j) -> const LobeFit& {
    return table[static_cast<size_t>(i * (i + 1) / 2 + j)];
  };
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= i; ++j) {
      Material material = model;
      material.alpha_x = std::max(float(i) / float(steps), 1e-3f);
      material.alpha_y = std::max(float(j) / float(steps), 1e-3f);
      std::vector<LobeFit> starts;
      if (i == 0) starts.push_back(start);
      if (i > j) starts.push_back(at(i - 1, j));
      if (i == j && i > 0) starts.push_back(at(i - 1, i - 1));
      if (j > 0) starts.push_back(at(i, j - 1));
      // Of several minima the one that continues a neighbour's, for interpolation.
      constexpr double kBetter = 0.9;
      LobeFitResult best{{}, std::numeric_limits<double>::infinity()};
      for (const LobeFit& near : starts) {
        LobeFitResult fit = fit_half_vector_lobes(material, near);
        if (fit.error < kBetter * best.error) best = std::move(fit);
      }
      table.push_back(best.lobes);
    }
  }
  return table;
}

FitError fit_error(const Material& material, const HalfVectorLobes& lobes) {
  double difference = 0, square = 0, projected_difference = 0, projected_square = 0;
  double energy = 0, lobes_energy = 0;
  for (const Node& node : hemisphere_nodes(material.alpha_x, material.alpha_y)) {
    const double d = published_distribution(material, node.direction), z = node.direction.z();
    double sum = 0;
    for (size_t k = 0; k < static_cast<size_t>(lobes.count); ++k)
      sum += double(eval(lobes.lobe[k], node.direction.cast<float>().eval()));
    difference += node.weight * (sum - d) * (sum - d);
    square += node.weight * d * d;
    projected_difference += node.weight * z * (sum - d) * (sum - d);
    projected_square += node.weight * z * d * d;
    energy += node.weight * z * d;
    lobes_energy += node.weight * z * sum;
  }
  return {std::sqrt(difference / square), std::sqrt(projected_difference / projected_square),
          lobes_energy / energy};
}

}  // namespace burnish::test
