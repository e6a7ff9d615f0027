#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "burnish/sphere/direction.h"

/// Tables over the unit square, one for each value of up to two parameters, as RGL's BRDF files
/// have them (dupuy2018adaptive).
namespace burnish::detail {

/// A place between the nodes of the parameters: up to four slices with their weights.
struct SliceWeights {
  std::array<std::size_t, 4> slice = {};
  std::array<double, 4> weight = {};
  int count = 0;
};

/// Where `value` lies among rising `nodes`: clamped to their range; a single node takes all.
struct NodeWeight {
  std::size_t node = 0;  ///< of the lower one
  double upper = 0;      ///< weight of the next one
};
NodeWeight weigh_nodes(const std::vector<float>& nodes, double value);

/// Of the slices [rows x columns] of nodes (a row, a column).
SliceWeights weigh_slices(const NodeWeight& row, const NodeWeight& column, std::size_t columns);

/// A place in a table's grid.
struct Cell {
  std::size_t column = 0, row = 0;
  double x = 0, y = 0;  ///< within the cell, 0..1
};

/// Bilinear between rows x columns nodes over [0, 1]^2; (0, 0) is the first node.
struct SquareTable {
  std::size_t rows = 0, columns = 0;  ///< >= 2
  std::vector<float> values;          ///< [slices x rows x columns]

  Cell cell(const Vector2<double>& at) const;
  double eval(const SliceWeights& slices, const Cell& cell) const;
};

/// A density over the square, bilinear between nodes, as a map of the square onto itself that makes
/// uniform samples from samples of the density: along y by the marginal, then along x.
class WarpTable {
 public:
  WarpTable() = default;
  /// Values >= 0. Each slice is normalised; one of zeros maps each place to itself.
  explicit WarpTable(SquareTable density);
  /// The uniform sample that the density's sampling takes to `at`.
  Vector2<double> invert(const SliceWeights& slices, const Vector2<double>& at) const;

 private:
  SquareTable density_;
  std::vector<float> conditional_;  ///< integral along the row up to a node
  std::vector<float> marginal_;     ///< integral over the rows up to one
};

}  // namespace burnish::detail
