#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "burnish/precompute/visibility_mask.h"
#include "burnish/sphere/octahedral_map.h"
#include "precompute/test_meshes.h"

namespace burnish {
namespace {

RayScene scene_of(const TriangleMesh& mesh) {
  RayScene scene;
  scene.add_mesh(mesh.positions, mesh.triangles);
  scene.commit();
  return scene;
}

// Of the directions above the horizon that something blocks.
double blocked_solid_angle(const VisibilityMask& mask, const DirectionTable& table,
                           const Vector3f& normal) {
  const int n = mask.resolution;
  int texels = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      texels += table.direction(x, y).dot(normal) > 0 && !mask.visible(x, y);
  return 4 * kPi<double> * texels / (double(n) * n);
}

// Only texels that the occluder's rim crosses can be counted wrongly: they are a band of one texel,
// sqrt(4 pi) / n, and errors on its two sides cancel but for a tenth at most.
double solid_angle_tolerance(double rim_length_rad, int n) {
  return 0.1 * rim_length_rad * std::sqrt(4 * kPi<double>) / n;
}

TEST(DirectionTable, HoldsTheTexelCentres) {
  const int n = 64;
  const DirectionTable table(n);
  ASSERT_EQ(table.tiles().size(), static_cast<std::size_t>(n * n / 16));
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(table.tiles().data()) % 64, 0u);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      ASSERT_LT((table.direction(x, y).cast<double>() - octahedral_texel_direction<double>(x, y, n))
                    .norm(),
                1e-7);  // one rounding to float
}

TEST(SampleVisibility, OpenPlaneSeesWhatIsStrictlyAboveItsHorizon) {
  TriangleMesh plane;
  test::add_quad(plane, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  const RayScene scene = scene_of(plane);
  const DirectionTable table(128);
  VisibilityMask mask(128);
  const std::uint64_t rays = sample_visibility(scene, table, {0, 0, 0}, {0, 0, 1}, mask);
  std::uint64_t above = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const bool expected = table.direction(x, y).z() > 0;
      above += expected;
      ASSERT_EQ(mask.visible(x, y), expected) << x << ", " << y;
    }
  EXPECT_EQ(rays, above);
}

// Every direction against the analytic ray-rectangle test, and the solid angle against its closed
// form: the oriented sum over the corners of atan(a b / (c sqrt(a^2 + b^2 + c^2))).
TEST(SampleVisibility, PanelBesideAFloorBlocksItsSolidAngle) {
  TriangleMesh mesh;
  test::add_quad(mesh, {-4, -4, 0}, {8, 0, 0}, {0, 8, 0});
  const double distance = 1.1, y0 = -1.3, y1 = 2.1, z0 = 0.3, z1 = 1.7;
  test::add_quad(mesh, Vector3d(distance, y0, z0).cast<float>(),
                 Vector3d(0, y1 - y0, 0).cast<float>(), Vector3d(0, 0, z1 - z0).cast<float>());
  const RayScene scene = scene_of(mesh);
  const int n = 256;
  const DirectionTable table(n);
  VisibilityMask mask(n);
  sample_visibility(scene, table, {0, 0, 0}, {0, 0, 1}, mask);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const auto d = octahedral_texel_direction<double>(x, y, n);
      const Vector3d hit = d * (distance / d.x());
      const double inside =
          d.x() <= 0 ? -1 : std::min({hit.y() - y0, y1 - hit.y(), hit.z() - z0, z1 - hit.z()});
      // The origin is lifted by 1e-4, which moves the rim by as much.
      if (std::abs(inside) < 1e-3) continue;
      ASSERT_EQ(mask.visible(x, y), d.z() > 0 && inside < 0) << d.transpose();
    }

  const auto corner = [&](double y, double z) {
    return std::atan(y * z / (distance * std::sqrt(y * y + z * z + distance * distance)));
  };
  const double wall = corner(y1, z1) - corner(y0, z1) - corner(y1, z0) + corner(y0, z0);
  EXPECT_NEAR(blocked_solid_angle(mask, table, {0, 0, 1}), wall, solid_angle_tolerance(6, n));
}

TEST(SampleVisibility, DiscFacingTheVertexBlocksACap) {
  const double height = 0.8, radius = 0.6;
  TriangleMesh disc =
      test::make_disc({0, 0, static_cast<float>(height)}, static_cast<float>(radius), 512);
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(0.5f, Vector3f(0.3f, -0.9f, 0.2f).normalized()).toRotationMatrix();
  for (Vector3f& p : disc.positions) p = turn * p;
  const RayScene scene = scene_of(disc);
  const int n = 256;
  const DirectionTable table(n);
  VisibilityMask mask(n);
  const double cap = 2 * kPi<double> * (1 - height / std::hypot(height, radius));
  // The normal does not change what the disc blocks while the disc is above the horizon.
  for (const Vector3f& normal : {Vector3f(0, 0, 1), Vector3f(turn.col(2))}) {
    sample_visibility(scene, table, {0, 0, 0}, normal, mask);
    EXPECT_NEAR(blocked_solid_angle(mask, table, normal), cap, solid_angle_tolerance(4, n));
  }
}

}  // namespace
}  // namespace burnish
