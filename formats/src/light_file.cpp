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

EnvironmentLobe read_lobe(const JsonPlace& place) {
  place.expect_fields({"axis", "tangent", "bandwidth_x", "bandwidth_y", "color"});
  EnvironmentLobe light;
  light.lobe.frame = read_frame(place.at("axis"), place.at("tangent"));
  light.lobe.bandwidth_x = place.at("bandwidth_x").float_in(0, kMax);
  light.lobe.bandwidth_y = place.at("bandwidth_y").float_in(0, kMax);
  light.color = read_vector(place.at("color"), 0).array();
  return light;
}

SphereLight read_sphere(const JsonPlace& place) {
  place.expect_fields({"center", "radius", "radiance"});
  SphereLight light;
  light.center = read_vector(place.at("center"));
  light.radius = place.at("radius").float_in(std::numeric_limits<float>::min(), kMax);
  light.radiance = read_vector(place.at("radiance"), 0).array();
  return light;
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

void check_version(const JsonPlace& root) {
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
  check_version(root);
  root.expect_fields({"format", "format_version", "name", "source", "fit_relative_l2",
                      "world_from_environment", "lobes", "spheres"});
  LightFile file;
  if (root.has("name")) file.name = root.at("name").string();
  if (root.has("source")) file.source = root.at("source").string();
  if (root.has("fit_relative_l2") && !root.at("fit_relative_l2").value.is_null()) {
    const JsonPlace place = root.at("fit_relative_l2");
    file.fit_relative_l2 = place.number();
    if (!(*file.fit_relative_l2 >= 0))
      place.fail(fmt::format("{}, expected 0 or more", *file.fit_relative_l2));
  }
  if (root.has("world_from_environment"))
    file.world_from_environment = read_rotation(root.at("world_from_environment"));
  if (root.has("lobes")) {
    const JsonPlace lobes = root.at("lobes");
    lobes.expect_array();
    for (size_t i = 0; i < lobes.value.size(); ++i)
      file.rig.lobes.push_back(read_lobe(lobes.at(i)));
  }
  if (root.has("spheres")) {
    const JsonPlace spheres = root.at("spheres");
    spheres.expect_array();
    for (size_t i = 0; i < spheres.value.size(); ++i)
      file.rig.spheres.push_back(read_sphere(spheres.at(i)));
  }
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
  text +=
      fmt::format("  \"world_from_environment\": [{}, {}, {}],\n", format_vector(rotation.row(0)),
                  format_vector(rotation.row(1)), format_vector(rotation.row(2)));
  text += format_list("lobes", lights.rig.lobes, format_lobe) + ",\n";
  text += format_list("spheres", lights.rig.spheres, format_sphere) + "\n}\n";
  try {
    parse_lights(text, subject);  // what we could not read back is not written
  } catch (const Error& error) {
    std::string message = error.what();
    message.erase(0, std::min(message.size(), subject.size() + 2));
    throw Error(ErrorKind::output, subject, "these lights cannot be stored: " + message);
  }
  return text;
}

LightFile read_lights(const std::string& path) { return parse_lights(read_file_bytes(path), path); }

void write_lights(const LightFile& lights, const std::string& path) {
  const std::string text = format_lights(lights, path);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace burnish
