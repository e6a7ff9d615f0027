// `burnish fit-brdf` through the real program, on a table made here.

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/material_file.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 19920726;

/// Ward's model, brushed along x, as a table of irregular samples.
std::string brushed_table(int samples) {
  Material truth;
  truth.model = SpecularModel::ward;
  truth.alpha_x = 0.1f;
  truth.alpha_y = 0.3f;
  truth.diffuse = Rgb(0.2f, 0.3f, 0.4f);
  truth.specular = Rgb::Constant(0.5f);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> angle(0, 75), azimuth(0, 360);
  const auto direction = [](double theta, double phi) -> Vector3f {
    const double degree = kPi<double> / 180;
    return Vector3d(std::sin(degree * theta) * std::cos(degree * phi),
                    std::sin(degree * theta) * std::sin(degree * phi), std::cos(degree * theta))
        .cast<float>();
  };
  std::string text = "# brushed plate\ntheta_i,phi_i,theta_o,phi_o,r,g,b\n";
  for (int i = 0; i < samples; ++i) {
    const double a = angle(random), b = azimuth(random), c = angle(random), d = azimuth(random);
    const Rgb value = eval_brdf(truth, direction(c, d), direction(a, b));
    text += fmt::format("{},{},{},{},{},{},{}\n", a, b, c, d, value[0], value[1], value[2]);
  }
  return text;
}

TEST(FitBrdfCommand, WritesAMaterialAPictureAndTheFigures) {
  const ScratchFolder folder;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  write_whole_file(folder.file("plate.csv"), brushed_table(4000));
  const auto run = [&](const std::string& name, const std::string& threads) {
    return burnish({"fit-brdf", folder.file("plate.csv"), "-o", folder.file(name + ".json"),
                    "--lobes", "1", "--preview", folder.file(name + ".png"), "--report",
                    folder.file(name + ".report.json"), "--threads", threads});
  };
  const RunResult result = run("a", "1");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("CSV: brushed plate, anisotropic, lobes: 1,"), std::string::npos)
      << result.out;
  for (const char* name : {"fitted", "Ward", "Ashikhmin-Shirley"})
    EXPECT_NE(result.out.find(name), std::string::npos) << result.out;
  // Ward's model made the table.
  EXPECT_NE(result.out.find("warning: the best Ward material is closer"), std::string::npos)
      << result.out;
  EXPECT_EQ(result.out.find("best Ashikhmin-Shirley"), std::string::npos) << result.out;

  const MaterialFile file = read_material_file(folder.file("a.json"));
  EXPECT_EQ(file.name, "brushed plate");
  EXPECT_EQ(file.source, "plate.csv");
  ASSERT_EQ(file.material.model, SpecularModel::fitted);
  ASSERT_EQ(file.material.fitted->lobes.size(), 1u);
  const AnisotropicGaussian<float>& lobe = file.material.fitted->lobes[0];
  // 1 / alpha^2, which is the best lobe to 20 % for alphas as large as .3
  EXPECT_NEAR(std::max(lobe.bandwidth_x, lobe.bandwidth_y) / 100, 1, 0.2);
  EXPECT_NEAR(std::min(lobe.bandwidth_x, lobe.bandwidth_y) / 11.1, 1, 0.2);

  const auto report = nlohmann::json::parse(read_whole_file(folder.file("a.report.json")));
  EXPECT_EQ(report["fitted"]["relative_l2"], file.fit_relative_l2);
  EXPECT_LT(report["fitted"]["relative_l2"], 0.05);
  EXPECT_LT(report["ward"]["relative_l2"], 0.01);  // the model that made the table
  EXPECT_NEAR(report["ward"]["alpha_x"], 0.1, 0.002);
  EXPECT_NEAR(report["ward"]["alpha_y"], 0.3, 0.006);
  EXPECT_GT(report["ashikhmin_shirley"]["relative_l2"], 0.1);
  EXPECT_EQ(report["samples"], 4000);
  EXPECT_TRUE(read_whole_file(folder.file("a.png")).starts_with("\x89PNG\r\n\x1a\n"));

  ASSERT_EQ(run("b", "2").exit_code, 0);
  for (const char* end : {".json", ".png"})
    EXPECT_TRUE(read_whole_file(folder.file("a") + end) == read_whole_file(folder.file("b") + end))
        << end;
}

TEST(FitBrdfCommand, BrokenTablesLeaveNoOutput) {
  const ScratchFolder folder;
  const std::string path = folder.file("plate.csv"), output = folder.file("a.json");
  write_whole_file(path, brushed_table(10) + "1,2,3\n");
  const RunResult result = burnish({"fit-brdf", path, "-o", output});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_NE(result.err.find("plate.csv: line 13: found 3 columns, expected 7"), std::string::npos)
      << result.err;
  EXPECT_FALSE(std::filesystem::exists(output));
}

TEST(FitBrdfCommand, TablesOfGrazingAnglesAloneAreNamedAsSuch) {
  const ScratchFolder folder;
  const std::string path = folder.file("plate.csv"), output = folder.file("a.json");
  write_whole_file(path, "theta_i,phi_i,theta_o,phi_o,r,g,b\n82,0,89,180,1,1,1\n");
  const RunResult result = burnish({"fit-brdf", path, "-o", output});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("plate.csv: no samples within 80 degrees of the normal; see "
                            "--max-angle"),
            std::string::npos)
      << result.err;
  EXPECT_FALSE(std::filesystem::exists(output));
}

}  // namespace
}  // namespace burnish::test
