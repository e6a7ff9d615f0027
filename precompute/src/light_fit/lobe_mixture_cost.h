#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/cost_function.h>

#include "burnish/sphere/direction.h"

namespace burnish {

/// The shape of a lobe as the solver sees it: lobe z, x and y are the rotated axes.
struct LobeShape {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector2d log_bandwidth = Eigen::Vector2d::Zero();  ///< natural logarithm, along x and y
};

LobeShape round_lobe(const Vector3d& axis, double bandwidth);

/// What the mixture is fitted to: the map's cells (a row each, weighted by solid angle), then its
/// irradiance on a set of normals. Both are scaled so that the target's norm is 1 over the cells
/// and the irradiance weight over the normals: half the squared residual is then the squared
/// relative error, plus weight^2 times that of the irradiance, over 2.
struct LightFitTarget {
  std::vector<Vector3d> direction;  ///< of the cells
  std::vector<double> variance;     ///< rad^2, of a cell along either side
  std::vector<double> resolution;   ///< variance below which nothing is known of a lobe's width
  Eigen::VectorXd scale;            ///< of a cell's radiance
  Eigen::MatrixXd irradiance;   ///< [normals x cells]: from scaled radiance to scaled irradiance
  double irradiance_scale = 1;  ///< of an irradiance
  Eigen::Matrix<double, Eigen::Dynamic, 3> value;  ///< [cells + normals], a column a channel
  bool signed_colors = false;                      ///< colours may be negative

  Eigen::Index rows() const { return value.rows(); }
  Eigen::Index cells() const { return scale.size(); }
};

/// Derivatives of a lobe's samples, a column a parameter: quaternion (x, y, z, w), log bandwidths.
using SampleDerivative = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// A unit lobe as seen by the target: its mean over each cell, taken as that of the lobe widened by
/// the cell's variance, scaled, followed by its irradiance. `derivative` is the data of a
/// SampleDerivative with as many rows as the target, or null.
void sample_lobe(const LightFitTarget& target, const double* rotation, const double* log_bandwidth,
                 Eigen::Ref<Eigen::VectorXd> value, double* derivative);

/// The best colours of given shapes, each channel >= 0 unless the target says otherwise.
struct LobeColors {
  Eigen::Matrix<double, Eigen::Dynamic, 3> color;  ///< a row a lobe
  std::vector<int> passive[3];                     ///< lobes in use, a list a channel
};
LobeColors solve_colors(const LightFitTarget& target, const Eigen::MatrixXd& lobes);

/// The error that is left by given shapes with their best colours: variable projection. Parameter
/// blocks: for each lobe a quaternion (x, y, z, w), then two log bandwidths. The residuals are not
/// those of the cells, but 6 * lobes + 1 numbers with the same squared norm, the same gradient and
/// the same J^T J, which is all that a solver asks of them.
class LobeMixtureCost : public ceres::CostFunction {
 public:
  /// Keeps a reference to the target.
  LobeMixtureCost(const LightFitTarget& target, int lobes);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const LightFitTarget& target_;
  int lobes_;
};

}  // namespace burnish
