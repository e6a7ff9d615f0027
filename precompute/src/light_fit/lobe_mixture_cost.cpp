// Based on: variable projection (golub1973varpro) with Kaufman's derivative (kaufman1975varpro):
// the colours are solved for, so that the solver sees the shapes only. Kaufman leaves out a term of
// the derivative that is orthogonal to the residual: the gradient stays exact.
#include "light_fit/lobe_mixture_cost.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

#include "light_fit/nonnegative_least_squares.h"

namespace burnish {
namespace {

// Derivatives of R(q)^T v by (x, y, z, w), from the form that is quadratic in q:
// (w^2 - u.u) v + 2 u (u.v) - 2 w u x v. The part along q is meaningless: the manifold drops it.
Eigen::Matrix<double, 3, 4> rotate_back_derivative(const Eigen::Quaterniond& q, const Vector3d& v) {
  const Vector3d u = q.vec();
  Eigen::Matrix<double, 3, 4> d;
  for (int i = 0; i < 3; ++i) {
    const Vector3d e = Vector3d::Unit(i);
    d.col(i) = 2 * (-u[i] * v + e * u.dot(v) + u * v[i] - q.w() * e.cross(v));
  }
  d.col(3) = 2 * (q.w() * v - u.cross(v));
  return d;
}

}  // namespace

void sample_lobe(const LightFitTarget& target, const double* rotation, const double* log_bandwidth,
                 Eigen::Ref<Eigen::VectorXd> value, SampleDerivative* derivative) {
  const Eigen::Quaterniond q = Eigen::Map<const Eigen::Quaterniond>(rotation).normalized();
  const Eigen::Matrix3d to_local = q.toRotationMatrix().transpose();
  const double bandwidth_x = std::exp(log_bandwidth[0]), bandwidth_y = std::exp(log_bandwidth[1]);
  const Eigen::Index cells = target.cells();
  if (derivative) derivative->setZero();
  for (Eigen::Index i = 0; i < cells; ++i) {
    const Vector3d v = to_local * target.direction[i];
    value[i] = 0;
    if (v.z() <= 0) continue;
    // A Gaussian of variance 1 / (2 b) averaged over a cell of variance s has bandwidth
    // b / (1 + 2 b s) and keeps its integral.
    const double widen_x = 1 / (1 + 2 * bandwidth_x * target.variance[i]);
    const double widen_y = 1 / (1 + 2 * bandwidth_y * target.variance[i]);
    const double bx = bandwidth_x * widen_x, by = bandwidth_y * widen_y;
    const double over_z = target.scale[i] * std::sqrt(widen_x * widen_y) *
                          std::exp(-bx * v.x() * v.x() - by * v.y() * v.y());
    const double f = over_z * v.z();
    value[i] = f;
    if (!derivative) continue;
    const Eigen::RowVector3d by_local(-2 * bx * v.x() * f, -2 * by * v.y() * f, over_z);
    derivative->row(i).head<4>() = by_local * rotate_back_derivative(q, target.direction[i]);
    (*derivative)(i, 4) = f * ((widen_x - 1) / 2 - bx * widen_x * v.x() * v.x());
    (*derivative)(i, 5) = f * ((widen_y - 1) / 2 - by * widen_y * v.y() * v.y());
  }
  const Eigen::Index normals = target.rows() - cells;
  value.tail(normals).noalias() = target.irradiance * value.head(cells);
  if (derivative)
    derivative->bottomRows(normals).noalias() = target.irradiance * derivative->topRows(cells);
}

LobeColors solve_colors(const LightFitTarget& target, const Eigen::MatrixXd& lobes) {
  LobeColors result;
  result.color.resize(lobes.cols(), 3);
  const Eigen::MatrixXd gram = lobes.transpose() * lobes;
  const Eigen::MatrixXd rhs = lobes.transpose() * target.value;
  for (int c = 0; c < 3; ++c)
    result.color.col(c) = solve_nonnegative(gram, rhs.col(c), result.passive[c]);
  return result;
}

LobeMixtureCost::LobeMixtureCost(const LightFitTarget& target, int lobes)
    : target_(target), lobes_(lobes) {
  set_num_residuals(static_cast<int>(3 * target.rows()));
  for (int i = 0; i < lobes; ++i) {
    mutable_parameter_block_sizes()->push_back(4);
    mutable_parameter_block_sizes()->push_back(2);
  }
}

bool LobeMixtureCost::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  const Eigen::Index rows = target_.rows();
  Eigen::MatrixXd lobes(rows, lobes_);
  std::vector<SampleDerivative> derivative(jacobians ? lobes_ : 0);
  tbb::parallel_for(0, lobes_, [&](int k) {
    if (jacobians) derivative[k].resize(rows, 6);
    sample_lobe(target_, parameters[2 * k], parameters[2 * k + 1], lobes.col(k),
                jacobians ? &derivative[k] : nullptr);
  });
  const LobeColors solved = solve_colors(target_, lobes);
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3>> residual(residuals, rows, 3);
  residual = target_.value;
  residual.noalias() -= lobes * solved.color;
  if (!jacobians) return true;

  const Eigen::MatrixXd gram = lobes.transpose() * lobes;
  Eigen::MatrixXd used[3];
  Eigen::LLT<Eigen::MatrixXd> factor[3];
  for (int c = 0; c < 3; ++c) {
    used[c] = lobes(Eigen::all, solved.passive[c]);
    factor[c].compute(gram(solved.passive[c], solved.passive[c]));
  }
  tbb::parallel_for(0, lobes_, [&](int k) {
    const Eigen::MatrixXd cross = lobes.transpose() * derivative[k];
    SampleDerivative part(rows, 6);
    for (int c = 0; c < 3; ++c) {
      // -color * (what of the derivative the lobes in use cannot make up for)
      part.setZero();
      if (const double color = solved.color(k, c); color > 0) {
        const Eigen::MatrixXd along =
            factor[c].solve(Eigen::MatrixXd(cross(solved.passive[c], Eigen::all)));
        part = -color * derivative[k];
        part.noalias() += used[c] * (color * along);
      }
      using RowMajor4 = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
      using RowMajor2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
      if (jacobians[2 * k])
        Eigen::Map<RowMajor4>(jacobians[2 * k] + c * rows * 4, rows, 4) = part.leftCols<4>();
      if (jacobians[2 * k + 1])
        Eigen::Map<RowMajor2>(jacobians[2 * k + 1] + c * rows * 2, rows, 2) = part.rightCols<2>();
    }
  });
  return true;
}

}  // namespace burnish
