#include "burnish/formats/light_file.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/output_file.h"
#include "file_bytes.h"
#include "json_text.h"

namespace burnish {
namespace {

constexpr const char* kLightFormatName = "burnish lights";
constexpr float kFrameTolerance = 1e-3f;
constexpr float kRounding = 4e-6f;  // some 30 roundings of a float near 1
constexpr float kMax = std::numeric_limits<float>::max();

Vector3f read_vector(const JsonPlace& place, float low = -kMax) {
  place.expect_array(3);
  return {place.at(size_t{0}).float_in(low, kMax), place.at(1).float_in(low, kMax),
          place.at(2).float_in(low, kMax)};
}

Vector3f read_unit(const JsonPlace& place) {
  const Vector3f vector = read_vector(place);
  const float length = vector.stableNorm();
  if (!(std::abs(length - 1) <= kFrameTolerance))
    place.fail(fmt::format("length {}, expected 1 within {}", length, kFrameTolerance));
  return vector;
}

/// Made exactly orthonormal, unless it is but for rounding: then it is kept as written.
Frame<float> read_frame(const JsonPlace& axis_place, const JsonPlace& tangent_place) {
  const Vector3f axis = read_unit(axis_place), tangent = read_unit(tangent_place);
  const float cosine = axis.dot(tangent);
  if (!(std::abs(cosine) <= kFrameTolerance))
    tangent_place.fail(
        fmt::format("cosine {} with the axis, expected 0 within {}", cosine, kFrameTolerance));
  const auto is_rounding = [](float error) { return std::abs(error) <= kRounding; };
  if (is_rounding(cosine) && is_rounding(axis.norm() - 1) && is_rounding(tangent.norm() - 1))
    return {tangent, axis.cross(tangent), axis};
  return frame_from_normal_tangent<float>(axis.normalized(), tangent);
}

EnvironmentLobe read_lobe(const JsonPlace& place, int /*version*/) {
  place.expect_fields({"axis", "tangent", "bandwidth_x", "bandwidth_y", "color"});
  EnvironmentLobe light;
  light.lobe.frame = read_frame(place.at("axis"), place.at("tangent"));
  light.lobe.bandwidth_x = place.at("bandwidth_x").float_in(0, kMax);
  light.lobe.bandwidth_y = place.at("bandwidth_y").float_in(0, kMax);
  light.color = read_vector(place.at("color")).array();
  return light;
}

Rgb read_color(const JsonPlace& place) { return read_vector(place, 0).array(); }

/// A light's radiance: as the file has it, or from the field `other`, of which one must be there.
template <class Convert>
Rgb read_radiance(const JsonPlace& place, const char* other, const Convert& radiance_of) {
  if (place.has("radiance") == place.has(other))
    place.fail(fmt::format("expected one of the fields 'radiance' and '{}'", other));
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
  light.radius = place.at("radius").float_in(std::numeric_limits<float>::min(), kMax);
  light.radiance = read_radiance(
      place, "power", [&](const Rgb& power) { return radiance_of_sphere(power, light.radius); });
  return light;
}

DirectionalLight read_directional(const JsonPlace& place, int /*version*/) {
  place.expect_fields({"toward", "angular_radius_rad", "irradiance", "radiance"});
  DirectionalLight light;
  light.toward = read_unit(place.at("toward"));
  if (std::abs(light.toward.norm() - 1) > kRounding) light.toward.normalize();
  light.angular_radius_rad = place.at("angular_radius_rad").float_in(0, kPi<float> / 2);
  if (place.has("radiance") == place.has("irradiance"))
    place.fail("expected one of the fields 'radiance' and 'irradiance'");
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
  if (!(length >= std::numeric_limits<float>::min() && length <= kMax))
    place.fail(fmt::format("length {}, expected above 0", length));
  return edge;
}

RectangleLight read_rectangle(const JsonPlace& place, int /*version*/) {
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
  if (std::abs(cosine) > kRounding) light.edge_y -= (cosine * height) * along;
  if (place.has("two_sided")) light.two_sided = place.at("two_sided").boolean();
  light.radiance = read_radiance(place, "power", [&](const Rgb& power) {
    return radiance_of_rectangle(power, width, height, light.two_sided);
  });
  return light;
}

template <class Light>
std::vector<Light> read_list(const JsonPlace& root, const char* name, int version,
                             Light (*read)(const JsonPlace&, int)) {
  std::vector<Light> lights;
  if (!root.has(name)) return lights;
  const JsonPlace list = root.at(name);
  list.expect_array();
  for (size_t i = 0; i < list.value.size(); ++i) lights.push_back(read(list.at(i), version));
  return lights;
}

std::optional<double> read_fit_error(const JsonPlace& root, const char* name) {
  if (!root.has(name) || root.at(name).value.is_null()) return {};
  const JsonPlace place = root.at(name);
  const double error = place.number();
  if (!(error >= 0)) place.fail(fmt::format("{}, expected 0 or more", error));
  return error;
}

/// A 3 x 3 rotation, rows first; made exactly orthonormal when it is not quite.
Eigen::Matrix3f read_rotation(const JsonPlace& place) {
  place.expect_array(3);
  Eigen::Matrix3f matrix;
  for (int row = 0; row < 3; ++row)
    matrix.row(row) =
        read_vector(place.at(static_cast<size_t>(row)), -1 - kFrameTolerance).transpose();
  const Eigen::Matrix3d product = (matrix.transpose() * matrix).cast<double>();
  const double error = (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= 2 * kFrameTolerance) || matrix.determinant() < 0)
    place.fail("not a rotation: expected orthonormal rows and determinant 1");
  if (error <= kRounding) return matrix;  // rounding of a rotation: kept as written
  const Eigen::JacobiSVD<Eigen::Matrix3f> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

int read_version(const JsonPlace& root) {
  const JsonPlace format = root.at("format");
  if (format.string() != kLightFormatName)
    format.fail(fmt::format("'{}', expected '{}'", format.string(), kLightFormatName));
  const JsonPlace version = root.at("format_version");
  if (!version.value.is_number_integer() || version.number() < 1)
    version.fail("expected an integer, 1 or more");
  if (version.number() > kLightFormatVersion)
    throw Error(ErrorKind::unsupported, root.subject,
                fmt::format("light format version {}, this build reads up to {}", version.number(),
                            kLightFormatVersion));
  return static_cast<int>(version.number());
}

template <class Vector>
std::string format_vector(const Vector& v) {
  return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]);
}

std::string format_lobe(const EnvironmentLobe& light) {
  const AnisotropicGaussian<float>& lobe = light.lobe;
  return fmt::format(
      "    {{\"axis\": {}, \"tangent\": {}, \"bandwidth_x\": {}, \"bandwidth_y\": {}, "
      "\"color\": {}}}",
      format_vector(lobe.frame.z), format_vector(lobe.frame.x), lobe.bandwidth_x, lobe.bandwidth_y,
      format_vector(Rgb(light.color * lobe.amplitude)));
}

std::string format_sphere(const SphereLight& light) {
  return fmt::format("    {{\"center\": {}, \"radius\": {}, \"radiance\": {}}}",
                     format_vector(light.center), light.radius, format_vector(light.radiance));
}

std::string format_directional(const DirectionalLight& light) {
  return fmt::format("    {{\"toward\": {}, \"angular_radius_rad\": {}, \"irradiance\": {}}}",
                     format_vector(light.toward), light.angular_radius_rad,
                     format_vector(light.irradiance));
}

std::string format_rectangle(const RectangleLight& light) {
  return fmt::format(
      "    {{\"center\": {}, \"edge_x\": {}, \"edge_y\": {}, \"two_sided\": {}, \"radiance\": {}}}",
      format_vector(light.center), format_vector(light.edge_x), format_vector(light.edge_y),
      light.two_sided, format_vector(light.radiance));
}

template <class Lights, class Format>
std::string format_list(const char* name, const Lights& lights, Format format) {
  std::string text = fmt::format("  \"{}\": [", name);
  const char* separator = "\n";
  for (const auto& light : lights) {
    text += separator + format(light);
    separator = ",\n";
  }
  return text + (lights.empty() ? "]" : "\n  ]");
}

}  // namespace

LightFile parse_lights(std::string_view json, const std::string& subject) {
  const nlohmann::json document = parse_json(json, subject);
  const JsonPlace root{document, nlohmann::json::json_pointer(), json, subject};
  const int version = read_version(root);
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
    file.world_from_environment = read_rotation(root.at("world_from_environment"));
  if (root.has("scale")) file.scale = root.at("scale").float_in(0, kMax);
  file.rig.lobes = read_list(root, "lobes", version, read_lobe);
  file.rig.directionals = read_list(root, "directionals", version, read_directional);
  file.rig.spheres = read_list(root, "spheres", version, read_sphere);
  file.rig.rectangles = read_list(root, "rectangles", version, read_rectangle);
  return file;
}

std::string format_lights(const LightFile& lights, const std::string& subject) {
  const Eigen::Matrix3f& rotation = lights.world_from_environment;
  std::string text = "{\n";
  text += fmt::format("  \"format\": \"{}\",\n", kLightFormatName);
  text += fmt::format("  \"format_version\": {},\n", kLightFormatVersion);
  text += fmt::format("  \"name\": {},\n", json_string(lights.name));
  text += fmt::format("  \"source\": {},\n", json_string(lights.source));
  if (lights.fit_relative_l2)
    text += fmt::format("  \"fit_relative_l2\": {},\n", *lights.fit_relative_l2);
  if (lights.fit_irradiance_relative_l2)
    text +=
        fmt::format("  \"fit_irradiance_relative_l2\": {},\n", *lights.fit_irradiance_relative_l2);
  text +=
      fmt::format("  \"world_from_environment\": [{}, {}, {}],\n", format_vector(rotation.row(0)),
                  format_vector(rotation.row(1)), format_vector(rotation.row(2)));
  text += fmt::format("  \"scale\": {},\n", lights.scale);
  text += format_list("lobes", lights.rig.lobes, format_lobe) + ",\n";
  text += format_list("directionals", lights.rig.directionals, format_directional) + ",\n";
  text += format_list("spheres", lights.rig.spheres, format_sphere) + ",\n";
  text += format_list("rectangles", lights.rig.rectangles, format_rectangle) + "\n}\n";
  try {
    parse_lights(text, subject);  // what we could not read back is not written
  } catch (const Error& error) {
    std::string message = error.what();
    message.erase(0, std::min(message.size(), subject.size() + 2));
    throw Error(ErrorKind::output, subject, "these lights cannot be stored: " + message);
  }
  return text;
}

LightRig world_lights(const LightFile& file) {
  LightRig rig = file.rig;
  rotate(rig, file.world_from_environment);
  scale(rig, file.scale);
  return rig;
}

LightFile read_lights(const std::string& path) { return parse_lights(read_file_bytes(path), path); }

void write_lights(const LightFile& lights, const std::string& path) {
  const std::string text = format_lights(lights, path);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace burnish
