#include "harness/draped_shapes.h"

#include <algorithm>
#include <cmath>

#include "harness/surface_grid.h"

namespace burnish {
namespace {

/// The quintic step, whose curvature is continuous.
double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * x * (x * (6 * x - 15) + 10);
}

/// Of the cloth, at an angle about the axis and a distance from the middle along the cloth.
Vector3d draped(double distance, double cos_angle, double sin_angle) {
  constexpr double kTable = 0.42, kBend = 0.3, kSteepest = 1.32;
  constexpr int kNodes = 64;
  // The slope grows from 0 over the table's edge; position is its integral along the cloth.
  double radius = 0, height = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double slope = kSteepest * smooth_step((distance * (i + 0.5) / kNodes - kTable) / kBend);
    radius += std::cos(slope) * distance / kNodes;
    height -= std::sin(slope) * distance / kNodes;
  }
  const double angle = std::atan2(sin_angle, cos_angle);
  radius += smooth_step((distance - kTable) / 0.9) *
            (0.13 * std::cos(8 * angle + 0.5) + 0.05 * std::cos(13 * angle + 2));
  return {radius * cos_angle, height, -radius * sin_angle};
}

}  // namespace

void append_scaly_knot(TriangleMesh& mesh, int steps, int segments) {
  constexpr double kMinor = 0.42, kBody = 0.17;
  const Surface surface = [](double u, double v) -> Vector3d {
    const double t = 2 * kPi<double> * u;
    const double c2 = std::cos(2 * t), s2 = std::sin(2 * t);
    const double c3 = std::cos(3 * t), s3 = std::sin(3 * t);
    const double radius = 1 + kMinor * c3;
    const Vector3d normal(c3 * c2, s3, c3 * s2);
    const Vector3d along = Vector3d(-3 * kMinor * s3 * c2 - 2 * radius * s2, 3 * kMinor * c3,
                                    -3 * kMinor * s3 * s2 + 2 * radius * c2)
                               .normalized();
    // Steps are closer along the ridge, at angle 0; the angle falls, so that normals point outward.
    const double angle = -2 * kPi<double> * v + 0.55 * std::sin(2 * kPi<double> * v);
    const Vector3d outward = std::cos(angle) * normal + std::sin(angle) * along.cross(normal);
    const double body = kBody * (1 + 0.3 * std::cos(t));
    const double scales = std::cos(80 * t + 5 * angle) * std::cos(80 * t - 5 * angle);
    const double spike = std::pow(0.5 + 0.5 * std::cos(40 * t), 1.5) *
                         std::exp(2 * (std::cos(angle) - 1) / (0.33 * 0.33));
    return Vector3d(radius * c2, kMinor * s3, radius * s2) +
           body * (1 + 0.05 * scales + 0.55 * spike) * outward;
  };
  append_surface(mesh, surface, {steps, segments, true, true});
}

void append_pillow(TriangleMesh& mesh, double half_size, double height, int cells) {
  // Half of it: the sides are drawn in between the corners, and the seam puckers the cloth.
  const auto half = [&](double top, double turn) -> Surface {
    return [=](double u, double v) -> Vector3d {
      const double s = turn * (2 * u - 1), t = 2 * v - 1;
      const double bulge = (1 - s * s) * (1 - t * t);
      const double pucker = 1 + 0.07 * std::cos(9 * s) * std::cos(9 * t + 1);
      return {half_size * s * (1 - 0.13 * (1 - t * t)), top * bulge * pucker,
              -half_size * t * (1 - 0.13 * (1 - s * s))};
    };
  };
  append_surface(mesh, half(height, 1), {cells, cells});
  append_surface(mesh, half(-height / 2, -1), {cells, cells});
}

void append_card(TriangleMesh& mesh, double width, double length, double thickness, int cells_width,
                 int cells_length) {
  constexpr double kLean_rad = 0.4, kBend = 0.08;
  append_sheet(mesh,
               [&](double u, double v) -> Vector3d {
                 const double across = width * (u - 0.5), up = length * v;
                 const double lift = kBend * (4 * v * (1 - v) - 2 * (2 * u - 1) * (2 * u - 1) * v);
                 return {across, 0.06 + up * std::sin(kLean_rad) + lift * std::cos(kLean_rad),
                         -0.25 - up * std::cos(kLean_rad) + lift * std::sin(kLean_rad)};
               },
               thickness, {cells_width, cells_length});
}

void append_draped_cloth(TriangleMesh& mesh, double thickness, int cells) {
  append_sheet(mesh,
               [](double u, double v) -> Vector3d {
                 const double s = 2 * u - 1, t = 2 * v - 1, distance = std::hypot(s, t);
                 return distance > 0 ? draped(distance, s / distance, t / distance)
                                     : Vector3d::Zero();
               },
               thickness, {cells, cells});
}

}  // namespace burnish
