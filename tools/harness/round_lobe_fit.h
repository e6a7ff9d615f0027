#pragma once

#include <functional>
#include <vector>

#include "burnish/material/material.h"
#include "burnish/sphere/spherical_gaussian.h"

/// What xu2013asg compare one ASG with (Fig. 8): D(h) as a row of round lobes, as wang2009svbrdf
/// have it.
namespace burnish {

using HalfVectorFunction = std::function<double(const Vector3<double>& half)>;

/// Of half vectors in the local frame, even in x and in y, falling about as
/// exp(-(h.x / alpha_x)^2 - (h.y / alpha_y)^2).
struct HalfVectorDistribution {
  HalfVectorFunction value;
  double alpha_x = 0.3, alpha_y = 0.3;
};

/// D of a material, which must be specular, without GGX's tail or lobes off the normal.
HalfVectorDistribution distribution_of(const Material& material);

/// |approximation - D| / |D|, |.| over the hemisphere up to 4.5 alphas along the longer axis.
double relative_l2(const HalfVectorDistribution& distribution,
                   const HalfVectorFunction& approximation);

struct RoundLobeFit {
  /// Half-vector lobes in the local frame, in order along the longer axis; amplitudes >= 0.
  std::vector<SphericalGaussian<float>> lobes;
  double relative_l2 = 0;
};

/// Least squares over the hemisphere by `count` >= 1 SGs with axes in the plane of the normal and
/// the longer axis, in pairs about the normal: places, sharpness and amplitudes of the pairs are
/// all free. The best of eight Levenberg-Marquardt searches, the same in every run.
RoundLobeFit fit_round_lobes(const HalfVectorDistribution& distribution, int count);

}  // namespace burnish
