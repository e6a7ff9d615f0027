#include "harness/primary_hits.h"

#include <chrono>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/shading/shade.h"

namespace burnish {

SceneRays::SceneRays(const Transfer& transfer) {
  visible_.add_mesh(transfer.positions, transfer.triangles);
  visible_.commit();
  if (transfer.occluder_triangles.empty()) return;
  shadowing_.emplace();
  shadowing_->add_mesh(transfer.positions, transfer.triangles);
  shadowing_->add_mesh(transfer.occluder_positions, transfer.occluder_triangles);
  shadowing_->commit();
}

Vector3f PrimaryHits::direction(const PrimaryRays& rays, size_t pixel, size_t sample) const {
  const auto width = static_cast<size_t>(view.width);
  const auto axis = static_cast<size_t>(view.samples_per_axis);
  const double x = double(pixel % width) + (double(sample % axis) + 0.5) / double(axis);
  const double y = double(pixel / width) + (double(sample / axis) + 0.5) / double(axis);
  return rays.direction(x, y);
}

PrimaryHits trace_primary_rays(const SceneRays& rays, const View& view) {
  const auto start = std::chrono::steady_clock::now();
  PrimaryHits result;
  result.view = view;
  const size_t per_pixel = result.samples_per_pixel();
  const size_t pixels = static_cast<size_t>(view.width) * static_cast<size_t>(view.height);
  result.hits.resize(pixels * per_pixel);
  const PrimaryRays camera = primary_rays(view.camera, view.width, view.height);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, pixels, 1024), [&](const auto& range) {
    for (size_t pixel = range.begin(); pixel < range.end(); ++pixel)
      for (size_t sample = 0; sample < per_pixel; ++sample) {
        RayHit hit{};
        if (!rays.visible().intersect(camera.origin, result.direction(camera, pixel, sample), hit))
          continue;
        result.hits[pixel * per_pixel + sample] = {hit.triangle, hit.u, hit.v};
      }
  });
  result.trace_ms =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

SurfacePoint surface_point(const Transfer& transfer, const PrimaryHit& hit, const Vector3f& eye) {
  SurfacePoint point;
  point.vertices = transfer.triangles[hit.triangle];
  point.weight = {1 - hit.u - hit.v, hit.u, hit.v};
  const auto& [a, b, c] = point.vertices;
  const Vector3f &p0 = transfer.positions[a], &p1 = transfer.positions[b],
                 &p2 = transfer.positions[c];
  point.position = point.weight[0] * p0 + point.weight[1] * p1 + point.weight[2] * p2;

  const Vector3f face =
      (p1 - p0).cast<double>().cross((p2 - p0).cast<double>()).normalized().cast<float>();
  Vector3f normal = Vector3f::Zero(), tangent = Vector3f::Zero();
  for (int i = 0; i < 3; ++i) {
    const Vector3f& t = transfer.tangents[point.vertices[i]];
    const float sign = t.dot(transfer.tangents[a]) < 0 ? -1.0f : 1.0f;
    normal += point.weight[i] * transfer.normals[point.vertices[i]];
    tangent += sign * point.weight[i] * t;
  }
  const float length = normal.norm();
  normal = length > 1e-6f ? Vector3f(normal / length) : face;  // opposite normals cancel
  point.frame = frame_from_normal_tangent(normal, tangent);
  const float side = face.dot(normal) < 0 ? -1.0f : 1.0f;
  point.front = side * face.dot((eye - point.position).normalized()) > 0;
  return point;
}

Vector3f outgoing_toward(const Vector3f& eye, const Vector3f& position, const Vector3f& normal) {
  return lift_above_horizon((eye - position).normalized(), normal);
}

}  // namespace burnish
