#include "burnish/formats/polygon_triangulation.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/frame.h"

// Based on: ear clipping (meisters1975twoears). Flat corners are no ears, so that a corner in the
// middle of an edge gets its triangle from the far side, not one without area; corners at the same
// place as a corner of the ear do not block it, so that the bridge to a hole can be cut.
namespace burnish {
namespace {

using Vector2d = Vector2<double>;
using IndexTriangle = std::array<std::uint32_t, 3>;

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

class EarClipper {
 public:
  EarClipper(std::vector<Vector2d> points, double flat) : points_(std::move(points)), flat_(flat) {
    const size_t n = points_.size();
    previous_.resize(n);
    next_.resize(n);
    is_blocker_.assign(n, false);
    for (size_t i = 0; i < n; ++i) {
      previous_[i] = i == 0 ? n - 1 : i - 1;
      next_[i] = i + 1 == n ? 0 : i + 1;
    }
    for (size_t i = 0; i < n; ++i) {
      is_blocker_[i] = turn(i) <= flat_;
      if (is_blocker_[i]) blockers_.push_back(i);
    }
    is_ear_.resize(n);
    for (size_t i = 0; i < n; ++i) ears_ += is_ear_[i] = is_ear(i);
  }

  void run(std::vector<IndexTriangle>& triangles) {
    size_t current = 0;
    for (size_t left = points_.size(); left > 3; --left) {
      current = ears_ > 0 ? next_ear(current) : most_convex(current);
      const size_t before = previous_[current];
      const size_t after = next_[current];
      emit(current, triangles);
      remove(current);
      update(before);
      update(after);
      current = next_[after];  // go round, so that a convex polygon does not become a fan
    }
    emit(current, triangles);
  }

 private:
  double turn(size_t i) const {
    return cross(points_[previous_[i]], points_[i], points_[next_[i]]);
  }

  bool is_ear(size_t i) {
    if (turn(i) <= flat_) return false;
    const Vector2d& a = points_[previous_[i]];
    const Vector2d& b = points_[i];
    const Vector2d& c = points_[next_[i]];
    for (size_t k = 0; k < blockers_.size();) {
      const size_t j = blockers_[k];
      if (!is_blocker_[j]) {  // clipped, or convex by now
        blockers_[k] = blockers_.back();
        blockers_.pop_back();
        continue;
      }
      ++k;
      const Vector2d& p = points_[j];
      if (p == a || p == b || p == c) continue;
      if (cross(a, b, p) >= -flat_ && cross(b, c, p) >= -flat_ && cross(c, a, p) >= -flat_)
        return false;
    }
    return true;
  }

  size_t next_ear(size_t i) const {
    while (!is_ear_[i]) i = next_[i];
    return i;
  }

  // Of a polygon that crosses itself, or is flat.
  size_t most_convex(size_t start) const {
    size_t best = start;
    for (size_t i = next_[start]; i != start; i = next_[i])
      if (turn(i) > turn(best)) best = i;
    return best;
  }

  void emit(size_t i, std::vector<IndexTriangle>& triangles) const {
    triangles.push_back({static_cast<std::uint32_t>(previous_[i]), static_cast<std::uint32_t>(i),
                         static_cast<std::uint32_t>(next_[i])});
  }

  void remove(size_t i) {
    next_[previous_[i]] = next_[i];
    previous_[next_[i]] = previous_[i];
    is_blocker_[i] = false;
    ears_ -= is_ear_[i];
    is_ear_[i] = false;
  }

  // A corner only loses angle when a neighbour is clipped, so blockers only ever become fewer, but
  // for polygons that cross themselves.
  void update(size_t i) {
    const bool blocks = turn(i) <= flat_;
    if (blocks && !is_blocker_[i]) blockers_.push_back(i);
    is_blocker_[i] = blocks;
    ears_ -= is_ear_[i];
    ears_ += is_ear_[i] = is_ear(i);
  }

  std::vector<Vector2d> points_;
  double flat_;  ///< twice the area below which a corner counts as straight
  std::vector<size_t> previous_;
  std::vector<size_t> next_;
  std::vector<size_t> blockers_;  ///< corners that are not convex; some are out of date
  std::vector<char> is_blocker_;
  std::vector<char> is_ear_;
  int ears_ = 0;
};

/// Twice the polygon's area, along its mean normal (Newell).
Vector3d area_vector(std::span<const Vector3f> corners) {
  const Vector3d origin = corners[0].cast<double>();
  Vector3d area = Vector3d::Zero();
  for (size_t i = 1; i + 1 < corners.size(); ++i)
    area += (corners[i].cast<double>() - origin).cross(corners[i + 1].cast<double>() - origin);
  return area;
}

// The shorter of the diagonals that lie inside. Faster than ears, and most polygons have four
// corners.
void triangulate_quad(std::span<const Vector3f> corners, const Vector3d& area,
                      std::vector<IndexTriangle>& triangles) {
  const auto at = [&](size_t i) -> Vector3d { return corners[i].cast<double>(); };
  const auto least_area = [&](size_t a, size_t b, size_t c, size_t d) {
    const Vector3d diagonal = at(c) - at(a);
    return std::min((at(b) - at(a)).cross(diagonal).dot(area),
                    diagonal.cross(at(d) - at(a)).dot(area));
  };
  const double from_first = least_area(0, 1, 2, 3);
  const double from_second = least_area(1, 2, 3, 0);
  const bool both_inside = from_first > 0 && from_second > 0;
  const bool use_first =
      both_inside ? (at(2) - at(0)).norm() <= (at(3) - at(1)).norm() : from_first >= from_second;
  if (use_first)
    triangles.insert(triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  else
    triangles.insert(triangles.end(), {{1, 2, 3}, {1, 3, 0}});
}

}  // namespace

void triangulate_polygon(std::span<const Vector3f> corners, std::vector<IndexTriangle>& triangles) {
  triangles.clear();
  if (corners.size() < 3) return;
  if (corners.size() == 3) {
    triangles.push_back({0, 1, 2});
    return;
  }
  const Vector3d area = area_vector(corners);
  if (corners.size() == 4) return triangulate_quad(corners, area, triangles);

  const double length = area.norm();
  const Vector3d normal = length > 0 ? Vector3d(area / length) : Vector3d::UnitZ();
  const Frame<double> plane = frame_from_axis(normal);
  std::vector<Vector2d> points;
  points.reserve(corners.size());
  double extent = 0;
  for (const Vector3f& corner : corners) {
    const Vector3d local = plane.to_local((corner - corners[0]).cast<double>());
    points.emplace_back(local.x(), local.y());
    extent = std::max(extent, points.back().norm());
  }
  // 1e-12: the rounding of cross() is 1e-16 extent^2 a term; what floats can express is 1e-7.
  EarClipper(std::move(points), 1e-12 * extent * extent).run(triangles);
}

}  // namespace burnish
