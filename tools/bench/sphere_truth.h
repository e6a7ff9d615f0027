#pragma once

/// What the sphere operators are measured against: quadrature in double.
namespace burnish::tools {

/// Fraction of an ASG of these bandwidths that lies on the visible side of a great circle at the
/// signed angle `distance` from its axis, the visible side's normal leaning toward `azimuth` from
/// the axis of bandwidth_x. Absolute error below 1e-6.
double asg_half_space_fraction(double bandwidth_x, double bandwidth_y, double distance,
                               double azimuth);

/// The same of a spherical Gaussian. Absolute error below 1e-9.
double sg_half_space_fraction(double sharpness, double distance);

}  // namespace burnish::tools
