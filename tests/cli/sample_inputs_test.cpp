// The samples of bad and unusual inputs under tests/data, and lights out of range, through the real
// program: an exit code and one clear line.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sample_files.h"

namespace burnish::test {
namespace {

std::string sample(const std::string& name) { return std::string(BURNISH_TEST_DATA) + "/" + name; }

void expect_refusal(const RunResult& result, int exit_code, const std::string& cause) {
  EXPECT_EQ(result.exit_code, exit_code);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  EXPECT_NE(result.err.find(cause), std::string::npos) << result.err;
}

TEST(SampleInputs, EnvironmentsAreRefusedInOneLine) {
  const ScratchFolder folder;
  for (const auto& [name, exit_code, cause] : {std::tuple{"deep.exr", 3, "deep picture"},
                                               {"cube.exr", 3, "cube map"},
                                               {"truncated.exr", 2, "truncated.exr"},
                                               {"truncated.hdr", 2, "truncated.hdr"}}) {
    SCOPED_TRACE(name);
    const std::string path = sample(std::string("environments/") + name);
    expect_refusal(burnish({"fit-light", path, "-o", folder.file("a.json")}), exit_code, cause);
    EXPECT_TRUE(folder.names().empty());
    // A cube map is a picture like any other.
    const RunResult info = burnish({"info", path});
    if (name == std::string("cube.exr")) {
      EXPECT_EQ(info.exit_code, 0) << info.err;
    } else {
      expect_refusal(info, exit_code, cause);
    }
  }
}

TEST(SampleInputs, LuminanceAloneIsRead) {
  const ScratchFolder folder;
  const std::string path = sample("environments/luminance.exr");
  EXPECT_EQ(burnish({"info", path}).exit_code, 0);
  const RunResult fit =
      burnish({"fit-light", path, "-o", folder.file("a.json"), "--lobes", "1", "--cells", "256"});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
}

TEST(SampleInputs, LightsAreRefusedInOneLine) {
  const ScratchFolder folder;
  ASSERT_EQ(make_quick_bake(folder).exit_code, 0);
  for (const auto& [name, cause] :
       {std::pair{"scale_out_of_range.json", "line 4, /scale: 1e+30, with which of /spheres/0"},
        {"point_out_of_range.json",
         "line 5, /directionals/0: radiance of the irradiance is inf"}}) {
    SCOPED_TRACE(name);
    const std::string path = sample(std::string("lights/") + name);
    expect_refusal(burnish({"info", path}), 2, cause);
    expect_refusal(
        burnish({"render", folder.file("box.h5"), "--lights", path, "--png", folder.file("a.png")}),
        2, cause);
  }
}

std::string one_lobe(const std::string& scale) {
  return R"({"format": "burnish lights", "format_version": 2, "scale": )" + scale +
         R"(, "lobes": [{"axis": [0, 1, 0], "tangent": [1, 0, 0], "bandwidth_x": 2,
         "bandwidth_y": 2, "color": [1e-6, 1e-6, 1e-6]}]})";
}

TEST(LightScale, OfTheMapIsCheckedToo) {
  const ScratchFolder folder;
  ASSERT_EQ(make_quick_bake(folder).exit_code, 0);
  const auto render = [&](const std::string& scale) {
    write_whole_file(folder.file("a.json"), one_lobe(scale));
    return burnish({"render", folder.file("box.h5"), "--env", folder.file("env.exr"), "--lights",
                    folder.file("a.json"), "--size", "8x8", "--png", folder.file("a.png")});
  };
  EXPECT_EQ(render("2").exit_code, 0);
  // The lobe is a millionth as bright as the map, and stays in range.
  expect_refusal(render("1e32"), 2, "env.exr: a radiance of ");
}

TEST(LightScale, IsInTheIntegralThatInfoShows) {
  const ScratchFolder folder;
  const auto integral = [&](const std::string& scale) {
    write_whole_file(folder.file("a.json"), one_lobe(scale));
    const std::string text = burnish({"info", folder.file("a.json"), "--json"}).out;
    return nlohmann::json::parse(text)["lobes_radiance_integral"][1].get<double>();
  };
  EXPECT_GT(integral("1"), 0);
  EXPECT_DOUBLE_EQ(integral("4"), 4 * integral("1"));  // a power of two: exact
}

}  // namespace
}  // namespace burnish::test
