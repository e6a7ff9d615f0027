#pragma once

#include <functional>
#include <string>
#include <vector>

#include "burnish/material/material.h"

/// The fit of D(h) by ASGs about the normal, of which the runtime holds a table.
namespace burnish::test {

/// A lobe of a fit, at alpha_x >= alpha_y.
struct FitLobe {
  double scaled_bandwidth_x = 1;  ///< times alpha_x^2
  double scaled_bandwidth_y = 1;  ///< times alpha_y^2
  double amplitude = 1;
};
using LobeFit = std::vector<FitLobe>;

/// What a sum of lobes misses of D.
struct FitError {
  double relative_l2 = 0;   ///< over the hemisphere
  double projected_l2 = 0;  ///< the same with weight h.z
  double energy = 1;        ///< ratio of the integrals of D h.z
};
FitError fit_error(const Material& material, const HalfVectorLobes& lobes);

/// The fit that a search from `start` finds: least squares of weight h.z, bandwidths and amplitudes
/// >= 0, the integral of D h.z exact.
struct LobeFitResult {
  LobeFit lobes;
  double error = 0;  ///< relative L2 of weight h.z
};
LobeFitResult fit_half_vector_lobes(const Material& material, const LobeFit& start);

/// The fits of a model on the grid alpha_x, alpha_y = i / steps, i >= j, the smallest alpha
/// standing for 0, each started from its neighbours: [i (i + 1) / 2 + j].
std::vector<LobeFit> fit_half_vector_table(const Material& model, const LobeFit& start, int steps);

}  // namespace burnish::test
