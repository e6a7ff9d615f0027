// Based on: newell1975, the control points as they are commonly published, by formula where they
// are regular: all rows of the pot are quarter circles of the same form.
#include "harness/teapot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "harness/mesh_building.h"

namespace burnish {
namespace {

/// Control points, z up as published: rows along the profile, columns across. Normals are along
/// columns x rows.
using Patch = std::array<std::array<Vector3d, 4>, 4>;

/// A row of the pot: the control points of a quarter circle, (radius, 0), (radius, tangent),
/// (tangent, radius), (0, radius) at a height.
struct CircleRow {
  double radius, tangent, height;
};
constexpr CircleRow circle(double radius, double height) { return {radius, 0.56 * radius, height}; }

/// From the middle of the lid to that of the bottom: the first row, then three a patch.
constexpr std::array<CircleRow, 22> kPot = {{
    {0, 0, 3.15},  // the knob
    {0.8, 0.45, 3.15},
    circle(0, 2.85),
    circle(0.2, 2.7),  //
    circle(0.4, 2.55),
    circle(1.3, 2.55),
    circle(1.3, 2.4),  // the lid
    circle(1.3 + 0.1 / 3, 2.4),
    circle(1.4 - 0.1 / 3, 2.4),
    circle(1.4, 2.4),  // ours: the ring
    circle(1.3375, 2.53125),
    circle(1.4375, 2.53125),
    circle(1.5, 2.4),  // the rim
    circle(1.75, 1.875),
    circle(2, 1.35),
    circle(2, 0.9),  // the body
    circle(2, 0.45),
    circle(1.5, 0.225),
    circle(1.5, 0.15),  //
    circle(1.5, 0.075),
    circle(1.425, 0),
    circle(0, 0),  // the bottom
}};
constexpr int kPotPatches = 7;

/// Rows of half of the handle and of the spout, in the plane y = 0 and at the distance `half_width`
/// from it: outer and inner x and z.
struct TubeRow {
  double outer_x, outer_z, inner_x, inner_z, half_width;
};
constexpr std::array<TubeRow, 7> kHandle = {{
    {-1.6, 2.025, -1.5, 2.25, 0.3},
    {-2.3, 2.025, -2.5, 2.25, 0.3},
    {-2.7, 2.025, -3, 2.25, 0.3},
    {-2.7, 1.8, -3, 1.8, 0.3},
    {-2.7, 1.575, -3, 1.35, 0.3},
    {-2.5, 1.125, -2.65, 0.9375, 0.3},
    {-2, 0.9, -1.9, 0.6, 0.3},
}};
constexpr std::array<TubeRow, 7> kSpout = {{
    {1.7, 1.425, 1.7, 0.6, 0.66},
    {2.6, 1.425, 3.1, 0.825, 0.66},
    {2.3, 2.1, 2.4, 2.025, 0.25},
    {2.7, 2.4, 3.3, 2.4, 0.25},
    {2.8, 2.475, 3.525, 2.49375, 0.25},
    {2.9, 2.475, 3.45, 2.5125, 0.15},
    {2.8, 2.4, 3.2, 2.4, 0.15},
}};

/// Bernstein's weights of i / n, bit for bit those of (n - i) / n turned round, and their
/// derivatives.
struct Weights {
  std::array<double, 4> value, slope;

  Weights(int i, int n) : Weights(double(i) / n, double(n - i) / n) {}
  Weights(double t, double s)
      : value{s * s * s, 3 * (s * s * t), 3 * (t * t * s), t * t * t},
        slope{-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t} {}
};

Vector3d combine(const Patch& patch, const std::array<double, 4>& across,
                 const std::array<double, 4>& along) {
  Vector3d sum = Vector3d::Zero();
  for (size_t row = 0; row < 4; ++row) {
    Vector3d of_row = Vector3d::Zero();
    for (size_t column = 0; column < 4; ++column) of_row += across[column] * patch[row][column];
    sum += along[row] * of_row;
  }
  return sum;
}

/// Of a patch at a place; at a pole, where columns meet, that of its surroundings.
Vector3d normal_at(const Patch& patch, const Weights& across, const Weights& along, double t) {
  const Vector3d around = combine(patch, across.slope, along.value);
  const Vector3d profile = combine(patch, across.value, along.slope);
  const Vector3d normal = around.cross(profile);
  if (normal.norm() > 1e-9) return normal.normalized();
  const double inside = t < 0.5 ? t + 1e-5 : t - 1e-5;
  const Weights near(inside, 1 - inside);
  return combine(patch, across.slope, near.value)
      .cross(combine(patch, across.value, near.slope))
      .normalized();
}

/// `flip`: the other side is outside.
void append_patch(TriangleMesh& mesh, const Patch& patch, int around, int along, bool flip) {
  const std::uint32_t first = next_vertex(mesh);
  for (int row = 0; row <= along; ++row)
    for (int i = 0; i <= around; ++i) {
      const Weights across(flip ? around - i : i, around), down(row, along);
      const Vector3d normal = normal_at(patch, across, down, double(row) / along);
      append_vertex(mesh, combine(patch, across.value, down.value), flip ? -normal : normal,
                    combine(patch, across.value, down.slope));
    }
  append_cells(mesh, first, around + 1, along + 1);
}

/// `cells.along` for a patch of length 2 (the longest), fewer for a shorter one.
int cells_along(const Patch& patch, const TeapotCells& cells, int fewest) {
  double length = 0;
  for (size_t row = 0; row < 3; ++row) length += (patch[row + 1][1] - patch[row][1]).norm();
  return std::max(static_cast<int>(std::lround(cells.along * std::min(length / 2, 1.0))), fewest);
}

void append_pot(TriangleMesh& mesh, const TeapotCells& cells) {
  for (size_t p = 0; p < kPotPatches; ++p)
    for (int quarter = 0; quarter < 4; ++quarter) {
      Patch patch;
      for (size_t row = 0; row < 4; ++row) {
        const auto& [radius, tangent, height] = kPot[3 * p + row];
        patch[row] = {Vector3d(radius, 0, height), Vector3d(radius, tangent, height),
                      Vector3d(tangent, radius, height), Vector3d(0, radius, height)};
        for (Vector3d& point : patch[row])
          for (int turn = 0; turn < quarter; ++turn)  // exact, so that seams close
            point = Vector3d(-point.y(), point.x(), point.z());
      }
      append_patch(mesh, patch, cells.around, cells_along(patch, cells, 2), true);
    }
}

/// A flat end of a tube, convex and symmetric about y = 0: a fan about its middle. `edge` runs once
/// around, counter-clockwise seen from outside.
void append_cap(TriangleMesh& mesh, std::span<const Vector3d> edge) {
  const std::uint32_t middle = next_vertex(mesh);
  Vector3d center = Vector3d::Zero();
  for (const Vector3d& point : edge) center += point / double(edge.size());
  const Vector3d normal = (edge[0] - center).cross(edge[edge.size() / 4] - center);
  append_vertex(mesh, center, normal, Vector3d::UnitY());
  for (const Vector3d& point : edge) append_vertex(mesh, point, normal, Vector3d::UnitY());
  const auto count = static_cast<std::uint32_t>(edge.size());
  for (std::uint32_t i = 0; i < count; ++i)
    mesh.triangles.push_back({middle, middle + 1 + i, middle + 1 + (i + 1) % count});
}

void append_tube(TriangleMesh& mesh, std::span<const TubeRow, 7> rows, const TeapotCells& cells) {
  std::array<Vector3d, 4> ends[2];
  for (size_t p = 0; p < 2; ++p)
    for (const double side : {-1.0, 1.0}) {
      Patch patch;
      for (size_t row = 0; row < 4; ++row) {
        const TubeRow& r = rows[3 * p + row];
        const double y = side * r.half_width;
        patch[row] = {Vector3d(r.outer_x, 0, r.outer_z), Vector3d(r.outer_x, y, r.outer_z),
                      Vector3d(r.inner_x, y, r.inner_z), Vector3d(r.inner_x, 0, r.inner_z)};
      }
      ends[p] = patch[3 * p];
      // The lip of the spout is short and turns round.
      append_patch(mesh, patch, cells.around, cells_along(patch, cells, cells.around), side > 0);
    }
  for (size_t p = 0; p < 2; ++p) {
    std::vector<Vector3d> edge;
    for (const double side : {1.0, -1.0})
      for (int i = 0; i < cells.around; ++i) {
        const int at = side > 0 ? i : cells.around - i;
        const Weights w(at, cells.around);
        Vector3d point = Vector3d::Zero();
        for (size_t column = 0; column < 4; ++column) point += w.value[column] * ends[p][column];
        edge.emplace_back(point.x(), side * point.y(), point.z());
      }
    if (p == 1) std::reverse(edge.begin(), edge.end());
    append_cap(mesh, edge);
  }
}

}  // namespace

void append_teapot(TriangleMesh& mesh, double scale, const TeapotCells& cells) {
  const std::uint32_t first = next_vertex(mesh);
  append_pot(mesh, cells);
  append_tube(mesh, kHandle, cells);
  append_tube(mesh, kSpout, cells);
  drop_unused_vertices(mesh, first);
  for (size_t v = first; v < mesh.positions.size(); ++v) {
    // (x, y, z up) to (x, z, -y), exactly.
    for (auto* vectors : {&mesh.positions, &mesh.normals, &mesh.tangents})
      (*vectors)[v] = Vector3f((*vectors)[v].x(), (*vectors)[v].z(), -(*vectors)[v].y());
    mesh.positions[v] *= static_cast<float>(scale);
  }
}

}  // namespace burnish
