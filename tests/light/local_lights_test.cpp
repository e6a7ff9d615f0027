#include "burnish/light/local_lights.h"

#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "burnish/sphere/cap_cosine.h"
#include "burnish/sphere/lobe_moments.h"
#include "support/quadrature.h"
#include "support/rectangle_nodes.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 17;

/// Integral of max(v . n, 0) over a cap, by circles about n: of each, the arc that is in the cap.
double cap_truth(double radius, double angle) {
  const double first = std::abs(angle - radius);
  const double last = kPi<double> - std::abs(kPi<double> - angle - radius);
  double sum = 0;
  // All of a circle is in the cap before `first`, if n is, and after `last`, if -n is.
  if (angle < radius) {
    const double sine = std::sin(std::min(first, kPi<double> / 2));
    sum += kPi<double> * sine * sine;
  }
  const double end = std::min(last, kPi<double> / 2);
  if (angle + radius > kPi<double>) sum += kPi<double> * std::pow(std::cos(end), 2);
  if (first >= end) return sum;
  // The arc has square-root ends; in u they are smooth.
  for (const auto& [u, weight] : test::gauss_legendre(200, -kPi<double> / 2, kPi<double> / 2)) {
    const double t = (first + end) / 2 + (end - first) / 2 * std::sin(u);
    const double denominator = std::sin(t) * std::sin(angle);
    const double cosine = (std::cos(radius) - std::cos(t) * std::cos(angle)) / denominator;
    const double arc = 2 * std::acos(std::clamp(cosine, -1.0, 1.0));
    sum += weight * (end - first) / 2 * std::cos(u) * std::cos(t) * std::sin(t) * arc;
  }
  return sum;
}

TEST(CapCosine, IsTheQuadratureWhateverTheHorizonCutsOff) {
  for (const double radius : {1e-6, 1e-3, 0.1, 0.7, 1.5, kPi<double> / 2, 2.0, 3.0, 3.14}) {
    for (double offset = -1.2; offset <= 1.2; offset += 0.15) {
      // Around the horizon for small caps, the whole range for large ones.
      const double angle =
          std::clamp(kPi<double> / 2 + offset * std::max(radius, 0.2 * (radius > 0.1)), 1e-3, 3.14);
      const double height = 2 * std::pow(std::sin(radius / 2), 2);
      const double most = kPi<double> * (height < 1 ? height * (2 - height) : 1);
      const double truth = cap_truth(radius, angle);
      // The truth's own rounding: differences of angles near pi / 2, 1e-16 of 1e-6.
      const double rounding = 1e-11 + 1e-15 / radius;
      EXPECT_NEAR(cap_cosine_integral(height, std::cos(angle)) / most, truth / most, rounding)
          << radius << " " << angle;
      // The cosine itself is rounded: by 6e-8 of 1, which for a small cap is more than its radius.
      const auto cosine = float(std::cos(angle));
      EXPECT_NEAR(cap_cosine_integral(float(height), cosine) / most,
                  cap_cosine_integral(double(float(height)), double(cosine)) / most, 2e-6)
          << radius << " " << angle;
    }
  }
}

Vector3f random_vector(std::mt19937& random) {
  return test::random_direction(random).cast<float>();
}

float irradiance(const LightAtPoint& light) { return light.color.x() * light.cosine_integral; }
float energy(const LightAtPoint& light) { return light.color.x() * light.integral; }

/// Everything an incoming light holds is finite, and its colors are not negative.
void expect_finite(const LightAtPoint& light) {
  if (!light.reaches) return;
  EXPECT_TRUE(light.lobe.frame.x.allFinite() && light.lobe.frame.y.allFinite());
  EXPECT_NEAR(light.lobe.frame.z.norm(), 1, 1e-5);
  EXPECT_TRUE(std::isfinite(light.lobe.bandwidth_x) && light.lobe.bandwidth_x >= 0);
  EXPECT_TRUE(std::isfinite(light.lobe.bandwidth_y) && light.lobe.bandwidth_y >= 0);
  EXPECT_TRUE(light.color.allFinite() && (light.color >= 0).all());
  EXPECT_TRUE(std::isfinite(light.integral) && light.integral > 0);
  EXPECT_TRUE(std::isfinite(light.cosine_integral) && light.cosine_integral >= 0);
}

TEST(SphereLight, IrradianceIsTheClosedFormAtEveryDistanceAndScale) {
  const Vector3f normal = Vector3f::UnitZ();
  const Vector3f toward = Vector3f(0.6f, 0, 0.8f);
  for (const float scale : {1e-6f, 1.0f, 1e6f}) {
    for (const float ratio : {1.3f, 2.0f, 10.0f, 1e3f, 1e6f, 1e15f}) {
      const SphereLight light{scale * toward, scale / ratio, Rgb::Constant(3)};
      const LightAtPoint seen = light_at(light, Vector3f::Zero(), normal);
      expect_finite(seen);
      const double truth = ratio > 1.5f
                               ? 3 * kPi<double> * 0.8 / (double(ratio) * ratio)
                               : 3 * cap_truth(std::asin(1 / double(ratio)), std::acos(0.8));
      // Radius, centre and cosine are floats: a dozen roundings.
      EXPECT_NEAR(irradiance(seen) / truth, 1, 2e-6) << scale << " " << ratio;
      const double sine2 = 1 / (double(ratio) * ratio);
      const double solid_angle = 2 * kPi<double> * sine2 / (1 + std::sqrt(1 - sine2));
      EXPECT_NEAR(energy(seen) / (3 * solid_angle), 1, 2e-6) << scale << " " << ratio;
    }
  }
}

TEST(SphereLight, CutByTheHorizonIsTheQuadrature) {
  for (const double angle : {1.2, 1.5, kPi<double> / 2, 1.7, 2.1}) {
    const Vector3f center(float(2 * std::sin(angle)), 0, float(2 * std::cos(angle)));
    for (const float radius : {0.3f, 1.0f, 1.9f}) {
      const LightAtPoint seen =
          light_at(SphereLight{center, radius, Rgb::Ones()}, Vector3f::Zero(), Vector3f::UnitZ());
      expect_finite(seen);
      const double sine = radius / center.cast<double>().norm();
      const double truth =
          cap_truth(std::asin(sine), std::acos(double(center.z()) / center.cast<double>().norm()));
      // The stated 2e-6 of what the light would give overhead, pi sin^2.
      EXPECT_NEAR(irradiance(seen), truth, 2e-6 * kPi<double> * sine * sine) << angle << radius;
      EXPECT_EQ(seen.reaches, truth > 0) << angle << radius;
    }
  }
}

TEST(SphereLight, IsAHemisphereOnItsSurfaceAndAllDirectionsInside) {
  // From the surface, a cap of a quarter turn: pi (1 + cos) / 2. Inside, pi for every normal.
  for (const float radius : {1e-6f, 1.0f, 1e6f}) {
    const SphereLight light{Vector3f(0, 0, radius), radius, Rgb::Ones()};
    for (const double angle : {0.0, 1.0, 2.0, 3.0}) {
      const Vector3f normal(float(std::sin(angle)), 0, float(std::cos(angle)));
      const LightAtPoint on = light_at(light, Vector3f::Zero(), normal);
      EXPECT_NEAR(irradiance(on), kPi<double> * (1 + std::cos(angle)) / 2, 1e-5) << angle;
      for (const float height : {0.02f, 0.5f, 1.0f}) {
        const LightAtPoint inside = light_at(light, Vector3f(0, 0, height * radius), normal);
        expect_finite(inside);
        EXPECT_NEAR(irradiance(inside), kPi<double>, 1e-5) << angle << " " << height;
        EXPECT_NEAR(energy(inside), 4 * kPi<double>, 1e-5);
      }
    }
  }
}

TEST(SphereLight, IsContinuousAcrossItsSurface) {
  const SphereLight light{Vector3f::Zero(), 2, Rgb::Ones()};
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  const Vector3f direction = random_vector(random), normal = random_vector(random);
  LightAtPoint last = light_at(light, direction * 2.1f, normal);
  // Outside, the cap's radius is asin(R / D), with a square-root start at the surface: between two
  // steps of 1e-4 radii it moves by at most sqrt(2e-4) = .014, the irradiance by at most pi times,
  // the energy by at most 2 pi times as much.
  for (float distance = 2.1f; distance > 1.9f; distance -= 2e-4f) {
    const LightAtPoint seen = light_at(light, direction * distance, normal);
    expect_finite(seen);
    EXPECT_NEAR(irradiance(seen), irradiance(last), 0.045) << distance;
    EXPECT_NEAR(energy(seen), energy(last), 0.09) << distance;
    last = seen;
  }
}

TEST(SphereLight, OfAPowerFallsWithTheSquareOfTheDistance) {
  const Rgb power(100, 50, 0);
  for (const float radius : {0.01f, 0.5f}) {
    const SphereLight light{Vector3f::Zero(), radius, radiance_of_sphere(power, radius)};
    EXPECT_LT((power_of_sphere(light.radiance, radius) - power).abs().maxCoeff(), 1e-4);
    for (const float distance : {1.0f, 2.0f, 40.0f}) {
      const LightAtPoint seen = light_at(light, Vector3f(0, 0, -distance), Vector3f(0.6f, 0, 0.8f));
      // All of the power through a sphere of this radius, at a cosine of .8: exact, because a
      // sphere shines as from its centre. Float: a dozen roundings.
      const Rgb truth = 0.8f * power / (4 * kPi<float> * distance * distance);
      EXPECT_LT((seen.color * seen.cosine_integral - truth).abs().maxCoeff(),
                2e-6f * truth.maxCoeff());
    }
  }
}

TEST(DirectionalLight, GivesItsIrradianceAtNormalIncidence) {
  const Vector3f normal = Vector3f::UnitZ();
  const Rgb given(3, 2, 1);
  for (const float radius : {0.0f, 1e-8f, 0.00465f, 0.3f, kPi<float> / 2}) {
    const DirectionalLight overhead{normal, radius, given};
    const LightAtPoint seen = light_at(overhead, Vector3f(7, 8, 9), normal);
    expect_finite(seen);
    // Sines and their squares, and the sharpness that goes in and out.
    EXPECT_LT((seen.color * seen.cosine_integral - given).abs().maxCoeff(), 1e-5) << radius;
    const DirectionalLight oblique{Vector3f(0.96f, 0, 0.28f), radius, given};
    // Above the horizon it falls with the cosine, up to a radius of asin(.28).
    if (radius < 0.28f) {
      EXPECT_NEAR(irradiance(light_at(oblique, Vector3f::Zero(), normal)), 0.28 * 3, 1e-5);
    }
    const DirectionalLight below{-normal, std::min(radius, 1.5f), given};
    EXPECT_FALSE(light_at(below, Vector3f::Zero(), normal).reaches);
  }
}

TEST(DirectionalLight, SetsGradually) {
  for (const float radius : {0.00465f, 0.5f}) {
    for (const double share : {-1.1, -0.9, -0.3, 0.0, 0.5, 1.1}) {
      const double angle = kPi<double> / 2 - share * double(radius);
      const DirectionalLight sun{Vector3f(float(std::sin(angle)), 0, float(std::cos(angle))),
                                 radius, irradiance_of_disc(Rgb::Ones(), radius)};
      const LightAtPoint seen = light_at(sun, Vector3f::Zero(), Vector3f::UnitZ());
      EXPECT_EQ(seen.reaches, share > -1);
      const double truth = cap_truth(double(radius), angle);
      const double overhead = kPi<double> * std::pow(std::sin(double(radius)), 2);
      // The stated 2e-6, and the rounding of the axis' z, 3e-8 of the radius.
      if (seen.reaches) {
        EXPECT_NEAR(irradiance(seen) / overhead, truth / overhead, 4e-6) << radius << " " << share;
      }
    }
  }
}

TEST(DirectionalLight, IsAFarSphereOfTheSameSize) {
  for (const float radius : {1e-3f, 0.2f, 1.2f}) {
    const Vector3f toward = Vector3f(2, -1, 0.4f).normalized();
    const Rgb radiance(5, 6, 7);
    const DirectionalLight sun{toward, radius, irradiance_of_disc(radiance, radius)};
    EXPECT_LT((radiance_of_disc(sun.irradiance, radius) / radiance - 1).abs().maxCoeff(), 1e-6);
    const SphereLight sphere{1000 * toward, 1000 * std::sin(radius), radiance};
    const LightAtPoint a = light_at(sun, Vector3f::Zero(), Vector3f::UnitZ());
    const LightAtPoint b = light_at(sphere, Vector3f::Zero(), Vector3f::UnitZ());
    // The square root of 1 - sine^2 magnifies the rounding of a large sine, by 1 / cos(1.2) twice.
    EXPECT_NEAR(a.lobe.bandwidth_x / b.lobe.bandwidth_x, 1, 2e-5);
    EXPECT_NEAR(energy(a) / energy(b), 1, 2e-5);
    EXPECT_NEAR(irradiance(a) / irradiance(b), 1, 2e-5);
  }
}

/// Sums over a fine grid of a rectangle's points.
struct RectangleTruth {
  double solid_angle = 0, cosine = 0;
  Vector3d mean = Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
};

RectangleTruth rectangle_truth(const RectangleLight& light, const Vector3d& position,
                               const Vector3d& normal, int steps) {
  const std::vector<test::Node> nodes = test::rectangle_nodes(light, position, steps);
  RectangleTruth sum;
  for (const auto& [direction, weight] : nodes) {
    sum.solid_angle += weight;
    sum.cosine += weight * std::max(direction.dot(normal), 0.0);
    sum.mean += weight * direction;
  }
  const Vector3d axis = sum.mean.normalized();
  for (const auto& [direction, weight] : nodes) {
    const Vector3d across = direction - axis * axis.dot(direction);
    sum.spread += weight * across * across.transpose();
  }
  return sum;
}

/// A rectangle of a random place and shape, some units away from the origin.
RectangleLight random_rectangle(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> unit(0, 1);
  const Frame<float> frame =
      test::random_frame(test::random_direction(random), random).cast<float>();
  RectangleLight light;
  light.center = (1 + unit(random)) * random_vector(random);
  light.edge_x = size * (0.2f + unit(random)) * frame.x;
  light.edge_y = size * (0.2f + unit(random)) * frame.y;
  light.radiance = Rgb::Constant(2);
  light.two_sided = true;
  return light;
}

TEST(RectangleLight, MomentsAreTheQuadrature) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (const float size : {1e-9f, 1e-7f, 1e-5f, 1e-3f, 0.1f, 0.5f, 2.0f}) {
    for (int i = 0; i < 10; ++i) {
      const RectangleLight light = random_rectangle(random, size);
      // The plane at a distance at which 48 nodes converge to 1e-7.
      if (std::abs(light.center.dot(light.edge_x.cross(light.edge_y).normalized())) < 0.2f * size)
        continue;
      const RectangleMoments found = rectangle_moments(light, Vector3f::Zero());
      const RectangleTruth truth = rectangle_truth(light, Vector3d::Zero(), Vector3d::UnitZ(), 48);
      ASSERT_GT(truth.solid_angle, 0);
      EXPECT_NEAR(found.solid_angle / truth.solid_angle, 1, 1e-6) << size;
      EXPECT_LT((found.mean - truth.mean).norm() / truth.solid_angle, 1e-6) << size;
      EXPECT_LT((found.spread - truth.spread).norm() / truth.spread.norm(), 1e-5) << size;
    }
  }
}

/// However small: their corners are then the same, or nearly, in double.
TEST(RectangleLight, TinyOnesArePoints) {
  const Vector3d normal = Vector3d(0, 0.6, 0.8);
  for (const float tilt : {1.0f, 1.0f / 32, 1.0f / 4096}) {  // from facing to grazing
    for (float size = 1e-3f; size > 1e-16f; size /= 8) {
      RectangleLight light;
      light.edge_x = Vector3f(size, 0, 0);
      light.edge_y = Vector3f(0, 0, size / 2);
      light.radiance = Rgb::Ones();
      light.two_sided = true;
      light.center = Vector3f(0.25f, tilt, 1);  // its plane passes the point at this distance
      const Vector3d center = light.center.cast<double>();
      const double distance = center.norm();
      const double solid_angle =
          double(size) * double(size / 2) * double(tilt) / std::pow(distance, 3);
      const RectangleMoments found = rectangle_moments(light, Vector3f::Zero());
      // What a point leaves out is size^2; the closed form just above an extent of 1e-3 loses 1e-16
      // over size and tilt.
      const double tolerance = 2 * double(size) * double(size) + 1e-9;
      EXPECT_NEAR(found.solid_angle / solid_angle, 1, tolerance) << size << " " << tilt;
      EXPECT_LT((found.mean / solid_angle - center / distance).norm(), tolerance)
          << size << " " << tilt;
      const LightAtPoint seen = light_at(light, Vector3f::Zero(), normal.cast<float>());
      expect_finite(seen);
      // Half a dozen float roundings.
      EXPECT_NEAR(irradiance(seen) / (solid_angle * normal.dot(center) / distance), 1,
                  1e-6 + tolerance)
          << size << " " << tilt;
      // Cut in half by the horizon: within the size of nothing.
      const LightAtPoint cut =
          light_at(light, Vector3f::Zero(), Vector3f(0, -1, tilt).normalized());
      EXPECT_LT(cut.reaches ? irradiance(cut) / solid_angle : 0, double(size) + 2e-7)
          << size << " " << tilt;
    }
  }
}

TEST(RectangleLight, IrradianceIsTheQuadratureAlsoCutByTheHorizon) {
  std::mt19937 random(kSeed + 1);
  SCOPED_TRACE(kSeed + 1);
  int cut = 0;
  for (int i = 0; i < 60; ++i) {
    const RectangleLight light = random_rectangle(random, i % 2 ? 0.3f : 2.0f);
    if (std::abs(light.center.dot(light.edge_x.cross(light.edge_y).normalized())) < 0.1f) continue;
    const Vector3f normal = random_vector(random);
    const LightAtPoint seen = light_at(light, Vector3f::Zero(), normal);
    expect_finite(seen);
    const RectangleTruth truth =
        rectangle_truth(light, Vector3d::Zero(), normal.cast<double>(), 200);
    // The integrand has a kink at the horizon: 200 nodes a side leave 1e-4 of the solid angle.
    EXPECT_NEAR(seen.reaches ? irradiance(seen) : 0.0, 2 * truth.cosine,
                2e-4 * truth.solid_angle + 1e-7);
    if (seen.reaches) {
      EXPECT_NEAR(energy(seen) / (2 * truth.solid_angle), 1, 1e-4);
      cut += truth.cosine > 1e-3 &&
             std::abs(truth.cosine - truth.mean.dot(normal.cast<double>())) > 1e-3;
    }
  }
  EXPECT_GT(cut, 5);  // the horizon was met
}

TEST(RectangleLight, IrradianceIsTheViewFactorOfTheHandbook) {
  // From an element to a parallel rectangle whose corner is above it (howell2010catalog, B-4).
  for (const double a : {0.1, 1.0, 20.0}) {
    for (const double b : {0.5, 3.0}) {
      const double ra = std::sqrt(1 + a * a), rb = std::sqrt(1 + b * b);
      const double factor = (a / ra * std::atan(b / ra) + b / rb * std::atan(a / rb)) / 2;
      for (const float scale : {1e-6f, 1.0f, 1e6f}) {
        RectangleLight light;
        light.center = scale * Vector3f(float(a / 2), float(b / 2), 1);
        light.edge_x = scale * Vector3f(0, float(b), 0);
        light.edge_y = scale * Vector3f(float(a), 0, 0);  // shines down
        light.radiance = Rgb::Ones();
        const LightAtPoint seen = light_at(light, Vector3f::Zero(), Vector3f::UnitZ());
        // Half an edge is a float.
        EXPECT_NEAR(irradiance(seen) / factor, 1, 2e-6) << a << " " << b << " " << scale;
      }
    }
  }
}

TEST(RectangleLight, FarAwayIsAPointOfItsPower) {
  const Rgb power(40, 20, 10);
  for (const bool two_sided : {false, true}) {
    RectangleLight light;
    light.edge_x = Vector3f(0.2f, 0, 0);
    light.edge_y = Vector3f(0, 0.5f, 0);
    light.radiance = radiance_of_rectangle(power, 0.2f, 0.5f, two_sided);
    light.two_sided = two_sided;
    EXPECT_LT((power_of_rectangle(light.radiance, 0.2f, 0.5f, two_sided) - power).abs().maxCoeff(),
              1e-5);
    for (const float distance : {1e3f, 1e6f}) {
      const Vector3f position = distance * Vector3f(0.6f, 0, 0.8f);
      const LightAtPoint seen = light_at(light, position, Vector3f(-0.6f, 0, -0.8f));
      expect_finite(seen);
      // Lambert's law: intensity = power / pi (half of it for two sides) times the cosine.
      const double truth =
          40 / kPi<double> * 0.8 / (two_sided ? 2 : 1) / (double(distance) * distance);
      EXPECT_NEAR(irradiance(seen) / truth, 1, 1e-5) << distance;  // (size / distance)^2, floats
    }
  }
}

TEST(RectangleLight, ShinesOnItsSideOnly) {
  RectangleLight light;
  light.radiance = Rgb::Ones();
  const Vector3f front(0.3f, 0.2f, 0.7f), back(0.3f, 0.2f, -0.7f);
  EXPECT_TRUE(light_at(light, front, -Vector3f::UnitZ()).reaches);
  EXPECT_FALSE(light_at(light, front, Vector3f::UnitZ()).reaches);  // below the horizon
  EXPECT_FALSE(light_at(light, back, Vector3f::UnitZ()).reaches);
  EXPECT_EQ(rectangle_moments(light, back).solid_angle, 0);
  light.two_sided = true;
  const LightAtPoint before = light_at(light, front, -Vector3f::UnitZ());
  const LightAtPoint behind = light_at(light, back, Vector3f::UnitZ());
  EXPECT_NEAR(irradiance(before), irradiance(behind), 1e-6);
  EXPECT_NEAR(before.lobe.frame.z.z(), -behind.lobe.frame.z.z(), 1e-6);
  // In its plane, inside and outside, on a corner and on the middle of an edge: nothing, and no
  // NaN.
  for (const Vector3f& position :
       {Vector3f(0, 0, 0), Vector3f(3, 1, 0), Vector3f(0.5f, 0.5f, 0), Vector3f(0.5f, 0, 0)})
    EXPECT_FALSE(light_at(light, position, -Vector3f::UnitZ()).reaches);
}

TEST(RectangleLight, JustBeforeItFillsTheHemisphere) {
  RectangleLight light;
  light.radiance = Rgb::Ones();
  for (const float height : {1e-3f, 1e-6f, 1e-20f, 1e-38f}) {
    const LightAtPoint seen = light_at(light, Vector3f(0.1f, 0, height), -Vector3f::UnitZ());
    expect_finite(seen);
    // What misses is a rim up to an elevation of height / .4, and has its square as cosine
    // integral.
    const double rim = kPi<double> * std::pow(height / 0.4, 2);
    EXPECT_NEAR(irradiance(seen), kPi<double>, rim + 1e-6) << height;
    EXPECT_NEAR(energy(seen), 2 * kPi<double>, 4 * kPi<double> * height + 1e-5) << height;
    // On an edge, half of it.
    const LightAtPoint edge = light_at(light, Vector3f(0.5f, 0, height), -Vector3f::UnitZ());
    expect_finite(edge);
    EXPECT_NEAR(irradiance(edge), kPi<double> / 2, 4 * height + 1e-5) << height;
  }
}

TEST(RectangleLight, LobeHasItsMeanAndItsSecondMoments) {
  std::mt19937 random(kSeed + 2);
  SCOPED_TRACE(kSeed + 2);
  for (int i = 0; i < 40; ++i) {
    const RectangleLight light = random_rectangle(random, i % 2 ? 0.2f : 0.6f);
    const RectangleMoments truth = rectangle_moments(light, Vector3f::Zero());
    if (truth.solid_angle < 1e-4) continue;
    const Vector3f normal = truth.mean.normalized().cast<float>();
    const LightAtPoint seen = light_at(light, Vector3f::Zero(), normal);
    EXPECT_LT((seen.lobe.frame.z - normal).norm(), 1e-6);
    const LobeMoments<double> moments =
        asg_moments<double>(seen.lobe.bandwidth_x, seen.lobe.bandwidth_y);
    const Vector3d x = seen.lobe.frame.x.cast<double>(), y = seen.lobe.frame.y.cast<double>();
    const double xx = x.dot(truth.spread * x) / truth.solid_angle;
    const double yy = y.dot(truth.spread * y) / truth.solid_angle;
    EXPECT_NEAR(x.dot(truth.spread * y) / truth.solid_angle, 0, 1e-6);
    // The relation of bandwidth and moment is that of round lobes: exact where equal or narrow.
    EXPECT_NEAR(moments.mean_xx, xx, 0.02 * std::max(xx, yy)) << i;
    EXPECT_NEAR(moments.mean_yy, yy, 0.02 * std::max(xx, yy)) << i;
  }
}

TEST(LocalLights, TurnWithEverythingElse) {
  std::mt19937 random(kSeed + 3);
  SCOPED_TRACE(kSeed + 3);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Matrix3f turn = minimal_rotation(random_vector(random), random_vector(random));
    const Vector3f position = random_vector(random), normal = random_vector(random);
    RectangleLight panel = random_rectangle(random, 1), turned_panel = panel;
    turned_panel.center = turn * panel.center;
    turned_panel.edge_x = turn * panel.edge_x;
    turned_panel.edge_y = turn * panel.edge_y;
    const LightAtPoint a = light_at(panel, position, normal);
    const LightAtPoint b = light_at(turned_panel, turn * position, turn * normal);
    ASSERT_EQ(a.reaches, b.reaches);
    if (!a.reaches) continue;
    // Floats turned by a float matrix.
    EXPECT_NEAR(irradiance(a), irradiance(b), 2e-5);
    EXPECT_NEAR(a.lobe.bandwidth_x / b.lobe.bandwidth_x, 1, 1e-4);
    EXPECT_LT((turn * a.lobe.frame.z - b.lobe.frame.z).norm(), 1e-5);
  }
}

TEST(LocalLights, DomainErrorsNameTheField) {
  EXPECT_EQ(domain_error(SphereLight{}), "");
  EXPECT_EQ(domain_error(DirectionalLight{}), "");
  EXPECT_EQ(domain_error(RectangleLight{}), "");
  SphereLight sphere;
  sphere.radius = -1;
  EXPECT_EQ(domain_error(sphere), "radius is -1.000000, expected a finite number > 0");
  sphere = {};
  sphere.center.y() = NAN;
  EXPECT_EQ(domain_error(sphere), "center is not finite");
  sphere = {};
  sphere.radiance.y() = -2;
  EXPECT_EQ(domain_error(sphere), "radiance is -2.000000, expected a finite number >= 0");
  DirectionalLight sun;
  sun.toward *= 2;
  EXPECT_EQ(domain_error(sun), "toward has length 2.000000, expected 1");
  sun = {};
  sun.angular_radius_rad = 2;
  EXPECT_EQ(domain_error(sun), "angular_radius_rad is 2.000000, expected 0 to pi / 2");
  sun = {};
  sun.angular_radius_rad = 0;  // shades as 1e-4: a radiance of 1e32 / (pi 1e-8)
  sun.irradiance.x() = 1e32f;
  EXPECT_EQ(domain_error(sun), "radiance of the irradiance is inf, expected at most 1e+30");
  sphere = {};
  sphere.radiance.x() = 2e30f;
  EXPECT_EQ(domain_error(sphere), "radiance is 2e+30, expected at most 1e+30");
  EnvironmentLobe lobe{{{}, 2, 2, 1e20f}, Rgb(0, -1e11f, 0)};
  EXPECT_EQ(domain_error(lobe), "color times amplitude is 1e+31, expected at most 1e+30");
  lobe.color.y() = -1e10f;
  EXPECT_EQ(domain_error(lobe), "");
  lobe.color.y() = NAN;
  EXPECT_EQ(domain_error(lobe), "color is nan, expected a finite number");
  RectangleLight panel;
  panel.edge_y.setZero();
  EXPECT_EQ(domain_error(panel), "edge_y has length 0.000000, expected a finite number > 0");
  panel.edge_y = Vector3f(1, 1, 0);
  EXPECT_EQ(domain_error(panel), "edge_x and edge_y have cosine 0.707107, expected 0");
}

}  // namespace
}  // namespace burnish
