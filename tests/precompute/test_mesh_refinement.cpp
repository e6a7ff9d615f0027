#include <map>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/mesh_statistics.h"
#include "burnish/precompute/mesh_refinement.h"
#include "burnish/sphere/octahedral_map.h"
#include "precompute/refinement_support.h"

namespace burnish::test {
namespace {

/// Whether a point sees a direction, above its horizon or not: single rays, another code path.
struct View {
  std::vector<int> above, visible;
};
View look(const RayScene& scene, const Vector3f& position, const Vector3f& normal) {
  View view;
  const Vector3f origin = position + scene.origin_offset() * normal;
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 32; ++x) {
      const Vector3f d = octahedral_texel_direction<double>(x, y, 32).cast<float>();
      view.above.push_back(d.dot(normal) > 0);
      view.visible.push_back(d.dot(normal) > 0 &&
                             !scene.occluded(origin, d, std::numeric_limits<float>::infinity()));
    }
  return view;
}
double difference(const View& a, const View& b) {
  int common = 0, different = 0;
  for (size_t i = 0; i < a.above.size(); ++i)
    if (a.above[i] && b.above[i]) {
      ++common;
      different += a.visible[i] != b.visible[i];
    }
  return common == 0 ? 0 : double(different) / common;
}

TEST(Density, MatchesSingleRays) {
  const TriangleMesh floor = make_floor(1), box = make_box({-0.3f, -0.2f, 0.1f}, {1, 0.5f, 1});
  TriangleMesh fine = floor;
  subdivide_long_edges(fine, 0.5);
  const RayScene scene = scene_of({fine, box});
  const DensityReport report = check_density(fine, scene, 0.15, 0, 1000);
  ASSERT_EQ(report.triangles, fine.triangles.size());
  std::vector<View> views;
  for (size_t v = 0; v < fine.positions.size(); ++v)
    views.push_back(look(scene, fine.positions[v], fine.normals[v]));
  std::map<std::uint32_t, float> worst;
  for (const DensityReport::Triangle& t : report.worst) worst[t.triangle] = t.difference;
  std::uint64_t exceeding = 0;
  for (std::uint32_t t = 0; t < fine.triangles.size(); ++t) {
    const Triangle& c = fine.triangles[t];
    const double largest =
        std::max({difference(views[c[0]], views[c[1]]), difference(views[c[1]], views[c[2]]),
                  difference(views[c[2]], views[c[0]])});
    // A few rays of 512 may graze an edge of the box on either side.
    const double slack = 0.01;
    if (std::abs(largest - 0.15) < slack) continue;
    EXPECT_EQ(worst.count(t), largest > 0.15) << t;
    if (largest > 0.15) {
      EXPECT_NEAR(worst[t], largest, slack);
    }
    exceeding += largest > 0.15;
  }
  EXPECT_GT(exceeding, 5u);
  EXPECT_GE(report.exceeding, exceeding);
  EXPECT_NEAR(report.exceeding_area, double(report.exceeding) / double(report.triangles), 1e-6)
      << "all triangles are equally large";
  for (size_t i = 1; i < report.worst.size(); ++i)
    EXPECT_GE(report.worst[i - 1].difference, report.worst[i].difference);
}

TEST(Density, NextToAWallHalfOfTheViewIsGone) {
  // From a corner at its foot a wall of 2000 x 1000 fills half of the hemisphere; from 1e5 away,
  // 1e-4 of it.
  TriangleMesh floor;
  floor.positions = {{0.1f, 0, 0}, {1e5f, -10, 0}, {1e5f, 10, 0}};
  floor.normals.assign(3, Vector3f::UnitZ());
  floor.triangles = {{0, 1, 2}};
  complete(floor);
  TriangleMesh wall;
  add_quad(wall, {0, -1000, -10}, {0, 2000, 0}, {0, 0, 1000});
  complete(wall);
  RayScene scene = scene_of({floor, wall});
  const DensityReport report = check_density(floor, scene, 0.2, 1e-3);
  ASSERT_EQ(report.exceeding, 1u);
  // The map's axes run along the wall: a row of 32 texels of 1024 lies on its edge.
  EXPECT_NEAR(report.worst[0].difference, 0.5, 0.04);
  EXPECT_NEAR(report.exceeding_area, 1, 1e-12);
}

TEST(Density, IgnoresWhatCannotBeBaked) {
  TriangleMesh mesh = make_floor(1);
  mesh.normals[0] = Vector3f::Zero();
  mesh.positions.push_back({kNan, 0, 0});
  mesh.normals.push_back(Vector3f::UnitZ());
  mesh.triangles.push_back({1, 2, 4});
  mesh.triangles.push_back({1, 1, 2});
  complete(mesh);
  const DensityReport report = check_density(mesh, scene_of({mesh}));
  EXPECT_EQ(report.triangles, 0u);
  EXPECT_EQ(report.mean_difference, 0);
}

TEST(Refinement, ResolvesTheShadowOfASmallBlocker) {
  // All corners of the floor's two triangles see the same: only the middle of an edge tells.
  const TriangleMesh box = make_box({-0.1f, -0.1f, 0.02f}, {0.2f, 0.2f, 0.2f});
  TriangleMesh floor = make_floor(2);
  const TriangleMesh before = floor;
  const RayScene scene = scene_of({floor, box});
  ASSERT_EQ(check_density(floor, scene, 0.1).exceeding, 0u);
  const RefinementOptions options{.max_difference = 0.1, .min_edge = 0.02};
  const RefinementReport report = refine_by_visibility(floor, scene, options);
  EXPECT_GT(report.added_vertices, 100u);
  EXPECT_LT(report.added_vertices, 10000u);
  EXPECT_FALSE(report.out_of_vertices);
  EXPECT_NEAR(surface_area(floor), surface_area(before), 1e-5);
  EXPECT_FALSE(has_t_junction(floor));
  EXPECT_EQ(euler_characteristic(floor), 1);
  expect_frames(floor);
  // rivara1984: half of the smallest angle there was; 1e-6 for float corners.
  EXPECT_GE(smallest_angle(floor), smallest_angle(before) / 2 - 1e-6);

  // What was to be resolved is: by single rays.
  std::vector<View> views;
  for (size_t v = 0; v < floor.positions.size(); ++v)
    views.push_back(look(scene, floor.positions[v], floor.normals[v]));
  std::uint64_t left = 0, edges = 0;
  std::set<std::pair<std::uint32_t, std::uint32_t>> seen;
  for (const Triangle& t : floor.triangles)
    for (size_t k = 0; k < 3; ++k) {
      const auto edge = std::minmax(t[k], t[(k + 1) % 3]);
      if (!seen.insert({edge.first, edge.second}).second) continue;
      const double length = (floor.positions[edge.first] - floor.positions[edge.second]).norm();
      ++edges;
      const double found = difference(views[edge.first], views[edge.second]);
      // 0.01: rays that graze an edge of the box.
      if (length >= 2 * options.min_edge * (1 + 1e-6)) {
        EXPECT_LE(found, 0.1 + 0.01) << length;
      }
      left += found > 0.1;
    }
  EXPECT_NEAR(double(report.left), double(left), 0.02 * double(edges));
}

TEST(Refinement, AddsNothingWhereNothingOccludes) {
  TriangleMesh sphere = make_sphere({0, 0, 0}, 1, 16);
  const size_t vertices = sphere.positions.size();
  const RayScene scene = scene_of({sphere});
  const RefinementReport report =
      refine_by_visibility(sphere, scene, {.max_difference = 0.05, .min_edge = 1e-3});
  EXPECT_EQ(report.added_vertices, 0u);
  EXPECT_EQ(report.left, 0u);
  EXPECT_EQ(sphere.positions.size(), vertices);
}

TEST(Refinement, CracksDoNotOpenAtHardEdges) {
  TriangleMesh box = make_box({0, 0, 0}, {1, 1, 1});
  const TriangleMesh roof = make_floor(0.7f, {0.2f, 0.3f, 1.3f});
  const RayScene scene = scene_of({box, roof});
  refine_by_visibility(box, scene, {.max_difference = 0.1, .min_edge = 0.05});
  EXPECT_GT(box.positions.size(), 60u);
  const MeshStatistics statistics = analyse_mesh(box);
  EXPECT_EQ(statistics.boundary_edges, 0u);
  EXPECT_EQ(statistics.non_manifold_edges, 0u);
  EXPECT_EQ(euler_characteristic(box), 2);
  EXPECT_FALSE(has_t_junction(box));
}

TEST(Refinement, AThinTriangleBesideAShadowEnds) {
  // Its long edges see the same at both ends; what lies between does not.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {4, 0, 0}, {1.7f, 0.05f, 0}, {1.7f, -1, 0}};
  mesh.normals.assign(4, Vector3f::UnitZ());
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  complete(mesh);
  const TriangleMesh before = mesh;
  const RayScene scene = scene_of({mesh, make_box({1, 0.04f, 0.01f}, {1, 1, 1})});
  const RefinementReport report =
      refine_by_visibility(mesh, scene, {.max_difference = 0.02, .min_edge = 0.01});
  EXPECT_FALSE(report.out_of_vertices);
  EXPECT_LT(mesh.positions.size(), 20000u);
  EXPECT_GE(smallest_angle(mesh), smallest_angle(before) / 2 - 1e-6);
}

TEST(Refinement, KeepsToItsBudget) {
  const RayScene scene = scene_of({make_floor(2), make_box({-0.1f, -0.1f, 0.02f}, {1, 1, 1})});
  for (const std::uint64_t budget : {0u, 4u, 5u, 60u, 200u}) {
    TriangleMesh floor = make_floor(2);
    const RefinementReport report = refine_by_visibility(
        floor, scene, {.max_difference = 0.05, .min_edge = 0.01, .max_vertices = budget});
    EXPECT_TRUE(report.out_of_vertices) << budget;
    EXPECT_GT(report.left, 0u);
    EXPECT_LE(floor.positions.size(), std::max<std::uint64_t>(budget, 4));
    if (budget >= 60) {
      EXPECT_GT(floor.positions.size(), budget / 2);
    }
    EXPECT_FALSE(has_t_junction(floor));
  }
}

TEST(Refinement, IsTheSameAtAnyNumberOfThreads) {
  const TriangleMesh box = make_box({-0.3f, -0.1f, 0.05f}, {0.7f, 0.2f, 1});
  const RayScene scene = scene_of({make_floor(1), box});
  TriangleMesh first;
  DensityReport first_density;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    TriangleMesh floor = make_floor(1);
    refine_by_visibility(floor, scene,
                         {.max_difference = 0.05, .min_edge = 0.02, .max_vertices = 700});
    const DensityReport density = check_density(floor, scene, 0.05);
    if (threads == 1) {
      first = floor;
      first_density = density;
    }
    EXPECT_EQ(floor.positions, first.positions);
    EXPECT_EQ(floor.normals, first.normals);
    EXPECT_EQ(floor.triangles, first.triangles);
    EXPECT_EQ(density.mean_difference, first_density.mean_difference);
    EXPECT_EQ(density.exceeding, first_density.exceeding);
  }
}

TEST(Refinement, WorksAtExtremeScales) {
  std::size_t vertices = 0;
  for (const float scale : {1.0f, 0x1p-20f, 0x1p20f}) {
    TriangleMesh floor = make_floor(scale);
    const RayScene scene = scene_of(
        {floor, make_box(scale * Vector3f(-0.3f, -0.1f, 0.05f), scale * Vector3f(1, 1, 1))});
    refine_by_visibility(floor, scene, {.max_difference = 0.1, .min_edge = 0.05 * scale});
    if (scale == 1) vertices = floor.positions.size();
    EXPECT_EQ(floor.positions.size(), vertices) << scale;  // powers of two: the same roundings
  }
}

TEST(Refinement, CancelledLeavesTheMeshAsItWas) {
  TriangleMesh floor = make_floor(2);
  const RayScene scene = scene_of({floor, make_box({-0.1f, -0.1f, 0.02f}, {1, 1, 1})});
  int calls = 0;
  const Progress progress = [&](std::string_view stage, std::uint64_t, std::uint64_t) {
    EXPECT_EQ(stage, "refine");
    return ++calls < 5;
  };
  EXPECT_THROW(refine_by_visibility(floor, scene, {.min_edge = 0.01}, progress), Cancelled);
  EXPECT_EQ(floor.positions.size(), 4u);
}

TEST(Refinement, RefusesOptionsOutOfRange) {
  TriangleMesh floor = make_floor(1);
  const RayScene scene = scene_of({floor});
  const auto error = [&](const RefinementOptions& options) {
    return error_of([&] { refine_by_visibility(floor, scene, options); });
  };
  EXPECT_NE(error({.max_difference = 0}).find("floor: the largest difference is 0"),
            std::string::npos);
  EXPECT_NE(error({.max_difference = kNan}), "");
  EXPECT_NE(error({.min_edge = -1}).find("floor: the shortest edge is -1"), std::string::npos);
  EXPECT_NE(error({.origin_offset = kNan}), "");
  EXPECT_EQ(error({}), "");
}

}  // namespace
}  // namespace burnish::test
