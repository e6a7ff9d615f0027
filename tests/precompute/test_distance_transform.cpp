#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/sphere/batch.h"
#include "distance_transform_support.h"

// The nearest points, against all of them compared in turn.
namespace burnish {
namespace {

using test::inverse;
using test::mask_of;
using test::transform;

constexpr unsigned kSeed = 4711;

// The middles of the edges between all pairs of neighbours that differ, straight from the
// definition, in double.
std::vector<Vector3d> boundary_of(const VisibilityMask& mask) {
  const int n = mask.resolution;
  std::vector<Vector3d> points;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
        const int other = octahedral_wrap(x + dx, y + dy, n);
        if (mask.visible(x, y) == mask.visible(other % n, other / n)) continue;
        points.push_back(octahedral_to_direction<double>((x + 0.5 + 0.5 * dx) / n,  //
                                                         (y + 0.5 + 0.5 * dy) / n));
      }
  return points;
}

// 1, -1 or 0 by how much of a bilinear lookup of the mask at `d` is visible: it is of one texel, or
// of four a quarter each.
double sign_at(const VisibilityMask& mask, const Vector3d& d) {
  const int n = mask.resolution;
  const auto footprint = octahedral_footprint<double>(direction_to_octahedral(d), n);
  double visible = 0;
  for (int k = 0; k < 4; ++k)
    if (mask.visible(footprint.texel[k] % n, footprint.texel[k] / n))
      visible += footprint.weight[k];
  return visible > 0.51 ? 1 : visible < 0.49 ? -1 : 0;
}

// The bound that the class states.
double rounding(double distance) { return std::min(1e-6 / std::sin(distance), 1e-3); }

// The slow, obvious form of the transform, at every `step`-th texel.
void expect_brute_force(const VisibilityMask& mask, int resolution, int step = 1) {
  const std::vector<float> fast = transform(mask, resolution);
  const std::vector<Vector3d> boundary = boundary_of(mask);
  for (int i = 0; i < resolution * resolution; i += step) {
    const auto d = octahedral_texel_direction<double>(i % resolution, i / resolution, resolution);
    double angle = kPi<double>;
    if (!boundary.empty()) {
      const auto nearest =
          *std::max_element(boundary.begin(), boundary.end(),
                            [&](const auto& a, const auto& b) { return a.dot(d) < b.dot(d); });
      angle = angle_between<double>(d, nearest);
    }
    ASSERT_NEAR(fast[static_cast<std::size_t>(i)], sign_at(mask, d) * angle, rounding(angle))
        << "texel " << i << " of " << resolution << "^2, mask of " << mask.resolution << "^2";
  }
}

VisibilityMask noise(int resolution, double density, std::mt19937& random) {
  std::bernoulli_distribution visible(density);
  return mask_of(resolution, [&](const Vector3d&) { return visible(random); });
}

// Visible outside of five caps, or inside of them.
VisibilityMask caps(int resolution, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> radius(0.02, 0.8);
  std::vector<std::pair<Vector3d, double>> caps;
  for (int k = 0; k < 5; ++k)
    caps.emplace_back(Vector3d(normal(random), normal(random), normal(random)).normalized(),
                      std::cos(radius(random)));
  const VisibilityMask mask = mask_of(resolution, [&](const Vector3d& d) {
    return std::none_of(caps.begin(), caps.end(),
                        [&](const auto& cap) { return d.dot(cap.first) > cap.second; });
  });
  return random() % 2 ? mask : inverse(mask);
}

VisibilityMask half_space(int resolution, const Vector3d& normal) {
  return mask_of(resolution, [&](const Vector3d& d) { return d.dot(normal) > 0; });
}

VisibilityMask texels_where(int n, const std::function<bool(int, int)>& visible) {
  VisibilityMask mask(n);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x)
      if (visible(x, y)) mask.set_visible(x, y);
  return mask;
}

// On each instruction set that this processor has.
class DistanceTransform : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(batch::use_instruction_set(GetParam())); }
  void TearDown() override { batch::use_instruction_set(""); }
};

std::vector<std::string> instruction_sets() {
  const std::vector<std::string_view> names = batch::instruction_sets();
  return {names.begin(), names.end()};
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, DistanceTransform,
                         testing::ValuesIn(instruction_sets()),
                         [](const auto& info) { return info.param; });

TEST_P(DistanceTransform, MatchesBruteForceOnNoise) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const double density : {0.001, 0.02, 0.5, 0.98, 0.999}) {
    const VisibilityMask mask = noise(64, density, random);
    for (const int resolution : {16, 32, 64}) expect_brute_force(mask, resolution, 3);
  }
}

TEST_P(DistanceTransform, MatchesBruteForceOnCaps) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 8; ++i) expect_brute_force(caps(128, random), 32);
}

TEST_P(DistanceTransform, MatchesBruteForceOnHalfSpaces) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  // Boundaries along the folds and the diagonals, a hair beside them, and at odd angles.
  std::vector<Vector3d> normals = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {1, 1, 0}, {1, 1e-3, 2e-3}};
  for (int i = 0; i < 4; ++i) normals.emplace_back(normal(random), normal(random), normal(random));
  for (const Vector3d& n : normals) {
    SCOPED_TRACE(testing::Message() << "normal " << n.transpose());
    for (const int resolution : {16, 64}) expect_brute_force(half_space(64, n), resolution);
  }
}

TEST_P(DistanceTransform, MatchesBruteForceAtEveryResolution) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (int n = 64; n <= 1024; n *= 2) {
    const VisibilityMask mask = caps(n, random);
    for (int resolution = 16; resolution <= n; resolution *= 2)
      expect_brute_force(mask, resolution, std::max(1, resolution * resolution / 120) | 1);
  }
}

TEST_P(DistanceTransform, MatchesBruteForceOnSingleTexels) {
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
    VisibilityMask open(n);
    open.set_visible(x, y);
    for (const int resolution : {16, 64}) {
      expect_brute_force(open, resolution);
      expect_brute_force(inverse(open), resolution);
    }
  }
}

TEST_P(DistanceTransform, MatchesBruteForceOnHairsAndSeams) {
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
    const VisibilityMask mask = texels_where(64, masks[i]);
    for (const int resolution : {16, 32, 64}) {
      expect_brute_force(mask, resolution, 3);
      expect_brute_force(inverse(mask), resolution, 3);
    }
  }
}

TEST_P(DistanceTransform, WithoutBoundaryIsPi) {
  for (const int resolution : {16, 64}) {
    const VisibilityMask blocked(64);
    for (const float v : transform(blocked, resolution)) ASSERT_EQ(v, -kPi<float>);
    for (const float v : transform(inverse(blocked), resolution)) ASSERT_EQ(v, kPi<float>);
  }
}

TEST_P(DistanceTransform, InverseMaskTurnsTheSign) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const VisibilityMask mask = noise(128, 0.9, random);
  for (const int resolution : {16, 64, 128}) {
    std::vector<float> turned = transform(inverse(mask), resolution);
    for (float& v : turned) v = -v;
    EXPECT_EQ(turned, transform(mask, resolution));
  }
}

// What a call leaves in the scratch must not reach the next, larger or smaller.
TEST_P(DistanceTransform, ScratchCanBeReused) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const DirectionTable directions(64);
  const SphericalDistanceTransform fine(directions, 64), coarse(directions, 16);
  SphericalDistanceTransform::Scratch scratch;
  const std::vector<VisibilityMask> masks = {noise(64, 0.3, random), half_space(64, {1, 2, 3}),
                                             VisibilityMask(64), noise(64, 0.999, random)};
  for (const std::size_t i : {0, 1, 2, 3, 0, 3, 1}) {
    for (const SphericalDistanceTransform* transformer : {&fine, &coarse}) {
      const int n = transformer->resolution();
      std::vector<float> ssdf(static_cast<std::size_t>(n * n));
      transformer->transform(masks[i], ssdf, scratch);
      EXPECT_EQ(ssdf, transform(masks[i], n));
    }
  }
}

}  // namespace
}  // namespace burnish
