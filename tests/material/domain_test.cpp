#include <limits>

#include <gtest/gtest.h>

#include "material/sample_materials.h"

namespace burnish {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The error of a good material after one change.
template <class Change>
std::string error_after(Material material, const Change& change) {
  EXPECT_EQ(domain_error(material), "");
  change(material);
  return domain_error(material);
}

Material ggx() { return test::white_microfacets(Distribution::ggx, Shadowing::smith, 0.3f, 0.1f); }

TEST(MaterialDomain, TakesAllModels) {
  for (const test::NamedMaterial& sample : test::all_materials())
    EXPECT_EQ(domain_error(sample.material), "") << sample.name;
  EXPECT_EQ(domain_error(Material{}), "");
}

TEST(MaterialDomain, NamesTheFieldThatIsOutOfRange) {
  EXPECT_EQ(error_after(ggx(), [](Material& m) { m.diffuse.y() = 1.5f; }),
            "diffuse is 1.500000, expected 0 to 1");
  EXPECT_EQ(error_after(ggx(), [](Material& m) { m.specular.z() = -1; }),
            "specular is -1.000000, expected 0 to 1000000");
  EXPECT_EQ(error_after(ggx(), [](Material& m) { m.alpha_x = 0; }),
            "alpha_x is 0.000000, expected 0.0001 to 1");
  EXPECT_EQ(error_after(ggx(), [](Material& m) { m.alpha_y = 1.5f; }),
            "alpha_y is 1.500000, expected 0.0001 to 1");
  EXPECT_EQ(error_after(ggx(), [](Material& m) { m.fresnel.normal_reflectance.x() = -1; }),
            "fresnel: normal_reflectance is -1.000000, expected 0 to 1");
}

TEST(MaterialDomain, RefusesWhatIsNotANumber) {
  EXPECT_NE(error_after(ggx(), [](Material& m) { m.diffuse.x() = kNan; }), "");
  EXPECT_NE(error_after(ggx(), [](Material& m) { m.specular.x() = kNan; }), "");
  EXPECT_NE(error_after(ggx(), [](Material& m) { m.alpha_x = kNan; }), "");
}

TEST(MaterialDomain, LooksAtFresnelOnlyWhereItIsUsed) {
  Material m = test::white(SpecularModel::ward, 0.1f, 0.1f);
  m.fresnel.normal_reflectance = Rgb::Constant(kNan);
  EXPECT_EQ(domain_error(m), "");
}

/// The error of fitted lobes after one change.
template <class Change>
std::string fitted_error_after(const Change& change) {
  return error_after(test::two_fitted_lobes(), [&](Material& m) {
    FittedSpecular fitted = *m.fitted;
    change(fitted);
    m.fitted = std::make_shared<const FittedSpecular>(fitted);
  });
}

TEST(MaterialDomain, LooksIntoFittedLobes) {
  EXPECT_EQ(error_after(test::two_fitted_lobes(), [](Material& m) { m.fitted = nullptr; }),
            "fitted is missing");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.lobes.clear(); }),
            "fitted: lobes has 0 entries, expected 1 to 8");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.lobes.resize(9, f.lobes[0]); }),
            "fitted: lobes has 9 entries, expected 1 to 8");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.lobes[1].bandwidth_x = 0; }),
            "fitted: lobes[1]: bandwidth_x is 0, expected > 0");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.lobes[0].amplitude = -1; }),
            "fitted: lobes[0]: amplitude is -1.000000, expected a finite number >= 0");
  EXPECT_NE(fitted_error_after([](FittedSpecular& f) { f.lobes[0].frame.z *= 2; }), "");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.masking.resize(1); }),
            "fitted: masking has 1 entries, expected 2 to 4096");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.masking[2] = -1; }),
            "fitted: masking[2] is -1.000000, expected a finite number >= 0");
  EXPECT_EQ(fitted_error_after([](FittedSpecular& f) { f.color_by_difference.clear(); }),
            "fitted: color_by_difference has 0 entries, expected 2 to 4096");
  EXPECT_NE(fitted_error_after([](FittedSpecular& f) { f.color_by_difference[1].y() = kNan; }), "");
  // Each in range, but not their product.
  EXPECT_NE(
      fitted_error_after([](FittedSpecular& f) { f.masking[0] = 1e13f; }).find("at most 1e+09"),
      std::string::npos);
}

}  // namespace
}  // namespace burnish
