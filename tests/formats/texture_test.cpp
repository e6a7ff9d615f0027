#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/material_file.h"
#include "burnish/formats/texture_file.h"
#include "burnish/material/roughness.h"
#include "files.h"
#include "png_examples.h"

namespace burnish::test {
namespace {

Image read_png(const PngExample& example, TextureContent content = TextureContent::data) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  write_bytes(path, encode_png(example));
  return read_texture(path, content);
}

void expect_pixel(const Image& image, int x, int y, const Rgb& expected) {
  EXPECT_LT((image.at(x, y) - expected).abs().maxCoeff(), 1e-6f)
      << x << ", " << y << ": " << image.at(x, y).transpose() << ", expected "
      << expected.transpose();
}

TEST(Texture, ReadsEveryKindOfPng) {
  // Two pixels: (51, 102, 153) / 255 and white.
  const Rgb first(0.2f, 0.4f, 0.6f);
  const Image rgb =
      read_png({2, 1, 8, PNG_COLOR_TYPE_RGB, false, {}, {51, 102, 153, 255, 255, 255}});
  ASSERT_EQ(rgb.width, 2);
  ASSERT_EQ(rgb.height, 1);
  expect_pixel(rgb, 0, 0, first);
  expect_pixel(rgb, 1, 0, Rgb::Ones());
  // Alpha is not read, not even where it is 0.
  expect_pixel(read_png({1, 1, 8, PNG_COLOR_TYPE_RGB_ALPHA, false, {}, {51, 102, 153, 0}}), 0, 0,
               first);
  expect_pixel(read_png({1, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, false, {}, {51, 7}}), 0, 0,
               Rgb::Constant(0.2f));
  expect_pixel(read_png({1, 1, 8, PNG_COLOR_TYPE_GRAY, false, {}, {102}}), 0, 0,
               Rgb::Constant(0.4f));
  // 0x1234 of 16 bits.
  const Image deep = read_png({1, 1, 16, PNG_COLOR_TYPE_GRAY, false, {}, {0x12, 0x34}});
  expect_pixel(deep, 0, 0, Rgb::Constant(0x1234 / 65535.0f));
  expect_pixel(read_png({1, 1, 16, PNG_COLOR_TYPE_RGB, false, {}, {0, 1, 0x80, 0, 255, 255}}), 0, 0,
               {1 / 65535.0f, 0x8000 / 65535.0f, 1});
  // Two bits a pixel: 0, 1, 2, 3 thirds.
  const Image thirds = read_png({4, 1, 2, PNG_COLOR_TYPE_GRAY, false, {}, {0b00011011}});
  for (int x = 0; x < 4; ++x) expect_pixel(thirds, x, 0, Rgb::Constant(float(x) / 3));
  const Image indexed =
      read_png({2, 1, 8, PNG_COLOR_TYPE_PALETTE, false, {{51, 102, 153}, {255, 0, 0}}, {1, 0}});
  expect_pixel(indexed, 0, 0, {1, 0, 0});
  expect_pixel(indexed, 1, 0, first);
}

TEST(Texture, RowsAndInterlacingKeepTheirOrder) {
  PngExample example{5, 3, 8, PNG_COLOR_TYPE_GRAY, false, {}, {}};
  for (int i = 0; i < 15; ++i) example.samples.push_back(static_cast<unsigned char>(17 * i));
  const Image plain = read_png(example);
  example.interlaced = true;
  const Image interlaced = read_png(example);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 5; ++x) {
      expect_pixel(plain, x, y, Rgb::Constant(17.0f * float(5 * y + x) / 255));
      expect_pixel(interlaced, x, y, plain.at(x, y));
    }
}

/// IEC 61966-2-1, and the inverse of what write_png does.
TEST(Texture, ColorsAreDecodedFromSrgb) {
  const PngExample example{3, 1, 8, PNG_COLOR_TYPE_GRAY, false, {}, {10, 128, 255}};
  const Image color = read_png(example, TextureContent::color);
  expect_pixel(color, 0, 0, Rgb::Constant(10 / 255.0f / 12.92f));
  expect_pixel(color, 1, 0, Rgb::Constant(0.2158605f));  // ((128/255 + .055) / 1.055)^2.4
  expect_pixel(color, 2, 0, Rgb::Ones());
  for (int i = 0; i <= 100; ++i) {
    const float value = float(i) / 100;
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(value)), value, 1e-6f);
  }
  EXPECT_EQ(linear_from_srgb(-1), 0);
  EXPECT_EQ(linear_from_srgb(2), 1);
  EXPECT_EQ(linear_from_srgb(NAN), 0);
}

TEST(Texture, ReadsOpenExrAsItIs) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.exr");
  Image image(3, 2, {0.25f, -7, 1000});
  write_exr(image, path, ExrPixelType::single_float);
  for (const TextureContent content : {TextureContent::color, TextureContent::data})
    EXPECT_TRUE((read_texture(path, content).at(2, 1) == image.at(0, 0)).all());
  image.at(1, 1) = {NAN, 1, INFINITY};
  write_exr(image, path, ExrPixelType::single_float);
  EXPECT_EQ(error_of(path, [&] { read_texture(path, TextureContent::data); }),
            path + ": 2 values are not finite, expected none in a texture");
}

TEST(Texture, DamagedPngsAreRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  PngExample example{16, 16, 8, PNG_COLOR_TYPE_RGB, true, {}, {}};
  std::mt19937 random(3);
  for (int i = 0; i < 16 * 16 * 3; ++i)
    example.samples.push_back(static_cast<unsigned char>(random()));
  const std::string whole = encode_png(example);
  const auto is_refused = [&](const std::string& bytes) {
    write_bytes(path, bytes);
    return error_of(path, [&] { read_texture(path, TextureContent::data); }) != "";
  };
  ASSERT_FALSE(is_refused(whole));
  for (size_t size = 0; size < whole.size(); ++size)
    EXPECT_TRUE(is_refused(whole.substr(0, size))) << "cut at byte " << size;
  // Every chunk is under a checksum but for its length and what follows the last.
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string damaged = whole;
    damaged[random() % damaged.size()] = static_cast<char>(random());
    refused += is_refused(damaged);
  }
  EXPECT_GT(refused, 1900);
  EXPECT_NE(error_of(folder.file("gone.png"),
                     [&] { read_texture(folder.file("gone.png"), TextureContent::data); }),
            "");
}

/// A header that claims a picture that its bytes cannot hold.
TEST(Texture, ForgedSizesAreRefusedBeforeMemoryIsTaken) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.png");
  std::string bytes = encode_png({1, 1, 8, PNG_COLOR_TYPE_GRAY, false, {}, {0}});
  bytes[16] = bytes[20] = 0;
  bytes[17] = bytes[21] = 0;
  bytes[18] = bytes[22] = static_cast<char>(0xff);  // 65280 x 65280
  bytes[19] = bytes[23] = 0;
  // The checksum of IHDR, bitwise (ISO 3309).
  std::uint32_t crc = 0xffffffff;
  for (size_t i = 12; i < 29; ++i) {
    crc ^= static_cast<unsigned char>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0);
  }
  crc = ~crc;
  for (size_t i = 0; i < 4; ++i) bytes[29 + i] = static_cast<char>(crc >> (24 - 8 * i));
  write_bytes(path, bytes);
  EXPECT_NE(error_of(path, [&] { read_texture(path, TextureContent::data); })
                .find("claims 65280 x 65280 pixels"),
            std::string::npos);
}

TEST(MaterialTextures, GiveTheirFieldsTheirValues) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const std::vector<unsigned char>& rgb) {
    write_bytes(folder.file(name), encode_png({1, 1, 8, PNG_COLOR_TYPE_RGB, false, {}, rgb}));
  };
  write("color.png", {128, 128, 128});
  write("half.png", {51, 0, 255});
  write("normal.png", {0, 255, 204});
  write_exr(Image(1, 1, {0.5f, -0.5f, 2}), folder.file("normal.exr"), ExrPixelType::single_float);
  const std::string path = folder.file("m.json");
  const auto pictures_of = [&](const std::string& model, const std::string& fields) {
    write_bytes(path, R"({"format": "burnish material", "format_version": 1, "model": ")" + model +
                          "\", " + fields + "}");
    return read_material_pictures(read_material_file(path), path);
  };
  const MaterialPictures ward = pictures_of("ward", R"("diffuse": {"texture": "color.png"},
          "specular": {"texture": "color.png", "scale": 2, "offset": 0.25},
          "alpha_x": {"texture": "half.png"}, "alpha_y": 0.5,
          "tangent_rotation_rad": {"texture": "half.png", "scale": -5, "offset": 1},
          "normal": {"texture": "normal.png"})");
  expect_pixel(*ward.diffuse, 0, 0, Rgb::Constant(0.2158605f));
  expect_pixel(*ward.specular, 0, 0, Rgb::Constant(2 * 0.2158605f + 0.25f));
  EXPECT_NEAR(ward.alpha_x->at(0, 0)[0], 0.2f, 1e-6f);
  EXPECT_FALSE(ward.alpha_y.has_value());
  EXPECT_NEAR(ward.tangent_rotation_rad->at(0, 0)[0], 0, 1e-6f);
  expect_pixel(*ward.normal, 0, 0, {-1, 1, 0.6f});
  // One texture for both alphas; a roughness is squared; normals of an OpenEXR file are as they
  // are.
  const MaterialPictures both = pictures_of("ward", R"("alpha": {"texture": "half.png"})");
  EXPECT_NEAR(both.alpha_y->at(0, 0)[0], 0.2f, 1e-6f);
  const MaterialPictures rough = pictures_of(
      "ward", R"("roughness": {"texture": "half.png"}, "normal": {"texture": "normal.exr"})");
  EXPECT_NEAR(rough.alpha_x->at(0, 0)[0], alpha_from_roughness(0.2f), 1e-6f);
  EXPECT_NEAR(rough.alpha_y->at(0, 0)[0], alpha_from_roughness(0.2f), 1e-6f);
  expect_pixel(*rough.normal, 0, 0, {0.5f, -0.5f, 2});
  const std::string gone = folder.file("gone.png");
  EXPECT_NE(error_of(gone, [&] { pictures_of("ward", R"("alpha": {"texture": "gone.png"})"); }),
            "");
}

TEST(MaterialTextures, ReadBackAsTheyWereWritten) {
  MaterialFile file;
  file.material.model = SpecularModel::ward;
  file.textures.diffuse = TextureFile{"wood \"1\".png", 0.3f, 0.1f};
  file.textures.specular = TextureFile{"s.exr"};
  file.textures.alpha_y = TextureFile{"a/b.png", 1, -0.25f};
  file.textures.tangent_rotation_rad = TextureFile{"t.png", 6.2831855f};
  file.textures.normal = TextureFile{"n.png"};
  file.textures.wrap = TextureWrap::mirror;
  const std::string json = format_material(file, "m.json");
  const MaterialFile found = parse_material(json, "m.json");
  EXPECT_EQ(format_material(found, "m.json"), json);
  ASSERT_TRUE(found.textures.diffuse && found.textures.alpha_y && found.textures.normal);
  EXPECT_EQ(found.textures.diffuse->file, "wood \"1\".png");
  EXPECT_EQ(found.textures.diffuse->scale, 0.3f);
  EXPECT_EQ(found.textures.diffuse->offset, 0.1f);
  EXPECT_EQ(found.textures.alpha_y->offset, -0.25f);
  EXPECT_EQ(found.textures.tangent_rotation_rad->scale, 6.2831855f);
  EXPECT_EQ(found.textures.wrap, TextureWrap::mirror);
  EXPECT_FALSE(found.textures.alpha_x || found.textures.roughness);
  file.textures.alpha_y.reset();
  file.textures.roughness = TextureFile{"r.png"};
  const MaterialFile rough = parse_material(format_material(file, "m.json"), "m.json");
  ASSERT_TRUE(rough.textures.roughness.has_value());
  EXPECT_EQ(rough.textures.roughness->file, "r.png");
}

TEST(MaterialTextures, BadFieldsAreRefusedByPathAndLine) {
  const auto error = [](const std::string& model, const std::string& fields) {
    const std::string name = "m.json";
    return error_of(name, [&] {
      parse_material(R"({"format": "burnish material", "format_version": 1, "model": ")" + model +
                         "\",\n" + fields + "}",
                     name);
    });
  };
  const auto expect = [&](const std::string& model, const std::string& fields,
                          const std::string& cause) {
    const std::string found = error(model, fields);
    EXPECT_NE(found.find("line 2, " + cause), std::string::npos) << cause << " / " << found;
  };
  EXPECT_EQ(error("diffuse", R"("diffuse": {"texture": "a.png"})"), "");
  expect("diffuse", R"("diffuse": {"file": "a.png"})", "/diffuse/file: unknown field");
  expect("diffuse", R"("diffuse": {"scale": 2})", "/diffuse: has no field 'texture'");
  expect("diffuse", R"("diffuse": {"texture": ""})", "/diffuse/texture: empty");
  expect("diffuse", R"("diffuse": {"texture": 3})", "/diffuse/texture: is number");
  expect("diffuse", R"("diffuse": {"texture": "a", "scale": 1e39})", "/diffuse/scale: 1e+39");
  expect("diffuse", R"("diffuse": 1, "wrap": "repeat")", "/wrap: without a texture");
  expect("diffuse", R"("diffuse": {"texture": "a"}, "wrap": "tile")",
         "/wrap: 'tile', expected repeat, mirror or clamp");
  expect("diffuse", R"("diffuse": 1, "normal": [0, 0, 1])",
         "/normal: is array, expected an object with a texture");
  expect("diffuse", R"("diffuse": 1, "normal": {"texture": "n", "scale": 2})",
         "/normal/scale: unknown field");
  expect("diffuse", R"("diffuse": 1, "tangent_rotation_rad": {"texture": "n"})",
         "/tangent_rotation_rad: not a field of the model 'diffuse'");
  expect("ward", R"("alpha": 1, "tangent_rotation_rad": 2)",
         "/tangent_rotation_rad: is number, expected an object with a texture");
}

TEST(MaterialTextures, AreNotSilentlyLeftOut) {
  const TemporaryFolder folder;
  const std::string path = folder.file("m.json");
  write_bytes(path, R"({"format": "burnish material", "format_version": 1, "model": "diffuse",
                        "diffuse": {"texture": "a.png"}})");
  EXPECT_NE(error_of(
                path, [&] { read_material(path); }, ErrorKind::unsupported)
                .find("has textures"),
            std::string::npos);
}

}  // namespace
}  // namespace burnish::test
