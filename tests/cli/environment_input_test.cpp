// Environments of every bad or unusual kind, through the real program: a fit, or one clear line.

#include <algorithm>
#include <cmath>
#include <limits>

#include <OpenEXR/ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include "../formats/exr_examples.h"
#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/light/environment_map.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

class EnvironmentInput : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }

  RunResult fit(const std::string& environment, const std::vector<std::string>& options = {}) {
    return burnish(
        joined({"fit-light", environment, "-o", file("out.json"), "--lobes", "3", "--cells", "256"},
               options));
  }

  // Ends in a sound light file.
  LightRig expect_fit(const std::string& environment,
                      const std::vector<std::string>& options = {}) {
    const RunResult result = fit(environment, options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    if (result.exit_code != 0) return {};
    const LightRig rig = read_lights(file("out.json")).rig;
    for (const EnvironmentLobe& light : rig.lobes) EXPECT_TRUE(light.color.isFinite().all());
    return rig;
  }

  void expect_refusal(const std::string& environment, int exit_code, const std::string& named) {
    const RunResult result = fit(environment);
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(environment), std::string::npos) << result.err;
    for (const std::string& name : folder_.names()) EXPECT_EQ(name.find("out"), std::string::npos);
  }

  Image picture(int width = 32, int height = 16) const {
    Image image(width, height, Rgb(0.2f, 0.25f, 0.3f));
    image.at(width / 3, height / 2) = Rgb(20, 18, 15);
    return image;
  }

 private:
  ScratchFolder folder_;
};

TEST_F(EnvironmentInput, ValuesThatAreNoRadianceAreReplaced) {
  Image image = picture();
  image.at(1, 1)[0] = kNan;
  image.at(2, 1)[1] = kInfinity;
  image.at(3, 1)[2] = -kInfinity;
  image.at(4, 1) = Rgb(-5, -1e30f, -0.0f);
  write_exr(image, file("a.exr"), ExrPixelType::single_float);
  EXPECT_EQ(expect_fit(file("a.exr")).lobes.size(), 3u);
  EXPECT_NE(fit(file("a.exr")).out.find("1 values that are not numbers"), std::string::npos);
  write_exr(Image(32, 16, Rgb(kNan, -1, -kInfinity)), file("b.exr"), ExrPixelType::single_float);
  EXPECT_TRUE(expect_fit(file("b.exr")).lobes.empty());
}

TEST_F(EnvironmentInput, BlackHasNoLights) {
  write_exr(Image(32, 16), file("a.exr"));
  EXPECT_TRUE(expect_fit(file("a.exr"), {"--preview", file("a.png")}).lobes.empty());
  EXPECT_TRUE(read_whole_file(file("a.png")).starts_with("\x89PNG"));
}

TEST_F(EnvironmentInput, AnyNumberOfPixelsWillDo) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 40}, {40, 1}, {3, 5}}) {
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    write_exr(picture(width, height), file("a.exr"));
    EXPECT_FALSE(expect_fit(file("a.exr"), {"--preview", file("a.png")}).lobes.empty());
  }
}

TEST_F(EnvironmentInput, OtherLayoutsAreRefusedByName) {
  const std::string path = file("a.exr");
  for (const auto& [width, height, named] : {std::tuple{32, 32, "angular map"},
                                             {64, 48, "cross"},
                                             {48, 64, "cross"},
                                             {96, 16, "strip"},
                                             {16, 96, "strip"}}) {
    write_exr(picture(width, height), path);
    expect_refusal(path, 3, named);
  }
  Imf::Header header = exr_header(picture(16, 96), {});
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  write_exr_variant(picture(16, 96), {}, path, &header);
  expect_refusal(path, 3, "cube map");
}

TEST_F(EnvironmentInput, LuminanceAloneIsGrey) {
  write_exr_variant(picture(), {.channels = {"Y"}}, file("a.exr"));
  const LightRig rig = expect_fit(file("a.exr"));
  ASSERT_FALSE(rig.lobes.empty());
  for (const EnvironmentLobe& light : rig.lobes)
    // The channels are fitted apart: the same but for the order of sums.
    EXPECT_NEAR(light.color[0], light.color[2], 1e-5f * light.color[0]);
}

TEST_F(EnvironmentInput, DeepIsRefusedAndOfSeveralPartsOneIsRead) {
  write_deep_exr(file("a.exr"));
  expect_refusal(file("a.exr"), 3, "deep picture");
  write_exr_parts(picture(), file("b.exr"));
  EXPECT_FALSE(expect_fit(file("b.exr")).lobes.empty());
  EXPECT_NE(fit(file("b.exr")).out.find("part 2 of 3 ('beauty')"), std::string::npos);
}

TEST_F(EnvironmentInput, BrokenFilesAreExitTwo) {
  write_exr(picture(), file("whole.exr"));
  const std::string bytes = read_whole_file(file("whole.exr"));
  write_whole_file(file("a.exr"), bytes.substr(0, bytes.size() / 2));
  expect_refusal(file("a.exr"), 2, "a.exr");
  write_whole_file(file("b.hdr"), "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 32\n");
  expect_refusal(file("b.hdr"), 2, "b.hdr");
  write_whole_file(file("c.exr"), "");
  expect_refusal(file("c.exr"), 2, "empty file");
}

TEST_F(EnvironmentInput, DialsReachTheFit) {
  write_exr(picture(), file("a.exr"));
  for (const EnvironmentLobe& light : expect_fit(file("a.exr"), {"--isotropic"}).lobes)
    EXPECT_EQ(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
  // A wide lobe with a dark hole in it, which only a negative lobe makes.
  LightRig truth;
  truth.lobes.resize(2);
  truth.lobes[0].lobe = {frame_from_axis(Vector3f(0.6f, 0.64f, 0.48f)), 2, 2, 1};
  truth.lobes[0].color = Rgb(2, 3, 4);
  truth.lobes[1].lobe = {frame_from_axis(Vector3f(0.48f, 0.8f, 0.36f)), 20, 60, 1};
  truth.lobes[1].color = Rgb(-1, -1.5f, -2);
  Image hole(64, 32);
  for (int y = 0; y < hole.height; ++y)
    for (int x = 0; x < hole.width; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / hole.width, (y + 0.5) / hole.height);
      hole.at(x, y) = eval_lobes(truth, v.cast<float>()).max(0);
    }
  write_exr(hole, file("hole.exr"));
  const auto least = [](const LightRig& rig) {
    float color = kInfinity;
    for (const EnvironmentLobe& light : rig.lobes) color = std::min(color, light.color.minCoeff());
    return color;
  };
  EXPECT_LT(least(expect_fit(file("hole.exr"), {"--signed"})), 0);
  EXPECT_GE(least(expect_fit(file("hole.exr"))), 0);
  const auto preview = [&](const char* exposure) {
    expect_fit(file("a.exr"), {"--preview", file("a.png"), "--exposure", exposure});
    return read_whole_file(file("a.png"));
  };
  EXPECT_NE(preview("0"), preview("1"));
  const auto first_color = [&](const char* weight) {
    const LightRig rig = expect_fit(file("a.exr"), {"--irradiance-weight", weight});
    return rig.lobes.empty() ? 0.0f : rig.lobes[0].color[0];
  };
  EXPECT_NE(first_color("0"), first_color("16"));
  // Without any error only a map made of lobes could be; with an error of 1 the first lobe will do.
  EXPECT_EQ(expect_fit(file("a.exr"), {"--target-error", "1"}).lobes.size(), 1u);
  EXPECT_NE(
      fit(file("a.exr"), {"--target-error", "1e-6"}).out.find("target of 0.0001 % is not met"),
      std::string::npos);
}

TEST_F(EnvironmentInput, APreviewThatCannotBeWrittenIsFoundFirst) {
  const RunResult result = fit("gone.exr", {"--preview", file("none/a.png")});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
}

}  // namespace
}  // namespace burnish::test
