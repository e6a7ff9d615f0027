#include "burnish/formats/scene_file.h"

#include <filesystem>
#include <set>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "file_bytes.h"
#include "json_values.h"

namespace burnish {
namespace {

constexpr JsonFormat kSceneFormat = {"burnish scene", "scene", kSceneFormatVersion};
constexpr std::array kRoleNames = {std::pair{"receiver", SceneRole::receiver},
                                   std::pair{"occluder", SceneRole::occluder}};
constexpr std::array kUpNames = {std::pair{"x", UpAxis::x}, std::pair{"y", UpAxis::y},
                                 std::pair{"z", UpAxis::z}};

Vector3d read_scale(const JsonPlace& place) {
  if (!place.value.is_array()) return Vector3d::Constant(read_positive(place));
  place.expect_array(3);
  return {read_positive(place.at(size_t{0})), read_positive(place.at(1)),
          read_positive(place.at(2))};
}

Eigen::Matrix3d read_rotation(const JsonPlace& place) {
  place.expect_fields({"axis", "degrees"});
  const JsonPlace axis_place = place.at("axis");
  const Vector3d axis = read_vector_double(axis_place);
  if (axis.isZero(0)) axis_place.fail("zero, expected a direction");
  const double degrees = read_number(place.at("degrees"));
  return Eigen::AngleAxisd(degrees * (kPi<double> / 180), axis.stableNormalized())
      .toRotationMatrix();
}

Placement read_matrix(const JsonPlace& place) {
  place.expect_array(3);
  Placement matrix;
  for (size_t row = 0; row < 3; ++row) {
    const JsonPlace row_place = place.at(row);
    row_place.expect_array(4);
    for (size_t column = 0; column < 4; ++column)
      matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column)) =
          read_number(row_place.at(column));
  }
  return matrix;
}

/// A name, and none that another mesh or instance of the scene has.
std::string read_name(const JsonPlace& place, std::set<std::string>& names) {
  const std::string name = place.string();
  if (name.empty()) place.fail("empty, expected a name");
  if (!names.insert(name).second) place.fail(fmt::format("the name '{}' occurs twice", name));
  return name;
}

SceneInstance read_instance(const JsonPlace& place, std::set<std::string>& names) {
  place.expect_fields({"name", "translation", "rotation", "scale", "matrix"});
  SceneInstance instance;
  if (place.has("name")) instance.name = read_name(place.at("name"), names);
  Placement& placement = instance.world_from_mesh;
  if (place.has("matrix")) {
    for (const char* other : {"translation", "rotation", "scale"})
      if (place.has(other)) place.at(other).fail("beside 'matrix', expected one or the other");
    placement = read_matrix(place.at("matrix"));
  } else {
    if (place.has("rotation")) placement.leftCols<3>() = read_rotation(place.at("rotation"));
    if (place.has("scale")) placement.leftCols<3>() *= read_scale(place.at("scale")).asDiagonal();
    if (place.has("translation")) placement.col(3) = read_vector_double(place.at("translation"));
  }
  if (!is_invertible(placement))
    (place.has("matrix") ? place.at("matrix") : place)
        .fail("flattens the mesh, expected a smallest stretch of at least 1e-6 of the largest");
  return instance;
}

std::vector<SceneInstance> read_instances(const JsonPlace& place, std::set<std::string>& names) {
  place.expect_array();
  if (place.value.empty()) place.fail("empty, expected at least one");
  std::vector<SceneInstance> instances;
  for (size_t i = 0; i < place.value.size(); ++i)
    instances.push_back(read_instance(place.at(i), names));
  return instances;
}

SceneMesh read_scene_mesh(const JsonPlace& place, const std::filesystem::path& folder,
                          std::set<std::string>& names) {
  place.expect_fields({"file", "name", "role", "instances"});
  SceneMesh mesh;
  const JsonPlace file = place.at("file");
  if (file.string().empty()) file.fail("empty, expected a mesh file");
  mesh.file = (folder / file.string()).string();
  mesh.place =
      fmt::format("line {}, {}", json_line(file.text, file.pointer), file.pointer.to_string());
  if (place.has("name")) mesh.name = read_name(place.at("name"), names);
  if (place.has("role")) mesh.role = read_choice(place.at("role"), kRoleNames);
  if (place.has("instances")) mesh.instances = read_instances(place.at("instances"), names);
  return mesh;
}

SceneGround read_ground(const JsonPlace& place) {
  place.expect_fields({"height", "size", "cells"});
  SceneGround ground;
  if (place.has("height")) {
    const JsonPlace height = place.at("height");
    if (height.value != "auto") {
      if (!height.value.is_number()) height.fail("expected a number or \"auto\"");
      ground.height = read_number(height);
    }
  }
  if (place.has("size")) ground.size = read_number(place.at("size"), 1, 1000);
  if (place.has("cells")) ground.cells = read_integer(place.at("cells"), 2, 4096);
  return ground;
}

bool has_receiver(const SceneDescription& scene) {
  if (scene.ground) return true;
  for (const SceneMesh& mesh : scene.meshes)
    if (mesh.role == SceneRole::receiver) return true;
  return false;
}

}  // namespace

bool is_invertible(const Placement& placement) {
  if (!placement.allFinite()) return false;
  const double largest = placement.leftCols<3>().cwiseAbs().maxCoeff();
  if (!(largest > 0)) return false;
  const Eigen::Matrix3d scaled = placement.leftCols<3>() / largest;
  const Vector3d stretches = Eigen::JacobiSVD<Eigen::Matrix3d>(scaled).singularValues();
  return stretches[2] >= 1e-6 * stretches[0];
}

SceneDescription parse_scene(std::string_view json, const std::string& path) {
  const nlohmann::json document = parse_json(json, path);
  const JsonPlace root{document, nlohmann::json::json_pointer(), json, path};
  read_format_version(root, kSceneFormat);
  root.expect_fields({"format", "format_version", "name", "up", "meshes", "ground"});
  SceneDescription scene;
  scene.path = path;
  if (root.has("name")) scene.name = root.at("name").string();
  if (root.has("up")) scene.up = read_choice(root.at("up"), kUpNames);
  const JsonPlace meshes = root.at("meshes");
  meshes.expect_array();
  if (meshes.value.empty()) meshes.fail("empty, expected at least one mesh");
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  std::set<std::string> names;
  for (size_t i = 0; i < meshes.value.size(); ++i)
    scene.meshes.push_back(read_scene_mesh(meshes.at(i), folder, names));
  if (root.has("ground")) scene.ground = read_ground(root.at("ground"));
  if (!has_receiver(scene)) meshes.fail("all are occluders, expected a receiver or a ground");
  return scene;
}

SceneDescription read_scene(const std::string& path) {
  return parse_scene(read_file_bytes(path), path);
}

}  // namespace burnish
