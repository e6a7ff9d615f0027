#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "burnish/formats/mesh_file.h"
#include "formats/files.h"
#include "harness/draped_shapes.h"
#include "harness/procedural_scenes.h"
#include "harness/shapes.h"
#include "harness/surface_grid.h"
#include "harness/teapot.h"
#include "mesh_measures.h"

namespace burnish {
namespace {

Eigen::AlignedBox3f bounds(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& p : mesh.positions) box.extend(p);
  return box;
}

/// The triangles whose vertices have one of the materials below `count`.
TriangleMesh bodies(const ProceduralScene& scene, size_t count) {
  TriangleMesh mesh = scene.mesh;
  std::erase_if(mesh.triangles,
                [&](const Triangle& t) { return scene.material_id[t[0]] >= count; });
  return mesh;
}

TEST(PaperScenes, HaveTheVertexCountsOfThePaper) {
  const std::pair<const char*, double> counts[] = {
      {"dish", 25e3},   {"teapot", 54e3}, {"cylinder", 54e3},  {"dish-balls", 29e3},
      {"dragon", 46e3}, {"pillow", 6e3},  {"dish-card", 17e3}, {"cloth", 16e3}};
  for (const auto& [name, count] : counts)
    EXPECT_NEAR(double(make_scene(name).mesh.positions.size()) / count, 1, 0.05) << name;
}

TEST(PaperScenes, HaveClosedBodiesOnTheirFloor) {
  for (const char* name :
       {"dish", "teapot", "cylinder", "dish-balls", "dragon", "pillow", "dish-card", "cloth"}) {
    const ProceduralScene scene = make_scene(name);
    ASSERT_GE(scene.materials.size(), 2u) << name;
    const size_t floor = scene.materials.size() - 1;
    EXPECT_EQ(test::open_edges(bodies(scene, floor)), 0u) << name;
    EXPECT_GT(test::signed_volume(bodies(scene, floor)), 0) << name;
    float lowest = 1;
    for (size_t v = 0; v < scene.mesh.positions.size(); ++v) {
      const Vector3f& p = scene.mesh.positions[v];
      if (scene.material_id[v] != floor)
        lowest = std::min(lowest, p.y());
      else
        EXPECT_EQ(p.y(), 0) << name;
    }
    EXPECT_NEAR(lowest, 0.007, 0.0035) << name << ": the bodies stand but for a gap";
  }
}

TEST(PaperScenes, AreBrushedWhereThePaperIs) {
  for (const char* name : {"dish", "teapot", "cylinder", "dish-balls", "dish-card"}) {
    const Material material = make_scene(name).materials[0];
    EXPECT_NEAR(
        std::max(material.alpha_x, material.alpha_y) / std::min(material.alpha_x, material.alpha_y),
        10, 1e-4)
        << name;
  }
  EXPECT_EQ(make_scene("dish-balls").materials.size(), 6u) << "of different anisotropy each";
}

TEST(Teapot, HasThePublishedSize) {
  TriangleMesh mesh;
  append_teapot(mesh, 1, {24, 48});
  const Eigen::AlignedBox3f box = bounds(mesh);
  // The handle, the bottom and the pot reach published numbers; the spout 3.434, as in the meshes
  // that go about. A grid of 24 cells misses the top of a curve by 1e-3.
  EXPECT_NEAR(box.min().x(), -3, 1e-6);
  EXPECT_NEAR(box.max().x(), 3.434, 2e-3);
  EXPECT_NEAR(box.min().y(), 0, 1e-6);
  EXPECT_NEAR(box.max().y(), 3.15, 1e-6);
  EXPECT_NEAR(box.min().z(), -2, 1e-3);
  EXPECT_NEAR(box.max().z(), 2, 1e-3);
  TriangleMesh half;
  append_teapot(half, 0.5, {24, 48});
  ASSERT_EQ(half.positions.size(), mesh.positions.size());
  for (size_t v = 0; v < mesh.positions.size(); v += 97)
    EXPECT_LT((half.positions[v] - 0.5f * mesh.positions[v]).norm(), 1e-6f);
}

TEST(Teapot, IsClosedAtAnyFineness) {
  for (const TeapotCells cells : {TeapotCells{6, 8}, TeapotCells{7, 31}, TeapotCells{30, 30}}) {
    TriangleMesh mesh;
    append_teapot(mesh, 0.37, cells);
    EXPECT_EQ(test::open_edges(mesh), 0u) << cells.around << "," << cells.along;
  }
}

TEST(Teapot, HasTheVolumeOfItsProfile) {
  TriangleMesh mesh;
  append_teapot(mesh, 1, {32, 64});
  // The pot alone: its last vertex is the middle of its bottom, at the origin.
  std::uint32_t pot = 0;
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (mesh.positions[v].isZero()) pot = v + 1;
  ASSERT_GT(pot, 0u);
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return t[0] >= pot; });
  // Published radii and heights, three steps a patch; the ring between lid and rim is level.
  const std::array<std::pair<double, double>, 19> rows = {{{0, 3.15},
                                                           {0.8, 3.15},
                                                           {0, 2.85},
                                                           {0.2, 2.7},
                                                           {0.4, 2.55},
                                                           {1.3, 2.55},
                                                           {1.3, 2.4},
                                                           // the rim begins at radius 1.4
                                                           {1.3375, 2.53125},
                                                           {1.4375, 2.53125},
                                                           {1.5, 2.4},
                                                           {1.75, 1.875},
                                                           {2, 1.35},
                                                           {2, 0.9},
                                                           {2, 0.45},
                                                           {1.5, 0.225},
                                                           {1.5, 0.15},
                                                           {1.5, 0.075},
                                                           {1.425, 0},
                                                           {0, 0}}};
  // What a published quarter of a circle encloses, of radius 1.
  const auto quarter_area = [](double tangent) {
    double area = 0;
    Vector2<double> before(1, 0);
    for (int i = 1; i <= 2000; ++i) {
      const double t = i / 2000.0, s = 1 - t;
      const Vector2<double> at(s * s * s + 3 * s * s * t + 3 * s * t * t * tangent,
                               3 * s * s * t * tangent + 3 * s * t * t + t * t * t);
      area += (before.x() * at.y() - before.y() * at.x()) / 2;
      before = at;
    }
    return area;
  };
  const double area = 4 * quarter_area(0.56);
  double volume = 0;
  for (size_t p = 0; p < 6; ++p) {
    std::array<std::pair<double, double>, 4> patch;
    std::copy_n(rows.begin() + 3 * static_cast<std::ptrdiff_t>(p), 4, patch.begin());
    if (p == 2) patch[0] = {1.4, 2.4};
    const auto at = [&](double t) {
      const double s = 1 - t, w[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
      std::pair<double, double> sum = {0, 0};
      for (size_t i = 0; i < 4; ++i)
        sum = {sum.first + w[i] * patch[i].first, sum.second + w[i] * patch[i].second};
      return sum;
    };
    for (int i = 0; i < 4000; ++i) {
      const auto [r, ignored] = at((i + 0.5) / 4000);
      volume -= area * r * r * (at((i + 1) / 4000.0).second - at(i / 4000.0).second);
    }
  }
  // 32 cells a quarter lack pi^2 / (6 x 64^2) = 4e-4, 64 along at most that again; the knob's row
  // of .5625 instead of .56 adds 1e-5.
  EXPECT_NEAR(test::signed_volume(mesh) / volume, 1, 1e-3);
}

TEST(Teapot, AgreesWithAMeshThatGoesAbout) {
  const std::string path = (test::shared_data() / "meshes/teapot.obj").string();
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const TriangleMesh other = read_mesh(path);
  TriangleMesh mesh;
  append_teapot(mesh, 1, {48, 96});
  double worst = 0;
  for (const Vector3f& p : other.positions) {
    size_t nearest = 0;
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      if ((mesh.positions[v] - p).squaredNorm() < (mesh.positions[nearest] - p).squaredNorm())
        nearest = v;
    ASSERT_LT((mesh.positions[nearest] - p).norm(), 0.15f);
    worst =
        std::max(worst, std::abs(double(mesh.normals[nearest].dot(p - mesh.positions[nearest]))));
  }
  // Half a cell off a surface, the more the more it is bent: most at the lip of the spout.
  EXPECT_LT(worst, 0.01) << "and 0.027 with cells twice as large";
}

TEST(Shapes, CylinderIsClosedAndHasItsVolume) {
  TriangleMesh mesh;
  append_cylinder(mesh, 0.5, 1.2, 0.1, {5, 12, 10}, 256);
  EXPECT_EQ(test::open_edges(mesh), 0u);
  const Eigen::AlignedBox3f box = bounds(mesh);
  EXPECT_NEAR(box.min().y(), 0, 1e-6);
  EXPECT_NEAR(box.max().y(), 1.2, 1e-6);
  EXPECT_NEAR(box.max().z(), 0.5, 1e-6);
  // Pappus: each rounded edge lacks the area b^2 (1 - pi / 4), whose middle is at b (1 - (10 - 3
  // pi) / (12 - 3 pi)) from the inner radius.
  const double pi = kPi<double>, b = 0.1;
  const double middle = 0.5 - b + b * (1 - (10 - 3 * pi) / (12 - 3 * pi));
  const double volume = pi * 0.25 * 1.2 - 2 * (2 * pi * middle) * b * b * (1 - pi / 4);
  // The polygon of 256 lacks 1.0e-4; the roundings' chords 2.9e-3 of quarter circles: 1.4e-4.
  EXPECT_NEAR(test::signed_volume(mesh) / volume, 1 - 2.4e-4, 2e-5);
}

TEST(Shapes, SheetIsClosedAndHasTheVolumeOfItsMiddle) {
  // A quarter of a hollow cylinder of mean radius 0.5, height 2, thickness 0.2: mean area x
  // thickness.
  TriangleMesh mesh;
  append_sheet(mesh,
               [](double u, double v) {
                 const double angle = kPi<double> / 2 * u;
                 return Vector3d(0.5 * std::sin(angle), -2 * v, 0.5 * std::cos(angle));
               },
               0.2, {90, 3});
  EXPECT_EQ(test::open_edges(mesh), 0u);
  // Chords of 1 degree lack 5e-5. The parameters turn so that du x dv points away from the axis.
  EXPECT_NEAR(std::abs(test::signed_volume(mesh)) / (kPi<double> / 4 * 2 * 0.2), 1, 1e-4);
  EXPECT_GT(test::signed_volume(mesh), 0) << "normals point outward";
}

TEST(Shapes, SurfaceGridHasTheNormalsAndTangentsOfItsSurface) {
  TriangleMesh mesh;
  const Surface torus = [](double u, double v) -> Vector3d {
    const double a = 2 * kPi<double> * u, b = 2 * kPi<double> * v;
    return {(1 + 0.3 * std::cos(b)) * std::cos(a), (1 + 0.3 * std::cos(b)) * std::sin(a),
            0.3 * std::sin(b)};
  };
  append_surface(mesh, torus, {64, 32, true, true});
  EXPECT_EQ(mesh.positions.size(), 64u * 32u);
  EXPECT_EQ(test::open_edges(mesh), 0u);
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Vector3f& p = mesh.positions[i];
    const Vector3f ring = Vector3f(p.x(), p.y(), 0).normalized();
    EXPECT_LT((mesh.normals[i] - (p - ring) / 0.3f).norm(), 2e-6f) << i;
    EXPECT_LT((mesh.tangents[i] - Vector3f(-ring.y(), ring.x(), 0)).norm(), 2e-6f) << i;
  }
  // 2 pi^2 R r^2; chords lack 2 pi^2 / (3 x 32^2) and a quarter of that.
  EXPECT_NEAR(test::signed_volume(mesh) / (2 * kPi<double> * kPi<double> * 0.09), 1, 9e-3);
}

TEST(Shapes, DrapedShapesAreClosedAtAnyFineness) {
  for (const int cells : {9, 16, 31}) {
    TriangleMesh pillow, card, cloth;
    append_pillow(pillow, 0.7, 0.2, cells);
    append_card(card, 0.6, 0.95, 0.01, cells, cells + 3);
    append_draped_cloth(cloth, 0.01, cells);
    EXPECT_EQ(test::open_edges(pillow), 0u) << cells;
    EXPECT_EQ(test::open_edges(card), 0u) << cells;
    EXPECT_EQ(test::open_edges(cloth), 0u) << cells;
  }
}

TEST(Shapes, PillowHasTheVolumeOfItsBulge) {
  TriangleMesh mesh;
  append_pillow(mesh, 1, 0.4, 80);
  // By the midpoint rule over s and t: bulge times the Jacobian of the drawn-in sides.
  double volume = 0;
  const int steps = 400;
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const double s = 2 * (i + 0.5) / steps - 1, t = 2 * (j + 0.5) / steps - 1;
      const double bulge = (1 - s * s) * (1 - t * t);
      const double pucker = 1 + 0.07 * std::cos(9 * s) * std::cos(9 * t + 1);
      const double jacobian =
          (1 - 0.13 * (1 - t * t)) * (1 - 0.13 * (1 - s * s)) - 0.26 * s * t * 0.26 * s * t;
      volume += 0.4 * bulge * pucker * jacobian * 4 / (steps * steps);
      const double below = 1 + 0.07 * std::cos(-9 * s) * std::cos(9 * t + 1);
      volume += 0.2 * bulge * below * jacobian * 4 / (steps * steps);
    }
  // Chords of the bulge: a second difference of h^2 / 8 x 2, h = 1/40, of a height of 4/9: 1e-3.
  EXPECT_NEAR(test::signed_volume(mesh) / volume, 1, 2e-3);
}

}  // namespace
}  // namespace burnish
