#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "burnish/formats/light_file.h"
#include "burnish/light/local_lights.h"
#include "file_bytes.h"
#include "json_values.h"
#include "light_format.h"

namespace burnish {
namespace {

EnvironmentLobe read_lobe(const JsonPlace& place, int version) {
  place.expect_fields({"axis", "tangent", "bandwidth_x", "bandwidth_y", "color"});
  EnvironmentLobe light;
  light.lobe.frame = read_frame(place.at("axis"), place.at("tangent"));
  light.lobe.bandwidth_x = place.at("bandwidth_x").float_in(0, kMaxFloat);
  light.lobe.bandwidth_y = place.at("bandwidth_y").float_in(0, kMaxFloat);
  light.color = read_vector(place.at("color"), version == 1 ? 0 : -kMaxFloat).array();
  return light;
}

/// A light's radiance: as the file has it, or from the field `other`, of which one must be there.
template <class Convert>
Rgb read_radiance(const JsonPlace& place, const char* other, const Convert& radiance_of) {
  expect_one_of(place, "radiance", other);
  if (place.has("radiance")) return read_color(place.at("radiance"));
  const JsonPlace given = place.at(other);
  const Rgb radiance = radiance_of(read_color(given));
  if (!radiance.allFinite()) given.fail("gives a radiance beyond the range of a float");
  return radiance;
}

SphereLight read_sphere(const JsonPlace& place, int version) {
  if (version == 1)
    place.expect_fields({"center", "radius", "radiance"});
  else
    place.expect_fields({"center", "radius", "radiance", "power"});
  SphereLight light;
  light.center = read_vector(place.at("center"));
  light.radius = place.at("radius").float_in(std::numeric_limits<float>::min(), kMaxFloat);
  light.radiance = read_radiance(
      place, "power", [&](const Rgb& power) { return radiance_of_sphere(power, light.radius); });
  return light;
}

DirectionalLight read_directional(const JsonPlace& place) {
  place.expect_fields({"toward", "angular_radius_rad", "irradiance", "radiance"});
  DirectionalLight light;
  light.toward = read_unit(place.at("toward"));
  if (std::abs(light.toward.norm() - 1) > kFrameRounding) light.toward.normalize();
  light.angular_radius_rad = place.at("angular_radius_rad").float_in(0, kPi<float> / 2);
  expect_one_of(place, "radiance", "irradiance");
  if (place.has("irradiance")) {
    light.irradiance = read_color(place.at("irradiance"));
    return light;
  }
  const Rgb radiance = read_color(place.at("radiance"));
  light.irradiance = irradiance_of_disc(radiance, light.angular_radius_rad);
  if (!light.irradiance.allFinite() || ((radiance > 0) != (light.irradiance > 0)).any())
    place.at("radiance")
        .fail(fmt::format(
            "gives an irradiance beyond the range of a float at an angular radius of {}",
            light.angular_radius_rad));
  return light;
}

Vector3f read_edge(const JsonPlace& place) {
  const Vector3f edge = read_vector(place);
  const float length = edge.stableNorm();
  if (!(length >= std::numeric_limits<float>::min() && length <= kMaxFloat))
    place.fail(fmt::format("length {}, expected above 0", length));
  return edge;
}

RectangleLight read_rectangle(const JsonPlace& place) {
  place.expect_fields({"center", "edge_x", "edge_y", "two_sided", "radiance", "power"});
  RectangleLight light;
  light.center = read_vector(place.at("center"));
  light.edge_x = read_edge(place.at("edge_x"));
  light.edge_y = read_edge(place.at("edge_y"));
  const Vector3f along = light.edge_x.stableNormalized();
  const float width = light.edge_x.stableNorm(), height = light.edge_y.stableNorm();
  const float cosine = along.dot(light.edge_y.stableNormalized());
  if (!(std::abs(cosine) <= kFrameTolerance))
    place.at("edge_y").fail(
        fmt::format("cosine {} with edge_x, expected 0 within {}", cosine, kFrameTolerance));
  if (std::abs(cosine) > kFrameRounding) light.edge_y -= (cosine * height) * along;
  if (place.has("two_sided")) light.two_sided = place.at("two_sided").boolean();
  light.radiance = read_radiance(place, "power", [&](const Rgb& power) {
    return radiance_of_rectangle(power, width, height, light.two_sided);
  });
  return light;
}

/// Fails for lights that cannot be shaded with, turned and scaled as the file says.
template <class Light>
void expect_sound(const JsonPlace& root, const char* list, const std::vector<Light>& world,
                  float scale) {
  for (size_t i = 0; i < world.size(); ++i) {
    const std::string error = domain_error(world[i]);
    if (error.empty()) continue;
    if (scale > 1)
      root.at("scale").fail(fmt::format("{}, with which of /{}/{} the {}", scale, list, i, error));
    root.at(list).at(i).fail(error);
  }
}

}  // namespace

LightFile parse_lights(std::string_view json, const std::string& subject) {
  const nlohmann::json document = parse_json(json, subject);
  const JsonPlace root{document, nlohmann::json::json_pointer(), json, subject};
  const int version = read_format_version(root, kLightFormat);
  if (version == 1)
    root.expect_fields({"format", "format_version", "name", "source", "fit_relative_l2",
                        "world_from_environment", "lobes", "spheres"});
  else
    root.expect_fields({"format", "format_version", "name", "source", "fit_relative_l2",
                        "fit_irradiance_relative_l2", "world_from_environment", "scale", "lobes",
                        "directionals", "spheres", "rectangles"});
  LightFile file;
  if (root.has("name")) file.name = root.at("name").string();
  if (root.has("source")) file.source = root.at("source").string();
  file.fit_relative_l2 = read_fit_error(root, "fit_relative_l2");
  file.fit_irradiance_relative_l2 = read_fit_error(root, "fit_irradiance_relative_l2");
  if (root.has("world_from_environment"))
    file.world_from_environment = read_rotation_matrix(root.at("world_from_environment"));
  if (root.has("scale")) file.scale = root.at("scale").float_in(0, kMaxFloat);
  file.rig.lobes =
      read_list(root, "lobes", [&](const JsonPlace& place) { return read_lobe(place, version); });
  file.rig.directionals = read_list(root, "directionals", read_directional);
  file.rig.spheres = read_list(root, "spheres",
                               [&](const JsonPlace& place) { return read_sphere(place, version); });
  file.rig.rectangles = read_list(root, "rectangles", read_rectangle);
  const LightRig world = world_lights(file);
  expect_sound(root, "lobes", world.lobes, file.scale);
  expect_sound(root, "directionals", world.directionals, file.scale);
  expect_sound(root, "spheres", world.spheres, file.scale);
  expect_sound(root, "rectangles", world.rectangles, file.scale);
  return file;
}

LightRig world_lights(const LightFile& file) {
  LightRig rig = file.rig;
  rotate(rig, file.world_from_environment);
  // The rounding that is kept in the file's frames and in its rotation may add up beyond what
  // shading takes for unit.
  for (EnvironmentLobe& light : rig.lobes)
    light.lobe.frame =
        frame_from_normal_tangent<float>(light.lobe.frame.z.normalized(), light.lobe.frame.x);
  for (DirectionalLight& light : rig.directionals) light.toward.normalize();
  scale(rig, file.scale);
  return rig;
}

LightFile read_lights(const std::string& path) { return parse_lights(read_file_bytes(path), path); }

}  // namespace burnish
