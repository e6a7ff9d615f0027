#include <cmath>
#include <functional>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "burnish/formats/image_file.h"
#include "files.h"

#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_HDR
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace burnish::test {
namespace {

using Rgbe = std::array<unsigned char, 4>;

struct RgbePicture {
  int width, height;
  std::vector<Rgbe> pixels;  ///< from the top left
};

/// Runs and noise. Never (2, 2, ...) or (1, 1, 1, ...), which flat codings take for marks.
RgbePicture random_rgbe(unsigned seed, int width, int height) {
  std::mt19937 random(seed);
  RgbePicture picture{width, height, {}};
  Rgbe pixel = {};
  for (int i = 0; i < width * height; ++i) {
    if (i == 0 || random() % 4 == 0)
      for (unsigned char& byte : pixel) byte = static_cast<unsigned char>(3 + random() % 250);
    picture.pixels.push_back(pixel);
  }
  picture.pixels[0][3] = 0;  // black, whatever its mantissas
  return picture;
}

/// The value by the format's definition: mantissa / 256 * 2^(exponent - 128).
Rgb rgbe_value(const Rgbe& pixel) {
  if (pixel[3] == 0) return Rgb::Zero();
  Rgb value;
  for (int c = 0; c < 3; ++c)
    value[c] = float(pixel[size_t(c)] / 256.0 * std::exp2(pixel[3] - 128));
  return value;
}

enum class Coding { flat, pixel_runs, component_runs };

void append_scanline(std::string& bytes, const std::vector<Rgbe>& line, Coding coding) {
  const auto put = [&](size_t byte) { bytes.push_back(static_cast<char>(byte)); };
  if (coding == Coding::component_runs) {
    for (const size_t byte : {size_t{2}, size_t{2}, line.size() >> 8, line.size() & 255}) put(byte);
    for (size_t c = 0; c < 4; ++c)
      for (size_t x = 0; x < line.size();) {
        size_t run = 1;
        while (x + run < line.size() && run < 127 && line[x + run][c] == line[x][c]) ++run;
        put(run > 2 ? 128 + run : run);
        for (size_t i = 0; i < (run > 2 ? 1 : run); ++i) put(line[x][c]);
        x += run;
      }
    return;
  }
  for (size_t x = 0; x < line.size();) {
    for (const unsigned char byte : line[x]) put(byte);
    size_t run = 0;
    if (coding == Coding::pixel_runs)
      while (x + 1 + run < line.size() && line[x + 1 + run] == line[x]) ++run;
    // A count of more than 255 goes on with its next byte.
    for (size_t rest = run; rest > 0; rest >>= 8)
      for (const size_t byte : {size_t{1}, size_t{1}, size_t{1}, rest & 255}) put(byte);
    x += 1 + run;
  }
}

struct Orientation {
  const char* text;  ///< with the two sizes to be filled in
  bool columns, flip_x, flip_y;
};

std::string encode_radiance(const RgbePicture& picture, Coding coding,
                            const Orientation& o = {"-Y {} +X {}", false, false, false},
                            const std::string& header = "") {
  const int lines = o.columns ? picture.width : picture.height;
  const int length = o.columns ? picture.height : picture.width;
  std::string bytes = "#?RADIANCE\n# a comment = none\nFORMAT=32-bit_rle_rgbe\n" + header + "\n";
  bytes += fmt::format(fmt::runtime(o.text), lines, length) + "\n";
  for (int line = 0; line < lines; ++line) {
    std::vector<Rgbe> scanline;
    for (int i = 0; i < length; ++i) {
      const int x = o.columns ? line : i, y = o.columns ? i : line;
      const int column = o.flip_x ? picture.width - 1 - x : x;
      const int row = o.flip_y ? picture.height - 1 - y : y;
      scanline.push_back(picture.pixels[size_t(row) * size_t(picture.width) + size_t(column)]);
    }
    append_scanline(bytes, scanline, coding);
  }
  return bytes;
}

void expect_picture(const Image& found, const RgbePicture& expected, const std::string& what,
                    const Rgb& scale = Rgb::Ones()) {
  ASSERT_EQ(found.width, expected.width) << what;
  ASSERT_EQ(found.height, expected.height) << what;
  for (size_t i = 0; i < found.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const float value = rgbe_value(expected.pixels[i])[c] * scale[c];
      ASSERT_FLOAT_EQ(found.pixels[i][c], value) << what << ", pixel " << i;
    }
}

std::string image_error(const std::string& path) {
  return error_of(path, [&] { read_image(path); });
}

TEST(RadianceRead, EveryCodingAndWidth) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  for (const int width : {1, 7, 8, 129, 700}) {
    const RgbePicture picture = random_rgbe(unsigned(width), width, 5);
    for (const Coding coding : {Coding::flat, Coding::pixel_runs, Coding::component_runs}) {
      if (coding == Coding::component_runs && width < 8) continue;
      write_bytes(path, encode_radiance(picture, coding));
      ImageReport report;
      expect_picture(read_image(path, &report), picture,
                     fmt::format("width {}, coding {}", width, int(coding)));
      EXPECT_EQ(report.format, "Radiance");
      EXPECT_TRUE(report.notes.empty());
    }
  }
}

TEST(RadianceRead, LongRunsOfPixels) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  RgbePicture picture{1000, 2, std::vector<Rgbe>(2000, Rgbe{9, 8, 7, 129})};
  write_bytes(path, encode_radiance(picture, Coding::pixel_runs));
  expect_picture(read_image(path), picture, "runs of more than 255");
}

TEST(RadianceRead, EveryOrientation) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  const RgbePicture picture = random_rgbe(3, 12, 9);
  for (const Orientation& orientation : {Orientation{"-Y {} +X {}", false, false, false},
                                         {"-Y {} -X {}", false, true, false},
                                         {"+Y {} +X {}", false, false, true},
                                         {"+Y {} -X {}", false, true, true},
                                         {"+X {} -Y {}", true, false, false},
                                         {"-X {} -Y {}", true, true, false},
                                         {"+X {} +Y {}", true, false, true},
                                         {"-X {} +Y {}", true, true, true}}) {
    write_bytes(path, encode_radiance(picture, Coding::component_runs, orientation));
    expect_picture(read_image(path), picture, orientation.text);
  }
}

TEST(RadianceRead, DividesByExposureAndColorCorrection) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  const RgbePicture picture = random_rgbe(4, 16, 4);
  write_bytes(path, encode_radiance(picture, Coding::flat, {"-Y {} +X {}", false, false, false},
                                    "EXPOSURE=  2.0\nEXPOSURE=4\nCOLORCORR= 1 2 0.5\n"));
  ImageReport report;
  expect_picture(read_image(path, &report), picture, "exposure",
                 Rgb(1 / 8.0f, 1 / 16.0f, 1 / 4.0f));
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].find("0.125 0.0625 0.25"), std::string::npos) << report.notes[0];
}

void expect_what_stb_reads(const std::string& path) {
  int width = 0, height = 0, components = 0;
  float* values = stbi_loadf(path.c_str(), &width, &height, &components, 3);
  ASSERT_NE(values, nullptr) << path;
  const Image image = read_image(path);
  ASSERT_EQ(image.width, width) << path;
  ASSERT_EQ(image.height, height) << path;
  for (size_t i = 0; i < image.pixels.size() * 3; ++i)
    ASSERT_EQ(image.pixels[i / 3][int(i % 3)], values[i]) << path << ", value " << i;
  stbi_image_free(values);
}

TEST(RadianceRead, AgreesWithStbImage) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  for (const Coding coding : {Coding::flat, Coding::component_runs}) {
    write_bytes(path, encode_radiance(random_rgbe(8, 301, 40), coding));
    expect_what_stb_reads(path);
  }
}

TEST(RadianceRead, AgreesWithStbImageOnSharedMaps) {
  const std::filesystem::path folder = shared_data() / "env";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no environments in " << folder << " (set BURNISH_SHARED_DATA)";
  int maps = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".hdr") {
      expect_what_stb_reads(entry.path().string());
      ++maps;
    }
  EXPECT_GT(maps, 0);
}

TEST(RadianceRead, RejectsBrokenHeaders) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  const std::string start = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
  const struct {
    std::string bytes, cause;
  } cases[] = {
      {"", "an empty file"},
      {"#?RADIANCE", "the header has no end"},
      {start, "the header has no end"},
      {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd", "32-bit_rle_xyze"},
      {start + "EXPOSURE=0\n\n-Y 1 +X 1\nabcd", "expected a positive number"},
      {start + "EXPOSURE=nan\n\n-Y 1 +X 1\nabcd", "expected a positive number"},
      {start + "EXPOSURE=1e-30\nEXPOSURE=1e-30\n\n-Y 1 +X 1\nabcd", "more than a float can hold"},
      {start + "\n-Y 0 +X 1\nabcd", "0 pixels, expected"},
      {start + "\n-Y -1 +X 1\nabcd", "pixels, expected"},
      {start + "\n-Y 1 +X 1000000\nabcd", "expected 1..65536"},
      {start + "\n-Y 99999999999999999999 +X 1\nabcd", "expected a resolution"},
      {start + "\n-Y 60000 +X 60000\nabcd", "at most 4096 pixels per byte"},
      {start + "\n-Y 1 +Y 1\nabcd", "expected a resolution"},
      {start + "\n-Y 1 +X 1 +Z 1\nabcd", "expected a resolution"},
      {start + "\n+X 1\nabcd", "expected a resolution"},
      {start + "\n-Y 1 +X 2\n\1\1\1\2zzzz", "a run that does not fit"},
      {start + "\n-Y 1 +X 8\n\2\2" + std::string(1, '\0') + "\7zz", "a scanline of 7 pixels"},
      {start + "\n-Y 1 +X 8\n\2\2" + std::string(1, '\0') + "\10\211z", "a run of 9 pixels"},
      {start + "\n-Y 1 +X 8\n\2\2" + std::string(1, '\0') + "\10" + std::string(1, '\0'),
       "a run of 0 pixels"},
      {"\x89PNG\r\n\x1a\n", "PNG"},
      {"hello", "an unknown format"},
  };
  for (const auto& broken : cases) {
    write_bytes(path, broken.bytes);
    const std::string error = image_error(path);
    EXPECT_NE(error.find(broken.cause), std::string::npos) << broken.cause << ": " << error;
  }
}

TEST(RadianceRead, EveryTruncationIsRejected) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  for (const Coding coding : {Coding::flat, Coding::pixel_runs, Coding::component_runs}) {
    const std::string bytes = encode_radiance(random_rgbe(6, 20, 10), coding);
    for (size_t size = 0; size < bytes.size(); ++size) {
      write_bytes(path, bytes.substr(0, size));
      EXPECT_NE(image_error(path), "") << size << " of " << bytes.size();
    }
  }
}

TEST(RadianceRead, ChangedBytesNeverCrash) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.hdr");
  constexpr unsigned kSeed = 78;
  std::mt19937 random(kSeed);
  int rejected = 0;
  for (const Coding coding : {Coding::flat, Coding::pixel_runs, Coding::component_runs}) {
    const std::string bytes = encode_radiance(random_rgbe(6, 40, 10), coding);
    for (int i = 0; i < 400; ++i) {
      std::string damaged = bytes;
      const size_t place = random() % (i % 2 ? bytes.size() : 80);
      damaged[place] = static_cast<char>(random());
      write_bytes(path, damaged);
      rejected += !error_of(path, [&] {
                     const Image image = read_image(path);
                     EXPECT_EQ(image.pixels.size(), size_t(image.width) * size_t(image.height));
                   }).empty();
    }
  }
  EXPECT_GT(rejected, 0);
}

}  // namespace
}  // namespace burnish::test
