#include "burnish/light/prefiltered_environment.h"

#include <random>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

AnisotropicGaussian<float> lobe_at(const Vector3d& axis, std::mt19937& random, float bandwidth_x,
                                   float bandwidth_y) {
  AnisotropicGaussian<float> lobe;
  lobe.frame = test::random_frame(axis, random).cast<float>();
  lobe.bandwidth_x = bandwidth_x;
  lobe.bandwidth_y = bandwidth_y;
  return lobe;
}

TEST(PrefilteredEnvironment, ConstantMapStaysThatConstant) {
  const unsigned seed = 4;
  std::mt19937 random(seed);
  const Rgb color(0.25f, 1, 40);
  const PrefilteredEnvironment environment = prefilter_environment(Image(16, 8, color));
  for (const auto& [bx, by] :
       {std::pair{0.f, 0.f}, {1e-3f, 5.f}, {1.f, 100.f}, {1e4f, 1e4f}, {1e8f, 2.f}}) {
    for (const int taps : {1, 7, 64}) {
      const Rgb mean = eval_prefiltered(
          environment, lobe_at(test::random_direction(random), random, bx, by), taps);
      // Weights are normalised: only their rounding is left.
      EXPECT_LT((mean / color - 1).abs().maxCoeff(), 1e-5) << "seed " << seed;
    }
  }
}

TEST(PrefilteredEnvironment, MatchesQuadratureOfASmoothMap) {
  // Two soft lights on a dim sky, of which a lobe's mean is integrated directly over the map's
  // pixels.
  const unsigned seed = 8;
  std::mt19937 random(seed);
  Image map(128, 64);
  const Vector3d a = Vector3d(1, 2, 0.5).normalized(), b = Vector3d(-0.3, 0.2, -1).normalized();
  std::vector<Vector3d> directions;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const Vector3d d = direction_from_latlong((x + 0.5) / map.width, (y + 0.5) / map.height);
      directions.push_back(d);
      map.at(x, y) = Rgb(0.1f, 0.2f, 0.3f) + Rgb(3, 2, 1) * float(std::exp(20 * (d.dot(a) - 1))) +
                     Rgb(0, 2, 4) * float(std::exp(60 * (d.dot(b) - 1)));
    }
  }
  const PrefilteredEnvironment environment = prefilter_environment(map);
  for (const auto& [bx, by] :
       {std::pair{1.f, 1.f}, {6.f, 6.f}, {40.f, 40.f}, {100.f, 100.f}, {60.f, 6.f}, {2.f, 200.f}}) {
    double error = 0, norm = 0;
    for (int i = 0; i < 60; ++i) {
      const AnisotropicGaussian<float> lobe =
          lobe_at(test::random_direction(random), random, bx, by);
      const AnisotropicGaussian<double> exact{lobe.frame.cast<double>(), bx, by, 1};
      Eigen::Array3d sum = Eigen::Array3d::Zero();
      double whole = 0;
      for (size_t p = 0; p < directions.size(); ++p) {
        const double weight =
            eval(exact, directions[p]) * latlong_pixel_solid_angle(map, int(p) / map.width);
        sum += weight * map.pixels[p].cast<double>();
        whole += weight;
      }
      const Eigen::Array3d mean = eval_prefiltered(environment, lobe, 32).cast<double>();
      error += (mean - sum / whole).square().sum();
      norm += (sum / whole).square().sum();
    }
    // The filter's stated error is 3 % relative L2 on photographs, 4 % for lobes as long as a
    // hemisphere; this map is smoother.
    EXPECT_LT(std::sqrt(error / norm), 0.03) << bx << " " << by << " seed " << seed;
  }
}

TEST(PrefilteredEnvironment, TurnsWithTheEnvironment) {
  Image map(32, 16);
  map.at(8, 8) = Rgb::Constant(100);  // along +x
  PrefilteredEnvironment environment = prefilter_environment(map);
  AnisotropicGaussian<float> lobe;
  lobe.bandwidth_x = lobe.bandwidth_y = 50;
  lobe.frame = frame_from_axis(Vector3f(0, 0, 1));
  const float away = eval_prefiltered(environment, lobe, 8).x();
  // The world's +z is the environment's +x.
  environment.environment_from_world =
      Eigen::AngleAxisf(kPi<float> / 2, Vector3f::UnitY()).toRotationMatrix();
  const float toward = eval_prefiltered(environment, lobe, 8).x();
  EXPECT_LT(away, 1e-3);
  EXPECT_GT(toward, 1);
}

}  // namespace
}  // namespace burnish
