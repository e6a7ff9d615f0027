#include "harness/procedural_scenes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "harness/primary_hits.h"
#include "harness/shapes.h"
#include "mesh_measures.h"

namespace burnish {
namespace {

class EachScene : public testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(ProceduralScenes, EachScene, testing::ValuesIn(scene_names()),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

Vector3d triangle_cross(const TriangleMesh& mesh, const Triangle& triangle) {
  const Vector3d a = mesh.positions[triangle[0]].cast<double>();
  const Vector3d b = mesh.positions[triangle[1]].cast<double>();
  const Vector3d c = mesh.positions[triangle[2]].cast<double>();
  return (b - a).cross(c - a);
}

TEST_P(EachScene, HasConsistentArrays) {
  const ProceduralScene scene = make_scene(GetParam());
  const TriangleMesh& mesh = scene.mesh;
  const size_t count = mesh.positions.size();
  EXPECT_EQ(scene.name, GetParam());
  EXPECT_EQ(mesh.name, GetParam());
  ASSERT_GT(count, 0u);
  EXPECT_EQ(mesh.normals.size(), count);
  EXPECT_EQ(mesh.tangents.size(), count);
  EXPECT_EQ(mesh.file_vertex.size(), count);
  EXPECT_EQ(scene.material_id.size(), count);
  ASSERT_FALSE(scene.materials.empty());
  for (size_t i = 0; i < count; ++i) {
    ASSERT_EQ(mesh.file_vertex[i], i);
    ASSERT_LT(scene.material_id[i], scene.materials.size());
  }
  std::set<std::uint32_t> used;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t index : t) {
      ASSERT_LT(index, count);
      used.insert(index);
    }
    EXPECT_EQ(scene.material_id[t[0]], scene.material_id[t[1]]);
    EXPECT_EQ(scene.material_id[t[0]], scene.material_id[t[2]]);
  }
  EXPECT_EQ(used.size(), count) << "every vertex belongs to a triangle";
  for (const Material& material : scene.materials) {
    EXPECT_TRUE((material.diffuse >= 0).all() && (material.diffuse <= 1).all());
    EXPECT_GE(material.alpha_x, kMinAlpha);
    EXPECT_LE(material.alpha_y, kMaxAlpha);
  }
}

TEST_P(EachScene, HasOrthonormalFramesAndSoundTriangles) {
  const TriangleMesh mesh = make_scene(GetParam()).mesh;
  // A handful of float roundings each.
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    ASSERT_TRUE(mesh.positions[i].allFinite()) << i;
    ASSERT_NEAR(mesh.normals[i].norm(), 1, 1e-6) << i;
    ASSERT_NEAR(mesh.tangents[i].norm(), 1, 1e-6) << i;
    ASSERT_NEAR(mesh.normals[i].dot(mesh.tangents[i]), 0, 1e-6) << i;
  }
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vector3d cross = triangle_cross(mesh, t);
    double longest = 0;
    for (int i = 0; i < 3; ++i)
      longest = std::max(
          longest, double((mesh.positions[t[i]] - mesh.positions[t[(i + 1) % 3]]).squaredNorm()));
    // Height over longest edge; the thinnest on purpose are the segments of the poles' fans.
    ASSERT_GT(cross.norm() / longest, 0.01) << "triangle " << f << " is degenerate";
    for (const std::uint32_t v : t)
      ASSERT_GT(cross.normalized().dot(mesh.normals[v].cast<double>()), 0.8)
          << "triangle " << f << ": normal of vertex " << v << " does not match the surface";
  }
}

TEST_P(EachScene, IsInFrontOfItsCamera) {
  const ProceduralScene scene = make_scene(GetParam());
  const Vector3f forward = (scene.camera.target - scene.camera.origin).normalized();
  EXPECT_TRUE(forward.allFinite());
  float nearest = std::numeric_limits<float>::infinity();
  for (const Vector3f& p : scene.mesh.positions)
    nearest = std::min(nearest, (p - scene.camera.origin).norm());
  EXPECT_GT(nearest, 0.1f) << "the camera is not inside an object";
}

TEST_P(EachScene, ShowsItsFirstMaterialInTheMiddleOfThePicture) {
  const ProceduralScene scene = make_scene(GetParam());
  Transfer transfer;
  transfer.positions = scene.mesh.positions;
  transfer.normals = scene.mesh.normals;
  transfer.tangents = scene.mesh.tangents;
  transfer.triangles = scene.mesh.triangles;
  const PrimaryHits hits = trace_primary_rays(SceneRays(transfer), {scene.camera, 48, 32, 1});
  size_t first = 0, front = 0, all = 0;
  for (const PrimaryHit& hit : hits.hits) {
    if (hit.triangle == PrimaryHit::kMiss) continue;
    ++all;
    first += scene.material_id[scene.mesh.triangles[hit.triangle][0]] == 0;
    front += surface_point(transfer, hit, scene.camera.origin).front;
  }
  EXPECT_GT(double(all), 0.4 * 48 * 32);
  EXPECT_GT(double(first), 0.05 * 48 * 32) << "what the scene is for is not a speck";
  EXPECT_EQ(front, all) << "nothing is seen from behind";
}

TEST(ProceduralScenes, HaveTheStatedSizes) {
  EXPECT_NEAR(double(make_scene("dish").mesh.positions.size()), 25000, 500);
  EXPECT_EQ(make_scene("knot").mesh.positions.size(), 54000u);
  EXPECT_NEAR(double(make_scene("sphere").mesh.positions.size()), 6000, 300);
}

TEST(ProceduralScenes, UnknownNameIsAnErrorThatListsTheKnown) {
  try {
    make_scene("dishes");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    const std::string text = error.what();
    EXPECT_EQ(text.find("dishes: "), 0u) << text;
    EXPECT_NE(text.find("dish, sphere, plane, wall, knot"), std::string::npos) << text;
  }
}

TEST(Shapes, DishIsClosedAndHasTheVolumeOfItsProfile) {
  TriangleMesh mesh;
  const double thickness = 0.03;
  append_dish(mesh, 0.004, thickness, 160);
  EXPECT_EQ(test::open_edges(mesh), 0u);
  float bottom = 1, outer = 0;
  for (const Vector3f& p : mesh.positions) {
    bottom = std::min(bottom, p.y());
    outer = std::max(outer, std::hypot(p.x(), p.z()));
  }
  EXPECT_NEAR(bottom, 0.004, 1e-6);
  EXPECT_NEAR(outer, 1.0, 1e-6);
  // An offset body's volume is thickness x middle surface (Steiner; the curvature terms of the two
  // sides cancel to third order in the thickness), plus half a torus of section radius t / 2 at the
  // rim: 2 pi (r + 4 (t/2) / (3 pi)) x pi (t/2)^2 / 2. The polygons lack 2.6e-4 (160 segments) and
  // about 1e-3 (rings); the third-order term is below 1e-3.
  const double rim = 1 - thickness / 2;
  double area = 0;
  const int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double r = rim * (i + 0.5) / steps;
    const double x = std::clamp((r - 0.45) / 0.45, 0.0, 1.0);
    area += 2 * kPi<double> * r * std::hypot(1.0, 0.2 * 30 * x * x * (1 - x) * (1 - x) / 0.45) *
            rim / steps;
  }
  const double half = thickness / 2;
  const double expected = thickness * area + 2 * kPi<double> *
                                                 (rim + 4 * half / (3 * kPi<double>)) *
                                                 kPi<double> * half * half / 2;
  EXPECT_NEAR(test::signed_volume(mesh) / expected, 1, 3e-3);
}

TEST(Shapes, SphereIsClosedAndHasItsVolume) {
  TriangleMesh mesh;
  append_sphere(mesh, Vector3f(1, 2, 3), 0.5, 96, 48);
  EXPECT_EQ(test::open_edges(mesh), 0u);
  // An inscribed mesh of step h lacks about h^2 / 4 in each direction: 2 x 1.1e-3 at h = 2 pi / 96.
  EXPECT_NEAR(test::signed_volume(mesh) / (4 * kPi<double> / 3 * 0.125), 1, 3e-3);
  for (size_t i = 0; i < mesh.positions.size(); ++i)
    EXPECT_LT((mesh.positions[i] - Vector3f(1, 2, 3) - 0.5f * mesh.normals[i]).norm(), 1e-6f);
}

TEST(Shapes, TorusKnotIsClosedAndHasTheVolumeOfItsTube) {
  TriangleMesh mesh;
  append_torus_knot(mesh, Vector3f::Zero(), 1.0, 0.4, 0.18, 1100, 40);
  EXPECT_EQ(test::open_edges(mesh), 0u);
  // A tube's volume is section x length of its middle curve (Pappus, for any closed curve).
  double length = 0;
  const int steps = 20000;
  for (int i = 0; i < steps; ++i) {
    const double t = 2 * kPi<double> * (i + 0.5) / steps;
    length += std::hypot(1.2, 2 * (1 + 0.4 * std::cos(3 * t))) * 2 * kPi<double> / steps;
  }
  // 40 segments lack 4.1e-3 of the section.
  EXPECT_NEAR(test::signed_volume(mesh) / (kPi<double> * 0.18 * 0.18 * length), 1, 6e-3);
}

TEST(Shapes, PolesHaveTheTangentOfEachSegment) {
  TriangleMesh mesh;
  append_dish(mesh, 0.0, 0.03, 160);
  int poles = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    if (mesh.positions[i].x() != 0 || mesh.positions[i].z() != 0) continue;
    ++poles;
    for (const Triangle& t : mesh.triangles) {
      if (t[0] != i && t[1] != i && t[2] != i) continue;
      const Vector3f middle =
          (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
      const Vector3f radial = Vector3f(middle.x(), 0, middle.z()).normalized();
      EXPECT_NEAR(std::abs(radial.dot(mesh.tangents[i])), 1, 1e-5) << i;
    }
  }
  EXPECT_EQ(poles, 320);
}

}  // namespace
}  // namespace burnish
