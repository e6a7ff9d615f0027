#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "burnish/formats/image_file.h"
#include "exr_examples.h"
#include "files.h"

namespace burnish::test {
namespace {

std::string image_error(const std::string& path, ErrorKind kind = ErrorKind::input) {
  return error_of(
      path, [&] { read_image(path); }, kind);
}

/// A smooth picture whose values are whole numbers up to 1000: exact in half, float and uint.
Image smooth_picture(int width, int height, bool gray = false) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float r = std::round(500 + 300 * std::sin(0.1f * float(x)));
      const float g = std::round(500 + 300 * std::cos(0.15f * float(y)));
      const float b = std::round(400 + 2 * float(x) + 3 * float(y));
      image.at(x, y) = gray ? Rgb::Constant(r) : Rgb(r, g, b);
    }
  return image;
}

void expect_equal(const Image& found, const Image& expected, const std::string& what,
                  float relative_tolerance = 0) {
  ASSERT_EQ(found.width, expected.width) << what;
  ASSERT_EQ(found.height, expected.height) << what;
  for (int y = 0; y < found.height; ++y)
    for (int x = 0; x < found.width; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(found.at(x, y)[c], expected.at(x, y)[c],
                    relative_tolerance * expected.at(x, y)[c])
            << what << ", pixel " << x << ", " << y << ", channel " << c;
}

/// Of 500 +- 300 in smooth slopes. Lossless codings keep whole numbers; PXR24 keeps 16 bits of a
/// float's mantissa. B44 keeps 6 bits of the differences in a 4x4 block, DWA (at its default level
/// 45) drops detail that the eye would not see: 3 % bounds both on this picture.
float coding_tolerance(Imf::Compression compression, Imf::PixelType type) {
  const bool is_b44 = compression == Imf::B44_COMPRESSION || compression == Imf::B44A_COMPRESSION;
  const bool is_dwa = compression == Imf::DWAA_COMPRESSION || compression == Imf::DWAB_COMPRESSION;
  return (is_b44 && type == Imf::HALF) || (is_dwa && type != Imf::UINT) ? 0.03f : 0;
}

TEST(ExrRead, EveryTypeCompressionAndStorage) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression)
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT, Imf::UINT})
      for (const int storage : {0, 1, 2, 3}) {  // scanlines, tiles, mip map, rip map
        ExrVariant variant;
        variant.type = type;
        variant.compression = static_cast<Imf::Compression>(compression);
        variant.tiled = storage > 0;
        variant.level_mode = storage == 2   ? Imf::MIPMAP_LEVELS
                             : storage == 3 ? Imf::RIPMAP_LEVELS
                                            : Imf::ONE_LEVEL;
        const std::string what =
            fmt::format("compression {} type {} storage {}", compression, int{type}, storage);
        const Image picture = smooth_picture(53, 37);
        write_exr_variant(picture, variant, path);
        ImageReport report;
        expect_equal(read_image(path, &report), picture, what,
                     coding_tolerance(variant.compression, type));
        EXPECT_EQ(report.storage, storage > 0 ? "tiled" : "scanline") << what;
        EXPECT_EQ(report.channels.size(), 3u);
      }
}

TEST(ExrRead, EveryChannelSetAndLineOrder) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  using Names = std::vector<std::string>;
  for (const Names& channels : {Names{"R", "G", "B"}, Names{"R", "G", "B", "A"}, Names{"Y"},
                                Names{"Y", "A"}, Names{"A", "B", "G", "R", "Y", "Z", "diffuse.R"}})
    for (const bool tiled : {false, true})
      for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y}) {
        ExrVariant variant;
        variant.channels = channels;
        variant.line_order = order;
        variant.tiled = tiled;
        const Image picture = smooth_picture(29, 43, channels[0] == "Y");
        write_exr_variant(picture, variant, path);
        ImageReport report;
        expect_equal(read_image(path, &report), picture,
                     fmt::format("{} channels, order {}", channels.size(), int{order}));
        EXPECT_EQ(report.channels.size(), channels.size());
        EXPECT_EQ(report.format, "OpenEXR");
        EXPECT_EQ(report.compression, "zip");
      }
}

TEST(ExrRead, DisplayWindowIsThePicture) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const Image data = smooth_picture(20, 10);
  using Imath::Box2i;
  using Imath::V2i;
  const V2i corner(-5, 7);
  for (const Box2i& display : {Box2i(V2i(-5, 7), V2i(14, 16)),   // the same
                               Box2i(V2i(-10, 0), V2i(30, 40)),  // larger
                               Box2i(V2i(0, 9), V2i(6, 12)),     // smaller
                               Box2i(V2i(10, 10), V2i(20, 12)),  // overlapping
                               Box2i(V2i(100, 100), V2i(103, 101)) /* elsewhere */}) {
    ExrVariant variant;
    variant.data_corner = corner;
    variant.display_window = display;
    write_exr_variant(data, variant, path);
    Image expected(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1);
    for (int y = 0; y < expected.height; ++y)
      for (int x = 0; x < expected.width; ++x) {
        const int i = x + display.min.x - corner.x, j = y + display.min.y - corner.y;
        if (i >= 0 && i < data.width && j >= 0 && j < data.height)
          expected.at(x, y) = data.at(i, j);
      }
    ImageReport report;
    expect_equal(read_image(path, &report), expected, "");
    EXPECT_EQ(report.width, expected.width);
    EXPECT_EQ(report.notes.empty(), display.min == corner);
  }
}

TEST(ExrRead, LatLongAttributeMakesTheDataWindowThePicture) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const Image data = smooth_picture(20, 10);
  ExrVariant variant;
  variant.data_corner = {3, 4};
  variant.display_window = {{0, 0}, {63, 31}};
  Imf::Header header = exr_header(data, variant);
  Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  write_exr_variant(data, variant, path, &header);
  expect_equal(read_environment(path), data, "lat-long");
  Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  write_exr_variant(data, variant, path, &header);
  const std::string error = error_of(
      path, [&] { read_environment(path); }, ErrorKind::unsupported);
  EXPECT_NE(error.find("cube map"), std::string::npos) << error;
}

TEST(ExrRead, LuminanceChroma) {
  const TemporaryFolder folder;
  const std::string path = folder.file("yc.exr");
  constexpr int kWidth = 96, kHeight = 80;
  const Image picture = smooth_picture(kWidth, kHeight);
  std::vector<Imf::Rgba> pixels;
  for (const Rgb& p : picture.pixels) pixels.emplace_back(p[0], p[1], p[2]);
  const auto write = [&](Imf::RgbaChannels channels) {
    Imf::RgbaOutputFile file(path.c_str(), kWidth, kHeight, channels);
    file.setFrameBuffer(pixels.data(), 1, kWidth);
    file.writePixels(kHeight);
  };
  write(Imf::WRITE_YC);
  ImageReport report;
  const Image found = read_image(path, &report);
  ASSERT_EQ(found.width, kWidth);
  ASSERT_EQ(found.height, kHeight);
  ASSERT_EQ(report.channels.size(), 3u);
  EXPECT_EQ(report.channels[0], "BY half 1/2x1/2");
  // OpenEXR rounds luminance to 7 bits (0.4 %) and chroma to 5 (1.6 % of a chroma up to 1): 2 %,
  // and 1 % for its filters. Within 13 pixels of the border its chroma filter mixes in repeated
  // border pixels, so those are held to less.
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool inside = std::min({x, y, kWidth - 1 - x, kHeight - 1 - y}) >= 13;
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(found.at(x, y)[c], picture.at(x, y)[c],
                    (inside ? 0.03f : 0.1f) * picture.at(x, y)[c])
            << x << ", " << y << ", " << c;
    }

  // Without chroma it is gray, and the luminance is that of the picture.
  write(Imf::WRITE_Y);
  const Image gray = read_image(path);
  for (size_t i = 0; i < gray.pixels.size(); ++i) {
    EXPECT_EQ(gray.pixels[i][0], gray.pixels[i][2]);
    EXPECT_NEAR(gray.pixels[i][0], luminance(picture.pixels[i]),
                0.005f * luminance(picture.pixels[i]));  // 7 bits
  }
}

TEST(ExrRead, NotesForeignPrimaries) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  const Image picture = smooth_picture(8, 4);
  Imf::Header header = exr_header(picture, {});
  Imf::addChromaticities(
      header,
      {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}});  // ACEScg
  write_exr_variant(picture, {}, path, &header);
  ImageReport report;
  expect_equal(read_image(path, &report), picture, "values as they are");
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].find("primaries"), std::string::npos);
}

TEST(ExrRead, FirstSuitablePartOfSeveral) {
  const TemporaryFolder folder;
  const std::string path = folder.file("parts.exr");
  const Image picture = smooth_picture(16, 8);
  write_exr_parts(picture, path);
  ImageReport report;
  expect_equal(read_image(path, &report), picture, "second part");
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes[0], "part 2 of 3 ('beauty')");
}

TEST(ExrRead, RejectsDeepPictures) {
  const TemporaryFolder folder;
  const std::string path = folder.file("deep.exr");
  write_deep_exr(path);
  EXPECT_EQ(image_error(path, ErrorKind::unsupported),
            path + ": is a deep picture, expected a flat one");
}

TEST(ExrRead, RejectsForeignChannelsByName) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  write_exr_variant(smooth_picture(4, 4), {.channels = {"R", "G", "depth.Z"}}, path);
  EXPECT_EQ(
      image_error(path, ErrorKind::unsupported),
      path + ": found the channels G half, R half, depth.Z half, expected R G B, Y, or Y RY BY");
}

TEST(ExrRead, RejectsAPictureFarLargerThanItsFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("bomb.exr");
  const Image picture = smooth_picture(4, 4);
  ExrVariant variant;
  variant.display_window = {{0, 0}, {59999, 59999}};
  write_exr_variant(picture, variant, path);
  EXPECT_NE(image_error(path).find("60000 x 60000 pixels"), std::string::npos);
  variant.display_window = {{0, 0}, {70000, 2}};
  write_exr_variant(picture, variant, path);
  EXPECT_NE(image_error(path).find("expected 1..65536"), std::string::npos);
}

TEST(ExrWrite, ReadsBackExactly) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  Image picture(37, 21);
  for (Rgb& pixel : picture.pixels)
    for (int c = 0; c < 3; ++c) {
      float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      while (!std::isfinite(value)) value = std::bit_cast<float>(std::uint32_t(random()));
      pixel[c] = value;
    }
  picture.at(0, 0) = {1e-42f, -std::numeric_limits<float>::infinity(), 0};
  picture.at(1, 0) = Rgb::Constant(std::numeric_limits<float>::quiet_NaN());
  write_exr(picture, path, ExrPixelType::single_float);
  ImageReport report;
  const Image found = read_image(path, &report);
  ASSERT_EQ(found.pixels.size(), picture.pixels.size());
  for (size_t i = 0; i < found.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(std::bit_cast<std::uint32_t>(found.pixels[i][c]),
                std::bit_cast<std::uint32_t>(picture.pixels[i][c]))
          << "seed " << kSeed;
  EXPECT_EQ(report.nan_values, 3u);
  EXPECT_EQ(report.infinite_values, 1u);
  EXPECT_EQ(report.channels[0], "B float");
}

TEST(ExrWrite, HalfRoundsAndStaysFinite) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  Image picture(2, 1);
  picture.at(0, 0) = {1e9f, -1e9f, std::numeric_limits<float>::infinity()};
  picture.at(1, 0) = {1 + std::ldexp(1.0f, -11), 0.1f, 65504};
  write_exr(picture, path);
  const Image found = read_image(path);
  EXPECT_EQ(found.at(0, 0)[0], 65504);
  EXPECT_EQ(found.at(0, 0)[1], -65504);
  EXPECT_EQ(found.at(0, 0)[2], std::numeric_limits<float>::infinity());
  EXPECT_EQ(found.at(1, 0)[0], 1);  // a tie goes to even
  EXPECT_NEAR(found.at(1, 0)[1], 0.1f, std::ldexp(0.1f, -11));
  EXPECT_EQ(found.at(1, 0)[2], 65504);
}

TEST(ExrWrite, EqualPicturesGiveEqualBytes) {
  const TemporaryFolder folder;
  write_exr(smooth_picture(64, 32), folder.file("a.exr"), ExrPixelType::half_float, true);
  write_exr(smooth_picture(64, 32), folder.file("b.exr"), ExrPixelType::half_float, true);
  EXPECT_EQ(read_bytes(folder.file("a.exr")), read_bytes(folder.file("b.exr")));
  EnvironmentReport report;
  expect_equal(read_environment(folder.file("a.exr"), &report), smooth_picture(64, 32), "");
  EXPECT_TRUE(report.image.notes.empty());
}

TEST(ExrWrite, FailedWriteLeavesTheOldFile) {
  expect_output_survives_failure(
      "a.exr", [](const std::string& path) { write_exr(smooth_picture(30, 20), path); });
}

TEST(ExrWrite, RejectsAPictureWithoutPixels) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  EXPECT_NE(error_of(
                path, [&] { write_exr(Image(), path); }, ErrorKind::output),
            "");
  Image wrong(4, 4);
  wrong.pixels.pop_back();
  EXPECT_NE(error_of(
                path, [&] { write_exr(wrong, path); }, ErrorKind::output),
            "");
  EXPECT_EQ(folder.file_count(), 0u);
}

std::vector<ExrVariant> damage_variants() {
  return {{.compression = Imf::NO_COMPRESSION},
          {.compression = Imf::ZIP_COMPRESSION, .tiled = true, .level_mode = Imf::MIPMAP_LEVELS},
          {.compression = Imf::PIZ_COMPRESSION},
          {.compression = Imf::B44_COMPRESSION},
          {.type = Imf::FLOAT, .compression = Imf::PXR24_COMPRESSION},
          {.compression = Imf::DWAA_COMPRESSION, .channels = {"Y"}},
          {.compression = Imf::RLE_COMPRESSION}};
}

TEST(ExrRead, EveryTruncationIsRejected) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  for (const ExrVariant& variant : damage_variants()) {
    write_exr_variant(smooth_picture(24, 18), variant, path);
    const std::string bytes = read_bytes(path);
    const Image whole = read_image(path);
    const size_t step = 1 + bytes.size() / 300;
    for (size_t size = 0; size < bytes.size(); size += step) {
      write_bytes(path, bytes.substr(0, size));
      try {
        // What is cut off may be the mip map's smaller levels.
        expect_equal(read_image(path), whole, fmt::format("{} of {} bytes", size, bytes.size()));
        EXPECT_TRUE(variant.tiled) << size << ", compression " << int{variant.compression};
        EXPECT_GT(size, bytes.size() / 2);
      } catch (const Error&) {
        continue;
      }
    }
  }
}

TEST(ExrRead, ChangedBytesNeverCrash) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  constexpr unsigned kSeed = 77;
  std::mt19937 random(kSeed);
  int rejected = 0, read = 0;
  for (const ExrVariant& variant : damage_variants()) {
    write_exr_variant(smooth_picture(24, 18), variant, path);
    const std::string bytes = read_bytes(path);
    for (int i = 0; i < 250; ++i) {
      std::string damaged = bytes;
      // Half of the changes hit the header, which is where the sizes are.
      const size_t place = random() % (i % 2 ? bytes.size() : std::min<size_t>(bytes.size(), 400));
      damaged[place] = static_cast<char>(random());
      write_bytes(path, damaged);
      try {
        const Image image = read_image(path);
        EXPECT_EQ(image.pixels.size(), size_t(image.width) * size_t(image.height));
        ++read;
      } catch (const Error&) {
        ++rejected;
      }
    }
  }
  // The format has no checksums: changed pixels read as other pixels.
  EXPECT_GT(read, 0);
  EXPECT_GT(rejected, 0);
}

}  // namespace
}  // namespace burnish::test
