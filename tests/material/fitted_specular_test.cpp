#include "burnish/material/fitted_specular.h"

#include <gtest/gtest.h>

#include "material/sample_materials.h"

namespace burnish {
namespace {

const FittedSpecular& fitted() {
  static const Material material = test::two_fitted_lobes();
  return *material.fitted;
}

float cos_deg(double degrees) { return float(std::cos(degrees * kPi<double> / 180)); }

TEST(FittedSpecular, DistributionIsTheSumOfItsLobesAboveTheHorizon) {
  const Vector3f h(0.6f, 0, 0.8f);
  // Of the first lobe: 2 * .8 exp(-60 * .36); the second has its peak there.
  EXPECT_NEAR(eval_distribution(fitted(), h), 2 + 1.6 * std::exp(-60 * 0.36), 1e-5);
  EXPECT_EQ(eval_distribution(fitted(), Vector3f(0.9998f, 0, -0.02f)), 0);
}

TEST(FittedSpecular, TablesAreLinearInTheAngleBetweenTheirEntries) {
  // Three entries: at 0, 45 and 90 degrees. masking is 1, .9, 1.5.
  const auto at = [](double o, double i, double d) {
    return eval_smooth_factor(fitted(), cos_deg(o), cos_deg(i), cos_deg(d));
  };
  EXPECT_TRUE(at(0, 0, 0).isApprox(Rgb(0.2f, 0.3f, 0.4f), 1e-5f));
  EXPECT_TRUE(at(45, 0, 0).isApprox(0.9f * Rgb(0.2f, 0.3f, 0.4f), 1e-5f));
  EXPECT_TRUE(at(0, 67.5, 0).isApprox(1.2f * Rgb(0.2f, 0.3f, 0.4f), 1e-5f));
  EXPECT_TRUE(at(0, 0, 22.5).isApprox(Rgb(0.25f, 0.3f, 0.35f), 1e-5f));
  EXPECT_TRUE(at(90, 90, 90).isApprox(Rgb::Constant(2.25f), 1e-5f));
}

TEST(FittedSpecular, TablesAreClampedBeyondTheirEnds) {
  const Rgb at_end = eval_smooth_factor(fitted(), 0, 1, 0);
  EXPECT_TRUE(eval_smooth_factor(fitted(), -0.5f, 1.0000002f, -1e-6f).isApprox(at_end, 1e-5f));
}

TEST(FittedSpecular, HasItsOwnLobesAsHalfVectorLobes) {
  const HalfVectorLobes lobes = half_vector_lobes(test::two_fitted_lobes(), 1);
  ASSERT_EQ(lobes.count, 2);
  EXPECT_EQ(lobes.lobe[1].frame.z, fitted().lobes[1].frame.z);
  EXPECT_EQ(lobes.lobe[0].bandwidth_x, fitted().lobes[0].bandwidth_x);
}

TEST(FittedSpecular, WithoutAnyAmplitudeIsBlack) {
  Material material = test::two_fitted_lobes();
  FittedSpecular dark = fitted();
  for (AnisotropicGaussian<float>& lobe : dark.lobes) lobe.amplitude = 0;
  material.fitted = std::make_shared<const FittedSpecular>(dark);
  const Vector3f o = test::from_angles(30, 10);
  const Vector3f i = sample_specular_brdf(material, o, 0.3f, 0.6f);
  EXPECT_TRUE(i.allFinite());
  EXPECT_EQ(pdf_specular_brdf(material, o, i), 0);
  EXPECT_EQ(eval_specular_brdf(material, o, i).x(), 0);
}

}  // namespace
}  // namespace burnish
