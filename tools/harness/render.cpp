#include "harness/render.h"

#include <chrono>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/shading/shade_varying.h"

namespace burnish {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Rgb interpolate_radiance(const std::vector<Rgb>& radiance, const SurfacePoint& point) {
  Rgb sum = Rgb::Zero();
  for (int i = 0; i < 3; ++i) sum += point.weight[i] * radiance[point.vertices[i]];
  return sum;
}

/// Shades points of the surface in batches: `add` any, in any order of materials, then `shade`.
class PixelShader {
 public:
  /// `sample_angle_rad` as surface_material takes it.
  PixelShader(const Subject& subject, std::span<const PreparedMaterial> materials,
              const Vector3f& eye, float sample_angle_rad, const Lighting& lighting,
              const ShadingOptions& options)
      : subject_(subject),
        materials_(materials),
        eye_(eye),
        sample_angle_rad_(sample_angle_rad),
        lighting_(lighting),
        options_(options),
        batches_(materials.size()) {}

  /// What the point adds to a pixel: weight times its radiance.
  void add(const SurfacePoint& surface, size_t pixel, float weight) {
    ShadingPoint point = {surface.position, surface.frame, surface.vertices, surface.weight};
    if (!subject_.varying) {
      Batch& batch = batches_[subject_.material_of(surface.vertices[0])];
      batch.points.push_back(point);
      batch.outgoing.push_back(outgoing_toward(eye_, surface.position, surface.frame.z));
      batch.pixels.push_back({pixel, weight});
      return;
    }
    const SurfaceMaterial at = surface_material(subject_, surface, eye_, sample_angle_rad_);
    point.frame = at.frame;
    const Rgb radiance =
        shade_point(*subject_.prepared, point, outgoing_toward(eye_, point.position, point.frame.z),
                    prepare_material(at.material, options_.specular), lighting_, options_);
    varied_.push_back({{pixel, weight}, radiance});
  }

  /// Adds what was added to the pixels' sums.
  void shade(std::span<Rgb> sums) {
    for (size_t id = 0; id < batches_.size(); ++id) {
      Batch& batch = batches_[id];
      radiance_.resize(batch.points.size());
      shade_points(*subject_.prepared, batch.points, batch.outgoing, materials_[id], lighting_,
                   options_, radiance_);
      for (size_t i = 0; i < radiance_.size(); ++i)
        sums[batch.pixels[i].first] += batch.pixels[i].second * radiance_[i];
      batch.points.clear();
      batch.outgoing.clear();
      batch.pixels.clear();
    }
    for (const auto& [place, radiance] : varied_) sums[place.first] += place.second * radiance;
    varied_.clear();
  }

 private:
  using PixelWeight = std::pair<size_t, float>;
  struct Batch {
    std::vector<ShadingPoint> points;
    std::vector<Vector3f> outgoing;
    std::vector<PixelWeight> pixels;
  };

  const Subject& subject_;
  std::span<const PreparedMaterial> materials_;
  Vector3f eye_;
  float sample_angle_rad_;
  const Lighting& lighting_;
  const ShadingOptions& options_;
  std::vector<Batch> batches_;  ///< by material
  std::vector<Rgb> radiance_;
  std::vector<std::pair<PixelWeight, Rgb>> varied_;
};

}  // namespace

std::vector<Rgb> shade_all_vertices(const Subject& subject, const Lighting& lighting,
                                    const Vector3f& eye, const ShadingOptions& options) {
  const std::vector<PreparedMaterial> materials = prepare_materials(subject.materials, options);
  std::vector<Rgb> radiance(subject.transfer->vertex_count());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, radiance.size(), 512), [&](const auto& range) {
    if (subject.varying)
      return shade_vertices(*subject.prepared, lighting, subject.materials[0],
                            variation_of(subject.varying->vertices), eye, options, range.begin(),
                            std::span(radiance).subspan(range.begin(), range.size()));
    shade_vertices(*subject.prepared, lighting, materials, subject.material_id, eye, options,
                   range.begin(), std::span(radiance).subspan(range.begin(), range.size()));
  });
  return radiance;
}

Picture render(const Subject& subject, const PrimaryHits& hits, const Lighting& lighting,
               const EnvironmentLight& background, ShadePer per, const ShadingOptions& options,
               RenderTimings* timings) {
  const View& view = hits.view;
  const Vector3f& eye = view.camera.origin;
  RenderTimings times;
  std::vector<Rgb> vertex_radiance;
  if (per == ShadePer::vertex) {
    const auto start = Clock::now();
    vertex_radiance = shade_all_vertices(subject, lighting, eye, options);
    times.vertices_ms = milliseconds_since(start);
  }

  const auto start = Clock::now();
  const std::vector<PreparedMaterial> materials = prepare_materials(subject.materials, options);
  const PrimaryRays camera = primary_rays(view.camera, view.width, view.height);
  const size_t per_pixel = hits.samples_per_pixel();
  Picture picture;
  picture.radiance = Image(view.width, view.height);
  picture.hit.assign(picture.radiance.pixels.size(), 0);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, picture.hit.size(), 256), [&](const auto& range) {
    PixelShader shade_pixel(subject, materials, eye, sample_angle_rad(view), lighting, options);
    const float weight = 1 / static_cast<float>(per_pixel);
    for (size_t pixel = range.begin(); pixel < range.end(); ++pixel) {
      const std::span<const PrimaryHit> samples = hits.pixel_hits(pixel);
      Rgb& sum = picture.radiance.pixels[pixel];
      size_t met = 0;
      for (size_t i = 0; i < per_pixel; ++i) {
        if (samples[i].triangle == PrimaryHit::kMiss) {
          sum += weight * eval_environment_light(background, hits.direction(camera, pixel, i));
          continue;
        }
        ++met;
        const SurfacePoint point = surface_point(*subject.transfer, samples[i], eye);
        if (!point.front) continue;
        if (per == ShadePer::vertex)
          sum += weight * interpolate_radiance(vertex_radiance, point);
        else
          shade_pixel.add(point, pixel, weight);
      }
      picture.hit[pixel] = met == per_pixel;
    }
    shade_pixel.shade(picture.radiance.pixels);
  });
  times.pixels_ms = milliseconds_since(start);
  if (timings) *timings = times;
  return picture;
}

}  // namespace burnish
