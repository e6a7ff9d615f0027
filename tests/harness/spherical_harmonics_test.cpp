#include "harness/rivals/spherical_harmonics.h"

#include <gtest/gtest.h>

#include "burnish/sphere/frame.h"
#include "burnish/visibility/visibility_ladder.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

double value_of(const Harmonics& harmonics, int bands, const Vector3d& direction) {
  Harmonics basis(harmonics.size());
  eval_harmonics(bands, direction.cast<float>(), {basis.data(), basis.data() + basis.size()});
  return double(basis.dot(harmonics));
}

Harmonics random_harmonics(int bands, std::mt19937& random) {
  std::normal_distribution<float> normal;
  Harmonics harmonics(Eigen::Index{bands} * bands);
  for (float& coefficient : harmonics) coefficient = normal(random);
  return harmonics;
}

TEST(SphericalHarmonics, RotationTurnsTheFunction) {
  std::mt19937 random(5);
  for (const int bands : {1, 3, 6}) {
    const Harmonics before = random_harmonics(bands, random);
    const Frame<double> frame = test::random_frame(test::random_direction(random), random);
    Eigen::Matrix3d rotation;
    rotation << frame.x, frame.y, frame.z;
    const Harmonics after = harmonics_rotation(bands, rotation.cast<float>()) * before;
    for (int i = 0; i < 20; ++i) {
      const Vector3d direction = test::random_direction(random);
      // Sums of up to 36 floats of magnitude 1.
      EXPECT_NEAR(value_of(after, bands, direction),
                  value_of(before, bands, rotation.transpose() * direction), 2e-5);
    }
  }
}

TEST(SphericalHarmonics, ProductMultipliesFunctions) {
  std::mt19937 random(6);
  constexpr int kBands = 4, kProductBands = 2 * kBands - 1;
  const Harmonics v = random_harmonics(kProductBands, random);
  const Harmonics f = random_harmonics(kBands, random);
  const Harmonics entries = harmonics_product(kBands) * v;
  const Harmonics product =
      Eigen::Map<const RowMatrix>(entries.data(), kBands * kBands, kBands * kBands) * f;
  for (const int k : {0, 2, 5, 15}) {
    Harmonics one = Harmonics::Zero(kBands * kBands);
    one[k] = 1;
    // Against a rule that is exact for a degree of 12: 32 x 2 x 64 nodes. Floats of magnitude 10.
    const double truth = test::integrate_sphere(
        [&](const Vector3d& d) {
          return value_of(one, kBands, d) * value_of(v, kProductBands, d) * value_of(f, kBands, d);
        },
        Vector3d::UnitZ(), 32);
    EXPECT_NEAR(double(product[k]), truth, 1e-4) << k;
  }
}

TEST(SphericalHarmonics, ProjectsAnEnvironment) {
  constexpr int kBands = 6;
  std::mt19937 random(7);
  const Harmonics truth = random_harmonics(kBands, random);
  Image map(256, 128);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      map.at(x, y) =
          Rgb(1, 2, -1) *
          float(value_of(truth, kBands, direction_from_latlong((x + 0.5) / 256, (y + 0.5) / 128)));
  const RgbHarmonics projected = project_environment(map, kBands);
  // Middles of pixels of 1/40 rad: band 5 lacks up to 30 / 24 / 40^2, .1 %, of magnitude 3, twice.
  for (Eigen::Index k = 0; k < truth.size(); ++k) {
    EXPECT_NEAR(projected(k, 0), truth[k], 5e-3) << k;
    EXPECT_NEAR(projected(k, 1), 2 * truth[k], 1e-2) << k;
    EXPECT_NEAR(projected(k, 2), -truth[k], 5e-3) << k;
  }
}

TEST(SphericalHarmonics, WindowKeepsTheMean) {
  RgbHarmonics harmonics = RgbHarmonics::Ones(16, 3);
  apply_window(4, harmonics);
  EXPECT_FLOAT_EQ(harmonics(0, 0), 1);
  EXPECT_NEAR(harmonics(2, 1), (1 + std::sqrt(0.5)) / 2, 1e-6);
  EXPECT_NEAR(harmonics(6, 2), 0.5, 1e-6);
  EXPECT_NEAR(harmonics(15, 0), (1 - std::sqrt(0.5)) / 2, 1e-6);
}

}  // namespace
}  // namespace burnish
