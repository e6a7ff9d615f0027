#include "burnish/light/lobe_moments.h"

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

TEST(LobeMoments, MatchQuadrature) {
  for (const auto& [bx, by] :
       {std::pair{0.0, 0.0}, {1e-4, 2.0}, {1.0, 1.0}, {10.0, 1.0}, {60.0, 60.0}, {0.5, 90.0}}) {
    AnisotropicGaussian<double> lobe;
    lobe.bandwidth_x = bx;
    lobe.bandwidth_y = by;
    const auto mean = [&](auto f) {
      return test::integrate_sphere([&](const Vector3d& v) { return eval(lobe, v) * f(v); },
                                    Vector3d::UnitZ(), 200);
    };
    const double whole = mean([](const Vector3d&) { return 1.0; });
    const double z = mean([](const Vector3d& v) { return v.z(); }) / whole;
    const LobeMoments<double> m = asg_moments(bx, by);
    EXPECT_NEAR(m.mean_z, z, 1e-5);
    EXPECT_NEAR(m.mean_xx, mean([](const Vector3d& v) { return v.x() * v.x(); }) / whole, 1e-5);
    EXPECT_NEAR(m.mean_yy, mean([](const Vector3d& v) { return v.y() * v.y(); }) / whole, 1e-5);
    EXPECT_NEAR(m.variance_z, mean([](const Vector3d& v) { return v.z() * v.z(); }) / whole - z * z,
                2e-5);
  }
}

TEST(LobeMoments, OfACapMatchQuadrature) {
  for (const double cos_edge : {0.95, 0.3, -0.5, -1.0}) {
    double whole = 0, z = 0, zz = 0;
    for (const auto& [u, w] : test::gauss_legendre(20, cos_edge, 1)) {
      whole += w;
      z += w * u;
      zz += w * u * u;
    }
    const LobeMoments<double> m = cap_moments(cos_edge);
    EXPECT_NEAR(m.mean_z, z / whole, 1e-12);
    EXPECT_NEAR(m.mean_xx, (1 - zz / whole) / 2, 1e-12);
    EXPECT_NEAR(m.variance_z, zz / whole - z * z / whole / whole, 1e-12);
  }
}

TEST(LobeMoments, ClampedCosineKeepsItsStatedError) {
  struct Case {
    double bandwidth_x, bandwidth_y, relative_l2;
  };
  // The figures of the declaration's comment, with a tenth of room for the choice of normals.
  for (const Case& c :
       {Case{0, 0, 0.036}, {1, 1, 0.028}, {10, 1, 0.024}, {16, 4, 0.0075}, {64, 64, 2e-4}}) {
    AnisotropicGaussian<double> lobe;
    lobe.bandwidth_x = c.bandwidth_x;
    lobe.bandwidth_y = c.bandwidth_y;
    const LobeMoments<double> moments = asg_moments(c.bandwidth_x, c.bandwidth_y);
    const double whole = integral(lobe);
    double error = 0, norm = 0;
    for (int t = 0; t <= 12; ++t) {
      for (int p = 0; p < 4; ++p) {
        const double theta = kPi<double> * t / 12, phi = kPi<double> / 6 * p;
        const Vector3d n(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                         std::cos(theta));
        // The quadrature's pole is the normal, so that the clamp's edge is a node boundary; the
        // lobe's own horizon is a kink in its derivative only, which leaves 1e-4.
        const double truth = test::integrate_sphere(
            [&](const Vector3d& v) { return eval(lobe, v) * std::max(n.dot(v), 0.0); }, n, 96);
        const double estimate = whole * mean_clamped_cosine(moments, n);
        error += std::sin(theta) * (estimate - truth) * (estimate - truth);
        norm += std::sin(theta) * truth * truth;
      }
    }
    EXPECT_LT(std::sqrt(error / norm), 1.1 * c.relative_l2 + 1e-4)
        << c.bandwidth_x << " " << c.bandwidth_y;
  }
}

TEST(LobeMoments, ClampedCosineIsFiniteForNeedles) {
  const LobeMoments<float> needle{1, 0, 0, 0};
  EXPECT_NEAR(mean_clamped_cosine(needle, Vector3f(0, 0.6f, 0.8f)), 0.8f, 1e-6f);
  EXPECT_EQ(mean_clamped_cosine(needle, Vector3f(0, 0.6f, -0.8f)), 0);
  EXPECT_GE(mean_clamped_cosine(needle, Vector3f(1, 0, 0)), 0);
}

}  // namespace
}  // namespace burnish
