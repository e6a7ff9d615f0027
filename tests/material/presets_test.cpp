#include "burnish/material/presets.h"

#include <set>

#include <gtest/gtest.h>

namespace burnish::test {
namespace {

TEST(MaterialPresets, AreNamedOnceAndSayTheirSource) {
  std::set<std::string> names;
  for (const MaterialPreset& preset : material_presets()) {
    EXPECT_TRUE(names.insert(preset.name).second) << preset.name;
    EXPECT_FALSE(preset.source.empty()) << preset.name;
    EXPECT_TRUE((preset.material.diffuse >= 0).all() && (preset.material.diffuse <= 1).all());
    EXPECT_TRUE(preset.material.has_specular()) << preset.name;
    EXPECT_EQ(find_material_preset(preset.name), &preset);
  }
  EXPECT_GE(names.size(), 20u);
}

TEST(MaterialPresets, AreFoundInAnyCaseAndSpelling) {
  const MaterialPreset* brushed = find_material_preset("brushed aluminium");
  ASSERT_NE(brushed, nullptr);
  EXPECT_EQ(find_material_preset("Brushed-Aluminium"), brushed);
  EXPECT_EQ(find_material_preset("BRUSHED_ALUMINIUM"), brushed);
  EXPECT_EQ(find_material_preset("brushed"), nullptr);
  EXPECT_EQ(find_material_preset(""), nullptr);
}

/// The figures of ward1992, table 1.
TEST(MaterialPresets, HaveTheAlphasOfWardsTable) {
  const struct {
    const char* name;
    float alpha_x, alpha_y;
  } table[] = {{"rolled brass", .05f, .16f},
               {"rolled aluminium", .04f, .09f},
               {"brushed aluminium", .088f, .13f},
               {"varnished plywood", .04f, .11f},
               {"enamelled metal", .08f, .096f},
               {"painted cardboard", .076f, .085f},
               {"ceramic tile", .071f, .071f},
               {"glossy paper", .082f, .082f},
               {"plastic", .13f, .13f},
               {"plastic laminate", .092f, .092f}};
  for (const auto& row : table) {
    const MaterialPreset* preset = find_material_preset(row.name);
    ASSERT_NE(preset, nullptr) << row.name;
    EXPECT_EQ(preset->material.alpha_x, row.alpha_x) << row.name;
    EXPECT_EQ(preset->material.alpha_y, row.alpha_y) << row.name;
  }
}

/// Against the metals of akenine2018rtr, table 9.2: other measurements, and another way from
/// spectra to RGB, which differ by up to .04.
TEST(MaterialPresets, MetalsReflectWhatIsPublishedOfThem) {
  const struct {
    const char* name;
    Rgb reflectance;
  } table[] = {{"gold", {1.0f, .766f, .336f}},
               {"silver", {.972f, .960f, .915f}},
               {"copper", {.955f, .638f, .538f}},
               {"aluminium", {.913f, .922f, .924f}},
               {"nickel", {.660f, .609f, .526f}}};
  for (const auto& row : table) {
    const MaterialPreset* preset = find_material_preset(row.name);
    ASSERT_NE(preset, nullptr) << row.name;
    const Fresnel& fresnel = preset->material.fresnel;
    ASSERT_EQ(fresnel.model, FresnelModel::conductor);
    const Rgb k2 = fresnel.k.square();
    const Rgb normal = ((fresnel.eta - 1).square() + k2) / ((fresnel.eta + 1).square() + k2);
    EXPECT_LT((normal - row.reflectance).abs().maxCoeff(), .05f)
        << row.name << ": " << normal.transpose();
  }
}

}  // namespace
}  // namespace burnish::test
