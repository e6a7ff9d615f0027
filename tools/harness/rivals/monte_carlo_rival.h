#pragma once

#include "harness/reference_integrator.h"
#include "harness/rivals/rival.h"

/// The reference integrator as a rival: what it does in a time, and what a given error takes it.
namespace burnish {

/// `samples` a vertex, as ReferenceOptions; local lights are those of the scene's rig.
Rival monte_carlo_rival(const RivalScene& scene, int samples, std::uint64_t seed = 1);

/// A run: what it took, all vertices together, and the relative L2 error that its variance tells.
struct MonteCarloRun {
  double samples = 0;  ///< a vertex
  double seconds = 0;
  double error = 0;
};

/// Runs the integrator over all vertices. `norm2` is the sum of squares of the truth; 0: of the
/// run's own result, whose noise is then in it.
MonteCarloRun run_monte_carlo(const RivalScene& scene,
                              const Eigen::Matrix3f& world_from_environment, const Vector3f& eye,
                              const ReferenceOptions& options, double norm2 = 0);

/// error = error_of_one samples^-exponent, time = seconds_per_sample samples.
struct MonteCarloLaw {
  double seconds_per_sample = 0;
  double error_of_one = 0;
  double exponent = 0.5;  ///< more for the well-spread samples that the integrator takes
};

/// The law through one run, with the exponent 1/2 of independent samples, or by least squares
/// through several of different numbers of samples. Throws std::invalid_argument for a run without
/// samples, time or error.
MonteCarloLaw monte_carlo_law(std::span<const MonteCarloRun> runs);

/// At equal time, and at equal error, > 0 both. Samples may be fewer than one.
/// @{
double monte_carlo_error_at(const MonteCarloLaw& law, double seconds);
double monte_carlo_samples_at(const MonteCarloLaw& law, double error);
double monte_carlo_seconds_at(const MonteCarloLaw& law, double error);
/// @}

}  // namespace burnish
