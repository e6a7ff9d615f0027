#pragma once

#include <vector>

#include "brdf_fit/brdf_samples.h"
#include "brdf_fit/smooth_factor_fit.h"
#include "burnish/sphere/anisotropic_gaussian.h"
#include "light_fit/lobe_pursuit.h"

namespace burnish {

/// A mixture of lobes over half vectors.
struct DistributionLobes {
  std::vector<LobeShape> shapes;
  std::vector<double> amplitudes;  ///< >= 0, a lobe

  std::vector<AnisotropicGaussian<double>> mixture() const;
};

/// Fits lobes to a table of half vectors by variable projection, as lights are fitted to a map of
/// one channel (light_fit/). Cells are joined in blocks where the table varies little.
class DistributionFit {
 public:
  /// Weighted squares of the table's cells; round lobes about the normal if they are isotropic.
  DistributionFit(const BrdfSamples& samples, const CellTarget& table);
  /// Whether there is anything to fit.
  bool empty() const { return target_.direction.empty(); }
  /// Adds a lobe where it lowers the error most, then improves all.
  void add_lobe(DistributionLobes& lobes) const;
  /// Improves all lobes together.
  void refine(int steps, DistributionLobes& lobes) const;

 private:
  void solve_amplitudes(DistributionLobes& lobes) const;

  bool isotropic_;
  double scale_ = 1;  ///< of the target's values against the table's
  LightFitTarget target_;
  LobeLimits limits_;
};

}  // namespace burnish
