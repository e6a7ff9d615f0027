#pragma once

#include <vector>

#include <Eigen/Core>

#include "brdf_fit/brdf_samples.h"

namespace burnish {

/// All of a fitted BRDF but its distribution: diffuse / pi + D(h) F(h.o) S(o.z) S(i.z).
struct SmoothFactor {
  Eigen::Array3d diffuse = Eigen::Array3d::Zero();
  Eigen::Matrix<double, Eigen::Dynamic, 3> color;  ///< F, at even angles of 0..pi / 2
  Eigen::VectorXd masking;                         ///< S, likewise
  double max_diffuse = 1;                          ///< in the values' unit
};

/// F = 1 and S = 1 / sqrt(cos), held near the horizon.
SmoothFactor initial_smooth_factor();

/// A fit's problem: a row a pair and channel. `place` are those of a pair's angles in the tables.
struct BrdfRows {
  explicit BrdfRows(const BrdfSamples& samples);

  struct Place {
    float difference, outgoing, incoming;
  };
  const BrdfSamples& samples;
  std::vector<Place> place;  ///< a pair
  double norm2 = 0;          ///< of the weighted values
};

/// Lowers the squared residual over F and diffuse (exactly), then over S (a Gauss-Newton step),
/// entries >= 0, given the distribution's value at each pair.
void improve_smooth_factor(const BrdfRows& rows, const std::vector<float>& distribution,
                           SmoothFactor& smooth);

/// Squared residual over the squared norm of the values.
double relative_square(const BrdfRows& rows, const std::vector<float>& distribution,
                       const SmoothFactor& smooth);
/// The same of the cube roots of f cos.
double relative_root_square(const BrdfRows& rows, const std::vector<float>& distribution,
                            const SmoothFactor& smooth);

/// The distribution that suits a cell best by itself, and how much it matters: the squared residual
/// is sum of weight (D - value)^2 and a part that does not depend on D.
struct CellTarget {
  std::vector<double> value, weight;  ///< >= 0, a cell; 0 where there is no pair
};
CellTarget cell_target(const BrdfRows& rows, const SmoothFactor& smooth);

}  // namespace burnish
