#include "harness/flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "support/csv.h"

namespace burnish {
namespace {

using Color8 = std::array<int, 3>;

constexpr int kWidth = 24, kHeight = 18;

/// The pictures of flip_oracle.py.
/// @{
Color8 reference_color(int x, int y) {
  if (x >= 6 && x < 12 && y >= 5 && y < 11) return {240, 236, 210};
  if (y == 14) return {12, 20, 40};
  return {40 + 7 * x, 30 + 9 * y, 200 - 5 * x};
}

Color8 test_color(int x, int y) {
  if (x == 19 && y == 4) return {255, 0, 0};
  const int noise = (x * 37 + y * 91 + x * y * 53) % 17 - 8;
  Color8 color = reference_color(x - 1, y);
  for (int& value : color) value = std::clamp(value + noise, 0, 255);
  return color;
}
/// @}

template <class F>
Image picture_of(const F& color) {
  Image picture(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const Color8 c = color(x, y);
      picture.at(x, y) = Rgb(float(c[0]), float(c[1]), float(c[2])) / 255;
    }
  return picture;
}

TEST(Flip, MatchesTheTwoDimensionalSumsOfAnotherImplementation) {
  const Image test = picture_of(test_color), reference = picture_of(reference_color);
  double pixels_per_degree = 0;
  Image map;
  size_t compared = 0;
  for (const auto& row : test::read_golden("flip.csv")) {
    if (row.at("pixels_per_degree") != pixels_per_degree) {
      pixels_per_degree = row.at("pixels_per_degree");
      map = flip_map(test, reference, pixels_per_degree);
    }
    const int x = static_cast<int>(row.at("x")), y = static_cast<int>(row.at("y"));
    // Linear values are floats: 1e-7 of a feature, under a root 3e-4, times p ln p, at most .37.
    EXPECT_NEAR(double(map.at(x, y).x()), row.at("flip"), 1.2e-4)
        << x << "," << y << " at " << pixels_per_degree << " pixels per degree";
    ++compared;
  }
  EXPECT_EQ(compared, 2u * kWidth * kHeight);
}

TEST(Flip, OfEvenPicturesIsTheDifferenceOfTheirColors) {
  const auto flip_of = [](const Rgb& a, const Rgb& b) {
    const Image map = flip_map(Image(9, 7, a), Image(9, 7, b));
    for (const Rgb& pixel : map.pixels) EXPECT_NEAR(pixel.x(), map.pixels[0].x(), 1e-5);
    return double(map.pixels[0].x());
  };
  EXPECT_EQ(flip_of(Rgb(0.3f, 0.4f, 0.5f), Rgb(0.3f, 0.4f, 0.5f)), 0);
  // The largest difference of the published scale. Roundings under a root show as above.
  EXPECT_NEAR(flip_of(Rgb(0, 1, 0), Rgb(0, 0, 1)), 1, 1e-5);
  // By hand: green has L* 87.735, a* -86.183, b* 83.181, blue 32.303, 79.197, -107.864 (D65), times
  // L* / 100: HyAB is 55.432 + |(-101.195, 107.822)| = 203.30. Black and white are 100 apart.
  const double largest = std::pow(203.30, 0.7), e = std::pow(100.0, 0.7);
  const double expected = 0.95 + 0.05 * (e - 0.4 * largest) / (0.6 * largest);
  EXPECT_NEAR(flip_of(Rgb::Zero(), Rgb::Ones()), expected, 1e-4);
  // Below the knee: greys of L* 50 and 51.
  const auto grey = [](double lightness) {
    const double linear = std::pow((lightness + 16) / 116, 3);
    return Rgb(Rgb::Constant(float(1.055 * std::pow(linear, 1 / 2.4) - 0.055)));
  };
  EXPECT_NEAR(flip_of(grey(50), grey(51)), 0.95 / (0.4 * largest), 1e-4);
}

TEST(Flip, IsSymmetricAndBetweenZeroAndOne) {
  const Image a = picture_of(test_color), b = picture_of(reference_color);
  const Image forth = flip_map(a, b), back = flip_map(b, a);
  for (size_t i = 0; i < forth.pixels.size(); ++i) {
    EXPECT_EQ(forth.pixels[i].x(), back.pixels[i].x());
    EXPECT_GE(forth.pixels[i].x(), 0);
    EXPECT_LE(forth.pixels[i].x(), 1);
  }
}

TEST(Flip, CountsADifferenceMoreWhereItMakesAnEdge) {
  // Half of a picture, and all of it, a little lighter.
  const Image dark(60, 40, Rgb::Constant(0.5f)), light(60, 40, Rgb::Constant(0.56f));
  Image half = dark;
  for (int y = 0; y < 40; ++y)
    for (int x = 30; x < 60; ++x) half.at(x, y) = light.at(x, y);
  const Image edge = flip_map(half, dark), even = flip_map(light, dark);
  EXPECT_GT(edge.at(31, 20).x(), 1.3f * even.at(31, 20).x());
  EXPECT_NEAR(edge.at(55, 20).x(), even.at(55, 20).x(), 1e-3) << "far from the edge";
  EXPECT_NEAR(edge.at(4, 20).x(), 0, 1e-3);
}

TEST(Flip, MeanIsOverAllPixels) {
  Image map(2, 1, Rgb::Constant(0.25f));
  map.at(1, 0) = Rgb::Constant(0.75f);
  EXPECT_EQ(flip_mean(map), 0.5);
}

}  // namespace
}  // namespace burnish
