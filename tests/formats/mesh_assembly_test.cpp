#include "burnish/formats/mesh_assembly.h"

#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "burnish/sphere/frame.h"
#include "mesh_test_support.h"

namespace burnish::test {
namespace {

TriangleMesh cube() { return load(mesh_data("cube.obj")).mesh; }

/// A random map whose stretches lie within 1/4..4, mirroring or not.
Placement random_placement(std::mt19937& random, bool mirrors) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto rotation = [&] {
    return Eigen::Quaterniond(uniform(random), uniform(random), uniform(random), uniform(random))
        .normalized()
        .toRotationMatrix();
  };
  Vector3d stretch;
  for (int i = 0; i < 3; ++i) stretch[i] = std::pow(4, uniform(random));
  if (mirrors) stretch.x() = -stretch.x();
  Placement placement;
  placement.leftCols<3>() = rotation() * stretch.asDiagonal() * rotation();
  placement.col(3) = 10 * Vector3d(uniform(random), uniform(random), uniform(random));
  return placement;
}

void expect_frames(const TriangleMesh& mesh) {
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    // 1e-6: a unit vector rounded to float.
    ASSERT_NEAR(mesh.normals[v].norm(), 1, 1e-6);
    ASSERT_NEAR(mesh.tangents[v].norm(), 1, 1e-6);
    ASSERT_NEAR(mesh.normals[v].dot(mesh.tangents[v]), 0, 1e-6);
  }
}

void expect_parts_cover(const TriangleMesh& mesh) {
  std::uint32_t vertex = 0, triangle = 0;
  for (const MeshPart& part : mesh.parts) {
    EXPECT_EQ(part.first_vertex, vertex) << part.name;
    EXPECT_EQ(part.first_triangle, triangle) << part.name;
    vertex += part.vertices;
    for (std::uint32_t t = triangle; t < triangle + part.triangles; ++t)
      for (const std::uint32_t v : mesh.triangles[t]) {
        EXPECT_GE(v, part.first_vertex);
        EXPECT_LT(v, vertex);
      }
    triangle += part.triangles;
  }
  EXPECT_EQ(vertex, mesh.positions.size());
  EXPECT_EQ(triangle, mesh.triangles.size());
}

TEST(PlaceMesh, MovesPositionsAndPlanesAsEigenDoes) {
  constexpr unsigned kSeed = 5;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const TriangleMesh mesh = cube();
  for (int i = 0; i < 50; ++i) {
    const Placement placement = random_placement(random, i % 2 == 1);
    const TriangleMesh placed = place_mesh(mesh, placement);
    expect_frames(placed);
    Eigen::Affine3d affine;
    affine.affine() = placement;
    affine.makeAffine();
    for (size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vector3d truth = affine * mesh.positions[v].cast<double>();
      // Half a float step at coordinates below 64.
      ASSERT_TRUE(placed.positions[v].cast<double>().isApprox(truth, 1e-6));
      // The plane through the vertex goes where its points go.
      const Vector3d a = frame_from_axis<double>(mesh.normals[v].cast<double>()).x;
      const Vector3d b = mesh.normals[v].cast<double>().cross(a);
      const Vector3d normal =
          (affine.linear() * a).cross(affine.linear() * b).normalized() * (i % 2 == 1 ? -1 : 1);
      ASSERT_NEAR((placed.normals[v].cast<double>() - normal).norm(), 0, 1e-6);
      const Vector3d tangent = (affine.linear() * mesh.tangents[v].cast<double>()).normalized();
      ASSERT_NEAR((placed.tangents[v].cast<double>() - tangent).norm(), 0, 1e-6);
    }
    EXPECT_EQ(placed.file_vertex, mesh.file_vertex);
    // The volume by its sign: outward still, mirrored or not. 1e-5: float corners.
    const double volume = signed_volume(mesh) * std::abs(affine.linear().determinant());
    EXPECT_NEAR(signed_volume(placed) / volume, 1, 1e-5);
  }
}

TEST(PlaceMesh, MirroredTrianglesRunTheWayOfTheirNormals) {
  const TriangleMesh mesh = load(mesh_data("cube_hard_edges.obj")).mesh;
  Placement mirror = Placement::Identity();
  mirror(1, 1) = -2;
  const TriangleMesh placed = place_mesh(mesh, mirror);
  for (const Triangle& t : placed.triangles) {
    const Vector3f across = (placed.positions[t[1]] - placed.positions[t[0]])
                                .cross(placed.positions[t[2]] - placed.positions[t[0]]);
    for (const std::uint32_t v : t) EXPECT_GT(across.dot(placed.normals[v]), 0);
  }
}

TEST(PlaceMesh, TheIdentityKeepsEveryByte) {
  const TriangleMesh mesh = load(mesh_data("cube_hard_edges.obj")).mesh;
  const TriangleMesh placed = place_mesh(mesh, Placement::Identity());
  EXPECT_EQ(placed.positions, mesh.positions);
  EXPECT_EQ(placed.normals, mesh.normals);
  EXPECT_EQ(placed.tangents, mesh.tangents);
  EXPECT_EQ(placed.triangles, mesh.triangles);
}

TEST(PlaceMesh, WorksAtExtremeScales) {
  const TriangleMesh mesh = cube();
  for (const double scale : {1e-30, 1e30}) {
    Placement placement = Placement::Identity();
    placement.leftCols<3>() *= scale;
    const TriangleMesh placed = place_mesh(mesh, placement);
    expect_frames(placed);
    EXPECT_NEAR(placed.positions[0].x(), mesh.positions[0].x() * scale, 1e-6 * scale);
  }
}

TEST(AssembleScene, EveryInstanceIsAPartOfItsOwn) {
  const SceneDescription scene =
      read_scene(std::string(BURNISH_TEST_DATA) + "/scene/cubes.scene.json");
  std::vector<std::string> read;
  const SceneMeshes meshes = load_scene(scene, {}, [&](const SceneMesh& m, const MeshReport& r) {
    read.push_back(r.format);
    EXPECT_FALSE(m.file.empty());
  });
  EXPECT_EQ(read.size(), 3u);
  const TriangleMesh& receiver = meshes.receiver;
  EXPECT_EQ(receiver.name, "cubes");
  std::vector<std::string> names;
  for (const MeshPart& part : receiver.parts) names.push_back(part.name);
  EXPECT_EQ(names, (std::vector<std::string>{"cube", "cube #2", "mirrored", "cube.ply", "ground"}));
  expect_parts_cover(receiver);
  expect_frames(receiver);
  EXPECT_EQ(receiver.triangles.size(), 4 * 12 + 2 * 8 * 8u);
  ASSERT_EQ(meshes.occluders.size(), 1u);
  EXPECT_EQ(meshes.occluders[0].name, "cube.off");
  EXPECT_NEAR(signed_volume(meshes.occluders[0]), 8 * 3 * 3 * 0.1, 1e-5);

  // The lowest cubes reach down to z = -1. The ground's gap: 2^-13 of the scene's size; that is
  // the ground's edge, 3 times the receivers' extent along x, -1..9.
  const MeshPart& ground = receiver.parts.back();
  for (std::uint32_t v = 0; v < ground.vertices; ++v) {
    const Vector3f& p = receiver.positions[ground.first_vertex + v];
    EXPECT_NEAR(p.z(), -1 - 30.0 / 8192, 1e-6);
    EXPECT_EQ(receiver.normals[ground.first_vertex + v], Vector3f::UnitZ());
    EXPECT_LE(std::abs(p.x() - 4), 15.0001f);
  }
}

TEST(AssembleScene, NamesDoNotRepeat) {
  SceneDescription scene;
  scene.path = "s.scene.json";
  SceneMesh a;
  a.file = "models/a.obj";
  a.instances = {{}, {}, {"a.obj #2", Placement::Identity()}};
  scene.meshes = {a, a};
  scene.meshes[1].instances.resize(1);
  scene.meshes.push_back(a);
  scene.meshes[2].name = "ground";
  scene.meshes[2].instances.resize(1);
  scene.ground.emplace();
  const std::vector<TriangleMesh> meshes(3, cube());
  const SceneMeshes assembled = assemble_scene(scene, meshes);
  std::vector<std::string> names;
  for (const MeshPart& part : assembled.receiver.parts) names.push_back(part.name);
  EXPECT_EQ(names, (std::vector<std::string>{"a.obj", "a.obj #3", "a.obj #2", "a.obj #4", "ground",
                                             "ground #2"}));
  EXPECT_EQ(assembled.receiver.name, "s.scene.json");
}

TEST(AssembleScene, PartsWithoutUvsGetZeros) {
  TriangleMesh with = cube(), without = cube();
  with.uvs.assign(with.positions.size(), Eigen::Vector2f(3, 4));
  TriangleMesh scene;
  append_part(scene, without, "first");
  append_part(scene, with, "second");
  append_part(scene, without, "third");
  ASSERT_EQ(scene.uvs.size(), 24u);
  for (size_t v = 0; v < 24; ++v)
    EXPECT_EQ(scene.uvs[v], v / 8 == 1 ? Eigen::Vector2f(3, 4) : Eigen::Vector2f(0, 0));
  expect_parts_cover(scene);
}

TEST(AssembleScene, AMeshWithoutPartsBecomesOne) {
  TriangleMesh scene = cube();
  append_part(scene, cube(), "second");
  ASSERT_EQ(scene.parts.size(), 2u);
  EXPECT_EQ(scene.parts[0].name, "cube.obj");
  expect_parts_cover(scene);
}

TEST(AssembleScene, MoreVerticesThanIndicesAreRefusedBeforeTheyAreMade) {
  SceneDescription scene;
  scene.path = "large.scene.json";
  scene.meshes.resize(1);
  TriangleMesh mesh;
  mesh.positions.resize(1 << 20, Vector3f::Zero());
  scene.meshes[0].instances.resize(1 << 12);  // 2^32 together
  const std::string error =
      error_of(scene.path, [&] { assemble_scene(scene, std::span(&mesh, 1)); });
  EXPECT_NE(error.find("4294967296 vertices and 0 triangles"), std::string::npos) << error;
}

TEST(AssembleScene, MapsThatFlattenAreRefused) {
  SceneDescription scene;
  scene.path = "flat.scene.json";
  scene.meshes.resize(1);
  scene.meshes[0].place = "line 3, /meshes/0/file";
  scene.meshes[0].name = "flat";
  scene.meshes[0].instances[0].world_from_mesh.col(1).setZero();
  const TriangleMesh mesh = cube();
  EXPECT_EQ(error_of(scene.path, [&] { assemble_scene(scene, std::span(&mesh, 1)); }),
            "flat.scene.json: line 3, /meshes/0/file: the map of 'flat' flattens it");
}

TEST(AssembleScene, AGroundNeedsSomethingToStandOnIt) {
  SceneDescription scene;
  scene.path = "empty.scene.json";
  scene.meshes.resize(1);
  scene.ground.emplace();
  const TriangleMesh mesh;
  EXPECT_NE(error_of(scene.path, [&] { assemble_scene(scene, std::span(&mesh, 1)); }), "");
}

TEST(AssembleScene, AGroundLiesUnderOccluders) {
  SceneDescription scene;
  scene.meshes.resize(1);
  scene.meshes[0].role = SceneRole::occluder;
  scene.ground = {.height = -7.0, .size = 2, .cells = 4};
  const TriangleMesh mesh = cube();
  const SceneMeshes assembled = assemble_scene(scene, std::span(&mesh, 1));
  EXPECT_EQ(assembled.receiver.parts.size(), 1u);
  EXPECT_EQ(assembled.receiver.positions.size(), 25u);
  for (const Vector3f& p : assembled.receiver.positions) EXPECT_EQ(p.y(), -7);
}

TEST(GroundPlane, IsASquareThatFacesUp) {
  const Eigen::AlignedBox3f bounds(Vector3f(1, 2, 3), Vector3f(5, 3, 6));
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z}) {
    const TriangleMesh mesh = ground_plane(bounds, up, -2, {.height = {}, .size = 3, .cells = 16});
    const auto axis = static_cast<Eigen::Index>(up);
    const double edge = 3 * (up == UpAxis::x ? 3 : 4);
    EXPECT_NEAR(surface_area(mesh), edge * edge, 1e-4);  // 512 triangles of float corners
    expect_frames(mesh);
    Vector3f middle = Vector3f(3, 2.5f, 4.5f);
    middle[axis] = -2;
    EXPECT_TRUE(mesh.positions[8 * 17 + 8].isApprox(middle, 1e-6f));
    double smallest = edge;
    for (const Triangle& t : mesh.triangles) {
      const Vector3f across = (mesh.positions[t[1]] - mesh.positions[t[0]])
                                  .cross(mesh.positions[t[2]] - mesh.positions[t[0]]);
      EXPECT_GT(across[axis], 0);
      smallest = std::min(smallest, double((mesh.positions[t[1]] - mesh.positions[t[0]]).norm()));
    }
    // A quarter of an even grid's cells; the fourth power of an eighth is all that is added.
    EXPECT_NEAR(smallest, edge / 16 / 4, edge / 16 * 1e-3);
    const TriangleMesh again = ground_plane(bounds, up, -2, {.height = {}, .size = 3, .cells = 16});
    EXPECT_EQ(again.positions, mesh.positions);
  }
}

}  // namespace
}  // namespace burnish::test
