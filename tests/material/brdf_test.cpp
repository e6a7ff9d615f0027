// What holds for the BRDF of every model.

#include <random>

#include <gtest/gtest.h>

#include "material/sample_materials.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

using test::from_angles;

constexpr unsigned kSeed = 17;
constexpr double kGrazing = 89.9999;

class Brdf : public testing::TestWithParam<test::NamedMaterial> {
 protected:
  const Material& material = GetParam().material;
};
INSTANTIATE_TEST_SUITE_P(Of, Brdf, testing::ValuesIn(test::all_materials()),
                         [](const auto& info) { return info.param.name; });

/// The same with other alphas.
std::vector<Material> with_extreme_alphas(const Material& material) {
  std::vector<Material> list;
  for (const auto& [x, y] : {std::pair{kMinAlpha, kMinAlpha},
                             {kMinAlpha, kMaxAlpha},
                             {kMaxAlpha, kMinAlpha},
                             {kMaxAlpha, kMaxAlpha},
                             {0.01f, 0.3f}}) {
    list.push_back(material);
    list.back().alpha_x = x;
    list.back().alpha_y = y;
  }
  return list;
}

TEST_P(Brdf, IsReciprocalToTheLastBit) {
  std::mt19937 random(kSeed);
  for (const Material& m : with_extreme_alphas(material))
    for (int i = 0; i < 1000; ++i) {
      Vector3f o = test::random_direction(random).cast<float>();
      Vector3f v = test::random_direction(random).cast<float>();
      o.z() = std::abs(o.z());
      v.z() = std::abs(v.z());
      const Rgb a = eval_brdf(m, o, v), b = eval_brdf(m, v, o);
      ASSERT_TRUE((a >= 0).all() && a.allFinite()) << "seed " << kSeed;
      // Compilers may fuse a product with either of two symmetric terms.
      ASSERT_TRUE(((a - b).abs() <= 1e-6f * a).all()) << a << " " << b << " seed " << kSeed;
    }
}

TEST_P(Brdf, IsZeroBelowTheHorizon) {
  EXPECT_EQ(eval_brdf(material, from_angles(30, 0), from_angles(100, 20)).x(), 0);
  EXPECT_EQ(eval_brdf(material, from_angles(100, 0), from_angles(30, 20)).x(), 0);
}

TEST_P(Brdf, IsFiniteForOppositeEqualAndGrazingDirections) {
  const Vector3f grazing = from_angles(kGrazing, 10), up = from_angles(0, 0);
  const Vector3f lowest(1, 0, 1e-30f);
  for (const Material& m : with_extreme_alphas(material))
    for (const auto& [o, i] : {std::pair{grazing, from_angles(kGrazing, 190)},
                               {Vector3f(-1, 0, 1e-30f), lowest},
                               {lowest, lowest},
                               {lowest, up},
                               {up, up},
                               {grazing, grazing},
                               {up, grazing},
                               {grazing, up}}) {
      const Rgb f = eval_brdf(m, o, i), smooth = specular_smooth_factor(m, o, i);
      EXPECT_TRUE(f.allFinite() && (f >= 0).all()) << m.alpha_x << " " << m.alpha_y;
      EXPECT_TRUE(smooth.allFinite() && (smooth >= 0).all()) << m.alpha_x << " " << m.alpha_y;
      const float pdf = pdf_specular_brdf(m, o, i);
      EXPECT_TRUE(std::isfinite(pdf) && pdf >= 0) << m.alpha_x << " " << m.alpha_y;
    }
}

TEST_P(Brdf, OfExactlyOppositeDirectionsIsBlack) {
  // Both on the horizon, the limit of "above" that a float has: there is no half vector.
  const Vector3f o(1, 0, 1e-30f), i(-1, 0, 1e-30f);
  EXPECT_EQ(eval_specular_brdf(material, o, i).x(), 0);
}

TEST_P(Brdf, OfEqualDirectionsHasTheDirectionItselfAsHalfVector) {
  const Vector3f o = from_angles(12, 70);
  const Rgb expected = specular_smooth_factor(material, o, o) *
                       float(test::published_distribution(material, o.cast<double>()));
  // Exponents reach 2 / .03^2: that many roundings of h.
  EXPECT_TRUE(eval_specular_brdf(material, o, o).isApprox(expected, 1e-3f));
}

TEST_P(Brdf, IsItsSmoothFactorTimesItsDistribution) {
  const Vector3f o = from_angles(20, 35);
  for (const double view : {0.0, 30.0, 80.0, 89.0}) {
    const Vector3f i = from_angles(view, 200);
    const Rgb split =
        specular_smooth_factor(material, o, i) *
        float(test::published_distribution(material, (o + i).cast<double>().normalized()));
    EXPECT_TRUE(split.isApprox(eval_specular_brdf(material, o, i), 1e-3f)) << view;
  }
}

class BrdfWithAlphas : public Brdf {};
INSTANTIATE_TEST_SUITE_P(Of, BrdfWithAlphas,
                         testing::ValuesIn(test::materials_that(test::has_alphas)),
                         [](const auto& info) { return info.param.name; });

TEST_P(BrdfWithAlphas, DoesNotDependOnTheDirectionOfAScratch) {
  // Half a turn about the normal maps an ellipse onto itself; `fitted` may lean.
  const Vector3f o = from_angles(40, 20), i = from_angles(30, 240);
  const auto turned = [](const Vector3f& v) { return Vector3f(-v.x(), -v.y(), v.z()); };
  EXPECT_FLOAT_EQ(eval_brdf(material, o, i).x(), eval_brdf(material, turned(o), turned(i)).x());
}

TEST(Material, DiffuseIsAlbedoOverPi) {
  Material m;
  m.diffuse = Rgb(0.2f, 0.4f, 0.6f);
  const Rgb f = eval_brdf(m, from_angles(10, 0), from_angles(70, 90));
  EXPECT_NEAR(f.y(), 0.4 / kPi<double>, 1e-6);
  EXPECT_FALSE(m.has_specular());
}

}  // namespace
}  // namespace burnish
