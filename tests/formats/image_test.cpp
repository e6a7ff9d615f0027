#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <png.h>

#include "burnish/formats/image_file.h"
#include "files.h"

namespace burnish::test {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

TEST(Environment, BadValuesAreReplacedByTheStatedRule) {
  Image image(3, 1);
  image.at(0, 0) = {kNan, -1, 7};
  image.at(1, 0) = {kInfinity, -kInfinity, 0};
  image.at(2, 0) = {1e30f, -0.0f, 3};
  float replacement = 0;
  EXPECT_EQ(sanitize_environment(image, &replacement), 4u);
  EXPECT_EQ(replacement, 1e30f);
  EXPECT_TRUE((image.at(0, 0) == Rgb(0, 0, 7)).all());
  EXPECT_TRUE((image.at(1, 0) == Rgb(1e30f, 0, 0)).all());
  EXPECT_TRUE((image.at(2, 0) == Rgb(1e30f, 0, 3)).all());

  Image hopeless(1, 1, Rgb(kInfinity, kNan, -5));
  EXPECT_EQ(sanitize_environment(hopeless, &replacement), 3u);
  EXPECT_EQ(replacement, 0);
  EXPECT_TRUE((hopeless.at(0, 0) == 0).all());
}

TEST(Environment, BadValuesAreCountedAsStored) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  Image image(4, 2, Rgb(1, 2, 3));
  image.at(0, 0) = {kNan, kNan, 3};
  image.at(1, 1) = {kInfinity, 10, -kInfinity};
  image.at(2, 1) = {-2, 2, 3};
  write_exr(image, path, ExrPixelType::single_float);
  EnvironmentReport report;
  const Image found = read_environment(path, &report);
  EXPECT_EQ(report.image.nan_values, 2u);
  EXPECT_EQ(report.image.infinite_values, 2u);
  EXPECT_EQ(report.image.negative_values, 2u);
  EXPECT_EQ(report.replaced_values, 5u);
  EXPECT_EQ(report.infinity_replacement, 10);
  EXPECT_EQ(report.image.min, (std::array<float, 3>{-2, 2, 3}));
  EXPECT_EQ(report.image.max, (std::array<float, 3>{1, 10, 3}));
  EXPECT_DOUBLE_EQ(report.image.mean[0], (5 * 1.0 - 2) / 6);  // 8 pixels, 2 of them not finite
  EXPECT_TRUE((found.at(1, 1) == Rgb(10, 10, 0)).all());
  EXPECT_TRUE((found.at(2, 1) == Rgb(0, 2, 3)).all());
}

TEST(Environment, AnyShapeIsAcceptedAndOddOnesAreNoted) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const struct {
    int width, height;
    bool noted;
  } shapes[] = {{1, 1, true}, {1, 9, true}, {8, 4, false}, {300, 1, true}};
  for (const auto& shape : shapes) {
    write_exr(Image(shape.width, shape.height, Rgb(1, 1, 1)), path);
    EnvironmentReport report;
    const Image image = read_environment(path, &report);
    EXPECT_EQ(image.width, shape.width);
    EXPECT_EQ(report.image.notes.size(), shape.noted ? 1u : 0u) << shape.width;
  }
}

TEST(Environment, OtherLayoutsAreRefusedByName) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const struct {
    int width, height;
    const char* named;  ///< nullptr: accepted
  } shapes[] = {{64, 64, "angular map"}, {64, 48, "a cross"},    {48, 64, "a cross"},
                {96, 16, "in a strip"},  {16, 96, "in a strip"}, {64, 32, nullptr},
                {65, 64, nullptr},       {12, 12, nullptr},      {90, 15, nullptr}};
  for (const auto& shape : shapes) {
    write_exr(Image(shape.width, shape.height, Rgb(1, 1, 1)), path);
    const std::string error = error_of(
        path, [&] { read_environment(path); }, ErrorKind::unsupported);
    if (shape.named) {
      EXPECT_NE(error.find(shape.named), std::string::npos) << error;
      EXPECT_NE(error.find("expected a lat-long environment"), std::string::npos) << error;
    } else {
      EXPECT_EQ(error, "");
    }
    // The picture itself is fine, and so is an environment that says it is one.
    EXPECT_EQ(read_image(path).width, shape.width);
    write_exr(Image(shape.width, shape.height, Rgb(1, 1, 1)), path, ExrPixelType::half_float, true);
    EXPECT_EQ(read_environment(path).width, shape.width);
  }
}

TEST(Environment, SharedMapsHaveTheirSizesAndPositiveValues) {
  const std::filesystem::path folder = shared_data() / "env";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no environments in " << folder << " (set BURNISH_SHARED_DATA)";
  const struct {
    const char* name;
    int width, height;
    std::uint64_t negative_values;  ///< ringing of the DWA compression
    float max;                      ///< as first read; HDR files are also compared with stb_image
  } maps[] = {{"apartment.exr", 512, 256, 17, 20.859375f},
              {"city.exr", 512, 256, 342, 11.046875f},
              {"grace_probe_latlong.hdr", 1024, 512, 0, 1088},
              {"kiara_1_dawn_1k.hdr", 1024, 512, 0, 102.5f},
              {"kloppenheim_05_1k.hdr", 1024, 512, 0, 83456},
              {"rnl_probe_latlong.hdr", 1024, 512, 0, 167},
              {"studio_small_03_1k.hdr", 1024, 512, 0, 3568}};
  for (const auto& map : maps) {
    EnvironmentReport report;
    const Image image = read_environment((folder / map.name).string(), &report);
    EXPECT_EQ(image.width, map.width) << map.name;
    EXPECT_EQ(image.height, map.height) << map.name;
    EXPECT_EQ(report.image.nan_values + report.image.infinite_values, 0u) << map.name;
    EXPECT_EQ(report.image.negative_values, map.negative_values) << map.name;
    EXPECT_EQ(report.replaced_values, map.negative_values) << map.name;
    float largest = 0;
    size_t black = 0;
    for (const Rgb& pixel : image.pixels) {
      ASSERT_TRUE(pixel.isFinite().all() && (pixel >= 0).all()) << map.name;
      black += (pixel == 0).all();
      largest = std::max(largest, pixel.maxCoeff());
    }
    EXPECT_EQ(largest, map.max) << map.name;
    EXPECT_LT(black, 100u) << map.name;  // of half a million, or 131,072
  }
}

/// Pixels of a PNG file, 8-bit RGB.
std::vector<unsigned char> read_png(const std::string& path, int& width, int& height) {
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&header, path.c_str()), 0) << header.message;
  EXPECT_EQ(header.format & PNG_FORMAT_FLAG_LINEAR, 0u);
  header.format = PNG_FORMAT_RGB;
  std::vector<unsigned char> samples(PNG_IMAGE_SIZE(header));
  EXPECT_NE(png_image_finish_read(&header, nullptr, samples.data(), 0, nullptr), 0);
  width = static_cast<int>(header.width);
  height = static_cast<int>(header.height);
  return samples;
}

TEST(PngWrite, AppliesExposureAndTheSrgbCurve) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  Image image(2, 2);
  image.at(0, 0) = {0, 1, 0.5f};
  image.at(1, 0) = {0.0031308f, 0.01f, 0.18f};
  image.at(0, 1) = {-1, kNan, kInfinity};
  image.at(1, 1) = {2, 100, 0.25f};
  write_png(image, path);
  int width = 0, height = 0;
  // Known values of the sRGB curve: linear 0.5 is 187.5, 0.18 is 117.6, 0.01 is 25.5 of 255.
  const std::vector<unsigned char> expected = {0, 255, 188, 10, 25, 118, 0, 0, 255, 255, 255, 137};
  EXPECT_EQ(read_png(path, width, height), expected);
  EXPECT_EQ(width, 2);
  EXPECT_EQ(height, 2);
  EXPECT_NE(read_bytes(path).find("sRGB"), std::string::npos);  // the chunk
  write_png(image, path, -1);                                   // a stop less: 1 as 0.5 before
  EXPECT_EQ(read_png(path, width, height)[1], 188);
  write_png(image, path, 1);  // a stop more: 0.25 as 0.5 before
  EXPECT_EQ(read_png(path, width, height)[11], 188);
}

TEST(PngWrite, SrgbCurveMeetsItsInverse) {
  // The inverse as IEC 61966-2-1 gives it; float rounding and the curve's joint at 0.0031308,
  // where its two pieces differ by 3e-8, stay far below 1e-6.
  for (int i = 0; i <= 10000; ++i) {
    const double encoded = i / 10000.0;
    const double linear =
        encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(srgb_from_linear(static_cast<float>(linear)), encoded, 1e-6);
  }
}

TEST(PngWrite, FailedWriteLeavesTheOldFile) {
  expect_output_survives_failure("a.png", [](const std::string& path) {
    write_png(Image(40, 30, Rgb(0.1f, 0.2f, 0.3f)), path);
  });
}

TEST(PngWrite, RejectsAPictureWithoutPixels) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  EXPECT_NE(error_of(
                path, [&] { write_png(Image(), path); }, ErrorKind::output),
            "");
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace
}  // namespace burnish::test
