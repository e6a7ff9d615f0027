// Based on: variable projection (golub1973varpro) with Kaufman's derivative (kaufman1975varpro):
// the colours are solved for, so that the solver sees the shapes only. Kaufman leaves out a term of
// the derivative that is orthogonal to the residual: the gradient stays exact.
//
// With D the derivatives of the lobes' samples, P the projection onto the lobes a channel uses, c
// their colours and r the residual, a channel's Jacobian is J = -(I - P) D diag(c), so that
//   J^T J = diag(c) (D^T D - D^T P D) diag(c),   J^T r = -diag(c) D^T r.
// Its thousands of rows are never formed: the Gram matrix of [lobes, D] holds it all, for the three
// channels at once.
#include "light_fit/lobe_mixture_cost.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

#include "burnish/sphere/frame.h"
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

LobeShape round_lobe(const Vector3d& axis, double bandwidth) {
  const Frame<double> frame = frame_from_axis(axis);
  Eigen::Matrix3d rotation;
  rotation << frame.x, frame.y, frame.z;
  LobeShape shape;
  shape.rotation = Eigen::Quaterniond(rotation).normalized();
  shape.log_bandwidth.setConstant(std::log(bandwidth));
  return shape;
}

void sample_lobe(const LightFitTarget& target, const double* rotation, const double* log_bandwidth,
                 Eigen::Ref<Eigen::VectorXd> value, double* derivative_values) {
  const Eigen::Quaterniond q = Eigen::Map<const Eigen::Quaterniond>(rotation).normalized();
  const Eigen::Matrix3d to_local = q.toRotationMatrix().transpose();
  const double bandwidth_x = std::exp(log_bandwidth[0]), bandwidth_y = std::exp(log_bandwidth[1]);
  const Eigen::Index cells = target.cells();
  const bool differentiate = derivative_values != nullptr;
  Eigen::Map<SampleDerivative> derivative(derivative_values, differentiate ? target.rows() : 0, 6);
  derivative.setZero();
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
    if (!differentiate) continue;
    const Eigen::RowVector3d by_local(-2 * bx * v.x() * f, -2 * by * v.y() * f, over_z);
    derivative.row(i).head<4>() = by_local * rotate_back_derivative(q, target.direction[i]);
    derivative(i, 4) = f * ((widen_x - 1) / 2 - bx * widen_x * v.x() * v.x());
    derivative(i, 5) = f * ((widen_y - 1) / 2 - by * widen_y * v.y() * v.y());
  }
  const Eigen::Index normals = target.rows() - cells;
  value.tail(normals).noalias() = target.irradiance * value.head(cells);
  if (differentiate)
    derivative.bottomRows(normals).noalias() = target.irradiance * derivative.topRows(cells);
}

namespace {

LobeColors solve_colors(const LightFitTarget& target, const Eigen::MatrixXd& gram,
                        const Eigen::MatrixXd& rhs) {
  const auto solve = target.signed_colors ? solve_signed : solve_nonnegative;
  LobeColors result;
  result.color.resize(gram.cols(), 3);
  for (int c = 0; c < 3; ++c) result.color.col(c) = solve(gram, rhs.col(c), result.passive[c]);
  return result;
}

// samples^T samples, in strips: the same bytes at any number of threads.
Eigen::MatrixXd gram_matrix(const Eigen::MatrixXd& samples) {
  constexpr Eigen::Index kStrip = 16;
  const Eigen::Index columns = samples.cols(), strips = (columns + kStrip - 1) / kStrip;
  Eigen::MatrixXd gram(columns, columns);
  tbb::parallel_for(Eigen::Index(0), strips, [&](Eigen::Index strip) {
    const Eigen::Index begin = strip * kStrip, size = std::min(kStrip, columns - begin);
    gram.block(0, begin, begin + size, size).noalias() =
        samples.leftCols(begin + size).transpose() * samples.middleCols(begin, size);
  });
  gram.triangularView<Eigen::StrictlyLower>() = gram.transpose();
  return gram;
}

// A matrix F of n rows with F^T F = `square`, n x n and positive semidefinite but for rounding.
Eigen::MatrixXd square_root(const Eigen::MatrixXd& square) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(square);
  const Eigen::VectorXd pivots = factor.vectorD();
  const double least = 1e-15 * pivots.cwiseAbs().maxCoeff();  // less is rounding
  const Eigen::VectorXd root = (pivots.array() > least).select(pivots.array().max(0).sqrt(), 0.0);
  Eigen::MatrixXd result = factor.matrixL();
  result *= root.asDiagonal();
  result = factor.transpositionsP().transpose() * result;
  return result.transpose();
}

}  // namespace

LobeColors solve_colors(const LightFitTarget& target, const Eigen::MatrixXd& lobes) {
  return solve_colors(target, lobes.transpose() * lobes, lobes.transpose() * target.value);
}

LobeMixtureCost::LobeMixtureCost(const LightFitTarget& target, int lobes)
    : target_(target), lobes_(lobes) {
  set_num_residuals(6 * lobes + 1);
  for (int i = 0; i < lobes; ++i) {
    mutable_parameter_block_sizes()->push_back(4);
    mutable_parameter_block_sizes()->push_back(2);
  }
}

bool LobeMixtureCost::Evaluate(double const* const* parameters, double* residuals,
                               double** jacobians) const {
  const Eigen::Index rows = target_.rows(), shapes = 6 * lobes_;
  // The lobes, then their derivatives.
  Eigen::MatrixXd samples(rows, lobes_ + (jacobians ? shapes : 0));
  tbb::parallel_for(0, lobes_, [&](int k) {
    sample_lobe(target_, parameters[2 * k], parameters[2 * k + 1], samples.col(k),
                jacobians ? samples.col(lobes_ + 6 * k).data() : nullptr);
  });
  const auto lobes = samples.leftCols(lobes_);
  const LobeColors solved = solve_colors(target_, lobes);
  Eigen::Matrix<double, Eigen::Dynamic, 3> residual = target_.value;
  residual.noalias() -= lobes * solved.color;
  Eigen::Map<Eigen::VectorXd> short_residual(residuals, num_residuals());
  if (!jacobians) {
    short_residual.setZero();
    short_residual[0] = residual.norm();
    return true;
  }

  const Eigen::MatrixXd gram = gram_matrix(samples);
  const auto derivatives = samples.rightCols(shapes);
  const Eigen::MatrixXd slope = derivatives.transpose() * residual;
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(shapes + 1, shapes + 1);
  for (int c = 0; c < 3; ++c) {
    const std::vector<int>& used = solved.passive[c];
    Eigen::MatrixXd normal = gram.bottomRightCorner(shapes, shapes);
    if (!used.empty()) {
      const Eigen::MatrixXd cross = gram(used, Eigen::seqN(lobes_, shapes));
      const Eigen::MatrixXd own = gram(used, used);
      normal.noalias() -= cross.transpose() * own.llt().solve(cross);
    }
    Eigen::VectorXd color(shapes);
    for (int i = 0; i < shapes; ++i) color[i] = solved.color(i / 6, c);
    square.topLeftCorner(shapes, shapes) += color.asDiagonal() * normal * color.asDiagonal();
    square.topRightCorner(shapes, 1) -= color.cwiseProduct(slope.col(c));
  }
  square.bottomLeftCorner(1, shapes) = square.topRightCorner(shapes, 1).transpose();
  square(shapes, shapes) = residual.squaredNorm();
  const Eigen::MatrixXd root = square_root(square);
  short_residual = root.col(shapes);
  using RowMajor4 = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
  using RowMajor2 = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
  for (int k = 0; k < lobes_; ++k) {
    if (jacobians[2 * k])
      Eigen::Map<RowMajor4>(jacobians[2 * k], shapes + 1, 4) = root.middleCols<4>(6 * k);
    if (jacobians[2 * k + 1])
      Eigen::Map<RowMajor2>(jacobians[2 * k + 1], shapes + 1, 2) = root.middleCols<2>(6 * k + 4);
  }
  return true;
}

}  // namespace burnish
