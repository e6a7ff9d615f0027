#include "harness/shapes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/mesh_building.h"

namespace burnish {

void append_revolution(TriangleMesh& mesh, std::span<const ProfilePoint> profile, int segments) {
  const std::uint32_t first = next_vertex(mesh);
  for (const ProfilePoint& point : profile) {
    const bool pole = point.radius == 0;
    for (int segment = 0; segment < segments; ++segment) {
      const double angle = 2 * kPi<double> * (segment + (pole ? 0.5 : 0.0)) / segments;
      const Vector3d radial(std::sin(angle), 0, std::cos(angle));
      append_vertex(mesh, point.radius * radial + point.height * Vector3d::UnitY(),
                    point.normal_radius * radial + point.normal_height * Vector3d::UnitY(),
                    -point.normal_height * radial + point.normal_radius * Vector3d::UnitY());
    }
  }
  for (size_t ring = 0; ring + 1 < profile.size(); ++ring) {
    const auto a = first + static_cast<std::uint32_t>(ring * static_cast<size_t>(segments));
    for (int segment = 0; segment < segments; ++segment) {
      const auto here = static_cast<std::uint32_t>(segment);
      const auto next = static_cast<std::uint32_t>((segment + 1) % segments);
      const auto n = static_cast<std::uint32_t>(segments);
      if (profile[ring].radius == 0)
        mesh.triangles.push_back({a + here, a + n + next, a + n + here});
      else if (profile[ring + 1].radius == 0)
        mesh.triangles.push_back({a + here, a + next, a + n + here});
      else
        append_cell(mesh, a + here, a + next, a + n + here, a + n + next);
    }
  }
}

void append_rectangle(TriangleMesh& mesh, const Vector3f& corner, const Vector3f& edge_u,
                      const Vector3f& edge_v, int cells_u, int cells_v) {
  const std::uint32_t first = next_vertex(mesh);
  const Vector3d u = edge_u.cast<double>(), v = edge_v.cast<double>();
  for (int row = 0; row <= cells_v; ++row)
    for (int column = 0; column <= cells_u; ++column)
      append_vertex(
          mesh, corner.cast<double>() + u * column / double(cells_u) + v * row / double(cells_v),
          u.cross(v), u.normalized());
  append_cells(mesh, first, cells_u + 1, cells_v + 1, false, false);
}

void append_floor(TriangleMesh& mesh, double half_size, int cells, double center_scale) {
  const std::uint32_t first = next_vertex(mesh);
  const auto coordinate = [=](int i) {
    const double t = 2.0 * i / cells - 1;
    return half_size * t * (center_scale + (1 - center_scale) * t * t * t * t);
  };
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= cells; ++column)  // z falls with the row: x cross -z = +y
      append_vertex(mesh, {coordinate(column), 0, -coordinate(row)}, Vector3d::UnitY(),
                    Vector3d::UnitX());
  append_cells(mesh, first, cells + 1, cells + 1, false, false);
}

void append_sphere(TriangleMesh& mesh, const Vector3f& center, double radius, int segments,
                   int rings) {
  std::vector<ProfilePoint> profile;
  for (int ring = 0; ring <= rings; ++ring) {
    const double angle = kPi<double> * ring / rings;
    const double s = ring == 0 || ring == rings ? 0 : std::sin(angle), c = -std::cos(angle);
    profile.push_back({radius * s, radius * c, s, c});
  }
  const size_t first = mesh.positions.size();
  append_revolution(mesh, profile, segments);
  for (size_t i = first; i < mesh.positions.size(); ++i) mesh.positions[i] += center;
}

void append_cylinder(TriangleMesh& mesh, double radius, double height, double bevel,
                     const CylinderRings& rings, int segments) {
  std::vector<ProfilePoint> profile;
  const double inner = radius - bevel;
  const auto append_disc = [&](double y, double normal, bool outward) {
    for (int ring = 0; ring < rings.disc; ++ring) {
      const int from_middle = outward ? ring : rings.disc - 1 - ring;
      profile.push_back({inner * from_middle / rings.disc, y, 0, normal});
    }
  };
  const auto append_bevel = [&](double y, double from_angle) {
    for (int ring = 0; ring <= rings.bevel; ++ring) {
      const double angle = from_angle + kPi<double> / 2 * ring / rings.bevel;
      profile.push_back({inner + bevel * std::cos(angle), y + bevel * std::sin(angle),
                         std::cos(angle), std::sin(angle)});
    }
  };
  append_disc(0, -1, true);
  append_bevel(bevel, -kPi<double> / 2);
  for (int ring = 1; ring < rings.side; ++ring)
    profile.push_back({radius, bevel + (height - 2 * bevel) * ring / rings.side, 1, 0});
  append_bevel(height - bevel, 0);
  append_disc(height, 1, false);
  append_revolution(mesh, profile, segments);
}

void append_torus_knot(TriangleMesh& mesh, const Vector3f& center, double major_radius,
                       double minor_radius, double tube_radius, int steps, int segments) {
  const std::uint32_t first = next_vertex(mesh);
  for (int step = 0; step < steps; ++step) {
    const double t = 2 * kPi<double> * step / steps;
    const double c2 = std::cos(2 * t), s2 = std::sin(2 * t);
    const double c3 = std::cos(3 * t), s3 = std::sin(3 * t);
    const double radius = major_radius + minor_radius * c3;
    // The torus's own normal is orthogonal to a curve on it, and comes back to itself.
    const Vector3d normal(c3 * c2, s3, c3 * s2);
    const Vector3d along =
        Vector3d(-3 * minor_radius * s3 * c2 - 2 * radius * s2, 3 * minor_radius * c3,
                 -3 * minor_radius * s3 * s2 + 2 * radius * c2)
            .normalized();
    const Vector3d across = along.cross(normal);
    const Vector3d on_curve =
        center.cast<double>() + Vector3d(radius * c2, minor_radius * s3, radius * s2);
    for (int segment = 0; segment < segments; ++segment) {
      const double angle = 2 * kPi<double> * segment / segments;
      const Vector3d outward = std::cos(angle) * normal + std::sin(angle) * across;
      append_vertex(mesh, on_curve + tube_radius * outward, outward, along);
    }
  }
  append_cells(mesh, first, segments, steps, true, true);
}

void append_dish(TriangleMesh& mesh, double base, double thickness, int segments) {
  constexpr double kRise = 0.2, kBowl = 0.45, kBrim = 0.9, kOuter = 1.0;
  constexpr int kUnderRings = 26, kRimRings = 10, kInnerRings = 56;
  const double half = thickness / 2;
  // Both faces are offsets of one middle curve, so that their normals are exact. It rises by the
  // quintic smooth step, whose curvature is continuous: no line shows in a highlight.
  const auto face_point = [&](double radius, double side) -> ProfilePoint {
    const double x = std::clamp((radius - kBowl) / (kBrim - kBowl), 0.0, 1.0);
    const double height = kRise * x * x * x * (x * (6 * x - 15) + 10);
    const double slope = kRise * 30 * x * x * (x - 1) * (x - 1) / (kBrim - kBowl);
    const double scale = side / std::sqrt(1 + slope * slope);
    return {radius - half * slope * scale, base + half + height + half * scale, -slope * scale,
            scale};
  };
  const double rim_radius = kOuter - half;
  std::vector<ProfilePoint> profile;
  for (int ring = 0; ring < kUnderRings; ++ring)
    profile.push_back(face_point(rim_radius * ring / kUnderRings, -1));
  for (int ring = 0; ring < kRimRings; ++ring) {
    const double angle = kPi<double> * (double(ring) / kRimRings - 0.5);
    const double c = ring == 0 ? 0 : std::cos(angle), s = std::sin(angle);
    profile.push_back({rim_radius + half * c, base + half + kRise + half * s, c, s});
  }
  for (int ring = kInnerRings; ring >= 0; --ring)
    profile.push_back(face_point(rim_radius * ring / kInnerRings, 1));
  append_revolution(mesh, profile, segments);
}

}  // namespace burnish
