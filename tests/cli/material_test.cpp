// Materials on the command line: presets, files and models, through the real program.

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/image_file.h"
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

/// A flat square of 8 x 8 cells in the plane y = 0, with UVs from 0 to 1, seen from above.
class TexturedMaterials : public testing::Test {
 protected:
  void SetUp() override {
    std::string obj;
    for (int z = 0; z <= 8; ++z)
      for (int x = 0; x <= 8; ++x)
        obj += fmt::format("v {} 0 {}\nvt {} {}\n", x / 4.0 - 1, z / 4.0 - 1, x / 8.0, 1 - z / 8.0);
    for (int z = 0; z < 8; ++z)
      for (int x = 0; x < 8; ++x) {
        const int a = 9 * z + x + 1;
        obj += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, a + 9, a + 10, a + 1);
      }
    write_whole_file(folder_.file("square.obj"), obj);
    write_small_environment(folder_.file("env.exr"));
    const RunResult baked =
        burnish(joined({"bake", folder_.file("square.obj"), "-o", folder_.file("square.h5")},
                       quick_bake_options()));
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
  }

  RunResult run(const std::string& transfer, const std::vector<std::string>& options) const {
    return burnish(
        joined({"render", folder_.file(transfer), "--env", folder_.file("env.exr"), "--lobes", "1",
                "--size", "32x32", "--camera", "0,3,0.001,0,0,0,30", "-o", folder_.file("a.exr")},
               options));
  }
  Image render(const std::vector<std::string>& options) const {
    const RunResult result = run("square.h5", options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_image(folder_.file("a.exr"));
  }
  /// Writes a material of fields beside the model.
  std::string material(const std::string& name, const std::string& model,
                       const std::string& fields) const {
    const std::string path = folder_.file(name);
    write_whole_file(path, R"({"format": "burnish material", "format_version": 1, "model": ")" +
                               model + "\", " + fields + "}");
    return path;
  }
  /// The largest, relative, over columns of the picture's middle.
  static double difference(const Image& a, const Image& b, int first, int last) {
    double most = 0;
    for (int y = 8; y < 24; ++y)
      for (int x = first; x < last; ++x)
        most = std::max(most, double((a.at(x, y) - b.at(x, y)).abs().maxCoeff()) /
                                  double(b.at(x, y).maxCoeff()));
    return most;
  }

  ScratchFolder folder_;
};

TEST_F(TexturedMaterials, TakeTheirColorsFromTheTexture) {
  EXPECT_EQ(json::parse(burnish({"info", folder_.file("square.h5"), "--json"}).out)["has_uvs"],
            true);
  Image halves(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      halves.at(x, y) = x < 32 ? Rgb(0.5f, 0.25f, 0) : Rgb(0.125f, 0.5f, 1);
  write_exr(halves, folder_.file("halves.exr"), ExrPixelType::single_float);
  const std::string textured =
      material("t.json", "diffuse", R"("diffuse": {"texture": "halves.exr", "wrap": 0})");
  EXPECT_EQ(run("square.h5", {"--material", textured}).exit_code, 2);
  material("t.json", "diffuse", R"("diffuse": {"texture": "halves.exr"})");
  const Image left = render({"--material", "diffuse", "--diffuse", "0.5,0.25,0"});
  const Image right = render({"--material", "diffuse", "--diffuse", "0.125,0.5,1"});
  for (const std::string per : {"vertex", "pixel"}) {
    SCOPED_TRACE(per);
    const Image picture = render({"--material", textured, "--per", per});
    // Halves of EXR, 5e-4; and rounding of weights.
    EXPECT_LT(difference(picture, left, 5, 10), 2e-3);
    EXPECT_LT(difference(picture, right, 22, 27), 2e-3);
    EXPECT_GT(difference(picture, right, 5, 10), 0.1);
  }
}

/// A rotation of a quarter turn swaps the alphas; a normal map changes the picture.
TEST_F(TexturedMaterials, TurnTheLobe) {
  write_exr(Image(4, 4, Rgb::Constant(0.25f)), folder_.file("quarter.exr"),
            ExrPixelType::single_float);
  write_exr(Image(4, 4, {0.3f, 0, 1}), folder_.file("normal.exr"), ExrPixelType::single_float);
  const std::string plain =
      material("plain.json", "ward", R"("alpha_x": 0.3, "alpha_y": 0.1, "specular": 1)");
  const std::string swapped =
      material("swapped.json", "ward", R"("alpha_x": 0.1, "alpha_y": 0.3, "specular": 1)");
  const std::string turned =
      material("turned.json", "ward", R"("alpha_x": 0.3, "alpha_y": 0.1, "specular": 1,
      "tangent_rotation_rad": {"texture": "quarter.exr", "scale": 6.2831853})");
  const std::string tilted =
      material("tilted.json", "ward", R"("alpha_x": 0.3, "alpha_y": 0.1, "specular": 1,
      "normal": {"texture": "normal.exr"})");
  const Image expected = render({"--material", swapped});
  EXPECT_LT(difference(render({"--material", turned}), expected, 8, 24), 5e-3);
  EXPECT_GT(difference(render({"--material", plain}), expected, 8, 24), 0.05);
  EXPECT_GT(difference(render({"--material", tilted}), render({"--material", plain}), 8, 24), 0.05);
}

/// The reference sees the same textures: 256 samples a pixel are off by some per cent.
TEST_F(TexturedMaterials, HaveAReference) {
  Image stripes(64, 1);
  for (int x = 0; x < 64; ++x) stripes.at(x, 0) = Rgb::Constant(x / 16 % 2 == 0 ? 0.1f : 0.9f);
  write_exr(stripes, folder_.file("stripes.exr"), ExrPixelType::single_float);
  const std::string textured =
      material("t.json", "diffuse", R"("diffuse": {"texture": "stripes.exr"})");
  const std::string report = folder_.file("report.json");
  const RunResult result = run("square.h5", {"--material", textured, "--per", "pixel",
                                             "--reference", "256", "--report", report});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json reference = json::parse(read_whole_file(report))["reference"];
  // The error of one light lobe is the same with and without a texture.
  const RunResult plain =
      run("square.h5", {"--material", "diffuse", "--per", "pixel", "--reference", "256", "--report",
                        folder_.file("plain.json")});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  const json uniform = json::parse(read_whole_file(folder_.file("plain.json")))["reference"];
  EXPECT_NEAR(reference["relative_l2"].get<double>(), uniform["relative_l2"].get<double>(), 0.03);
}

TEST_F(TexturedMaterials, NeedTextureCoordinates) {
  ASSERT_EQ(make_quick_bake(folder_).exit_code, 0);
  write_exr(Image(1, 1), folder_.file("a.exr"));
  const std::string path = material("t.json", "diffuse", R"("diffuse": {"texture": "a.exr"})");
  const RunResult result = run("box.h5", {"--material", path});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  EXPECT_NE(result.err.find("box.h5: has no texture coordinates"), std::string::npos) << result.err;
  expect_usage_error(run("square.h5", {"--material", path, "--diffuse", "1,1,1"}),
                     {"--diffuse: found with a material that has a texture for it"});
  const RunResult gone =
      run("square.h5",
          {"--material", material("g.json", "diffuse", R"("diffuse": {"texture": "gone.png"})")});
  EXPECT_EQ(gone.exit_code, 2);
  EXPECT_NE(gone.err.find("gone.png"), std::string::npos) << gone.err;
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
