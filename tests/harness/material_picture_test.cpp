#include "harness/material_picture.h"

#include <cmath>

#include <gtest/gtest.h>

namespace burnish::test {
namespace {

Material glossy() {
  Material material;
  material.model = SpecularModel::ward_balanced;
  material.specular = {0.5f, 0.25f, 0.125f};
  material.alpha_x = material.alpha_y = 0.2f;
  return material;
}

/// Against a sum over a fine grid of directions.
TEST(SliceErrors, MatchAGridOfDirections) {
  const Material material = glossy();
  const std::vector<SliceError> errors = slice_errors(material, {});
  ASSERT_EQ(errors.size(), kLobeViewsDeg.size());
  const PreparedMaterial prepared = prepare_material(material, {});
  for (size_t view = 0; view < errors.size(); ++view) {
    const double polar = kLobeViewsDeg[view] * kPi<double> / 180;
    const double azimuth = kLobeViewAzimuthDeg * kPi<double> / 180;
    const Vector3f outgoing = Vector3d(std::sin(polar) * std::cos(azimuth),
                                       std::sin(polar) * std::sin(azimuth), std::cos(polar))
                                  .cast<float>();
    std::array<SliceLobe, kMaxSpecularTeeth> lobes;
    const int count = specular_slice(prepared, outgoing, lobes);
    double albedo = 0, difference = 0, norm = 0;
    constexpr int kRows = 600, kColumns = 1200;
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kColumns; ++j) {
        const double z = (i + 0.5) / kRows, phi = 2 * kPi<double> * (j + 0.5) / kColumns;
        const double r = std::sqrt(1 - z * z);
        const Vector3f incoming = Vector3d(r * std::cos(phi), r * std::sin(phi), z).cast<float>();
        const Rgb exact = eval_specular_brdf(material, outgoing, incoming) * incoming.z();
        Rgb sum = Rgb::Zero();
        for (int k = 0; k < count; ++k)
          sum += lobes[size_t(k)].weight * eval(lobes[size_t(k)].lobe, incoming);
        const double cell = 2 * kPi<double> / (double(kRows) * kColumns);
        albedo += cell * luminance(exact);
        difference += cell * double((sum - exact).square().sum());
        norm += cell * double(exact.square().sum());
      }
    // 2^15 low-discrepancy points; the grid itself is off by less.
    EXPECT_NEAR(errors[view].albedo, albedo, 0.005 * albedo) << view;
    EXPECT_NEAR(errors[view].relative_l2, std::sqrt(difference / norm), 0.005) << view;
  }
}

TEST(MaterialPicture, HasARowAViewAndGreyOutsideTheHemisphere) {
  const Image picture = draw_material_lobes(glossy(), {});
  const int step = kLobePanel + kLobePanelGap;
  EXPECT_EQ(picture.width, 3 * step + kLobePanelGap);
  EXPECT_EQ(picture.height, 4 * step + kLobePanelGap);
  for (int row = 0; row < 4; ++row) {
    const int top = kLobePanelGap + row * step;
    float most = 0;
    for (int y = 0; y < kLobePanel; ++y)
      for (int x = 0; x < kLobePanel; ++x)
        most = std::max(most, picture.at(kLobePanelGap + x, top + y)[0]);
    EXPECT_NEAR(most, 1, 1e-6);  // scaled to its peak
    EXPECT_TRUE((picture.at(kLobePanelGap, top) == Rgb::Constant(0.2f)).all());
    // Green is half of red in the exact column and in that of the lobes.
    for (const int column : {0, 1}) {
      const Rgb middle =
          picture.at(kLobePanelGap + column * step + kLobePanel / 2, top + kLobePanel / 2);
      EXPECT_NEAR(middle[1], 0.5f * middle[0], 1e-6f);
    }
  }
  // From above, an isotropic lobe is in the middle, and its values are the same on both sides.
  const Rgb right = picture.at(kLobePanelGap + kLobePanel / 2 + 20, kLobePanelGap + kLobePanel / 2);
  const Rgb left = picture.at(kLobePanelGap + kLobePanel / 2 - 21, kLobePanelGap + kLobePanel / 2);
  EXPECT_NEAR(right[0], left[0], 1e-4f * right[0]);
}

}  // namespace
}  // namespace burnish::test
