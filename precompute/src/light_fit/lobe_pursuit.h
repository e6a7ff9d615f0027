#pragma once

#include <functional>
#include <vector>

#include "light_fit/lobe_mixture_cost.h"

namespace burnish {

/// What is left of the target: a row a cell or normal, a column a channel.
using LightFitResidual = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// What shapes the lobes may have.
struct LobeLimits {
  double min_bandwidth, max_bandwidth;
  bool isotropic = false;   ///< equal bandwidths
  bool fixed_axes = false;  ///< frames stay as they are
};

/// Direction `i` of `count` that are spread evenly over the sphere.
Vector3d fibonacci_direction(int i, int count);

/// Round lobes to start from: wide ones in directions all over the sphere, sampled once, and narrow
/// ones where the residual is large, chosen at each call.
class LobeDictionary {
 public:
  /// Keeps a reference to the target.
  LobeDictionary(const LightFitTarget& target, const LobeLimits& limits);
  /// The single lobe that lowers the squared residual most.
  LobeShape propose(const LightFitResidual& residual) const;

 private:
  const LightFitTarget& target_;
  LobeLimits limits_;
  std::vector<LobeShape> wide_;
  Eigen::MatrixXd wide_samples_;
};

/// A column a lobe: the lobe's samples.
Eigen::MatrixXd sample_lobes(const LightFitTarget& target, const std::vector<LobeShape>& shapes);

/// What the shapes leave of the target with their best colours.
LightFitResidual mixture_residual(const LightFitTarget& target,
                                  const std::vector<LobeShape>& shapes);

/// Improves all shapes together by Levenberg-Marquardt. Returns the number of steps. `keep_going`
/// is asked after each.
int refine_lobes(const LightFitTarget& target, const LobeLimits& limits, int max_steps,
                 double tolerance, const std::function<bool()>& keep_going,
                 std::vector<LobeShape>& shapes);

}  // namespace burnish
