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

/// The weighted mean of three vertices' coefficients; `of(vertex)` points to a vertex's.
template <class Coefficients>
void interpolate(const SurfacePoint& surface, const Coefficients& of, std::vector<float>& result) {
  const float* a = of(surface.vertices[0]);
  const float* b = of(surface.vertices[1]);
  const float* c = of(surface.vertices[2]);
  for (size_t i = 0; i < result.size(); ++i)
    result[i] = surface.weight[0] * a[i] + surface.weight[1] * b[i] + surface.weight[2] * c[i];
}

/// Shades interpolated points; holds the interpolated coefficients between calls.
class PixelShader {
 public:
  /// `sample_angle_rad` as surface_material takes it.
  PixelShader(const Subject& subject, std::span<const PreparedMaterial> materials,
              const Vector3f& eye, float sample_angle_rad, const Lighting& lighting,
              const ShadingOptions& options)
      : subject_(subject),
        transfer_(*subject.transfer),
        materials_(materials),
        eye_(eye),
        sample_angle_rad_(sample_angle_rad),
        lighting_(lighting),
        options_(options),
        coefficients_(static_cast<size_t>(transfer_.terms())),
        ladder_coefficients_(static_cast<size_t>(transfer_.ladder_terms())) {}

  Rgb operator()(const SurfacePoint& surface) {
    if (!subject_.varying)
      return shade(surface, materials_[subject_.material_of(surface.vertices[0])]);
    const SurfaceMaterial at = surface_material(subject_, surface, eye_, sample_angle_rad_);
    SurfacePoint turned = surface;
    turned.frame = at.frame;
    return shade(turned, prepare_material(at.material, options_.specular));
  }

 private:
  Rgb shade(const SurfacePoint& surface, const PreparedMaterial& material) {
    const Vector3f outgoing = outgoing_toward(eye_, surface.position, surface.frame.z);
    const auto& [a, b, c] = surface.vertices;
    if (transfer_.bases.empty() || (transfer_.basis_id[a] == transfer_.basis_id[b] &&
                                    transfer_.basis_id[a] == transfer_.basis_id[c]))
      return shade_point(interpolated_point(surface), outgoing, material, lighting_, options_);
    // Coefficients of different bases cannot be mixed; the radiance they give can.
    Rgb sum = Rgb::Zero();
    for (int i = 0; i < 3; ++i)
      sum += surface.weight[i] * shade_point(point_like_vertex(surface, surface.vertices[i]),
                                             outgoing, material, lighting_, options_);
    return sum;
  }

  /// The surface point with the visibility of a vertex.
  ShadingPoint point_like_vertex(const SurfacePoint& surface, std::uint32_t vertex) const {
    ShadingPoint point = vertex_shading_point(transfer_, vertex);
    point.position = surface.position;
    point.frame = surface.frame;
    return point;
  }

  /// The surface point with interpolated coefficients, all three corners being of one basis.
  ShadingPoint interpolated_point(const SurfacePoint& surface) {
    ShadingPoint point = point_like_vertex(surface, surface.vertices[0]);
    if (point.basis) {
      const auto of = [&](std::uint32_t v) { return transfer_.vertex_coefficients(v); };
      interpolate(surface, of, coefficients_);
      point.coefficients = coefficients_.data();
    }
    if (point.ladder) {
      const auto of = [&](std::uint32_t v) { return transfer_.vertex_ladder_coefficients(v); };
      interpolate(surface, of, ladder_coefficients_);
      point.ladder_coefficients = ladder_coefficients_.data();
    }
    return point;
  }

  const Subject& subject_;
  const Transfer& transfer_;
  std::span<const PreparedMaterial> materials_;
  Vector3f eye_;
  float sample_angle_rad_;
  const Lighting& lighting_;
  const ShadingOptions& options_;
  std::vector<float> coefficients_, ladder_coefficients_;
};

}  // namespace

std::vector<Rgb> shade_all_vertices(const Subject& subject, const Lighting& lighting,
                                    const Vector3f& eye, const ShadingOptions& options) {
  const std::vector<PreparedMaterial> materials = prepare_materials(subject.materials, options);
  std::vector<Rgb> radiance(subject.transfer->vertex_count());
  tbb::parallel_for(tbb::blocked_range<size_t>(0, radiance.size(), 64), [&](const auto& range) {
    if (subject.varying)
      return shade_vertices(*subject.transfer, lighting, subject.materials[0],
                            variation_of(subject.varying->vertices), eye, options, range.begin(),
                            std::span(radiance).subspan(range.begin(), range.size()));
    shade_vertices(*subject.transfer, lighting, materials, subject.material_id, eye, options,
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
    for (size_t pixel = range.begin(); pixel < range.end(); ++pixel) {
      const std::span<const PrimaryHit> samples = hits.pixel_hits(pixel);
      Rgb sum = Rgb::Zero();
      size_t met = 0;
      for (size_t i = 0; i < per_pixel; ++i) {
        if (samples[i].triangle == PrimaryHit::kMiss) {
          sum += eval_environment_light(background, hits.direction(camera, pixel, i));
          continue;
        }
        ++met;
        const SurfacePoint point = surface_point(*subject.transfer, samples[i], eye);
        if (!point.front) continue;
        sum += per == ShadePer::vertex ? interpolate_radiance(vertex_radiance, point)
                                       : shade_pixel(point);
      }
      picture.radiance.pixels[pixel] = sum / float(per_pixel);
      picture.hit[pixel] = met == per_pixel;
    }
  });
  times.pixels_ms = milliseconds_since(start);
  if (timings) *timings = times;
  return picture;
}

}  // namespace burnish
