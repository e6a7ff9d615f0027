#include "burnish/material/texture.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace burnish::test {
namespace {

constexpr TextureWrap kWraps[] = {TextureWrap::repeat, TextureWrap::mirror, TextureWrap::clamp};

Image random_image(int width, int height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform;
  Image image(width, height);
  for (Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) pixel[c] = uniform(random);
  return image;
}

Rgb mean_of(const Image& image) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const Rgb& pixel : image.pixels) sum += pixel.cast<double>();
  return (sum / double(image.pixels.size())).cast<float>();
}

TEST(Texture, EveryLevelKeepsTheMeanOfOddSizesToo) {
  for (const auto& [width, height] : {std::pair{16, 16}, {17, 5}, {1, 9}, {100, 3}, {1, 1}}) {
    const Image image = random_image(width, height, 3);
    const Texture texture = make_texture(image, TextureWrap::repeat);
    for (const Image& level : texture.levels)
      // Floats add up some hundred times.
      EXPECT_LT((mean_of(level) - mean_of(image)).abs().maxCoeff(), 1e-5f)
          << width << " x " << height << " to " << level.width << " x " << level.height;
    EXPECT_EQ(texture.levels.back().width, 1);
    EXPECT_EQ(texture.levels.back().height, 1);
  }
}

/// u to the right and v up: the picture's first row is at the top.
TEST(Texture, StandsUpright) {
  Image image(2, 2);
  image.at(0, 0) = {1, 0, 0};  // upper left
  image.at(1, 0) = {0, 1, 0};
  image.at(0, 1) = {0, 0, 1};
  image.at(1, 1) = {1, 1, 1};
  const Texture texture = make_texture(image, TextureWrap::clamp);
  EXPECT_TRUE((eval_texture(texture, {0.25f, 0.75f}, 0) == image.at(0, 0)).all());
  EXPECT_TRUE((eval_texture(texture, {0.75f, 0.75f}, 0) == image.at(1, 0)).all());
  EXPECT_TRUE((eval_texture(texture, {0.25f, 0.25f}, 0) == image.at(0, 1)).all());
  EXPECT_TRUE((eval_texture(texture, {0.75f, 0.25f}, 0) == image.at(1, 1)).all());
  const Rgb middle = eval_texture(texture, {0.5f, 0.5f}, 0);
  EXPECT_LT((middle - Rgb::Constant(0.5f)).abs().maxCoeff(), 1e-6f);
}

/// Bilinear lookups reproduce a plane between the outermost pixels' centres.
TEST(Texture, ReproducesAPlane) {
  Image image(12, 7);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float u = (float(x) + 0.5f) / 12, v = 1 - (float(y) + 0.5f) / 7;
      image.at(x, y) = {u, v, 2 * u - v};
    }
  const Texture texture = make_texture(image, TextureWrap::clamp);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> inside(0.1f, 0.9f);
  for (int i = 0; i < 200; ++i) {
    const Vector2<float> uv(inside(random), inside(random));
    const Rgb expected(uv.x(), uv.y(), 2 * uv.x() - uv.y());
    EXPECT_LT((eval_texture(texture, uv, 0) - expected).abs().maxCoeff(), 1e-5f) << uv;
  }
}

TEST(Texture, GoesOnBeyondItsEdges) {
  const Image image = random_image(8, 4, 7);
  const Texture repeat = make_texture(image, TextureWrap::repeat);
  const Texture mirror = make_texture(image, TextureWrap::mirror);
  const Texture clamp = make_texture(image, TextureWrap::clamp);
  std::mt19937 random(6);
  std::uniform_real_distribution<float> anywhere(-3, 3), within(0.1f, 0.9f);
  const auto near = [](const Rgb& a, const Rgb& b) { return (a - b).abs().maxCoeff() < 1e-4f; };
  for (int i = 0; i < 200; ++i) {
    const Vector2<float> uv(anywhere(random), anywhere(random));
    const float shift = std::floor(anywhere(random));
    EXPECT_TRUE(near(eval_texture(repeat, uv, 0),
                     eval_texture(repeat, {uv.x() + shift, uv.y() - shift}, 0)));
    EXPECT_TRUE(near(eval_texture(mirror, uv, 0), eval_texture(mirror, {-uv.x(), uv.y()}, 0)));
    EXPECT_TRUE(near(eval_texture(mirror, uv, 0), eval_texture(mirror, {uv.x(), 2 - uv.y()}, 0)));
    const Vector2<float> held(std::clamp(uv.x(), 0.0f, 1.0f), std::clamp(uv.y(), 0.0f, 1.0f));
    EXPECT_TRUE(near(eval_texture(clamp, uv, 0), eval_texture(clamp, held, 0)));
    // All agree well within.
    const Vector2<float> inner(within(random), 0.2f + 0.6f * within(random));
    EXPECT_TRUE(near(eval_texture(repeat, inner, 0), eval_texture(mirror, inner, 0)));
    EXPECT_TRUE(near(eval_texture(repeat, inner, 0), eval_texture(clamp, inner, 0)));
  }
}

TEST(Texture, WideLookupsAreMeans) {
  const Image image = random_image(33, 20, 8);
  for (const TextureWrap wrap : kWraps) {
    const Texture texture = make_texture(image, wrap);
    for (const float width : {4.0f, 10.0f, 1e30f})
      EXPECT_LT((eval_texture(texture, {0.3f, 0.6f}, width) - mean_of(image)).abs().maxCoeff(),
                1e-5f);
  }
  // Against means over the square, of a smooth picture: two waves, looked up an eighth wide. The
  // lookup's variance is that of the square, or up to a third more between two levels, which damps
  // the waves by 3 % more; the rest is where the square lies among the pixels.
  Image waves(256, 256);
  const auto wave = [](float u, float v) {
    return 0.5f + 0.25f * std::sin(4 * kPi<float> * u) + 0.25f * std::cos(4 * kPi<float> * v);
  };
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      waves.at(x, y) = Rgb::Constant(wave((float(x) + 0.5f) / 256, 1 - (float(y) + 0.5f) / 256));
  const Texture texture = make_texture(waves, TextureWrap::repeat);
  constexpr float kWidth = 0.125f;
  float worst = 0;
  for (int i = 0; i < 64; ++i) {
    const Vector2<float> uv(float(i) / 64, float((7 * i) % 64) / 64);
    // The mean of a sine over a width is sinc times it.
    const float x = 2 * kPi<float> * kWidth;
    const float mean = 0.5f + std::sin(x) / x * (wave(uv.x(), uv.y()) - 0.5f);
    worst = std::max(worst, std::abs(eval_texture(texture, uv, kWidth)[0] - mean));
  }
  EXPECT_LT(worst, 0.05f);
}

TEST(Texture, ChangesContinuouslyWithTheWidth) {
  const Texture texture = make_texture(random_image(64, 64, 9), TextureWrap::repeat);
  Rgb last = eval_texture(texture, {0.4f, 0.7f}, 1e-3f);
  for (float width = 1e-3f; width < 2; width *= 1.01f) {
    const Rgb value = eval_texture(texture, {0.4f, 0.7f}, width);
    // Two neighbouring levels differ by at most 1, over 70 steps.
    EXPECT_LT((value - last).abs().maxCoeff(), 0.02f) << width;
    last = value;
  }
}

}  // namespace
}  // namespace burnish::test
