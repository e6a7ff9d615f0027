#include <random>

#include <gtest/gtest.h>

#include "bit_grid.h"
#include "burnish/precompute/ray_scene.h"
#include "burnish/sphere/octahedral_map.h"
#include "point_tree.h"
#include "precompute/test_meshes.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 20080815;

BitGrid random_grid(int size, std::mt19937& random) {
  BitGrid grid(size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      if (random() % 16 == 0) grid.set(x, y);
  return grid;
}

bool wrapped(const BitGrid& grid, int x, int y) {
  const int texel = octahedral_wrap(x, y, grid.size);
  return grid.get(texel % grid.size, texel / grid.size);
}

bool inside(int x, int size) { return x >= 0 && x < size; }

TEST(BitGrid, NeighboursFollowTheMapsWrap) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const int size : {16, 32, 64, 256}) {
    const BitGrid grid = random_grid(size, random);
    BitGrid found(size);
    for (int y = 0; y < size; ++y) gather_neighbours(grid, y, found.row(y));
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x)
        ASSERT_EQ(found.get(x, y), wrapped(grid, x - 1, y) || wrapped(grid, x + 1, y) ||
                                       wrapped(grid, x, y - 1) || wrapped(grid, x, y + 1))
            << size << ": " << x << ", " << y;
  }
}

// Within the map, the coarse samples next to a texel; over its edge, their wrapped places at least.
TEST(BitGrid, CoarseSamplesReachTheTexelsAroundThem) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const int size : {16, 32, 64, 128})
    for (const int odd : {0, 1}) {
      const BitGrid coarse = random_grid(size, random);
      BitGrid fine(2 * size), placed(2 * size);
      const auto parity = static_cast<SampleParity>(odd);
      gather_coarse_samples(coarse, parity, fine);
      place_coarse_samples(coarse, parity, placed);
      for (int y = 0; y < 2 * size; ++y)
        for (int x = 0; x < 2 * size; ++x) {
          const int x0 = (x - odd) >> 1, y0 = (y - odd) >> 1;  // rounds down
          const int x1 = x0 + ((x - odd) & 1), y1 = y0 + ((y - odd) & 1);
          const bool expected = wrapped(coarse, x0, y0) || wrapped(coarse, x1, y0) ||
                                wrapped(coarse, x0, y1) || wrapped(coarse, x1, y1);
          const bool whole =
              inside(x0, size) && inside(y0, size) && inside(x1, size) && inside(y1, size);
          ASSERT_TRUE(whole ? fine.get(x, y) == expected : fine.get(x, y) || !expected)
              << size << ": " << x << ", " << y;
          const bool own = x % 2 == odd && y % 2 == odd;
          ASSERT_EQ(placed.get(x, y), own && coarse.get(x / 2, y / 2));
        }
    }
}

TEST(BitGrid, SamplesAroundACellAreGathered) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const int size : {16, 64, 128})
    for (const int odd : {0, 1}) {
      const BitGrid samples = random_grid(size, random);
      BitGrid around(size), filled(4 * size);
      gather_samples_around(samples, static_cast<SampleParity>(odd), around);
      fill_cells(around, filled);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          bool expected = false, whole = true;
          for (int v = y - odd; v <= y + 1; ++v)
            for (int u = x - odd; u <= x + 1; ++u) {
              expected |= wrapped(samples, u, v);
              whole &= inside(u, size) && inside(v, size);
            }
          ASSERT_TRUE(whole ? around.get(x, y) == expected : around.get(x, y) || !expected)
              << size << ": " << x << ", " << y;
          for (int i = 0; i < 16; ++i)
            ASSERT_EQ(filled.get(4 * x + i % 4, 4 * y + i / 4), around.get(x, y));
        }
    }
}

TEST(PointTree, AgreesWithLookingAtEveryPoint) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<float> normal;
  const auto vector = [&] { return Vector3f(normal(random), normal(random), normal(random)); };
  int above = 0;
  for (const std::size_t count : {0, 1, 16, 17, 1000}) {
    std::vector<Vector3f> points(count);
    for (Vector3f& p : points) p = vector();
    const PointTree tree(points);
    for (int i = 0; i < 200; ++i) {
      const Vector3f direction = vector().normalized();
      float highest = -std::numeric_limits<float>::infinity();
      for (const Vector3f& p : points) highest = std::max(highest, direction.dot(p));
      ASSERT_FALSE(tree.any_above(direction, highest + 1e-5f));  // more than float's rounding
      if (count > 0) {
        ASSERT_TRUE(tree.any_above(direction, highest - 1e-5f));
      }
      const float height = 3.0f * normal(random);
      above += tree.any_above(direction, height);
    }
  }
  EXPECT_GT(above, 100);
  const PointTree same(std::vector<Vector3f>(100, Vector3f(1, 2, 3)));
  EXPECT_TRUE(same.any_above(Vector3f::UnitZ(), 2.9f));
  EXPECT_FALSE(same.any_above(Vector3f::UnitZ(), 3.1f));
}

TEST(RayScene, EmptyHemisphereIsToldFromOneThatHoldsACorner) {
  TriangleMesh mesh = test::make_sphere({0, 0, 0}, 1, 24);
  for (const float scale : {1e-6f, 1.0f, 1e6f})
    for (const float height : {1.2f, 0.999f}) {
      TriangleMesh scaled = mesh;
      // One triangle, its highest corner just above or below the pole's tangent plane.
      const auto first = static_cast<std::uint32_t>(scaled.positions.size());
      for (const Vector3f& p : {Vector3f(3, 0, 0), Vector3f(3, 1, 0), Vector3f(3, 0, height)})
        scaled.positions.push_back(p);
      scaled.triangles.push_back({first, first + 1, first + 2});
      for (Vector3f& p : scaled.positions) p *= scale;
      RayScene scene;
      scene.add_mesh(scaled.positions, scaled.triangles);
      scene.commit();
      const Vector3f up(0, 0, 1), origin = (scale + scene.origin_offset()) * up;
      EXPECT_EQ(scene.hemisphere_is_empty(origin, up), height < 1) << scale;
      EXPECT_FALSE(scene.hemisphere_is_empty(origin, -up)) << "the sphere itself";
      EXPECT_FALSE(scene.hemisphere_is_empty(0.5f * origin, up));
    }
}

TEST(RayScene, EmptyHemisphereIgnoresWhatCannotBeHit) {
  RayScene scene;
  EXPECT_TRUE(scene.hemisphere_is_empty({0, 0, 0}, {0, 0, 1})) << "before commit";
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vector3f> positions = {{0, 0, 0}, {1, 0, 0},   {0, 1, 0},
                                           {0, 0, 5}, {nan, 0, 0}, {0, 0, 2e30f}};
  scene.add_mesh(positions, std::vector<Triangle>{{0, 1, 2}, {0, 3, 4}, {0, 3, 5}});
  scene.commit();
  EXPECT_TRUE(scene.hemisphere_is_empty({0.2f, 0.2f, 0.001f}, {0, 0, 1}));
  EXPECT_FALSE(scene.hemisphere_is_empty({0.2f, 0.2f, 0.001f}, {0, 0, -1}));
  EXPECT_TRUE(scene.hemisphere_is_empty({nan, 0, 0}, {0, 0, -1})) << "hits nothing";
}

}  // namespace
}  // namespace burnish
