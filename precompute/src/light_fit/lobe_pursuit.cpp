#include "light_fit/lobe_pursuit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <tbb/parallel_for.h>

#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

// Bandwidths of the dictionary: the solver finds those between. Below the first a lobe hardly
// changes with its bandwidth.
constexpr double kWideBandwidths[] = {0.5, 2, 8};
constexpr double kNarrowBandwidths[] = {32, 128, 512, 2048, 8192};
constexpr int kWideDirections = 256;  // as far apart as the narrowest of the wide lobes is wide
constexpr int kNarrowDirections = 48;

// The cells where the residual's density is highest.
std::vector<int> strongest_cells(const LightFitTarget& target, const LightFitResidual& residual) {
  const Eigen::Index cells = target.cells();
  LightFitResidual missing = residual.topRows(cells);
  missing = target.signed_colors ? missing.cwiseAbs().eval() : missing.cwiseMax(0.0).eval();
  const Eigen::VectorXd density = missing.rowwise().sum().cwiseQuotient(target.scale);
  std::vector<int> order(cells);
  std::iota(order.begin(), order.end(), 0);
  const auto count = std::min<std::ptrdiff_t>(kNarrowDirections, cells);
  std::partial_sort(order.begin(), order.begin() + count, order.end(), [&](int a, int b) {
    return density[a] != density[b] ? density[a] > density[b] : a < b;
  });
  order.resize(count);
  return order;
}

// By how much the best colour of each lobe lowers the squared residual.
Eigen::VectorXd gains(const LightFitTarget& target, const Eigen::MatrixXd& samples,
                      const LightFitResidual& residual) {
  Eigen::MatrixXd along = samples.transpose() * residual;
  if (!target.signed_colors) along = along.cwiseMax(0.0);
  const Eigen::VectorXd square = samples.colwise().squaredNorm().transpose();
  return (square.array() > 0).select(along.rowwise().squaredNorm().array() / square.array(), 0.0);
}

// Asks after every step whether to go on.
class AskToGoOn : public ceres::IterationCallback {
 public:
  explicit AskToGoOn(const std::function<bool()>& keep_going) : keep_going_(keep_going) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    return keep_going_() ? ceres::SOLVER_CONTINUE : ceres::SOLVER_ABORT;
  }

 private:
  const std::function<bool()>& keep_going_;
};

// Keeps two equal logarithms of bandwidths equal.
class EqualBandwidths : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 2; }
  int TangentSize() const override { return 1; }
  bool Plus(const double* x, const double* delta, double* result) const override {
    result[0] = result[1] = x[0] + delta[0];
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    jacobian[0] = jacobian[1] = 1;
    return true;
  }
  bool Minus(const double* y, const double* x, double* delta) const override {
    delta[0] = y[0] - x[0];
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    jacobian[0] = 1;
    jacobian[1] = 0;
    return true;
  }
};

}  // namespace

Vector3d fibonacci_direction(int i, int count) {
  const double z = 1 - (2 * i + 1) / double(count);
  const double angle = i * kPi<double> * (3 - std::sqrt(5.0));
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

LobeDictionary::LobeDictionary(const LightFitTarget& target, const LobeLimits& limits)
    : target_(target), limits_(limits) {
  for (const double bandwidth : kWideBandwidths)
    for (int i = 0; i < kWideDirections; ++i)
      wide_.push_back(
          round_lobe(fibonacci_direction(i, kWideDirections),
                     std::clamp(bandwidth, limits.min_bandwidth, limits.max_bandwidth)));
  wide_samples_ = sample_lobes(target, wide_);
}

LobeShape LobeDictionary::propose(const LightFitResidual& residual) const {
  std::vector<LobeShape> narrow;
  for (const int cell : strongest_cells(target_, residual))
    for (const double bandwidth : kNarrowBandwidths)
      if (bandwidth >= limits_.min_bandwidth && bandwidth <= limits_.max_bandwidth)
        narrow.push_back(round_lobe(target_.direction[cell], bandwidth));
  Eigen::Index best_wide = 0, best_narrow = 0;
  const double gain_wide = gains(target_, wide_samples_, residual).maxCoeff(&best_wide);
  if (narrow.empty()) return wide_[best_wide];
  const double gain_narrow =
      gains(target_, sample_lobes(target_, narrow), residual).maxCoeff(&best_narrow);
  return gain_narrow > gain_wide ? narrow[best_narrow] : wide_[best_wide];
}

Eigen::MatrixXd sample_lobes(const LightFitTarget& target, const std::vector<LobeShape>& shapes) {
  Eigen::MatrixXd samples(target.rows(), shapes.size());
  tbb::parallel_for(size_t(0), shapes.size(), [&](size_t i) {
    sample_lobe(target, shapes[i].rotation.coeffs().data(), shapes[i].log_bandwidth.data(),
                samples.col(i), nullptr);
  });
  return samples;
}

LightFitResidual mixture_residual(const LightFitTarget& target,
                                  const std::vector<LobeShape>& shapes) {
  const Eigen::MatrixXd samples = sample_lobes(target, shapes);
  return target.value - samples * solve_colors(target, samples).color;
}

int refine_lobes(const LightFitTarget& target, const LobeLimits& limits, int max_steps,
                 double tolerance, const std::function<bool()>& keep_going,
                 std::vector<LobeShape>& shapes) {
  LobeMixtureCost cost(target, static_cast<int>(shapes.size()));
  ceres::EigenQuaternionManifold manifold;
  EqualBandwidths equal;
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  std::vector<double*> blocks;
  for (LobeShape& shape : shapes) {
    blocks.push_back(shape.rotation.coeffs().data());
    blocks.push_back(shape.log_bandwidth.data());
  }
  problem.AddResidualBlock(&cost, nullptr, blocks);
  for (LobeShape& shape : shapes) {
    problem.SetManifold(shape.rotation.coeffs().data(), &manifold);
    if (limits.fixed_axes) problem.SetParameterBlockConstant(shape.rotation.coeffs().data());
    if (limits.isotropic) problem.SetManifold(shape.log_bandwidth.data(), &equal);
    for (int i = 0; i < 2; ++i) {
      shape.log_bandwidth[i] = std::clamp(shape.log_bandwidth[i], std::log(limits.min_bandwidth),
                                          std::log(limits.max_bandwidth));
      problem.SetParameterLowerBound(shape.log_bandwidth.data(), i, std::log(limits.min_bandwidth));
      problem.SetParameterUpperBound(shape.log_bandwidth.data(), i, std::log(limits.max_bandwidth));
    }
  }
  AskToGoOn ask(keep_going);
  ceres::Solver::Options options;
  // There are few rows, and a lobe nearly round makes columns vanish: a Cholesky factor may fail.
  options.linear_solver_type = ceres::DENSE_QR;
  options.num_threads = 1;  // one residual block; and the same bytes on any machine
  options.max_num_iterations = max_steps;
  options.function_tolerance = tolerance;
  options.logging_type = ceres::SILENT;
  options.update_state_every_iteration = false;
  options.callbacks.push_back(&ask);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (LobeShape& shape : shapes) shape.rotation.normalize();
  return static_cast<int>(summary.iterations.size()) - 1;
}

}  // namespace burnish
