#include "harness/transfer_picture.h"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/formats/image_file.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/visibility_ladder.h"

namespace burnish {
namespace {

bool is_blue(const Rgb& color) { return color.z() > 1.05f * color.x(); }
bool is_red(const Rgb& color) { return color.x() > 1.05f * color.z(); }
bool is_white(const Rgb& color) { return color.minCoeff() > 0.99f; }

// The pixel of a map in the sheet, `x`, `y` in pixels of the map.
Rgb pixel(const Image& sheet, const Transfer& transfer, int column, int row, int x, int y) {
  const int step = picture_map_edge(transfer) + kPictureGutter;
  return sheet.at(kPictureGutter + column * step + x, kPictureGutter + row * step + y);
}

// Nine vertices with normals all around, two bases of 16 x 16 texels with a term each.
Transfer example(float amplitude_rad) {
  Transfer transfer;
  for (int i = 0; i < 9; ++i) {
    transfer.positions.emplace_back(static_cast<float>(i), 0.0f, 0.0f);
    transfer.normals.push_back(octahedral_to_direction<float>(0.1f * i, 0.3f));
    transfer.basis_id.push_back(i % 2);
    transfer.coefficients.push_back(i % 2 ? 1.0f : 0.0f);
  }
  for (int b = 0; b < 2; ++b) {
    SsdfBasis basis;
    basis.resolution = 16;
    basis.terms = 1;
    basis.amplitude_rad = amplitude_rad;
    for (int i = 0; i < 256; ++i) {
      // Visible on the left, hidden on the right, a boundary in column 8; a term that turns
      // basis 1.
      const float side = i % 16 < 8 ? 0.5f : i % 16 > 8 ? -0.5f : 0.0f;
      basis.mean.push_back(side);
      basis.eigen.push_back(-2 * side);
    }
    transfer.bases.push_back(basis);
  }
  return transfer;
}

TEST(TransferPicture, ColorsDivergeFromWhite) {
  EXPECT_TRUE(is_white(diverging_color(0)));
  EXPECT_TRUE(is_white(diverging_color(std::numeric_limits<float>::quiet_NaN())));
  for (float value = 0.05f; value < 1; value += 0.05f) {
    EXPECT_TRUE(is_blue(diverging_color(value))) << value;
    EXPECT_TRUE(is_red(diverging_color(-value))) << value;
    // Farther from the boundary is darker.
    for (const float sign : {1.0f, -1.0f})
      EXPECT_LT(diverging_color(sign * value).sum(), diverging_color(sign * (value - 0.05f)).sum());
  }
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE((diverging_color(infinity) == diverging_color(1)).all());
  EXPECT_TRUE((diverging_color(-infinity) == diverging_color(-1)).all());
  // As the file shows it: half a step of 8 bits.
  EXPECT_NEAR(255 * srgb_from_linear(diverging_color(1).x()), 33, 0.5);
  EXPECT_NEAR(255 * srgb_from_linear(diverging_color(1).z()), 172, 0.5);
  EXPECT_NEAR(255 * srgb_from_linear(diverging_color(-1).x()), 178, 0.5);
}

TEST(TransferPicture, SizeFollowsFromWhatThereIs) {
  Transfer transfer;
  const auto expect_size = [&](int edge, int rows) {
    const Image sheet = draw_transfer(transfer);
    EXPECT_EQ(sheet.width, 8 * (edge + 2) + 2);
    EXPECT_EQ(sheet.height, rows * (edge + 2) + 2);
  };
  expect_size(128, 1);
  transfer = example(0);
  expect_size(128, 3);
  transfer.bases.resize(1);
  transfer.basis_id.assign(9, 0);
  transfer.bases[0].resolution = 256;
  transfer.bases[0].mean.assign(65536, 0.0f);
  transfer.bases[0].eigen.assign(65536, 0.0f);
  expect_size(256, 2);
  transfer.bases.assign(100, transfer.bases[0]);
  expect_size(256, 1 + kPictureBases);
}

TEST(TransferPicture, SignIsHue) {
  for (const float amplitude_rad : {0.0f, 0.4f}) {
    const Transfer transfer = example(amplitude_rad);
    const Image sheet = draw_transfer(transfer);
    for (int column = 0; column < kPictureColumns; ++column) {
      // The middle of eight stretches of nine vertices: 0, 1, 2, 3, 5, 6, 7, 8.
      const int vertex = column < 4 ? column : column + 1;
      for (const int y : {0, 50, 127}) {
        const Rgb left = pixel(sheet, transfer, column, 0, 63, y);
        const Rgb right = pixel(sheet, transfer, column, 0, 72, y);
        EXPECT_TRUE(vertex % 2 ? is_red(left) : is_blue(left)) << column;
        EXPECT_TRUE(vertex % 2 ? is_blue(right) : is_red(right)) << column;
        EXPECT_TRUE(is_white(pixel(sheet, transfer, column, 0, 64, y))) << column;
        EXPECT_TRUE(is_white(pixel(sheet, transfer, column, 0, 71, y))) << column;
      }
    }
    for (int row = 1; row <= 2; ++row) {
      EXPECT_TRUE(is_blue(pixel(sheet, transfer, 0, row, 63, 9)));
      EXPECT_TRUE(is_red(pixel(sheet, transfer, 0, row, 72, 9)));
      // The eigen-SSDF is scaled to its largest value.
      EXPECT_TRUE((pixel(sheet, transfer, 1, row, 63, 9) == diverging_color(-1)).all());
      EXPECT_TRUE((pixel(sheet, transfer, 1, row, 72, 9) == diverging_color(1)).all());
      // There is no second term: the gutters' grey.
      EXPECT_TRUE((pixel(sheet, transfer, 2, row, 9, 9) == sheet.at(0, 0)).all());
    }
  }
}

TEST(TransferPicture, WithoutBasesItShowsHorizons) {
  Transfer transfer = example(0);
  transfer.bases.clear();
  transfer.basis_id.clear();
  transfer.coefficients.clear();
  const Image sheet = draw_transfer(transfer);
  for (int column = 0; column < kPictureColumns; ++column) {
    const Vector3f& normal =
        transfer.normals[static_cast<std::size_t>(column < 4 ? column : column + 1)];
    for (int y = 0; y < 128; ++y)
      for (int x = 0; x < 128; ++x) {
        const float cosine = normal.dot(octahedral_texel_direction<float>(x, y, 128));
        const Rgb color = pixel(sheet, transfer, column, 0, x, y);
        // Nearer than this the boundary is nearly white.
        if (std::abs(cosine) < 0.02f) continue;
        ASSERT_TRUE(cosine > 0 ? is_blue(color) : is_red(color));
      }
    // Over the seam a map meets its own mirror image: texels at most 0.042 rad apart. From 0.1 rad
    // off the boundary on, shade changes by at most 1.3 a radian, a colour by 2 a unit of shade.
    for (int i = 0; i < 64; ++i)
      for (const int edge : {0, 127}) {
        const float cosine = normal.dot(octahedral_texel_direction<float>(i, edge, 128));
        if (std::abs(cosine) < 0.12f) continue;
        const Rgb across = pixel(sheet, transfer, column, 0, i, edge);
        const Rgb mirrored = pixel(sheet, transfer, column, 0, 127 - i, edge);
        ASSERT_LT((across - mirrored).abs().maxCoeff(), 0.042f * 1.3f * 2);
      }
  }
}

TEST(TransferPicture, LaddersShowWhatLobesSee) {
  Transfer transfer = example(0);
  // Two bands: all of the sphere sees 1/2 more or less of a cosine about +z, the middle of the map.
  LadderBasis ladder;
  ladder.bands = 2;
  ladder.terms = 1;
  ladder.mean = {std::sqrt(kPi<float>), 0, 0, 0};
  ladder.eigen = {0, 0, 0, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    // Whichever of the band's three it is that points to +z.
    std::array<float, 4> up = {};
    eval_harmonics(2, {0, 0, 1}, up);
    ladder.eigen[i] = i == 0 ? 0 : up[i];
  }
  transfer.ladder_bases.push_back(ladder);
  transfer.ladder_coefficients = {0.5f, -0.5f, 0.5f, -0.5f, 0.5f, -0.5f, 0.5f, -0.5f, 0};
  const Image sheet = draw_transfer(transfer);
  ASSERT_EQ(sheet.height, 5 * 130 + 2);
  for (int column = 0; column < kPictureColumns; ++column) {
    // The vertices' mean is the ladder's mean: one half everywhere.
    EXPECT_TRUE(is_white(pixel(sheet, transfer, column, 3, 64, 64)));
    EXPECT_TRUE(is_white(pixel(sheet, transfer, column, 3, 5, 5)));
    EXPECT_TRUE(is_blue(pixel(sheet, transfer, column, 4, 64, 64)));
    EXPECT_TRUE(is_red(pixel(sheet, transfer, column, 4, 1, 1)));
  }
  // Wider lobes see less of a difference.
  EXPECT_GT(pixel(sheet, transfer, 0, 4, 64, 64).sum(), pixel(sheet, transfer, 7, 4, 64, 64).sum());
}

}  // namespace
}  // namespace burnish
