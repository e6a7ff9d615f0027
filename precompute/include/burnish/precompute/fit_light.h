#pragma once

#include "burnish/light/environment_map.h"
#include "burnish/light/light_rig.h"
#include "burnish/precompute/progress.h"

namespace burnish {

/// Dials of a light fit.
struct LightFitOptions {
  int lobes = 10;           ///< at most this many, 1..128
  double target_error = 0;  ///< relative L2 error of the radiance at which to stop, 0..1; 0: never
  bool isotropic = false;   ///< equal bandwidths: stands in for spherical Gaussians, to compare
  bool signed_colors = false;  ///< colours may be negative
  int cells = 2048;            ///< areas the map is averaged over before fitting, 256..16384
  double irradiance_weight =
      16;                       ///< of the relative irradiance error against that of the map, >= 0
  double min_bandwidth = 0.05;  ///< > 0
  double max_bandwidth = 1e5;   ///< >= min_bandwidth; the cells limit it further
};

/// How far a rig's environment lobes are from an environment.
struct LightFitError {
  double relative_l2 = 0;             ///< radiance over the sphere, at the map's own resolution
  double irradiance_relative_l2 = 0;  ///< unshadowed irradiance over all normals
};

/// What fit_light found.
struct LightFit {
  LightRig rig;  ///< lobes in the environment's frame, by falling power; none of zero colour
  LightFitError error;
  bool met_target = true;  ///< whether the radiance's error is at most `target_error`, if not 0
  int iterations = 0;      ///< Levenberg-Marquardt steps, all stages together
};

/// Fits a mixture of anisotropic spherical Gaussians to a lat-long environment (xu2013asg, Sec.
/// 5.1). The error it lowers is that of the radiance and, `irradiance_weight` times as dear, that
/// of the irradiance. A compact source that outshines the rest (the sun) gets a lobe of its own
/// with its energy. With a `target_error`, lobes are added one by one until it is met or `lobes`
/// are in use. A black map gives a rig without lobes. A map wider than 4096 pixels is averaged down
/// first: memory stays at that of the map and some hundred megabytes. Same input, same bytes, at
/// any number of threads.
///
/// Throws Error for options out of range, for an environment without pixels and for a pixel that is
/// negative or not finite; Cancelled when `progress` (stage "fit lights", in lobes) asked to stop.
LightFit fit_light(const Image& environment, const LightFitOptions& options = {},
                   const Progress& progress = {});

/// The error of any rig against an environment; both 0 for a black map and no lobes, infinite for a
/// black map and some. Same precondition on the pixels as fit_light, not checked.
LightFitError measure_light_fit(const Image& environment, const LightRig& rig);

}  // namespace burnish
