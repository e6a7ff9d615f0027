// Based on: the inverse of marginal-conditional sampling of bilinear densities (dupuy2018adaptive,
// and their brdf-loader, whose parameterisation the files follow).
#include "measured/warp_table.h"

#include <algorithm>
#include <utility>

namespace burnish::detail {

NodeWeight weigh_nodes(const std::vector<float>& nodes, double value) {
  if (nodes.size() < 2) return {};
  const auto above = std::upper_bound(nodes.begin(), nodes.end(), value);
  const auto node = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      above - nodes.begin() - 1, 0, static_cast<std::ptrdiff_t>(nodes.size()) - 2));
  const double low = nodes[node], high = nodes[node + 1];
  return {node, std::clamp((value - low) / (high - low), 0.0, 1.0)};
}

SliceWeights weigh_slices(const NodeWeight& row, const NodeWeight& column, std::size_t columns) {
  SliceWeights slices;
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < 2; ++i) {
      const double weight = (j ? row.upper : 1 - row.upper) * (i ? column.upper : 1 - column.upper);
      if (weight == 0) continue;
      const auto k = static_cast<std::size_t>(slices.count++);
      slices.slice[k] = (row.node + j) * columns + column.node + i;
      slices.weight[k] = weight;
    }
  return slices;
}

Cell SquareTable::cell(const Vector2<double>& at) const {
  const auto place = [](double t, std::size_t nodes) {
    const double position = std::clamp(t, 0.0, 1.0) * static_cast<double>(nodes - 1);
    const std::size_t index = std::min(static_cast<std::size_t>(position), nodes - 2);
    return std::pair(index, position - static_cast<double>(index));
  };
  const auto [column, x] = place(at.x(), columns);
  const auto [row, y] = place(at.y(), rows);
  return {column, row, x, y};
}

double SquareTable::eval(const SliceWeights& slices, const Cell& cell) const {
  double sum = 0;
  for (int k = 0; k < slices.count; ++k) {
    const auto slice = slices.slice[static_cast<std::size_t>(k)];
    const float* corner = values.data() + (slice * rows + cell.row) * columns + cell.column;
    const double low = (1 - cell.x) * double(corner[0]) + cell.x * double(corner[1]);
    const double high =
        (1 - cell.x) * double(corner[columns]) + cell.x * double(corner[columns + 1]);
    sum += slices.weight[static_cast<std::size_t>(k)] * ((1 - cell.y) * low + cell.y * high);
  }
  return sum;
}

WarpTable::WarpTable(SquareTable density) : density_(std::move(density)) {
  const std::size_t rows = density_.rows, columns = density_.columns;
  const std::size_t slices = density_.values.size() / (rows * columns);
  conditional_.resize(density_.values.size());
  marginal_.resize(slices * rows);
  for (std::size_t slice = 0; slice < slices; ++slice) {
    float* const density_data = density_.values.data() + slice * rows * columns;
    float* const conditional = conditional_.data() + slice * rows * columns;
    float* const marginal = marginal_.data() + slice * rows;
    double total = 0, before = 0;
    std::vector<double> sums(rows * columns), totals(rows);
    for (std::size_t y = 0; y < rows; ++y) {
      double sum = 0;
      for (std::size_t x = 1; x < columns; ++x) {
        const float* pair = density_data + y * columns + x - 1;
        sum += 0.5 * (double(pair[0]) + double(pair[1]));
        sums[y * columns + x] = sum;
      }
      if (y > 0) total += 0.5 * (before + sum);
      totals[y] = total;
      before = sum;
    }
    const double scale = total > 0 ? 1 / total : 0;
    for (std::size_t i = 0; i < rows * columns; ++i) {
      density_data[i] = static_cast<float>(scale * double(density_data[i]));
      conditional[i] = static_cast<float>(scale * sums[i]);
    }
    for (std::size_t y = 0; y < rows; ++y) marginal[y] = static_cast<float>(scale * totals[y]);
  }
}

Vector2<double> WarpTable::invert(const SliceWeights& slices, const Vector2<double>& at) const {
  const std::size_t rows = density_.rows, columns = density_.columns;
  const Cell cell = density_.cell(at);
  double c0 = 0, c1 = 0, left = 0, r0 = 0, r1 = 0, below = 0;
  for (int k = 0; k < slices.count; ++k) {
    const auto slice = slices.slice[static_cast<std::size_t>(k)];
    const double weight = slices.weight[static_cast<std::size_t>(k)];
    const std::size_t corner = (slice * rows + cell.row) * columns + cell.column;
    const auto along_y = [&](const std::vector<float>& table, std::size_t i) {
      return (1 - cell.y) * double(table[i]) + cell.y * double(table[i + columns]);
    };
    c0 += weight * along_y(density_.values, corner);
    c1 += weight * along_y(density_.values, corner + 1);
    left += weight * along_y(conditional_, corner);
    const std::size_t row_end = (slice * rows + cell.row + 1) * columns - 1;
    r0 += weight * double(conditional_[row_end]);
    r1 += weight * double(conditional_[row_end + columns]);
    below += weight * double(marginal_[slice * rows + cell.row]);
  }
  const double row_integral = (1 - cell.y) * r0 + cell.y * r1;
  Vector2<double> sample = at;
  if (row_integral > 0)
    sample.x() = (left + cell.x * (c0 + 0.5 * cell.x * (c1 - c0))) / row_integral;
  if (below + r0 + r1 > 0) sample.y() = below + cell.y * (r0 + 0.5 * cell.y * (r1 - r0));
  return sample.cwiseMax(0.0).cwiseMin(1.0);
}

}  // namespace burnish::detail
