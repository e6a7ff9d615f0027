#include <bit>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/mesh_assembly.h"
#include "burnish/precompute/buried_vertices.h"
#include "burnish/precompute/visibility_mask.h"
#include "precompute/test_meshes.h"

namespace burnish {
namespace {

/// A horizontal grid of cells x cells around `center`, facing up.
TriangleMesh make_grid(const Vector3f& center, float half, int cells) {
  TriangleMesh mesh;
  const float step = 2 * half / static_cast<float>(cells);
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x)
      mesh.positions.push_back(center + Vector3f(step * static_cast<float>(x) - half,
                                                 step * static_cast<float>(y) - half, 0));
  mesh.normals.assign(mesh.positions.size(), Vector3f::UnitZ());
  const auto n = static_cast<std::uint32_t>(cells + 1);
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t a = y * n + x;
      mesh.triangles.push_back({a, a + 1, a + n + 1});
      mesh.triangles.push_back({a, a + n + 1, a + n});
    }
  test::complete(mesh);
  return mesh;
}

/// A box around `center` with a normal for each face; `sign` -1: a room, seen from within.
TriangleMesh make_box(const Vector3f& center, float half, float sign = 1) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      Vector3f u = Vector3f::Zero(), v = Vector3f::Zero(), corner = Vector3f::Constant(-half);
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2 * half;
      if (side * sign < 0) std::swap(u, v);
      corner[axis] = side * half;
      test::add_quad(mesh, center + corner, u, v);
    }
  test::complete(mesh);
  return mesh;
}

BuriedVertices find(const TriangleMesh& receiver, const std::vector<TriangleMesh>& occluders,
                    double offsets = 1) {
  RayScene scene;
  scene.add_mesh(receiver.positions, receiver.triangles);
  for (const TriangleMesh& occluder : occluders)
    scene.add_mesh(occluder.positions, occluder.triangles);
  scene.commit();
  return find_buried_vertices(scene, receiver, occluders, offsets * double(scene.origin_offset()));
}

TEST(BuriedVertices, FloorUnderAHalfSunkSphere) {
  const TriangleMesh sphere = test::make_sphere({0, 0, 0}, 1, 32);
  const TriangleMesh floor = make_grid({0, 0, 0}, 2, 40);
  std::uint64_t truth = 0;
  for (const Vector3f& p : floor.positions) {
    const float r = p.norm();
    truth += r < 0.995f;
    // The sphere's facets lie within 0.2 % of it; no vertex of the floor does, but for
    // those at its radius, which lie outside.
    ASSERT_FALSE(r >= 0.995f && r < 0.9999f) << r;
  }
  for (const double offsets : {1.0, 100.0}) {  // no offset helps
    const BuriedVertices found = find(floor, {sphere}, offsets);
    EXPECT_EQ(found.inside.count, truth);
    EXPECT_EQ(found.covered.count + found.pierced.count, 0u);
  }
  const BuriedVertices found = find(floor, {sphere});
  ASSERT_EQ(found.inside.first.size(), BuriedVertices::kExamples);
  for (size_t i = 0; i < found.inside.first.size(); ++i) {
    EXPECT_LT(floor.positions[found.inside.first[i]].norm(), 1);
    if (i > 0) {
      EXPECT_GT(found.inside.first[i], found.inside.first[i - 1]);
    }
  }
  EXPECT_EQ(found.inside.per_part, std::vector<std::uint64_t>{truth});
}

TEST(BuriedVertices, ABodyWithinABody) {
  const TriangleMesh outer = make_box({0, 0, 0}, 2), inner = make_box({0.3f, 0, 0}, 1);
  EXPECT_EQ(find(inner, {outer}).inside.count, 24u);
  EXPECT_EQ(find(outer, {inner}).count(), 0u);
}

TEST(BuriedVertices, FurnitureInARoomIsNot) {
  const TriangleMesh room = make_box({0, 0, 0}, 2, -1), table = make_box({0.3f, 0, 0}, 0.5f);
  EXPECT_EQ(find(table, {room}).count(), 0u);
  EXPECT_EQ(find(room, {table}).count(), 0u);
}

TEST(BuriedVertices, NeitherIsWhatLiesUnderASingleSheet) {
  // Seen from below, a sheet shows its back: to a third of the hemisphere of the floor's middle.
  const TriangleMesh floor = make_grid({0, 0, 0}, 1, 10), roof = make_grid({0, 0, 1}, 1, 4);
  EXPECT_EQ(find(floor, {roof}).count(), 0u);
  // One that fills the view is taken for a body: there is no telling it from the ground above.
  const TriangleMesh sky = make_grid({0, 0, 0.05f}, 10, 4);
  EXPECT_EQ(find(floor, {sky}).inside.count, floor.positions.size());
}

TEST(BuriedVertices, LeavesOfTwoSidesAreNot) {
  TriangleMesh leaves;
  for (int i = 0; i < 30; ++i) {
    const Vector3f at(0.1f * static_cast<float>(i % 6), 0.13f * static_cast<float>(i / 6),
                      0.07f * static_cast<float>(i % 4));
    const Vector3f u(0.3f, 0.05f * static_cast<float>(i % 3), 0.1f), v(0, 0.3f, 0.1f);
    test::add_quad(leaves, at, u, v);
  }
  const std::vector<Triangle> front = leaves.triangles;
  const auto vertices = static_cast<std::uint32_t>(leaves.positions.size());
  for (std::uint32_t v = 0; v < vertices; ++v) {
    leaves.positions.push_back(Vector3f(leaves.positions[v]));
    leaves.normals.push_back(-leaves.normals[v]);
  }
  for (const Triangle& t : front)
    leaves.triangles.push_back({t[0] + vertices, t[2] + vertices, t[1] + vertices});
  test::complete(leaves);
  EXPECT_EQ(find(leaves, {}).count(), 0u);
  // A body that was written twice is a body.
  TriangleMesh twice = make_box({0, 0, 0}, 2);
  const std::vector<Triangle> once = twice.triangles;
  twice.triangles.insert(twice.triangles.end(), once.begin(), once.end());
  EXPECT_EQ(find(make_box({0, 0, 0}, 1), {twice}).inside.count, 24u);
}

TEST(BuriedVertices, ALargerOffsetFreesADecal) {
  const TriangleMesh wall = make_grid({0, 0, 0}, 1, 7);
  for (const float depth : {2.0f, 6.5f}) {  // offsets; 6.5: 1e-4 of the scene's size
    const TriangleMesh decal = make_grid({0.01f, 0.02f, -depth * 0x1p-15f}, 0.5f, 6);
    const BuriedVertices found = find(decal, {wall});
    EXPECT_EQ(found.covered.count, decal.positions.size());
    EXPECT_EQ(found.inside.count, 0u);
    EXPECT_EQ(find(decal, {wall}, 8).count(), 0u);
    EXPECT_EQ(find(wall, {decal}).count(), 0u);
  }
  // Deeper, it is below ground.
  EXPECT_EQ(find(make_grid({0.01f, 0.02f, -30 * 0x1p-15f}, 0.5f, 6), {wall}).inside.count, 49u);
}

TEST(BuriedVertices, AFloorJustUnderABoxIsPierced) {
  // Its rays start in the box: half an offset above it is the underside.
  const TriangleMesh box = make_box({0.1f, 0.05f, 0.5f + 0x1p-15f}, 0.5f);
  const TriangleMesh floor = make_grid({0, 0, 0}, 2, 21);
  std::uint64_t truth = 0;
  for (const Vector3f& p : floor.positions)
    truth += std::abs(p.x() - 0.1f) < 0.5f && std::abs(p.y() - 0.05f) < 0.5f;
  EXPECT_GT(truth, 10u);
  EXPECT_EQ(find(floor, {box}).pierced.count, truth);
}

TEST(BuriedVertices, ABoxJustInTheFloorIsPierced) {
  // Its underside lies half an offset in the floor: rays start below. The sides look along it.
  const TriangleMesh floor = make_grid({0, 0, 0}, 2, 7);
  const TriangleMesh box = make_box({0.1f, 0.05f, 0.5f - 0x1p-15f}, 0.5f);
  const BuriedVertices found = find(box, {floor});
  EXPECT_EQ(found.pierced.count, 4u);
  EXPECT_EQ(found.inside.count, 0u);
  // Eight offsets above, as the ground of a scene file lies: all is well.
  EXPECT_EQ(find(make_box({0.1f, 0.05f, 0.5f + 0x1p-11f}, 0.5f), {floor}).count(), 0u);
}

TEST(BuriedVertices, WhatStandsOnTheAutomaticGroundDoesNotSeeThroughIt) {
  SceneDescription scene;
  scene.up = UpAxis::z;
  scene.meshes.resize(1);
  const TriangleMesh sphere = test::make_sphere({0, 0, 1}, 1, 16);
  const DirectionTable table(64);
  // What the lowest vertex sees of the hemisphere below it: no more than its horizon; and all of it
  // from a ground at its own height, through which its rays' origin has gone.
  for (const bool automatic : {true, false}) {
    scene.ground.emplace();
    if (!automatic) scene.ground->height = 0;
    const TriangleMesh mesh = assemble_scene(scene, std::span(&sphere, 1)).receiver;
    RayScene rays;
    rays.add_mesh(mesh.positions, mesh.triangles);
    rays.commit();
    std::size_t lowest = 0;
    for (std::size_t v = 0; v < sphere.positions.size(); ++v)
      if (sphere.positions[v].z() < sphere.positions[lowest].z()) lowest = v;
    VisibilityMask mask(64);
    sample_visibility(rays, table, mesh.positions[lowest], mesh.normals[lowest], mask);
    int visible = 0;
    for (const std::uint64_t word : mask.bits) visible += std::popcount(word);
    if (automatic) {
      EXPECT_LE(visible,
                126);  // texels that lie on the horizon but for rounding: along |u| + |v| = 1
      EXPECT_EQ(find(mesh, {}).count(), 0u);
    } else {
      EXPECT_GT(visible, 1900);  // of 2048 directions; some graze the sphere's facets
    }
  }
}

TEST(BuriedVertices, CountsByPart) {
  const TriangleMesh outer = make_box({0, 0, 0}, 2);
  TriangleMesh mesh = make_box({5, 0, 0}, 1);
  const TriangleMesh inner = make_box({0, 0, 0}, 1);
  mesh.positions.insert(mesh.positions.end(), inner.positions.begin(), inner.positions.end());
  mesh.normals.insert(mesh.normals.end(), inner.normals.begin(), inner.normals.end());
  for (Triangle t : inner.triangles) {
    for (std::uint32_t& v : t) v += 24;
    mesh.triangles.push_back(t);
  }
  mesh.parts = {{"free", 0, 24, 0, 12}, {"empty", 24, 0, 12, 0}, {"buried", 24, 24, 12, 12}};
  test::complete(mesh);
  const BuriedVertices found = find(mesh, {outer});
  EXPECT_EQ(found.inside.per_part, (std::vector<std::uint64_t>{0, 0, 24}));
  EXPECT_EQ(found.inside.first.front(), 24u);
  EXPECT_EQ(found.covered.per_part, (std::vector<std::uint64_t>{0, 0, 0}));
}

TEST(BuriedVertices, NormalsSayWhereTheFrontIs) {
  // The outer body's triangles run the wrong way; its normals are right.
  TriangleMesh outer = make_box({0, 0, 0}, 2);
  for (Triangle& t : outer.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(find(make_box({0, 0, 0}, 1), {outer}).inside.count, 24u);
}

TEST(BuriedVertices, PassesOverWhatCannotBeBaked) {
  TriangleMesh inner = make_box({0, 0, 0}, 1);
  inner.normals[0] = Vector3f::Zero();
  inner.normals[1] = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  inner.positions.push_back({0, 0, 0});  // in no triangle
  inner.normals.push_back(Vector3f::UnitZ());
  inner.positions.push_back(Vector3f::Constant(std::numeric_limits<float>::infinity()));
  inner.normals.push_back(Vector3f::UnitZ());
  inner.triangles.push_back({2, 3, 25});
  test::complete(inner);
  EXPECT_EQ(find(inner, {make_box({0, 0, 0}, 2)}).inside.count, 22u);
}

TEST(BuriedVertices, ScaleAndThreadsDoNotMatter) {
  for (const float scale : {1.0f, 1e-6f, 1e6f})
    for (const std::size_t threads : {1u, 2u, 4u}) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      const TriangleMesh sphere = test::make_sphere({0, 0, 0}, scale, 16);
      const TriangleMesh floor = make_grid({0, 0, 0}, 1.7f * scale, 9);
      const BuriedVertices found = find(floor, {sphere});
      std::uint64_t truth = 0;
      for (const Vector3f& p : floor.positions) truth += p.norm() < scale;
      EXPECT_EQ(found.inside.count, truth) << scale;
    }
}

}  // namespace
}  // namespace burnish
