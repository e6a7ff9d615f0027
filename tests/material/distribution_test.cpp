#include <gtest/gtest.h>

#include "material/sample_materials.h"

namespace burnish {
namespace {

using test::from_angles;

class DistributionOf : public testing::TestWithParam<test::NamedMaterial> {
 protected:
  const Material& material = GetParam().material;
};
INSTANTIATE_TEST_SUITE_P(Of, DistributionOf, testing::ValuesIn(test::all_materials()),
                         [](const auto& info) { return info.param.name; });

TEST_P(DistributionOf, IsThePublishedFormula) {
  for (const float alpha_x : {kMinAlpha, 0.01f, 0.3f, kMaxAlpha})
    for (const float alpha_y : {kMinAlpha, 0.3f, kMaxAlpha}) {
      Material m = material;
      m.alpha_x = alpha_x;
      m.alpha_y = alpha_y;
      for (const double reach : {0.0, 0.3, 1.0, 2.5})
        for (const double phi : {0.0, 0.4, 1.5}) {
          // Half vectors within `reach` deviations.
          const Vector3f h =
              Vector3d(reach * alpha_x * std::cos(phi), reach * alpha_y * std::sin(phi), 1)
                  .normalized()
                  .cast<float>();
          // Unit in double: near the axis a float's h.z is one.
          const Vector3d exact(h.x(), h.y(),
                               std::sqrt(1 - h.head<2>().cast<double>().squaredNorm()));
          const double truth = std::max(test::published_distribution(m, exact), 1e-300);
          // A few roundings of the exponent, and denormal numbers.
          const double tolerance = truth * (1e-5 - 2e-6 * std::log(truth)) + 1e-37;
          EXPECT_NEAR(eval_distribution(m, h), truth, tolerance)
              << alpha_x << " " << alpha_y << " " << h.transpose();
        }
    }
}

TEST_P(DistributionOf, IsFiniteDownToTheHorizonAndZeroBelow) {
  for (const float z : {1.0f, 1e-3f, 1e-10f, 1e-30f}) {
    const Vector3f h = Vector3f(1, 0, z).normalized();
    EXPECT_TRUE(std::isfinite(eval_distribution(material, h))) << z;
    EXPECT_GE(eval_distribution(material, h), 0) << z;
  }
  EXPECT_EQ(eval_distribution(material, Vector3f(0.6f, 0, -0.8f)), 0);
  EXPECT_EQ(eval_distribution(material, Vector3f::UnitX()), 0);
}

/// Integral of D h.z over half vectors, D over its peak.
double energy(const Material& material) {
  double sum = 0;
  for (const test::Node& node : test::hemisphere_nodes(material.alpha_x, material.alpha_y, 48))
    sum += node.weight * node.direction.z() *
           double(eval_distribution(material, node.direction.cast<float>()));
  return sum;
}

bool is_normalised(const Material& material) {
  return material.model == SpecularModel::cook_torrance ||
         material.model == SpecularModel::ward_balanced;
}

class NormalisedDistribution : public DistributionOf {};
INSTANTIATE_TEST_SUITE_P(Of, NormalisedDistribution,
                         testing::ValuesIn(test::materials_that(is_normalised)),
                         [](const auto& info) { return info.param.name; });

TEST_P(NormalisedDistribution, OfMicrofacetsIntegratesToOne) {
  // At normal incidence all shadowing is one, so the BRDF's peak is D / 4.
  const Vector3f up = Vector3f::UnitZ();
  const double peak = 4 * double(eval_specular_brdf(material, up, up).x());
  for (const auto& [x, y] :
       {std::pair{material.alpha_x, material.alpha_y}, {0.01f, 0.03f}, {0.7f, 0.7f}}) {
    Material m = material;
    m.alpha_x = x;
    m.alpha_y = y;
    const double scale = double(material.alpha_x) * material.alpha_y / (double(x) * y);
    // Float's rounding of D; the quadrature is better than 1e-6.
    EXPECT_NEAR(energy(m) * peak * scale, 1, 2e-5) << x << " " << y;
  }
}

TEST(AshikhminDistribution, IsNormalisedOverHalfVectors) {
  // ashikhmin2000phong: sqrt((n_x + 1) (n_y + 1)) / (2 pi) D integrates to one, without the cosine.
  const Material m = test::white(SpecularModel::ashikhmin_shirley, 0.3f, 0.1f);
  double sum = 0;
  for (const test::Node& node : test::hemisphere_nodes(m.alpha_x, m.alpha_y, 48))
    sum += node.weight * double(eval_distribution(m, node.direction.cast<float>()));
  const double n_x = 2 / 0.09, n_y = 2 / 0.01;
  EXPECT_NEAR(sum * std::sqrt((n_x + 1) * (n_y + 1)) / (2 * kPi<double>), 1, 2e-5);
}

TEST(WardDistribution, IsNormalisedForNarrowLobes) {
  // ward1992: 1 / (4 pi alpha_x alpha_y) normalises the BRDF for small alphas; to order alpha^2.
  const Material m = test::white(SpecularModel::ward, 0.02f, 0.01f);
  EXPECT_NEAR(energy(m) / (kPi<double> * 0.02 * 0.01), 1, 3e-4);
}

}  // namespace
}  // namespace burnish
