// Materials on the command line: presets, files and models, through the real program.

#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/material_file.h"
#include "burnish/material/presets.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

using nlohmann::json;

void expect_usage_error(const RunResult& result, const std::vector<std::string>& causes) {
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  for (const std::string& cause : causes)
    EXPECT_NE(result.err.find(cause), std::string::npos) << cause << " / " << result.err;
}

class Materials : public testing::Test {
 protected:
  void SetUp() override { ASSERT_EQ(make_quick_bake(folder_).exit_code, 0); }

  RunResult run(const std::vector<std::string>& options) const {
    return burnish(joined({"shade", folder_.file("box.h5"), "--env", folder_.file("env.exr"),
                           "--lobes", "1", "-o", folder_.file("shaded.ply")},
                          options));
  }
  /// The bytes of the shaded mesh.
  std::string shade(const std::vector<std::string>& options) const {
    const RunResult result = run(options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return read_whole_file(folder_.file("shaded.ply"));
  }

  ScratchFolder folder_;
};

TEST_F(Materials, APresetShadesAsItsFile) {
  const MaterialPreset* brass = find_material_preset("rolled brass");
  ASSERT_NE(brass, nullptr);
  const std::string path = folder_.file("brass.json");
  write_material(brass->material, path);
  const std::string by_name = shade({"--material", "rolled brass"});
  EXPECT_EQ(by_name, shade({"--material", path}));
  EXPECT_EQ(by_name, shade({"--material", "Rolled-Brass"}));
  EXPECT_NE(by_name, shade({"--material", "rolled aluminium"}));
}

TEST_F(Materials, OptionsOverrideAMaterial) {
  Material material = find_material_preset("rolled brass")->material;
  const std::string path = folder_.file("other.json");
  material.alpha_x = 0.25f;
  material.alpha_y = 0.125f;
  material.diffuse = {0.25f, 0.5f, 0.75f};
  material.specular = {0.5f, 0.25f, 0.125f};
  write_material(material, path);
  EXPECT_EQ(shade({"--material", "rolled brass", "--alpha-x", "0.25", "--alpha-y", "0.125",
                   "--diffuse", "0.25,0.5,0.75", "--specular", "0.5,0.25,0.125"}),
            shade({"--material", path}));
}

/// Of models with a Fresnel factor --specular is the reflectance at normal incidence.
TEST_F(Materials, SpecularIsTheNormalReflectanceOfFresnelModels) {
  for (const auto& [name, model, distribution] :
       {std::tuple{"ashikhmin", SpecularModel::ashikhmin_shirley, Distribution::ggx},
        {"ggx", SpecularModel::cook_torrance, Distribution::ggx},
        {"beckmann", SpecularModel::cook_torrance, Distribution::beckmann},
        {"blinn-phong", SpecularModel::cook_torrance, Distribution::blinn_phong}}) {
    SCOPED_TRACE(name);
    Material material;
    material.model = model;
    material.distribution = distribution;
    material.alpha_x = material.alpha_y = 0.25f;
    material.fresnel.normal_reflectance = {0.5f, 0.25f, 0.125f};
    const std::string path = folder_.file("m.json");
    write_material(material, path);
    EXPECT_EQ(shade({"--material", name, "--alpha-x", "0.25", "--alpha-y", "0.25", "--specular",
                     "0.5,0.25,0.125"}),
              shade({"--material", path}));
  }
}

TEST_F(Materials, UnknownNamesListWhatIsAccepted) {
  expect_usage_error(
      run({"--material", "unobtainium"}),
      {"--material: found 'unobtainium'", "ward-balanced", "brushed aluminium", ".json"});
  expect_usage_error(run({"--material", "diffuse", "--alpha-x", "0.5"}),
                     {"--alpha-x: found with a material of the model 'diffuse'"});
  expect_usage_error(run({"--material", "ward", "--alpha-x", "2"}),
                     {"--alpha-x: found '2', expected a number in 0.0001..1"});
  expect_usage_error(run({"--material", "ward", "--specular", "1,2"}),
                     {"--specular: found '1,2', expected three numbers"});
}

TEST_F(Materials, BadFilesAreExitTwo) {
  const std::string path = folder_.file("bad.json");
  write_whole_file(path,
                   "{\"format\": \"burnish material\",\n \"format_version\": 1,\n"
                   " \"model\": \"ward\", \"alpha\": 2}");
  for (const RunResult& result : {run({"--material", path}), burnish({"info", path})}) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
    EXPECT_NE(result.err.find("bad.json: line 3, /alpha: 2, expected"), std::string::npos)
        << result.err;
  }
  EXPECT_EQ(run({"--material", folder_.file("gone.json")}).exit_code, 2);
}

TEST(MaterialInfo, ListsThePresets) {
  const json info = json::parse(burnish({"info", "--materials", "--json"}).out);
  ASSERT_EQ(info["materials"].size(), material_presets().size());
  for (size_t i = 0; i < material_presets().size(); ++i) {
    EXPECT_EQ(info["materials"][i]["name"], material_presets()[i].name);
    EXPECT_EQ(info["materials"][i]["source"], material_presets()[i].source);
  }
  const std::string text = burnish({"info", "--materials"}).out;
  EXPECT_NE(text.find("brushed aluminium"), std::string::npos) << text;
  expect_usage_error(burnish({"info", "gold", "--materials"}), {"--materials: found a FILE"});
  expect_usage_error(burnish({"info"}), {"FILE is required"});
}

TEST(MaterialInfo, SaysWhatAMaterialIs) {
  const json preset = json::parse(burnish({"info", "rolled brass", "--json"}).out);
  EXPECT_EQ(preset["kind"], "material");
  EXPECT_EQ(preset["model"], "ward");
  EXPECT_EQ(preset["alpha_y"], 0.16);
  ASSERT_EQ(preset["views"].size(), 4u);
  // How well the lobes do is not the program's matter, but that they are compared is.
  for (const json& view : preset["views"]) {
    EXPECT_GT(view["albedo"], 0);
    EXPECT_GT(view["relative_l2"], 0);
    EXPECT_LT(view["relative_l2"], 1);
  }
  const ScratchFolder folder;
  const std::string path = folder.file("gold.json");
  MaterialFile file;
  file.name = "my gold";
  file.fit_relative_l2 = 0.25;
  file.material = find_material_preset("gold")->material;
  write_material_file(file, path);
  const json info = json::parse(burnish({"info", path, "--json"}).out);
  EXPECT_EQ(info["name"], "my gold");
  EXPECT_EQ(info["fit_relative_l2"], 0.25);
  EXPECT_EQ(info["distribution"], "ggx");
  EXPECT_EQ(info["eta"][2], 1.442);
  const json plain = json::parse(burnish({"info", "gold", "--json"}).out);
  EXPECT_EQ(plain["k"], info["k"]);
  EXPECT_EQ(plain["views"], info["views"]);
}

TEST(MaterialInfo, DrawsTheLobe) {
  const ScratchFolder folder;
  const std::string picture = folder.file("satin.png");
  const RunResult plain = burnish({"info", "satin", "--json"});
  const RunResult drawn = burnish({"info", "satin", "--json", "--png", picture});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(drawn.out, plain.out);
  EXPECT_TRUE(read_whole_file(picture).starts_with("\x89PNG\r\n\x1a\n"));
  EXPECT_EQ(burnish({"info", "satin", "--png", folder.file("none/a.png")}).exit_code, 4);
}

TEST(MaterialInfo, UnknownNamesListThePresets) {
  expect_usage_error(burnish({"info", "unobtainium"}),
                     {"found 'unobtainium'", "brushed aluminium", "file"});
}

}  // namespace
}  // namespace burnish::test
