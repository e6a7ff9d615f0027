#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/precompute/spherical_distance_transform.h"
#include "burnish/sphere/octahedral_map.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 4711;
using Predicate = std::function<bool(const Vector3d&)>;

VisibilityMask mask_of(int resolution, const Predicate& visible) {
  VisibilityMask mask(resolution);
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x)
      if (visible(octahedral_texel_direction<double>(x, y, resolution))) mask.set_visible(x, y);
  return mask;
}

std::vector<float> transform(const VisibilityMask& mask, int resolution) {
  const DirectionTable directions(mask.resolution);
  const SphericalDistanceTransform transform(directions, resolution);
  SphericalDistanceTransform::Scratch scratch;
  std::vector<float> ssdf(static_cast<std::size_t>(resolution * resolution), -100.0f);
  transform.transform(mask, ssdf, scratch);
  return ssdf;
}

float pitch(int resolution) {
  const DirectionTable directions(resolution);
  return SphericalDistanceTransform(directions, 16).boundary_pitch();
}

// Midpoints of all pairs of neighbours that differ, straight from the definition, in double.
std::vector<Vector3d> boundary_of(const VisibilityMask& mask) {
  const int n = mask.resolution;
  std::vector<Vector3d> points;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int other = octahedral_wrap(x + dx, y + dy, n);
        if (mask.visible(x, y) == mask.visible(other % n, other / n)) continue;
        points.push_back((octahedral_texel_direction<double>(x, y, n) +
                          octahedral_texel_direction<double>(other % n, other / n, n))
                             .normalized());
      }
  return points;
}

// The slow, obvious form of the transform.
std::vector<double> brute_force(const VisibilityMask& mask, int resolution) {
  const std::vector<Vector3d> boundary = boundary_of(mask);
  std::vector<double> ssdf;
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x) {
      const auto d = octahedral_texel_direction<double>(x, y, resolution);
      // How much of a bilinear lookup there is visible: of one texel, or of four a quarter each.
      const auto footprint =
          octahedral_footprint<double>(direction_to_octahedral(d), mask.resolution);
      double visible = 0;
      for (int k = 0; k < 4; ++k)
        if (mask.visible(footprint.texel[k] % mask.resolution,
                         footprint.texel[k] / mask.resolution))
          visible += footprint.weight[k];
      const double sign = visible > 0.51 ? 1 : visible < 0.49 ? -1 : 0;
      double largest = -2;
      Vector3d nearest = -d;
      for (const Vector3d& p : boundary)
        if (p.dot(d) > largest) {
          largest = p.dot(d);
          nearest = p;
        }
      ssdf.push_back(boundary.empty() ? sign * kPi<double> : sign * angle_between(d, nearest));
    }
  return ssdf;
}

// Float rounding of unit vectors moves a point by about 1e-7, and the nearest point is found among
// chords rounded alike: 2e-6 leaves room for the squares and roots on the way.
void expect_brute_force(const VisibilityMask& mask, int resolution) {
  const std::vector<float> fast = transform(mask, resolution);
  const std::vector<double> slow = brute_force(mask, resolution);
  for (std::size_t i = 0; i < slow.size(); ++i)
    ASSERT_NEAR(fast[i], slow[i], 2e-6) << "texel " << i << " of " << resolution << "^2";
}

TEST(SphericalDistanceTransform, MatchesBruteForceOnNoise) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const double density : {0.001, 0.02, 0.5, 0.98, 0.999}) {
    std::bernoulli_distribution visible(density);
    const VisibilityMask mask = mask_of(64, [&](const Vector3d&) { return visible(random); });
    for (const int resolution : {16, 32, 64}) expect_brute_force(mask, resolution);
  }
}

TEST(SphericalDistanceTransform, MatchesBruteForceOnUnionsOfCaps) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> radius(0.05, 0.8);
  for (int i = 0; i < 8; ++i) {
    std::vector<std::pair<Vector3d, double>> caps;
    for (int k = 0; k < 5; ++k)
      caps.emplace_back(Vector3d(normal(random), normal(random), normal(random)).normalized(),
                        std::cos(radius(random)));
    const VisibilityMask mask = mask_of(128, [&](const Vector3d& d) {
      return std::none_of(caps.begin(), caps.end(),
                          [&](const auto& cap) { return d.dot(cap.first) > cap.second; });
    });
    expect_brute_force(mask, 32);
  }
}

TEST(SphericalDistanceTransform, MatchesBruteForceOnSingleTexels) {
  const int n = 64;
  // The middle (+z), corners (-z), the middles of edges (the equator's folds), an edge off its
  // middle (its neighbour is across the wrap), and an ordinary place.
  for (const auto& [x, y] : {std::pair{32, 32},
                             {31, 32},
                             {0, 0},
                             {63, 0},
                             {63, 63},
                             {0, 31},
                             {32, 63},
                             {63, 5},
                             {10, 0},
                             {16, 15},
                             {20, 50}}) {
    SCOPED_TRACE(testing::Message() << "texel " << x << ", " << y);
    VisibilityMask open(n), blocked(n);
    open.set_visible(x, y);
    for (std::size_t i = 0; i < open.bits.size(); ++i) blocked.bits[i] = ~open.bits[i];
    for (const int resolution : {16, 64}) {
      expect_brute_force(open, resolution);
      expect_brute_force(blocked, resolution);
    }
  }
}

TEST(SphericalDistanceTransform, MatchesBruteForceOnHairsAndSeams) {
  const int n = 64;
  const std::vector<std::function<bool(int, int)>> masks = {
      [](int x, int) { return x == 17; },             // a hair from seam to seam
      [](int, int y) { return y != 63; },             // along a seam
      [](int x, int y) { return x == y; },            // through both poles
      [](int x, int y) { return x + y == 31; },       // along the equator
      [](int x, int y) { return (x + y) % 2 == 0; },  // every texel differs from its neighbours
      [](int x, int y) { return x < 3 || (y > 60 && x < 40); },  // across seam and corner
      [](int x, int y) { return x == 0 || y == 0 || x == 63 || y == 63; }};
  for (std::size_t i = 0; i < masks.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "mask " << i);
    VisibilityMask mask(n);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        if (masks[i](x, y)) mask.set_visible(x, y);
    for (const int resolution : {16, 32, 64}) expect_brute_force(mask, resolution);
  }
}

TEST(SphericalDistanceTransform, PitchIsTheLargestAngleBetweenNeighbours) {
  for (const int n : {64, 128, 256}) {
    double largest = 0;
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        for (const int other : {octahedral_wrap(x + 1, y, n), octahedral_wrap(x, y + 1, n)})
          largest = std::max(
              largest,
              angle_between<double>(octahedral_texel_direction<double>(x, y, n),
                                    octahedral_texel_direction<double>(other % n, other / n, n)));
    EXPECT_NEAR(pitch(n), largest, 1e-6);
    // A texel has 4 pi / n^2 sr, so no pitch can be below its root, and Clarberg's map stretches
    // it by less than half as much again.
    EXPECT_GT(pitch(n), 3.54 / n);
    EXPECT_LT(pitch(n), 1.5 * 3.55 / n);
  }
}

// The bound stated in the header: |distance| is at most h/2 too small and at most h too large. With
// boundaries known in closed form.
void expect_closed_form(int n, int resolution, const std::function<double(const Vector3d&)>& ssdf) {
  const std::vector<float> found =
      transform(mask_of(n, [&](const Vector3d& d) { return ssdf(d) > 0; }), resolution);
  const double h = pitch(n);
  double too_large = 0, too_small = 0;
  for (int y = 0; y < resolution; ++y)
    for (int x = 0; x < resolution; ++x) {
      const double truth = ssdf(octahedral_texel_direction<double>(x, y, resolution));
      const double value = found[static_cast<std::size_t>(y * resolution + x)];
      too_large = std::max(too_large, std::abs(value) - std::abs(truth));
      // A texel within h/2 of the boundary may have the wrong sign.
      if (std::abs(truth) > h / 2) {
        ASSERT_GT(value * truth, 0) << x << ", " << y << ": " << value << " for " << truth;
        too_small = std::max(too_small, std::abs(truth) - std::abs(value));
      }
    }
  EXPECT_LE(too_large, h);
  EXPECT_LE(too_small, h / 2 + 1e-6);  // 1e-6: float rounding of directions and angles
}

TEST(SphericalDistanceTransform, HalfSpaceIsTheArcSine) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  std::vector<Vector3d> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (int i = 0; i < 8; ++i)
    normals.push_back(Vector3d(normal(random), normal(random), normal(random)).normalized());
  for (const Vector3d& n : normals) {
    SCOPED_TRACE(testing::Message() << "normal " << n.transpose());
    for (const int resolution : {32, 128})
      expect_closed_form(128, resolution, [&](const Vector3d& d) {
        return std::asin(std::clamp(n.dot(d), -1.0, 1.0));
      });
  }
}

TEST(SphericalDistanceTransform, CapIsTheAngleToItsRim) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  for (const double radius : {0.15, 0.5, 1.2, 2.0, 2.9})
    for (int i = 0; i < 3; ++i) {
      const Vector3d axis = Vector3d(normal(random), normal(random), normal(random)).normalized();
      SCOPED_TRACE(testing::Message() << "radius " << radius << " axis " << axis.transpose());
      expect_closed_form(
          128, 32, [&](const Vector3d& d) { return angle_between<double>(d, axis) - radius; });
    }
}

TEST(SphericalDistanceTransform, NearestOfTwoOccludersCounts) {
  const Vector3d a = Vector3d(1, 0.3, 0.2).normalized(), b = Vector3d(-0.2, -1, 0.5).normalized();
  expect_closed_form(128, 32, [&](const Vector3d& d) {
    return std::min(angle_between<double>(d, a) - 0.4, angle_between<double>(d, b) - 0.25);
  });
}

TEST(SphericalDistanceTransform, WithoutBoundaryIsPi) {
  VisibilityMask mask(64);
  for (const float v : transform(mask, 16)) ASSERT_EQ(v, -kPi<float>);
  std::fill(mask.bits.begin(), mask.bits.end(), ~std::uint64_t{0});
  for (const float v : transform(mask, 16)) ASSERT_EQ(v, kPi<float>);
}

TEST(SphericalDistanceTransform, DistanceIsContinuous) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const int n = 64;
  const double h = pitch(n);
  for (const double density : {0.01, 0.5, 0.95}) {
    std::bernoulli_distribution visible(density);
    const VisibilityMask mask = mask_of(n, [&](const Vector3d&) { return visible(random); });
    for (const int resolution : {16, 32, 64}) {
      const std::vector<float> ssdf = transform(mask, resolution);
      const auto at = [&](int i) { return ssdf[static_cast<std::size_t>(i)]; };
      for (int y = 0; y < resolution; ++y)
        for (int x = 0; x < resolution; ++x)
          for (const int other :
               {octahedral_wrap(x + 1, y, resolution), octahedral_wrap(x, y + 1, resolution)}) {
            const int here = y * resolution + x;
            const double apart =
                angle_between<double>(octahedral_texel_direction<double>(x, y, resolution),
                                      octahedral_texel_direction<double>(
                                          other % resolution, other / resolution, resolution));
            // Of one sign, a distance changes by no more than the way (to float rounding); where
            // the sign changes there is a boundary point within the corner's four texels of the
            // path, at each end at most a texel's diagonal aside.
            const bool crosses = at(here) * at(other) <= 0;
            ASSERT_LE(std::abs(at(here) - at(other)),
                      apart + (crosses ? 2 * std::sqrt(2.0) * h : 2e-6));
          }
    }
  }
}

TEST(SphericalDistanceTransform, ScratchCanBeReused) {
  const DirectionTable directions(64);
  const SphericalDistanceTransform transformer(directions, 32);
  SphericalDistanceTransform::Scratch scratch;
  std::vector<float> ssdf(32 * 32);
  const VisibilityMask busy =
      mask_of(64, [i = 0](const Vector3d&) mutable { return i++ % 3 == 0; });
  const VisibilityMask plain = mask_of(64, [](const Vector3d& d) { return d.x() > 0.2; });
  for (const VisibilityMask* mask : {&busy, &plain, &busy, &plain}) {
    transformer.transform(*mask, ssdf, scratch);
    EXPECT_EQ(ssdf, transform(*mask, 32));
  }
}

}  // namespace
}  // namespace burnish
