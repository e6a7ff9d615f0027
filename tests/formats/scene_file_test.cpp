#include "burnish/formats/scene_file.h"

#include <filesystem>
#include <random>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "burnish/formats/mesh_assembly.h"
#include "files.h"
#include "json_damage.h"

namespace burnish::test {
namespace {

std::string scene_data(const std::string& name) {
  return std::string(BURNISH_TEST_DATA) + "/scene/" + name;
}

TEST(SceneFile, ReadsWhatItSays) {
  const std::string path = scene_data("cubes.scene.json");
  const SceneDescription scene = read_scene(path);
  EXPECT_EQ(scene.path, path);
  EXPECT_EQ(scene.name, "cubes");
  EXPECT_EQ(scene.up, UpAxis::z);
  ASSERT_EQ(scene.meshes.size(), 3u);
  const SceneMesh& cube = scene.meshes[0];
  EXPECT_TRUE(
      std::filesystem::equivalent(cube.file, std::string(BURNISH_TEST_DATA) + "/meshes/cube.obj"));
  EXPECT_EQ(cube.name, "cube");
  EXPECT_EQ(cube.role, SceneRole::receiver);
  EXPECT_EQ(cube.place, "line 8, /meshes/0/file");
  ASSERT_EQ(cube.instances.size(), 3u);
  EXPECT_EQ(cube.instances[0].world_from_mesh, Placement::Identity());
  const Eigen::Affine3d turned = Eigen::Translation3d(4, 0, 0) *
                                 Eigen::AngleAxisd(kPi<double> / 4, Vector3d::UnitZ()) *
                                 Eigen::Scaling(0.5);
  // A few roundings of double.
  EXPECT_TRUE(cube.instances[1].world_from_mesh.isApprox(turned.affine(), 1e-15));
  EXPECT_EQ(cube.instances[2].name, "mirrored");
  Placement mirrored;
  mirrored << -1, 0, 0, 8, 0, 1, 0, 0, 0, 0, 2, 1;
  EXPECT_EQ(cube.instances[2].world_from_mesh, mirrored);
  EXPECT_EQ(scene.meshes[1].name, "");
  EXPECT_EQ(scene.meshes[1].instances.size(), 1u);
  EXPECT_EQ(scene.meshes[2].role, SceneRole::occluder);
  ASSERT_TRUE(scene.ground);
  EXPECT_FALSE(scene.ground->height);
  EXPECT_EQ(scene.ground->size, 3);
  EXPECT_EQ(scene.ground->cells, 8);
}

TEST(SceneFile, ScalesThenTurnsThenMoves) {
  const SceneDescription scene = parse_scene(R"({
    "format": "burnish scene", "format_version": 1,
    "meshes": [{"file": "/a/b.obj", "instances": [
      {"translation": [1, 2, 3], "scale": [2, 3, 4],
       "rotation": {"axis": [0, 0, 0.1], "degrees": 90}}]}],
    "ground": {"height": -1.5}})",
                                             "x/y.scene.json");
  EXPECT_EQ(scene.meshes.at(0).file, "/a/b.obj");
  EXPECT_EQ(scene.up, UpAxis::y);
  EXPECT_EQ(scene.ground->height, -1.5);
  const Vector3d moved =
      scene.meshes[0].instances.at(0).world_from_mesh * Eigen::Vector4d(1, 1, 1, 1);
  // x: 2 turns to y; y: 3 turns to -x.
  EXPECT_TRUE(moved.isApprox(Vector3d(1 - 3, 2 + 2, 3 + 4), 1e-15)) << moved;
}

TEST(SceneFile, RelativePathsStartAtTheSceneFile) {
  const std::string json = R"({"format": "burnish scene", "format_version": 1,
                               "meshes": [{"file": "../m.obj"}]})";
  EXPECT_EQ(parse_scene(json, "a/b/c.json").meshes[0].file, "a/b/../m.obj");
  EXPECT_EQ(parse_scene(json, "c.json").meshes[0].file, "../m.obj");
}

TEST(SceneFile, RejectsEveryMalformedSample) {
  const struct {
    const char *name, *words;
    ErrorKind kind = ErrorKind::input;
  } cases[] = {
      {"other_format", "line 2, /format: 'burnish lights', expected 'burnish scene'"},
      {"newer_version", "scene format version 2, this build reads up to 1", ErrorKind::unsupported},
      {"no_meshes", "line 1, /: has no field 'meshes'"},
      {"empty_meshes", "line 4, /meshes: empty"},
      {"unknown_field", "line 5, /meshes/0/scale: unknown field, expected one of file, name,"},
      {"unknown_ground_field", "line 7, /ground/heigth: unknown field"},
      {"no_file", "line 5, /meshes/0: has no field 'file'"},
      {"empty_file", "line 5, /meshes/0/file: empty"},
      {"bad_role", "line 5, /meshes/0/role: 'shadow', expected receiver or occluder"},
      {"bad_up", "line 7, /up: 'Y', expected x, y or z"},
      {"only_occluders", "line 4, /meshes: all are occluders"},
      {"no_instances", "line 5, /meshes/0/instances: empty"},
      {"zero_scale", "line 5, /meshes/0/instances/0/scale: 0, expected more than 0"},
      {"negative_scale", "/meshes/0/instances/0/scale/1: -1, expected more than 0"},
      {"flat_scale", "line 5, /meshes/0/instances/0: flattens the mesh"},
      {"singular_matrix", "line 5, /meshes/0/instances/0/matrix: flattens the mesh"},
      {"short_matrix", "/meshes/0/instances/0/matrix: has 2 elements, expected 3"},
      {"matrix_and_scale", "/meshes/0/instances/0/scale: beside 'matrix'"},
      {"zero_axis", "/meshes/0/instances/0/rotation/axis: zero"},
      {"no_degrees", "/meshes/0/instances/0/rotation: has no field 'degrees'"},
      {"far_away", "/meshes/0/instances/0/translation/2: 1e+39"},
      {"same_name", "/meshes/0/instances/1/name: the name 'cube' occurs twice"},
      {"empty_name", "/meshes/0/name: empty"},
      {"missing_mesh", "line 5, /meshes/0/file: "},
      {"malformed_mesh", "line 5, /meshes/0/file: "},
      {"beyond_float", "line 5, /meshes/0/file: the map of 'cube.obj' takes vertex 1 beyond"},
      {"bad_height", "line 7, /ground/height: expected a number or \"auto\""},
      {"small_ground", "line 7, /ground/size: 0.5, expected 1..1000"},
      {"one_cell", "line 7, /ground/cells: 1, expected 2..4096"},
      {"half_cells", "line 7, /ground/cells: 2.5, expected an integer"},
      {"twice", "\"role\" occurs twice"},
  };
  std::set<std::string> named;
  for (const auto& bad : cases) {
    named.insert(bad.name + std::string(".scene.json"));
    const std::string path = scene_data("malformed/" + std::string(bad.name) + ".scene.json");
    const std::string error = error_of(
        path, [&] { load_scene(read_scene(path)); }, bad.kind);
    EXPECT_NE(error.find(bad.words), std::string::npos) << bad.name << ": " << error;
  }
  for (const auto& entry : std::filesystem::directory_iterator(scene_data("malformed")))
    EXPECT_TRUE(named.count(entry.path().filename().string())) << entry.path();
}

TEST(SceneFile, AMeshThatCannotBeReadIsNamed) {
  const std::string path = scene_data("malformed/missing_mesh.scene.json");
  const std::string error = error_of(path, [&] { load_scene(read_scene(path)); });
  EXPECT_NE(error.find("no_such.obj: cannot open"), std::string::npos) << error;
  const std::string other = scene_data("malformed/malformed_mesh.scene.json");
  const std::string mesh_error = error_of(other, [&] { load_scene(read_scene(other)); });
  EXPECT_NE(mesh_error.find("nan_coordinate.obj: line "), std::string::npos) << mesh_error;
  EXPECT_NE(error_of("no.scene.json", [] { read_scene("no.scene.json"); }), "");
}

TEST(SceneFile, EveryTruncationAndChangeIsRejectedOrRead) {
  expect_damage_is_refused_or_read(
      read_bytes(scene_data("cubes.scene.json")), 14,
      [](const std::string& json) { parse_scene(json, "cubes.scene.json"); });
}

}  // namespace
}  // namespace burnish::test
