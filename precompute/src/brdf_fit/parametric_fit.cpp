// The best Ward and Ashikhmin-Shirley materials: for given roughness the BRDF is linear in the
// diffuse and specular reflectances (a non-negative least-squares problem a channel); roughness is
// scanned, then improved by Levenberg-Marquardt.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "brdf_fit/brdf_error.h"
#include "brdf_fit/brdf_samples.h"
#include "burnish/formats/error.h"
#include "light_fit/nonnegative_least_squares.h"

namespace burnish {
namespace {

/// The columns that a model is a combination of: diffuse, specular at full reflectance and, of
/// Ashikhmin-Shirley, the same times Schlick's factor of zero normal reflectance.
class ParametricModel {
 public:
  /// `unit` is what the samples' values were divided by.
  ParametricModel(SpecularModel model, const BrdfSamples& samples, double unit)
      : samples_(samples),
        unit_(unit),
        columns_(model == SpecularModel::ashikhmin_shirley ? 3 : 2) {
    material_.model = model;
    for (const BrdfPair& pair : samples.pairs)
      norm2_ += (double(pair.weight) * pair.value.cast<double>()).square().sum();
  }

  /// The best material of a roughness; the residuals, relative, if asked for.
  Material solve(double alpha_x, double alpha_y, double* residuals, double& square) const {
    Material material = material_;
    material.alpha_x = std::clamp(static_cast<float>(alpha_x), kMinAlpha, kMaxAlpha);
    material.alpha_y = std::clamp(static_cast<float>(alpha_y), kMinAlpha, kMaxAlpha);
    const Eigen::MatrixXd columns = sample(material);
    const Eigen::Index rows = columns.rows();
    Eigen::MatrixXd value(rows, 3);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const BrdfPair& pair = samples_.pairs[static_cast<size_t>(i)];
      value.row(i) = (pair.weight * pair.value).cast<double>().matrix().transpose();
    }
    const Eigen::MatrixXd gram = columns.transpose() * columns;
    const Eigen::MatrixXd right = columns.transpose() * value;
    Eigen::MatrixXd factors(columns_, 3);
    for (int c = 0; c < 3; ++c) factors.col(c) = solve_factors(gram, right.col(c));
    const Eigen::MatrixXd residual = (columns * factors - value) / std::sqrt(norm2_);
    square = residual.squaredNorm();
    if (residuals) Eigen::Map<Eigen::MatrixXd>(residuals, rows, 3) = residual;
    set_reflectances(factors, material);
    return material;
  }

  int residuals() const { return 3 * static_cast<int>(samples_.pairs.size()); }

 private:
  /// Factors >= 0; with diffuse held where it would be above 1.
  Eigen::VectorXd solve_factors(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right) const {
    std::vector<int> passive;
    Eigen::VectorXd factors = solve_nonnegative(gram, right, passive);
    const Eigen::Index others = columns_ - 1;
    if (unit_ * factors[0] > 1) {
      factors[0] = 1 / unit_;
      passive.clear();
      factors.tail(others) =
          solve_nonnegative(gram.bottomRightCorner(others, others),
                            right.tail(others) - factors[0] * gram.col(0).tail(others), passive);
    }
    factors.tail(others) = factors.tail(others).cwiseMin(double(kMaxSpecular) / unit_);
    return factors;
  }

  Eigen::MatrixXd sample(Material material) const {
    Eigen::MatrixXd columns(samples_.pairs.size(), columns_);
    material.specular = Rgb::Ones();
    material.diffuse = Rgb::Zero();
    // All channels hold the same; the second has Schlick's factor alone.
    material.fresnel.normal_reflectance = Rgb(1, 0, 1);
    tbb::parallel_for(Eigen::Index(0), columns.rows(), [&](Eigen::Index i) {
      const BrdfPair& pair = samples_.pairs[static_cast<size_t>(i)];
      const Rgb value = eval_specular_brdf(material, pair.outgoing, pair.incoming);
      columns(i, 0) = double(pair.weight) / kPi<double>;
      for (int k = 1; k < columns_; ++k) columns(i, k) = double(pair.weight * value[k - 1]);
    });
    return columns;
  }

  void set_reflectances(const Eigen::MatrixXd& relative, Material& material) const {
    const Eigen::MatrixXd factors = unit_ * relative;
    for (int c = 0; c < 3; ++c) {
      material.diffuse[c] = static_cast<float>(std::min(factors(0, c), 1.0));
      double specular = factors(1, c);
      if (columns_ == 3) {
        // r + (1 - r) s, r the normal reflectance and s Schlick's factor: full, and s alone.
        specular = factors(1, c) + factors(2, c);
        material.fresnel.normal_reflectance[c] =
            specular > 0 ? static_cast<float>(factors(1, c) / specular) : 0.04f;
      }
      material.specular[c] = static_cast<float>(std::min(specular, double(kMaxSpecular)));
    }
  }

  const BrdfSamples& samples_;
  double unit_;
  int columns_;
  Material material_;
  double norm2_ = 0;
};

/// Residuals as a function of the logarithms of alpha_x and, unless isotropic, alpha_y.
struct RoughnessCost {
  const ParametricModel& model;
  bool isotropic;

  bool operator()(double const* const* parameters, double* residuals) const {
    double square = 0;
    model.solve(std::exp(parameters[0][0]), std::exp(parameters[0][isotropic ? 0 : 1]), residuals,
                square);
    return true;
  }
};

/// Logarithms of the best roughness of a scan.
Eigen::Vector2d scan_roughness(const ParametricModel& model, bool isotropic) {
  const std::vector<double> alphas = {0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8};
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (const double x : alphas)
    for (const double y : alphas) {
      if (isotropic && y != x) continue;
      double square = 0;
      model.solve(x, y, nullptr, square);
      if (square < least) {
        least = square;
        best = {std::log(x), std::log(y)};
      }
    }
  return best;
}

}  // namespace

Material fit_parametric_brdf(const MeasuredBrdf& measured, SpecularModel model,
                             const BrdfFitOptions& options) {
  check_options(options);
  if (model != SpecularModel::ward && model != SpecularModel::ashikhmin_shirley)
    throw Error(ErrorKind::input, "measured BRDF",
                "a parametric fit of another model, expected ward or ashikhmin_shirley");
  // Few unknowns: a coarser table will do.
  BrdfSamples samples =
      sample_brdf(measured, {options.resolution / 2, options.max_angle_rad, 1 << 15, 0});
  const double unit = normalize_values(samples, options);
  const ParametricModel parametric(model, samples, unit);
  Eigen::Vector2d log_alpha = scan_roughness(parametric, samples.isotropic);
  using Cost = ceres::DynamicNumericDiffCostFunction<RoughnessCost, ceres::CENTRAL>;
  ceres::NumericDiffOptions steps;
  steps.relative_step_size = 1e-3;  // the models are float
  auto* const cost =
      new Cost(new RoughnessCost{parametric, samples.isotropic}, ceres::TAKE_OWNERSHIP, steps);
  const int unknowns = samples.isotropic ? 1 : 2;
  cost->AddParameterBlock(unknowns);
  cost->SetNumResiduals(parametric.residuals());
  ceres::Problem problem;
  problem.AddResidualBlock(cost, nullptr, log_alpha.data());
  for (int i = 0; i < unknowns; ++i) {
    problem.SetParameterLowerBound(log_alpha.data(), i, std::log(double(kMinAlpha)));
    problem.SetParameterUpperBound(log_alpha.data(), i, std::log(double(kMaxAlpha)));
  }
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.num_threads = 1;
  solver.max_num_iterations = 20;
  solver.function_tolerance = 1e-5;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  double square = 0;
  return parametric.solve(std::exp(log_alpha[0]), std::exp(log_alpha[samples.isotropic ? 0 : 1]),
                          nullptr, square);
}

}  // namespace burnish
