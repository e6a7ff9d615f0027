#include "light_fit/environment_cells.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace burnish {
namespace {

double latitude(const Image& environment, double row) {
  return (0.5 - row / environment.height) * kPi<double>;
}

double longitude(const Image& environment, double column) {
  return (0.5 - column / environment.width) * 2 * kPi<double>;
}

// Calls visit(pixel, column0, column1, row0, row1) for the part of each pixel inside a rectangle.
template <class Visit>
void for_each_part(const Image& environment, const EnvironmentCell& cell, Visit&& visit) {
  const int first_row = static_cast<int>(std::floor(cell.row0));
  const int first_column = static_cast<int>(std::floor(cell.column0));
  for (int y = first_row; y < environment.height && y < cell.row1; ++y) {
    const double row0 = std::max<double>(y, cell.row0), row1 = std::min<double>(y + 1, cell.row1);
    for (int x = first_column; x < environment.width && x < cell.column1; ++x)
      visit(environment.at(x, y), std::max<double>(x, cell.column0),
            std::min<double>(x + 1, cell.column1), row0, row1);
  }
}

// The pixel boundary nearest to the middle of [begin, end], or -1 if none lies inside.
double split_position(double begin, double end) {
  const double middle = std::round((begin + end) / 2);
  if (middle > begin && middle < end) return middle;
  const double inner = std::floor(begin) + 1;
  return inner < end ? inner : -1;
}

// Splits a cell across its longer side, along pixel boundaries. False if it lies in one pixel.
bool split_cell(const Image& environment, const EnvironmentCell& cell, EnvironmentCell& first,
                EnvironmentCell& second) {
  const double middle = latitude(environment, (cell.row0 + cell.row1) / 2);
  const double wide =
      (cell.column1 - cell.column0) * 2 * kPi<double> / environment.width * std::cos(middle);
  const double high = (cell.row1 - cell.row0) * kPi<double> / environment.height;
  const double column = split_position(cell.column0, cell.column1);
  const double row = split_position(cell.row0, cell.row1);
  if (column < 0 && row < 0) return false;
  if (row < 0 || (column >= 0 && wide >= high)) {
    first = make_cell(environment, cell.column0, column, cell.row0, cell.row1);
    second = make_cell(environment, column, cell.column1, cell.row0, cell.row1);
  } else {
    first = make_cell(environment, cell.column0, cell.column1, cell.row0, row);
    second = make_cell(environment, cell.column0, cell.column1, row, cell.row1);
  }
  return true;
}

// About `count` equal parts of `pixels` in line. Coarse pixels are not cut into unequal parts:
// cells split further would be slivers of them, so small that they bound no lobe's width.
std::vector<double> edges(int pixels, int count) {
  std::vector<double> result;
  if (pixels >= 2 * count) {
    for (int i = 0; i <= count; ++i) result.push_back(double(pixels) * i / count);
  } else if (pixels >= count) {
    for (int i = 0; i <= count; ++i) result.push_back(std::round(double(pixels) * i / count));
  } else {
    const int parts = (count + pixels - 1) / pixels;  // of each pixel
    for (int i = 0; i <= pixels * parts; ++i) result.push_back(double(i) / parts);
  }
  return result;
}

}  // namespace

EnvironmentCell make_cell(const Image& environment, double column0, double column1, double row0,
                          double row1) {
  EnvironmentCell cell{column0, column1, row0, row1, 0, Eigen::Array3d::Zero(), 0};
  double row_begin = -1, sine_step = 0, square = 0;
  const double column_angle = 2 * kPi<double> / environment.width;
  for_each_part(
      environment, cell, [&](const Rgb& pixel, double c0, double c1, double r0, double r1) {
        if (r0 != row_begin) {
          row_begin = r0;
          sine_step = std::sin(latitude(environment, r0)) - std::sin(latitude(environment, r1));
        }
        const double weight = (c1 - c0) * column_angle * sine_step;
        const Eigen::Array3d value = pixel.cast<double>();
        cell.solid_angle += weight;
        cell.radiance += weight * value;
        square += weight * value.square().sum();
      });
  cell.radiance /= cell.solid_angle;
  cell.spread = std::max(square - cell.solid_angle * cell.radiance.square().sum(), 0.0);
  return cell;
}

Vector3d cell_direction(const Image& environment, const EnvironmentCell& cell) {
  const double sine =
      (std::sin(latitude(environment, cell.row0)) + std::sin(latitude(environment, cell.row1))) / 2;
  const double angle = longitude(environment, (cell.column0 + cell.column1) / 2);
  const double horizontal = std::sqrt(std::max(1 - sine * sine, 0.0));
  return {horizontal * std::sin(angle), sine, horizontal * std::cos(angle)};
}

Eigen::Matrix3d cell_vector_irradiance(const Image& environment, const EnvironmentCell& cell) {
  // With latitude a and longitude b: v = (cos a sin b, sin a, cos a cos b), dv = cos a da db.
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for_each_part(
      environment, cell, [&](const Rgb& pixel, double c0, double c1, double r0, double r1) {
        const double top = latitude(environment, r0), bottom = latitude(environment, r1);
        const double left = longitude(environment, c0), right = longitude(environment, c1);
        const double cos_square =
            (top - bottom) / 2 + (std::sin(2 * top) - std::sin(2 * bottom)) / 4;
        const double sin_cos =
            (std::sin(top) + std::sin(bottom)) * (std::sin(top) - std::sin(bottom)) / 2;
        const Vector3d direction(cos_square * (std::cos(right) - std::cos(left)),
                                 sin_cos * (left - right),
                                 cos_square * (std::sin(left) - std::sin(right)));
        sum += direction * pixel.cast<double>().matrix().transpose();
      });
  return sum;
}

double cell_irradiance(const Vector3d& direction, double solid_angle, const Vector3d& normal) {
  const double cosine = normal.dot(direction);
  const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
  const double reach = std::sqrt(solid_angle) / 2 * sine;  // of the cosine, to either side
  if (cosine >= reach) return solid_angle * cosine;
  if (cosine <= -reach) return 0;
  return solid_angle * (cosine + reach) * (cosine + reach) / (4 * reach);
}

std::vector<EnvironmentCell> environment_cells(const Image& environment, int rows, size_t count) {
  std::vector<EnvironmentCell> cells;
  const std::vector<double> row = edges(environment.height, rows);
  for (size_t i = 0; i + 1 < row.size(); ++i) {
    const double cosine = std::cos(latitude(environment, (row[i] + row[i + 1]) / 2));
    const int columns = std::max(3, static_cast<int>(std::lround(2 * rows * cosine)));
    const std::vector<double> column = edges(environment.width, columns);
    for (size_t j = 0; j + 1 < column.size(); ++j)
      cells.push_back(make_cell(environment, column[j], column[j + 1], row[i], row[i + 1]));
  }
  const auto less = [&](size_t a, size_t b) {
    return cells[a].spread != cells[b].spread ? cells[a].spread < cells[b].spread : a > b;
  };
  std::priority_queue<size_t, std::vector<size_t>, decltype(less)> queue(less);
  for (size_t i = 0; i < cells.size(); ++i)
    if (cells[i].spread > 0) queue.push(i);
  while (cells.size() < count && !queue.empty()) {
    const size_t i = queue.top();
    queue.pop();
    EnvironmentCell first, second;
    if (!split_cell(environment, cells[i], first, second)) continue;
    cells[i] = first;
    cells.push_back(second);
    if (first.spread > 0) queue.push(i);
    if (second.spread > 0) queue.push(cells.size() - 1);
  }
  return cells;
}

}  // namespace burnish
