#include "burnish/formats/mesh_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace burnish {
namespace {

/// Twice the area vector of a triangle.
Vector3d area_vector(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return (b - a).cross(c - a);
}

double angle_at(const Vector3d& corner, const Vector3d& b, const Vector3d& c) {
  return angle_between<double>(b - corner, c - corner);
}

std::array<Vector3d, 3> corners_of(std::span<const Vector3f> positions, const Triangle& triangle) {
  return {positions[triangle[0]].cast<double>(), positions[triangle[1]].cast<double>(),
          positions[triangle[2]].cast<double>()};
}

/// A vertex's sum while its triangles are gone through.
struct NormalSum {
  Vector3d sum = Vector3d::Zero();
  double weight = 0;  ///< of all parts, had none cancelled
  double largest = 0;
  Vector3d largest_normal = Vector3d::Zero();
};

bool finish_normal(const NormalSum& sum, Vector3f& normal) {
  if (sum.weight <= 0) return false;
  // 1e-6: what remains of a sum of floats' directions that cancel is of the order of 1e-7.
  const bool cancels = sum.sum.norm() <= 1e-6 * sum.weight;
  normal = (cancels ? sum.largest_normal : sum.sum).normalized().cast<float>();
  return true;
}

/// Direction on the triangle in which u grows while v stays; false where the UVs do not say.
bool uv_direction(const std::array<Vector3d, 3>& p, const std::array<Vector2<double>, 3>& uv,
                  Vector3d& direction) {
  const Vector2<double> d1 = uv[1] - uv[0];
  const Vector2<double> d2 = uv[2] - uv[0];
  const double determinant = d1.x() * d2.y() - d1.y() * d2.x();
  // 1e-7: below, the UVs lie on a line as far as floats can tell. NaN fails the comparison.
  if (!(std::abs(determinant) > 1e-7 * d1.norm() * d2.norm())) return false;
  direction = ((p[1] - p[0]) * d2.y() - (p[2] - p[0]) * d1.y()) / determinant;
  const double length = direction.norm();
  if (!(length > 0) || !std::isfinite(length)) return false;
  direction /= length;
  return true;
}

}  // namespace

Vector3f up_direction(UpAxis axis) {
  return axis == UpAxis::x   ? Vector3f::UnitX()
         : axis == UpAxis::y ? Vector3f::UnitY()
                             : Vector3f::UnitZ();
}

bool is_degenerate(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  const Vector3d p = a.cast<double>(), q = b.cast<double>(), r = c.cast<double>();
  const double longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
  // Differences of floats are exact or nearly so in double: their cross product rounds by a few
  // 1e-16 of the edges' product. NaN fails the comparison.
  return !(area_vector(p, q, r).norm() > 1e-15 * longest * longest) || !std::isfinite(longest);
}

std::vector<Vector3f> compute_normals(std::span<const Vector3f> positions,
                                      std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> shared,
                                      const Vector3f& fallback, std::uint64_t* fallbacks) {
  const auto group = [&](std::uint32_t v) { return shared.empty() ? v : shared[v]; };
  const size_t groups = shared.empty()
                            ? positions.size()
                            : size_t{*std::max_element(shared.begin(), shared.end())} + 1;
  std::vector<NormalSum> sums(groups);
  for (const Triangle& triangle : triangles) {
    if (is_degenerate(positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]))
      continue;
    const auto p = corners_of(positions, triangle);
    const Vector3d area = area_vector(p[0], p[1], p[2]);
    const double size = area.norm();
    for (size_t k = 0; k < 3; ++k) {
      NormalSum& sum = sums[group(triangle[k])];
      const double angle = angle_at(p[k], p[(k + 1) % 3], p[(k + 2) % 3]);
      sum.sum += angle * area;
      sum.weight += angle * size;
      if (size > sum.largest) {
        sum.largest = size;
        sum.largest_normal = area;
      }
    }
  }
  std::vector<Vector3f> normals(positions.size());
  std::uint64_t without = 0;
  for (size_t v = 0; v < normals.size(); ++v) {
    if (finish_normal(sums[group(static_cast<std::uint32_t>(v))], normals[v])) continue;
    normals[v] = fallback;
    ++without;
  }
  if (fallbacks != nullptr) *fallbacks = without;
  return normals;
}

// For r orthogonal to up u, the rotation that takes u to n along their great circle takes r to
// r - (r.n) / (1 + u.n) (u + n).
Vector3f tangent_from_up(const Vector3f& normal, UpAxis up) {
  const Vector3d u = up_direction(up).cast<double>();
  const Vector3d reference = up == UpAxis::x ? Vector3d::UnitY() : Vector3d::UnitX();
  const Vector3d n = normal.cast<double>().normalized();
  const double cosine = 1 + u.dot(n);
  // 1e-12: 1 + u.n = angle^2 / 2 near -up, so this is 1.4e-6 rad, ten times a float's rounding.
  if (!(cosine > 1e-12)) return reference.cast<float>();
  Vector3d tangent = reference - reference.dot(n) / cosine * (u + n);
  tangent -= tangent.dot(n) * n;  // near -up the quotient is of small numbers
  return tangent.normalized().cast<float>();
}

std::vector<Vector3f> compute_tangents(std::span<const Vector3f> positions,
                                       std::span<const Vector3f> normals,
                                       std::span<const Eigen::Vector2f> uvs,
                                       std::span<const Triangle> triangles, UpAxis up,
                                       std::uint64_t* fallbacks) {
  std::vector<Vector3d> sums(positions.size(), Vector3d::Zero());
  for (const Triangle& triangle : triangles) {
    if (uvs.empty() ||
        is_degenerate(positions[triangle[0]], positions[triangle[1]], positions[triangle[2]]))
      continue;
    const auto p = corners_of(positions, triangle);
    Vector3d direction;
    if (!uv_direction(p,
                      {uvs[triangle[0]].cast<double>(), uvs[triangle[1]].cast<double>(),
                       uvs[triangle[2]].cast<double>()},
                      direction))
      continue;
    for (size_t k = 0; k < 3; ++k) {
      const Vector3d normal = normals[triangle[k]].cast<double>();
      Vector3d tangent = direction - direction.dot(normal) * normal;
      const double length = tangent.norm();
      // 1e-3: u grows along the normal; what is left has no direction to speak of.
      if (length < 1e-3) continue;
      tangent *= angle_at(p[k], p[(k + 1) % 3], p[(k + 2) % 3]) / length;
      Vector3d& sum = sums[triangle[k]];
      sum += sum.dot(tangent) < 0 ? Vector3d(-tangent) : tangent;
    }
  }
  std::vector<Vector3f> tangents(positions.size());
  std::uint64_t without = 0;
  for (size_t v = 0; v < tangents.size(); ++v) {
    const Vector3d normal = normals[v].cast<double>();
    const Vector3d tangent = sums[v] - sums[v].dot(normal) * normal;
    if (tangent.norm() > 0) {
      tangents[v] = tangent.normalized().cast<float>();
    } else {
      tangents[v] = tangent_from_up(normals[v], up);
      ++without;
    }
  }
  if (fallbacks != nullptr) *fallbacks = without;
  return tangents;
}

}  // namespace burnish
