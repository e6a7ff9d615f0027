#include "harness/brdf_picture.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace burnish {
namespace {

constexpr int kStep = kBrdfPanelSize + kBrdfPanelGap;

Material plate() {
  Material material;
  material.model = SpecularModel::ward;
  material.alpha_x = material.alpha_y = 0.2f;
  material.diffuse = Rgb(0.1f, 0.2f, 0.3f);
  return material;
}

MeasuredBrdf measurement_of(const Material& material) {
  MeasuredBrdf measured;
  measured.eval = [material](const Vector3f& outgoing, const Vector3f& incoming) {
    return eval_brdf(material, outgoing, incoming);
  };
  return measured;
}

TEST(BrdfPicture, ShowsAPerfectFitTwiceAndNoDifference) {
  const Material material = plate();
  const Image image = draw_brdf_fit(measurement_of(material), {material, Material()});
  EXPECT_EQ(image.width, 4 * kStep - kBrdfPanelGap);
  EXPECT_EQ(image.height, kBrdfPanelRows * kStep - kBrdfPanelGap);
  int shown = 0;
  for (int row = 0; row < kBrdfPanelRows; ++row)
    for (int y = 0; y < kBrdfPanelSize; ++y)
      for (int x = 0; x < kBrdfPanelSize; ++x) {
        const auto at = [&](int column) { return image.at(column * kStep + x, row * kStep + y); };
        EXPECT_TRUE((at(0) == at(1)).all());
        const bool hidden = (at(0) == 0.2f).all();
        EXPECT_TRUE((at(3) == (hidden ? 0.2f : 0.0f)).all());
        shown += !hidden;
        EXPECT_GE(image.at(x, row * kStep + y).minCoeff(), 0);
        EXPECT_LE(image.at(x, row * kStep + y).maxCoeff(), 1);
      }
  // A disc's part of a square, less what is below the horizon.
  const int pixels = kBrdfPanelRows * kBrdfPanelSize * kBrdfPanelSize;
  EXPECT_GT(shown, pixels / 2);
  EXPECT_LT(shown, 0.8 * pixels);
  // The peak is at the mirror direction for a view along the normal.
  EXPECT_EQ(image.at(kBrdfPanelSize / 2, kBrdfPanelSize / 2).maxCoeff(), 1);
}

TEST(BrdfPicture, WhatWasNotMeasuredIsGrey) {
  MeasuredBrdf nothing;
  nothing.eval = [](const Vector3f&, const Vector3f&) -> Rgb {
    return Rgb::Constant(std::numeric_limits<float>::quiet_NaN());
  };
  const Image image = draw_brdf_fit(nothing, {plate()});
  EXPECT_TRUE((image.at(kBrdfPanelSize / 2, kBrdfPanelSize / 2) == 0.2f).all());
}

// exp(-4 sin^2(t / 2) / alpha^2) is a hundredth; the scan's steps are 2 %.
TEST(BrdfPicture, RadiusIsTwiceTheReachOfTheDistribution) {
  const double reach = 2 * std::asin(0.1 * std::sqrt(std::log(100)));
  EXPECT_NEAR(brdf_panel_radius(plate()) / (2 * reach), 1, 0.02);
}

}  // namespace
}  // namespace burnish
