// Energy: what the specular parts reflect of white light from everywhere.

#include <gtest/gtest.h>

#include "material/sample_materials.h"

namespace burnish {
namespace {

using test::from_angles;

class Furnace : public testing::TestWithParam<test::NamedMaterial> {
 protected:
  const Material& material = GetParam().material;
};
bool promises_energy(const Material& material) {
  // walter2007's substitution gives Blinn-Phong the shadowing of Beckmann.
  const bool substituted = material.model == SpecularModel::cook_torrance &&
                           material.distribution == Distribution::blinn_phong &&
                           material.shadowing != Shadowing::v_cavity;
  return material.model != SpecularModel::ward && material.model != SpecularModel::fitted &&
         !substituted;
}

class FurnaceOfAPromise : public Furnace {};
INSTANTIATE_TEST_SUITE_P(Of, FurnaceOfAPromise,
                         testing::ValuesIn(test::materials_that(promises_energy)),
                         [](const auto& info) { return info.param.name; });

TEST_P(FurnaceOfAPromise, NeverReturnsMoreThanItGets) {
  for (const double view : {0.0, 30.0, 60.0, 80.0, 88.0, 89.9})
    for (const double azimuth : {0.0, 40.0, 90.0})
      // The quadrature's error, where the horizon cuts cells.
      EXPECT_LE(test::specular_albedo(material, from_angles(view, azimuth)), 1 + 2e-3)
          << view << " " << azimuth;
}

class FurnaceWithAlphas : public Furnace {};
INSTANTIATE_TEST_SUITE_P(Of, FurnaceWithAlphas,
                         testing::ValuesIn(test::materials_that(test::has_alphas)),
                         [](const auto& info) { return info.param.name; });

TEST_P(FurnaceWithAlphas, OfNarrowLobesReturnsNearlyAll) {
  Material narrow = material;
  narrow.alpha_x = 0.01f;
  narrow.alpha_y = 0.02f;
  for (const double view : {0.0, 45.0}) {
    const Vector3f o = from_angles(view, 30);
    // Ward's goes with the cosine: its 1 / sqrt(cos cos) divides by one of the two there are.
    const double expected = material.model == SpecularModel::ward ? double(o.z()) : 1;
    // What is lost is of the order of alpha times the tangent.
    EXPECT_NEAR(test::specular_albedo(narrow, o), expected, 1e-2) << view;
  }
}

TEST(WardFurnace, ReturnsMoreThanItGetsAtTheHorizon) {
  // As alpha^(3/2) / sqrt(cos).
  const Material m = test::white(SpecularModel::ward, 0.3f, 0.3f);
  EXPECT_GT(test::specular_albedo(m, from_angles(89.9, 0)), 1.2);
  EXPECT_GT(test::specular_albedo(m, from_angles(89.99, 0)), 4);
  const Material balanced = test::white(SpecularModel::ward_balanced, 0.3f, 0.3f);
  EXPECT_LE(test::specular_albedo(balanced, from_angles(89.99, 0)), 1);
}

TEST(BlinnPhongFurnace, WithSmithsShadowingGainsWhatItsHeaderSays) {
  const auto albedo = [](float alpha) {
    return test::specular_albedo(
        test::white_microfacets(Distribution::blinn_phong, Shadowing::smith, alpha, alpha),
        from_angles(89.9, 0));
  };
  // The figures are rounded up to a percent.
  EXPECT_NEAR(albedo(0.1f), 1.00, 0.01);
  EXPECT_NEAR(albedo(0.3f), 1.04, 0.01);
  EXPECT_NEAR(albedo(0.5f), 1.11, 0.01);
  EXPECT_NEAR(albedo(1), 1.76, 0.01);
}

/// A(o) = o.z / G1(o), from the BRDF: with separable shadowing and light along the normal, which
/// nothing hides, f = D F / (4 A).
double facing_area(Material material, const Vector3f& outgoing) {
  material.shadowing = Shadowing::smith_separable;
  const Vector3f up = Vector3f::UnitZ();
  return double(specular_smooth_factor(material, up, up).x()) /
         double(specular_smooth_factor(material, outgoing, up).x());
}

/// heitz2014, Eq. 17: the integral of G1(o) D(h) max(o.h, 0) is o.z.
double weak_furnace(const Material& material, const Vector3f& outgoing) {
  double sum = 0;
  for (const test::Node& node : test::hemisphere_nodes(material.alpha_x, material.alpha_y, 256))
    sum += node.weight * test::published_distribution(material, node.direction) *
           std::max(node.direction.dot(outgoing.cast<double>()), 0.0);
  const double peak = 1 / (kPi<double> * material.alpha_x * material.alpha_y);
  return peak * sum / facing_area(material, outgoing);
}

TEST(WeakFurnace, OfSmithIsExactForBeckmannAndGgx) {
  for (const Distribution distribution : {Distribution::beckmann, Distribution::ggx})
    for (const auto& [x, y] : {std::pair{0.05f, 0.05f}, {0.5f, 0.1f}, {1.0f, 1.0f}}) {
      const Material m = test::white_microfacets(distribution, Shadowing::smith, x, y);
      for (const double view : {0.0, 40.0, 80.0, 89.0, 89.99})
        // Rounding, and the kink at o.h = 0 in the quadrature.
        EXPECT_NEAR(weak_furnace(m, from_angles(view, 25)), 1, 1e-4)
            << int(distribution) << " " << x << " " << y << " view " << view;
    }
}

TEST(WeakFurnace, OfBlinnPhongIsNearOneForNarrowLobes) {
  // walter2007 substitutes Beckmann's G1: off by about .35 alpha^2 at grazing views.
  for (const float alpha : {0.05f, 0.1f, 0.3f}) {
    const Material m =
        test::white_microfacets(Distribution::blinn_phong, Shadowing::smith, alpha, alpha);
    for (const double view : {0.0, 40.0, 80.0, 89.0})
      EXPECT_NEAR(weak_furnace(m, from_angles(view, 25)), 1, 0.5 * alpha * alpha)
          << alpha << " " << view;
  }
}

}  // namespace
}  // namespace burnish
