#include "harness/primary_hits.h"

#include <algorithm>
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

VaryingSubject varying_subject(const Transfer& transfer, MaterialMaps maps) {
  VaryingSubject varying;
  varying.maps = std::move(maps);
  const VertexTaps taps = vertex_taps(transfer);
  resize(varying.vertices, varying.maps, transfer.vertex_count());
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, transfer.vertex_count(), 256), [&](const auto& range) {
        sample_vertices(varying.maps, taps, range.begin(), range.end(), varying.vertices);
      });
  return varying;
}

SurfaceMaterial surface_material(const Subject& subject, const SurfacePoint& point,
                                 const Vector3f& eye, float sample_angle_rad) {
  if (!subject.varying) return {subject.vertex_material(point.vertices[0]), point.frame};
  const Transfer& transfer = *subject.transfer;
  const auto& [a, b, c] = point.vertices;
  TexturePlace place;
  for (int i = 0; i < 3; ++i)
    place.uv += point.weight[size_t(i)] * transfer.texcoords[point.vertices[size_t(i)]];
  const Vector3f across = (transfer.positions[b] - transfer.positions[a])
                              .cross(transfer.positions[c] - transfer.positions[a]);
  const Vector2<float> uv_b = transfer.texcoords[b] - transfer.texcoords[a];
  const Vector2<float> uv_c = transfer.texcoords[c] - transfer.texcoords[a];
  const float uv_area = std::abs(uv_b.x() * uv_c.y() - uv_b.y() * uv_c.x());
  // The area that a sample sees: as of a sphere around the eye, over the cosine of the view.
  const Vector3f to_eye = eye - point.position;
  const float cosine = std::max(std::abs(across.normalized().dot(to_eye.normalized())), 0.05f);
  const float seen = to_eye.squaredNorm() * sample_angle_rad * sample_angle_rad / cosine;
  if (across.norm() > 0) place.width = std::sqrt(seen * uv_area / across.norm());
  const TextureSigns signs = texture_signs(transfer, point.vertices, point.frame);
  place.u_sign = signs.u;
  place.v_sign = signs.v;
  return material_at(subject.materials[0], subject.varying->maps, place, point.frame);
}

SurfaceMaterial vertex_material(const Subject& subject, size_t vertex) {
  const Transfer& transfer = *subject.transfer;
  const Frame<float> frame =
      frame_from_normal_tangent(transfer.normals[vertex], transfer.tangents[vertex]);
  if (!subject.varying) return {subject.vertex_material(vertex), frame};
  return material_at(subject.materials[0], variation_of(subject.varying->vertices), vertex, frame);
}

float sample_angle_rad(const View& view) {
  const float half = view.camera.vertical_fov_deg * (kPi<float> / 360);
  return 2 * std::tan(half) / float(view.height * view.samples_per_axis);
}

Vector3f outgoing_toward(const Vector3f& eye, const Vector3f& position, const Vector3f& normal) {
  return lift_above_horizon((eye - position).normalized(), normal);
}

}  // namespace burnish
