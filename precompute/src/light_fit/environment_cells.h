#pragma once

#include <vector>

#include <Eigen/Core>

#include "burnish/light/environment_map.h"

namespace burnish {

/// A rectangle of longitude and latitude, and the exact mean of the environment over it.
struct EnvironmentCell {
  double column0, column1, row0, row1;  ///< in pixels of the environment, fractions allowed
  double solid_angle;                   ///< sr
  Eigen::Array3d radiance;              ///< mean over the cell
  double spread;                        ///< integral of |radiance - mean|^2 over the cell
};

/// The cell between these columns and rows of an environment, in pixels.
EnvironmentCell make_cell(const Image& environment, double column0, double column1, double row0,
                          double row1);

/// The direction in the middle (by area) of a cell.
Vector3d cell_direction(const Image& environment, const EnvironmentCell& cell);

/// The integral of (radiance * direction) over a cell: a column a channel. Its product with a
/// normal is the cell's irradiance on it, exactly, where the cell lies above that normal's horizon.
Eigen::Matrix3d cell_vector_irradiance(const Image& environment, const EnvironmentCell& cell);

/// Irradiance of a cell of unit radiance, mean direction `direction` and this solid angle: its
/// cosine is spread evenly over its width where it lies across the horizon.
double cell_irradiance(const Vector3d& direction, double solid_angle, const Vector3d& normal);

/// Covers the sphere with about `rows` rows of nearly square cells, of coarse pixels whole ones or
/// equal parts, then splits the cell of the largest
/// spread until there are `count` cells (fewer where every cell is constant).
std::vector<EnvironmentCell> environment_cells(const Image& environment, int rows, size_t count);

}  // namespace burnish
