#pragma once

#include <vector>

#include <Eigen/Core>

#include "burnish/light/environment_map.h"
#include "burnish/light/light_rig.h"

namespace burnish {

/// The integral of (|radiance| * direction) over a small area, a column a channel, and the sign of
/// each channel. The irradiance on a normal n is the sum of sign * max(n . vector, 0), exact but
/// for the areas on its horizon.
struct Flux {
  Eigen::Matrix3d vector;
  Eigen::RowVector3d sign = Eigen::RowVector3d::Ones();
};
using FluxVectors = std::vector<Flux>;

/// Flux of an environment over areas about 2 degrees wide.
FluxVectors environment_flux(const Image& environment);

/// Appends the flux of a lobe, out to five standard deviations (all but 1e-6 of it).
void append_lobe_flux(const EnvironmentLobe& light, FluxVectors& flux);

/// Irradiance on a unit normal, by channel.
Eigen::RowVector3d irradiance_of_flux(const FluxVectors& flux, const Vector3d& normal);

}  // namespace burnish
