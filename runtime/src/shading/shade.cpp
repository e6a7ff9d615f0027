#include "burnish/shading/shade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "burnish/light/lobe_split.h"
#include "burnish/sphere/asg_product.h"
#include "burnish/sphere/lobe_domain.h"
#include "burnish/sphere/lobe_moments.h"
#include "burnish/visibility/ssdf.h"
#include "burnish/visibility/visibility_ladder.h"

// Based on: xu2013asg, section 6 (Eq. 29, 30), over the SSDF visibility of wang2009svbrdf. Where we
// differ: the visible fraction takes the boundary's direction into account, and the diffuse cosine
// belongs to the integral (docs/maths.md, "Diffuse term").
namespace burnish {
namespace {

/// What is seen of the surroundings of a point.
class PointVisibility {
 public:
  PointVisibility(const ShadingPoint& point, const ShadingOptions& options, bool diffuse)
      : point_(point) {
    if (!point.basis) return;
    const int baked = point.basis->terms;
    terms_ = options.terms > 0 ? std::min(options.terms, baked) : baked;
    has_ladder_ = diffuse && options.cosine == CosineModel::horizon_normalised && options.ladder &&
                  point.ladder && point.ladder_crossover > 0;
    if (has_ladder_) harmonics_ = reconstruct_harmonics(*point.ladder, point.ladder_coefficients);
  }

  /// Signed distance to the nearest boundary. Without a bake, that is the horizon.
  SsdfSample lookup(const Vector3f& direction) const {
    if (!point_.basis) return horizon(direction);
    return lookup_ssdf(*point_.basis, point_.coefficients, terms_, direction);
  }

  SsdfSample horizon(const Vector3f& direction) const {
    const Vector3f& normal = point_.frame.z;
    const float sine = std::clamp(normal.dot(direction), -1.0f, 1.0f);
    const Vector3f gradient = normal - sine * direction;
    const float length = gradient.norm();
    return {std::asin(sine), length > 1e-6f ? Vector3f(gradient / length) : Vector3f::Zero()};
  }

  bool only_horizon() const { return point_.basis == nullptr; }

  /// How much the ladder, and not the SSDF, tells of a lobe: 1 for wide lobes, 0 for narrow ones, a
  /// smooth step over an octave either side of the crossover.
  float ladder_weight(float bandwidth) const {
    if (!has_ladder_) return 0;
    const float octaves = std::log2(bandwidth / point_.ladder_crossover);
    const float t = std::clamp((1 - octaves) / 2, 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  }

  /// Visible fraction of a round lobe by the ladder.
  float wide_fraction(const Vector3f& direction, const LobeBands& lobe) const {
    return visible_fraction(harmonics_, direction, lobe);
  }

 private:
  const ShadingPoint& point_;
  int terms_ = 0;
  bool has_ladder_ = false;
  VisibilityHarmonics harmonics_;
};

/// Where the product of a lobe and the clamped cosine peaks, and how wide it is there, as a lobe
/// without amplitude. The cosine is exp(kCosineSharpness n.v) up to a factor.
AnisotropicGaussian<float> lobe_times_cosine(const AnisotropicGaussian<float>& lobe,
                                             const Vector3f& normal) {
  constexpr float kCosineSharpness =
      2.133f;  // least-squares SG of the clamped cosine (wang2009svbrdf)
  const Vector3f n = kCosineSharpness * lobe.frame.to_local(normal);
  const float two_x = 2 * lobe.bandwidth_x, two_y = 2 * lobe.bandwidth_y;
  // Maximum of log z - b_x x^2 - b_y y^2 + n.v on the unit sphere, by its Lagrange multiplier:
  // |v(m)| = 1, |v| falls with m. Newton in log m from a start below the root; the result is
  // normalised anyway.
  float multiplier = 2.5f;
  Vector3f v = Vector3f::UnitZ();
  for (int i = 0; i < 4; ++i) {
    const float root = std::sqrt(n.z() * n.z() + 4 * multiplier);
    v = {n.x() / (two_x + multiplier), n.y() / (two_y + multiplier),
         (n.z() + root) / (2 * multiplier)};
    const float dz = (1 / root - v.z()) / multiplier;
    const float slope =
        -v.x() * v.x() / (two_x + multiplier) - v.y() * v.y() / (two_y + multiplier) + v.z() * dz;
    const float step = (v.squaredNorm() - 1) / std::max(-2 * slope, 1e-6f);
    multiplier = std::clamp(multiplier + step, 0.3f * multiplier, 3 * multiplier);
  }
  v.normalize();

  AnisotropicGaussian<float> result;
  const Frame<float> tangent = frame_from_axis(v);
  // Curvature of the exponent in the tangent plane; an ASG's smooth term accounts for 1 of it.
  const Vector3f diagonal(two_x, two_y, 1 / std::max(v.z() * v.z(), 1e-4f));
  const float xx = tangent.x.dot(diagonal.cwiseProduct(tangent.x)) + multiplier;
  const float yy = tangent.y.dot(diagonal.cwiseProduct(tangent.y)) + multiplier;
  const float xy = tangent.x.dot(diagonal.cwiseProduct(tangent.y));
  const float half_difference = (xx - yy) / 2;
  const float radius = std::hypot(half_difference, xy);
  const float angle = 0.5f * std::atan2(xy, half_difference);
  const Vector3f major = std::cos(angle) * tangent.x + std::sin(angle) * tangent.y;
  const Frame<float> local = {major, v.cross(major), v};
  result.frame = {lobe.frame.to_world(local.x), lobe.frame.to_world(local.y),
                  lobe.frame.to_world(local.z)};
  result.bandwidth_x = std::max(((xx + yy) / 2 + radius - 1) / 2, 0.05f);
  result.bandwidth_y = std::max(((xx + yy) / 2 - radius - 1) / 2, 0.05f);
  return result;
}

/// What is visible of a lobe, of what is above the horizon, by the ladder. A long lobe is read at
/// three places along its long axis, the nodes of Gauss-Hermite quadrature: by one round lobe it
/// errs by up to twice as much.
float visible_share_by_ladder(const PointVisibility& visibility,
                              const AnisotropicGaussian<float>& lobe, float wide, float narrow) {
  constexpr float kLong = 2;  // ratio of bandwidths from which on three places are read
  const Vector3f& axis = lobe.frame.z;
  float seen = 0, above = 0;
  const auto add = [&](const Vector3f& direction, float weight, float bandwidth) {
    seen += weight * visibility.wide_fraction(direction, lobe_bands(bandwidth));
    above +=
        weight * visible_fraction_hemisphere(2 * bandwidth, visibility.horizon(direction).distance);
  };
  if (narrow < kLong * wide) {
    add(axis, 1, std::sqrt(wide * narrow));
  } else {
    // Each part as wide as the lobe is narrow, but at least half as wide as it is long; their
    // places have the rest of its variance.
    const float part = std::min(narrow, 4 * wide);
    const float tangent = std::sqrt(1.5f * (1 / wide - 1 / part));
    const Vector3f offset =
        tangent * (lobe.bandwidth_x < lobe.bandwidth_y ? lobe.frame.x : lobe.frame.y);
    const float bandwidth = std::sqrt(part * narrow);
    add(axis, 2.0f / 3, bandwidth);
    add((axis + offset).normalized(), 1.0f / 6, bandwidth);
    add((axis - offset).normalized(), 1.0f / 6, bandwidth);
  }
  return seen < above ? seen / above : 1.0f;
}

/// The same by the SSDF.
float visible_share_by_ssdf(const PointVisibility& visibility, const ShadingOptions& options,
                            const AnisotropicGaussian<float>& lobe) {
  const SsdfSample boundary = visibility.lookup(lobe.frame.z);
  const SsdfSample horizon = visibility.horizon(lobe.frame.z);
  const float seen =
      visible_fraction(options.visibility, lobe, boundary.distance, boundary.gradient);
  const float above =
      visible_fraction(options.visibility, lobe, horizon.distance, horizon.gradient);
  // Both vanish together where the lobe is far below the horizon; there the integral does, too.
  return seen < above ? seen / above : 1.0f;
}

/// Integral of a lobe (unit amplitude) times visibility times the clamped cosine, from the lobe's
/// own integral and that with the cosine but without visibility.
float diffuse_integral(const AnisotropicGaussian<float>& lobe, float integral, float unshadowed,
                       const ShadingPoint& point, const PointVisibility& visibility,
                       const ShadingOptions& options) {
  const Vector3f& normal = point.frame.z;
  if (options.cosine == CosineModel::constant) {  // Eq. 29
    const float cosine = normal.dot(lobe.frame.z);
    if (cosine <= 0) return 0;
    const SsdfSample boundary = visibility.lookup(lobe.frame.z);
    return cosine * integral *
           visible_fraction(options.visibility, lobe, boundary.distance, boundary.gradient);
  }
  if (unshadowed <= 0 || visibility.only_horizon()) return unshadowed;
  const AnisotropicGaussian<float> lit = lobe_times_cosine(lobe, normal);
  // The curvature, without the ASG's smooth term, which the ladder's lobes do not have.
  const float wide = std::min(lit.bandwidth_x, lit.bandwidth_y) + 0.5f;
  const float narrow = std::max(lit.bandwidth_x, lit.bandwidth_y) + 0.5f;
  const float weight = visibility.ladder_weight(std::sqrt(wide * narrow));
  float share = 0;
  if (weight > 0) share += weight * visible_share_by_ladder(visibility, lit, wide, narrow);
  if (weight < 1) share += (1 - weight) * visible_share_by_ssdf(visibility, options, lit);
  return unshadowed * share;
}

/// With the cosine, without visibility. Eq. 29 has no use for it.
float unshadowed_integral(const PreparedLobe& light, const Vector3f& normal,
                          const ShadingOptions& options) {
  if (options.cosine == CosineModel::constant) return 0;
  return light.integral * mean_clamped_cosine(light.moments, light.lobe.frame.to_local(normal));
}

/// A lobe of a material's specular part at a point: light through `lobe`, times `weight`.
struct SpecularView {
  AnisotropicGaussian<float> lobe;  ///< over incoming directions of the world
  float integral = 0;               ///< of the lobe
  Rgb weight;                       ///< smooth factor, cosine and visibility
};

struct SpecularViews {
  std::array<SpecularView, kMaxSpecularTeeth> view;
  int count = 0;

  std::span<const SpecularView> all() const {
    return std::span(view).first(static_cast<size_t>(count));
  }
};

/// What is visible of a lobe of a slice.
float visible_part(const AnisotropicGaussian<float>& lobe, SpecularForm form,
                   const PointVisibility& visibility, const ShadingOptions& options) {
  if (form == SpecularForm::moments)
    return visibility.only_horizon() ? 1 : visible_share_by_ssdf(visibility, options, lobe);
  const SsdfSample boundary = visibility.lookup(lobe.frame.z);
  return visible_fraction(options.visibility, lobe, boundary.distance, boundary.gradient);
}

/// Without what is hidden or below the horizon.
void find_specular_views(const ShadingPoint& point, const Vector3f& outgoing,
                         const PreparedMaterial& material, const PointVisibility& visibility,
                         const ShadingOptions& options, SpecularViews& views) {
  std::array<SliceLobe, kMaxSpecularTeeth> slice;
  const int count = specular_slice(material, point.frame.to_local(outgoing), slice);
  for (const SliceLobe& part : std::span(slice).first(static_cast<size_t>(count))) {
    SpecularView& view = views.view[static_cast<size_t>(views.count)];
    view.lobe = part.lobe;
    view.lobe.frame = {point.frame.to_world(part.lobe.frame.x),
                       point.frame.to_world(part.lobe.frame.y),
                       point.frame.to_world(part.lobe.frame.z)};
    const float visible = visible_part(view.lobe, material.form, visibility, options);
    if (visible <= 0) continue;
    view.integral = material.form == SpecularForm::moments ? part.integral
                                                           : integral(view.lobe, options.integral);
    view.weight = part.weight * visible;
    ++views.count;
  }
}

/// Integral of the distant environment's radiance times the lobe.
Rgb light_through(const SpecularView& view, const Lighting& lighting,
                  const ShadingOptions& options) {
  if (lighting.environment)
    return eval_prefiltered(*lighting.environment, view.lobe, options.environment_taps) *
           view.integral;
  Rgb sum = Rgb::Zero();
  for (const PreparedLobe& light : lighting.lights->lobes)
    sum += light.color * integral(product(light.lobe, view.lobe), options.integral);
  return sum;
}

/// The same of another light. The Gaussian is brighter than the light at its middle, but no lobe
/// sees more than the light's own radiance.
Rgb light_through(const SpecularView& view, const LightAtPoint& light,
                  const ShadingOptions& options) {
  const Rgb seen = light.color * integral(product(light.lobe, view.lobe), options.integral);
  return seen.min(light.radiance * view.integral);
}

void require(const std::string& error, const char* kind, size_t number) {
  if (!error.empty())
    throw std::invalid_argument(std::string(kind) + " " + std::to_string(number) + ": " + error);
}

/// Those that are not black.
template <class Light>
std::vector<Light> lit(const std::vector<Light>& lights, const char* kind, Rgb Light::*energy) {
  std::vector<Light> result;
  for (size_t i = 0; i < lights.size(); ++i) {
    require(domain_error(lights[i]), kind, i);
    if ((lights[i].*energy > 0).any()) result.push_back(lights[i]);
  }
  return result;
}

}  // namespace

PreparedLights prepare_lights(const LightRig& rig, const ShadingOptions& options) {
  PreparedLights prepared;
  prepared.directionals = lit(rig.directionals, "directional light", &DirectionalLight::irradiance);
  prepared.spheres = lit(rig.spheres, "sphere light", &SphereLight::radiance);
  prepared.rectangles = lit(rig.rectangles, "rectangle light", &RectangleLight::radiance);
  for (size_t i = 0; i < rig.lobes.size(); ++i)
    require(domain_error(rig.lobes[i]), "light lobe", i);
  for (const EnvironmentLobe& light : split_wide_lobes(rig.lobes, options.split_bandwidth)) {
    PreparedLobe lobe;
    lobe.lobe = light.lobe;
    lobe.lobe.amplitude = 1;
    lobe.color = light.color * light.lobe.amplitude;
    lobe.integral = integral(lobe.lobe, options.integral);
    lobe.moments = asg_moments(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
    prepared.lobes.push_back(lobe);
  }
  return prepared;
}

std::vector<PreparedMaterial> prepare_materials(std::span<const Material> materials,
                                                const ShadingOptions& options) {
  std::vector<PreparedMaterial> prepared;
  prepared.reserve(materials.size());
  for (size_t i = 0; i < materials.size(); ++i) {
    require(domain_error(materials[i]), "material", i);
    prepared.push_back(prepare_material(materials[i], options.specular));
  }
  return prepared;
}

Rgb shade_point(const ShadingPoint& point, const Vector3f& outgoing,
                const PreparedMaterial& material, const Lighting& lighting,
                const ShadingOptions& options) noexcept {
  if (outgoing.dot(point.frame.z) <= 0) return Rgb::Zero();
  const Rgb& albedo = material.material.diffuse;
  const bool diffuse = (albedo > 0).any();
  const PointVisibility visibility(point, options, diffuse);
  SpecularViews views;
  if (material.count > 0)
    find_specular_views(point, outgoing, material, visibility, options, views);
  const PreparedLights& lights = *lighting.lights;
  Rgb irradiance = Rgb::Zero(), reflected = Rgb::Zero();
  if (diffuse)
    for (const PreparedLobe& light : lights.lobes)
      irradiance +=
          light.color * diffuse_integral(light.lobe, light.integral,
                                         unshadowed_integral(light, point.frame.z, options), point,
                                         visibility, options);
  for (const SpecularView& view : views.all())
    reflected += view.weight * light_through(view, lighting, options);
  const auto add_lights = [&](const auto& list) {
    for (const auto& source : list) {
      const LightAtPoint light = light_at(source, point.position, point.frame.z);
      if (!light.reaches) continue;
      if (diffuse)
        irradiance +=
            light.color * diffuse_integral(light.lobe, light.integral, light.cosine_integral, point,
                                           visibility, options);
      for (const SpecularView& view : views.all())
        reflected += view.weight * light_through(view, light, options);
    }
  };
  if (diffuse || views.count > 0) {
    add_lights(lights.directionals);
    add_lights(lights.spheres);
    add_lights(lights.rectangles);
  }
  return albedo / kPi<float> * irradiance + reflected;
}

ShadingPoint vertex_shading_point(const Transfer& transfer, size_t vertex) noexcept {
  ShadingPoint point;
  point.position = transfer.positions[vertex];
  point.frame = frame_from_normal_tangent(transfer.normals[vertex], transfer.tangents[vertex]);
  if (transfer.bases.empty()) return point;
  point.basis = &transfer.bases[transfer.basis_id[vertex]];
  point.coefficients = transfer.vertex_coefficients(vertex);
  point.ladder = transfer.vertex_ladder_basis(vertex);
  if (!point.ladder) return point;
  point.ladder_coefficients = transfer.vertex_ladder_coefficients(vertex);
  point.ladder_crossover = transfer.ladder_crossover;
  return point;
}

void shade_vertices(const Transfer& transfer, const Lighting& lighting,
                    std::span<const PreparedMaterial> materials,
                    std::span<const std::uint8_t> material_id, const Vector3f& eye,
                    const ShadingOptions& options, size_t first, std::span<Rgb> radiance) noexcept {
  for (size_t i = 0; i < radiance.size(); ++i) {
    const size_t vertex = first + i;
    const ShadingPoint point = vertex_shading_point(transfer, vertex);
    const PreparedMaterial& material = materials[material_id.empty() ? 0 : material_id[vertex]];
    const Vector3f outgoing =
        lift_above_horizon((eye - point.position).normalized(), point.frame.z);
    radiance[i] = shade_point(point, outgoing, material, lighting, options);
  }
}

}  // namespace burnish
