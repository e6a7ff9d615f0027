#include "harness/reference_integrator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/light/local_lights.h"
#include "harness/parallel_progress.h"

namespace burnish {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Pairs of dimensions of a sample.
enum : std::uint32_t { kEnvironmentPair, kBrdfPair, kChoicePair, kFirstLightPair };

/// Into [0, 1) as float: rounding a double just below one would give one.
float below_one(double uniform) {
  return std::min(static_cast<float>(uniform), std::nextafter(1.0f, 0.0f));
}

Vector3f sample_cosine(const Uniform2& uniform) {
  const double radius = std::sqrt(uniform.u), angle = 2 * kPi<double> * uniform.v;
  return Vector3d(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - uniform.u))
      .cast<float>();
}

/// Density of the BRDF technique, per sr.
double brdf_pdf(const ReferenceIntegrator::Point& point, const Vector3f& incoming) {
  double pdf = point.diffuse_chance * std::max(double(incoming.z()), 0.0) / kPi<double>;
  if (point.diffuse_chance < 1)
    pdf += (1 - point.diffuse_chance) *
           double(pdf_specular_brdf(*point.material, point.local_outgoing, incoming));
  return pdf;
}

/// An estimate of what the specular part reflects: as if all of it left by the mirror direction.
/// d omega_i = 4 h.o d omega_h.
double mirror_albedo(const Material& material, const Vector3f& outgoing) {
  double lobes_integral = 0;
  const HalfVectorLobes lobes = half_vector_lobes(material, 1);
  for (size_t i = 0; i < static_cast<size_t>(lobes.count); ++i)
    lobes_integral += double(integral(lobes.lobe[i]));
  const Vector3f mirror(-outgoing.x(), -outgoing.y(), outgoing.z());
  const double cosine = outgoing.z();
  return luminance(specular_smooth_factor(material, outgoing, mirror)) * lobes_integral * 4 *
         cosine * cosine;
}

/// A uniform direction of the cone around a unit axis, of a height 1 - cos(its radius).
Vector3d sample_cone(const Vector3d& axis, double height, const Uniform2& uniform) {
  const double drop = uniform.u * height;  // 1 - cos of the angle to the axis
  const double sine = std::sqrt(std::max(drop * (2 - drop), 0.0));
  const double angle = 2 * kPi<double> * uniform.v;
  const Vector3d local(sine * std::cos(angle), sine * std::sin(angle), 1 - drop);
  return frame_from_axis<double>(axis).to_world(local);
}

double pdf_cone(double height) { return 1 / (2 * kPi<double> * height); }

/// A direction drawn from a light: the distance of the light there, and its density per sr (0: the
/// light is not seen).
struct LightSample {
  Vector3d direction = Vector3d::UnitZ();
  double distance = 0, pdf = 0;
};

/// Where a ray meets a light: its distance, negative if it does not, and with which density the
/// light's own technique draws the ray's direction.
struct LightHit {
  double distance = -1, pdf = 0;
};

/// A sphere light as seen from a point.
struct SphereView {
  Eigen::Array3d radiance;
  Vector3d to_center;
  double distance2, radius2;
  bool inside;
  double height;  ///< 1 - cos of the cone it fills; 2 inside

  SphereView(const SphereLight& sphere, const Vector3f& position)
      : radiance(sphere.radiance.cast<double>()),
        to_center(sphere.center.cast<double>() - position.cast<double>()),
        distance2(to_center.squaredNorm()),
        radius2(double(sphere.radius) * sphere.radius),
        inside(distance2 <= radius2),
        height(2) {
    if (inside) return;
    const double sine2 = radius2 / distance2;
    height = sine2 / (1 + std::sqrt(1 - sine2));
  }

  LightSample sample(const Uniform2& uniform) const {
    // At the very centre there is no axis; the whole sphere is sampled there, so any will do.
    const Vector3d axis = distance2 > 0 ? to_center.normalized() : Vector3d::UnitZ();
    const Vector3d direction = sample_cone(axis, height, uniform);
    // A direction on the very edge may miss by a rounding: the light is then at the tangent point.
    const LightHit hit = meet(direction);
    const double tangent = std::sqrt(std::max(distance2 - radius2, 0.0));
    return {direction, hit.distance >= 0 ? hit.distance : tangent, pdf_cone(height)};
  }

  LightHit meet(const Vector3d& direction) const {
    const double along = to_center.dot(direction);
    const double miss2 = to_center.cross(direction).squaredNorm();
    if (miss2 > radius2 || (!inside && along <= 0)) return {};
    const double half_chord = std::sqrt(radius2 - miss2);
    return {inside ? along + half_chord : along - half_chord, pdf_cone(height)};
  }
};

/// A directional light as seen from any point.
struct DirectionalView {
  Eigen::Array3d radiance;
  Vector3d toward;
  double height;  ///< 1 - cos of the cone it fills

  DirectionalView(const DirectionalLight& light, const Vector3f& /*position*/)
      : toward(light.toward.cast<double>().normalized()) {
    const double radius = shaded_angular_radius(light);
    const double sine = std::sin(radius), half_sine = std::sin(radius / 2);
    radiance = light.irradiance.cast<double>() / (kPi<double> * sine * sine);
    height = 2 * half_sine * half_sine;
  }

  LightSample sample(const Uniform2& uniform) const {
    return {sample_cone(toward, height, uniform), kInfinity, pdf_cone(height)};
  }

  LightHit meet(const Vector3d& direction) const {
    // 1 - cos of the angle, without cancellation.
    if ((direction - toward).squaredNorm() / 2 > height) return {};
    return {kInfinity, pdf_cone(height)};
  }
};

/// A rectangle light as seen from a point. Points of its surface are drawn evenly.
struct RectangleView {
  Eigen::Array3d radiance;
  Vector3d to_center, edge_x, edge_y, normal;
  double area;
  bool shines;  ///< toward the point

  RectangleView(const RectangleLight& light, const Vector3f& position)
      : radiance(light.radiance.cast<double>()),
        to_center(light.center.cast<double>() - position.cast<double>()),
        edge_x(light.edge_x.cast<double>()),
        edge_y(light.edge_y.cast<double>()) {
    const Vector3d cross = edge_x.cross(edge_y);
    area = cross.norm();
    normal = cross / area;
    const double height = normal.dot(to_center);
    shines = light.two_sided ? height != 0 : height < 0;
  }

  double pdf(const Vector3d& direction, double distance) const {
    return distance * distance / (area * std::abs(normal.dot(direction)));
  }

  LightSample sample(const Uniform2& uniform) const {
    if (!shines) return {};
    const Vector3d offset = to_center + (uniform.u - 0.5) * edge_x + (uniform.v - 0.5) * edge_y;
    const double distance = offset.norm();
    const Vector3d direction = offset / distance;
    return {direction, distance, pdf(direction, distance)};
  }

  LightHit meet(const Vector3d& direction) const {
    const double distance = normal.dot(to_center) / normal.dot(direction);
    if (!shines || !(distance > 0 && distance < kInfinity)) return {};
    const Vector3d offset = distance * direction - to_center;
    if (std::abs(offset.dot(edge_x)) > edge_x.squaredNorm() / 2 ||
        std::abs(offset.dot(edge_y)) > edge_y.squaredNorm() / 2)
      return {};
    return {distance, pdf(direction, distance)};
  }
};

/// Calls f(view) for every light but the environment, always in the same order.
template <class F>
void for_each_light(const ReferenceLights& lights, const Vector3f& position, const F& f) {
  for (const SphereLight& light : lights.spheres) f(SphereView(light, position));
  for (const DirectionalLight& light : lights.directionals) f(DirectionalView(light, position));
  for (const RectangleLight& light : lights.rectangles) f(RectangleView(light, position));
}

/// 1 / density, by which a sample's value is multiplied: of the technique that drew it alone, or of
/// both by the balance heuristic.
double sample_weight(double own_pdf, double other_pdf, SamplingTechnique technique) {
  const double pdf = technique == SamplingTechnique::combined ? own_pdf + other_pdf : own_pdf;
  return pdf > 0 ? 1 / pdf : 0;
}

}  // namespace

/// What a direction brings apart from light: the direction in both frames, BRDF times cosine.
struct ReferenceIntegrator::Incoming {
  Vector3d world;
  Vector3f local;
  Eigen::Array3d response;

  Incoming(const Point& point, const Vector3d& direction)
      : world(direction), local(point.frame.to_local(direction).cast<float>()) {
    respond(point);
  }
  Incoming(const Point& point, const Vector3f& local_direction)
      : world(point.frame.to_world(local_direction.cast<double>()).normalized()),
        local(local_direction) {
    respond(point);
  }
  bool dark() const { return !(response > 0).any(); }

 private:
  void respond(const Point& point) {
    response = Eigen::Array3d::Zero();
    if (local.z() <= 0) return;
    response =
        eval_brdf(*point.material, point.local_outgoing, local).cast<double>() * double(local.z());
  }
};

ReferenceIntegrator::ReferenceIntegrator(const RayScene& shadowing, const ReferenceLights& lights)
    : shadowing_(shadowing),
      lights_(lights),
      world_from_environment_(lights.environment.world_from_environment.cast<double>()) {
  if (!lights.environment.map) return;
  environment_.emplace(*lights.environment.map);
  if (environment_->empty()) environment_.reset();
}

ReferenceIntegrator::Point ReferenceIntegrator::prepare(const Vector3f& position,
                                                        const Frame<float>& frame,
                                                        const Vector3f& outgoing,
                                                        const Material& material) const {
  Point point;
  point.position = position;
  point.frame = frame.cast<double>();
  point.ray_origin = position + shadowing_.origin_offset() * frame.z;
  point.local_outgoing = frame.to_local(outgoing).normalized();
  point.material = &material;
  const double diffuse = luminance(material.diffuse);
  if (!material.has_specular() || point.local_outgoing.z() <= 0) return point;
  // Both parts keep a share, since the specular part's albedo is an estimate.
  const double specular = mirror_albedo(material, point.local_outgoing);
  point.diffuse_chance = diffuse > 0 ? std::clamp(diffuse / (diffuse + specular), 0.1, 0.9) : 0;
  return point;
}

bool ReferenceIntegrator::occluded(const Point& point, const Vector3d& direction,
                                   double distance) const {
  // The ray starts off the surface, nearer to the light, and ends as far before the light, so that
  // a surface that the light lies on does not shadow it.
  const double end = std::max(distance - 2.0 * double(shadowing_.origin_offset()), 0.0);
  return shadowing_.occluded(point.ray_origin, direction.cast<float>(), static_cast<float>(end));
}

Eigen::Array3d ReferenceIntegrator::sample_environment(const Point& point, const Uniform2& uniform,
                                                       SamplingTechnique technique) const {
  const EnvironmentSampler::Sample light = environment_->sample(uniform);
  const Incoming incoming(point, Vector3d(world_from_environment_ * light.direction));
  if (incoming.dark() || occluded(point, incoming.world, kInfinity)) return Eigen::Array3d::Zero();
  return incoming.response * light.radiance.cast<double>() *
         sample_weight(light.pdf, brdf_pdf(point, incoming.local), technique);
}

template <class LightView>
Eigen::Array3d ReferenceIntegrator::sample_light(const Point& point, const LightView& view,
                                                 const Uniform2& uniform,
                                                 SamplingTechnique technique) const {
  const LightSample light = view.sample(uniform);
  if (!(light.pdf > 0)) return Eigen::Array3d::Zero();
  const Incoming incoming(point, light.direction);
  if (incoming.dark() || occluded(point, incoming.world, light.distance))
    return Eigen::Array3d::Zero();
  return incoming.response * view.radiance *
         sample_weight(light.pdf, brdf_pdf(point, incoming.local), technique);
}

Eigen::Array3d ReferenceIntegrator::sample_brdf(const Point& point, const Uniform2& uniform,
                                                double choice, SamplingTechnique technique) const {
  const bool diffuse = choice < point.diffuse_chance;
  const Incoming incoming(
      point, diffuse ? sample_cosine(uniform)
                     : sample_specular_brdf(*point.material, point.local_outgoing,
                                            below_one(uniform.u), below_one(uniform.v)));
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  if (incoming.dark()) return sum;
  const double pdf = brdf_pdf(point, incoming.local);
  const bool blocked = occluded(point, incoming.world, kInfinity);
  if (environment_ && !blocked) {
    const Rgb& radiance = eval_environment(*lights_.environment.map,
                                           world_from_environment_.transpose() * incoming.world);
    sum += radiance.cast<double>() *
           sample_weight(pdf, environment_->pdf_of_radiance(radiance), technique);
  }
  for_each_light(lights_, point.position, [&](const auto& view) {
    const LightHit hit = view.meet(incoming.world);
    if (hit.distance < 0 || (blocked && occluded(point, incoming.world, hit.distance))) return;
    sum += view.radiance * sample_weight(pdf, hit.pdf, technique);
  });
  return sum * incoming.response;
}

Eigen::Array3d ReferenceIntegrator::sample(const Point& point, const SampleSequence& sequence,
                                           std::uint32_t index, SamplingTechnique technique) const {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  if (point.local_outgoing.z() <= 0) return sum;
  if (technique != SamplingTechnique::brdf_only) {
    if (environment_)
      sum += sample_environment(point, sequence(index, kEnvironmentPair), technique);
    std::uint32_t pair = kFirstLightPair;
    for_each_light(lights_, point.position, [&](const auto& view) {
      sum += sample_light(point, view, sequence(index, pair++), technique);
    });
  }
  if (technique != SamplingTechnique::lights_only)
    sum +=
        sample_brdf(point, sequence(index, kBrdfPair), sequence(index, kChoicePair).u, technique);
  return sum;
}

ReferenceEstimate estimate_radiance(const ReferenceIntegrator& integrator,
                                    std::span<const ReferenceIntegrator::Point> points,
                                    std::uint64_t stream, const ReferenceOptions& options) {
  ReferenceEstimate estimate;
  if (points.empty()) return estimate;
  const auto replicates = static_cast<size_t>(std::max(options.replicates, 2));
  const size_t chunk = replicates * points.size();
  const size_t per_point = (static_cast<size_t>(std::max(options.samples, 1)) + chunk - 1) / chunk;
  const std::uint64_t seed = mix_seed(options.seed, stream);
  // Welford's running mean and sum of squares over the replicates, each an independent estimate.
  Eigen::Array3d squares = Eigen::Array3d::Zero();
  for (size_t replicate = 0; replicate < replicates; ++replicate) {
    const SampleSequence sequence(mix_seed(seed, replicate));
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    std::uint32_t index = 0;
    // Consecutive indices for each point: such a run is well spread by itself.
    for (const ReferenceIntegrator::Point& point : points)
      for (size_t i = 0; i < per_point; ++i)
        sum += integrator.sample(point, sequence, index++, options.technique);
    const Eigen::Array3d value = sum / double(per_point * points.size());
    const Eigen::Array3d delta = value - estimate.mean;
    estimate.mean += delta / double(replicate + 1);
    squares += delta * (value - estimate.mean);
  }
  estimate.variance = squares / (double(replicates - 1) * double(replicates));
  return estimate;
}

Picture render_reference(const Subject& subject, const SceneRays& rays, const PrimaryHits& hits,
                         const ReferenceLights& lights, const ReferenceOptions& options,
                         const Progress& progress) {
  const ReferenceIntegrator integrator(rays.shadowing(), lights);
  const View& view = hits.view;
  const Vector3f& eye = view.camera.origin;
  const PrimaryRays camera = primary_rays(view.camera, view.width, view.height);
  const size_t per_pixel = hits.samples_per_pixel();
  const float sample_angle = sample_angle_rad(view);
  Picture picture;
  picture.radiance = picture.variance = Image(view.width, view.height);
  picture.hit.assign(picture.radiance.pixels.size(), 0);
  parallel_with_progress("reference", picture.hit.size(), 64, progress, [&](size_t pixel) {
    std::vector<ReferenceIntegrator::Point> points;
    std::vector<SurfaceMaterial> materials;  // that the points refer to
    points.reserve(per_pixel);
    materials.reserve(per_pixel);
    Rgb background = Rgb::Zero();
    size_t met = 0;
    for (size_t sample = 0; sample < per_pixel; ++sample) {
      const PrimaryHit& hit = hits.pixel_hits(pixel)[sample];
      if (hit.triangle == PrimaryHit::kMiss) {
        background +=
            eval_environment_light(lights.environment, hits.direction(camera, pixel, sample));
        continue;
      }
      ++met;
      const SurfacePoint point = surface_point(*subject.transfer, hit, eye);
      if (!point.front) continue;
      const SurfaceMaterial& at =
          materials.emplace_back(surface_material(subject, point, eye, sample_angle));
      points.push_back(integrator.prepare(
          point.position, at.frame, outgoing_toward(eye, point.position, at.frame.z), at.material));
    }
    const ReferenceEstimate estimate = estimate_radiance(integrator, points, pixel, options);
    const double share = double(points.size()) / double(per_pixel);
    picture.radiance.pixels[pixel] =
        (estimate.mean * share).cast<float>() + background / float(per_pixel);
    picture.variance.pixels[pixel] = (estimate.variance * share * share).cast<float>();
    picture.hit[pixel] = met == per_pixel;
  });
  return picture;
}

VertexReference shade_reference_vertices(const Subject& subject, const SceneRays& rays,
                                         const Vector3f& eye, const ReferenceLights& lights,
                                         const ReferenceOptions& options,
                                         const Progress& progress) {
  const ReferenceIntegrator integrator(rays.shadowing(), lights);
  const Transfer& transfer = *subject.transfer;
  VertexReference result;
  result.radiance.resize(transfer.vertex_count());
  result.variance.resize(transfer.vertex_count());
  parallel_with_progress("reference", transfer.vertex_count(), 16, progress, [&](size_t vertex) {
    const Vector3f& position = transfer.positions[vertex];
    const SurfaceMaterial at = vertex_material(subject, vertex);
    const ReferenceIntegrator::Point point = integrator.prepare(
        position, at.frame, outgoing_toward(eye, position, at.frame.z), at.material);
    const ReferenceEstimate estimate = estimate_radiance(integrator, {&point, 1}, vertex, options);
    result.radiance[vertex] = estimate.mean.cast<float>();
    result.variance[vertex] = estimate.variance.cast<float>();
  });
  return result;
}

}  // namespace burnish
