#include "burnish/material/texture.h"

#include <algorithm>
#include <cmath>

namespace burnish {
namespace {

/// What of each of `from` pixels in a row lies in one of `to`: the first of them, and their shares.
struct Shares {
  int first = 0;
  std::vector<float> share;  ///< sums to 1
};

Shares shares_of(int pixel, int from, int to) {
  const double begin = double(pixel) * from / to, end = double(pixel + 1) * from / to;
  Shares shares;
  shares.first = static_cast<int>(begin);
  for (int i = shares.first; i < std::min(static_cast<int>(std::ceil(end - 1e-9)), from); ++i)
    shares.share.push_back(static_cast<float>(
        (std::min<double>(end, i + 1) - std::max<double>(begin, i)) * to / from));
  return shares;
}

/// Of half the width and height, rounded down; each pixel the mean over its area.
Image halved(const Image& image) {
  Image across(std::max(image.width / 2, 1), image.height);
  for (int x = 0; x < across.width; ++x) {
    const Shares columns = shares_of(x, image.width, across.width);
    for (int y = 0; y < image.height; ++y)
      for (size_t i = 0; i < columns.share.size(); ++i)
        across.at(x, y) += columns.share[i] * image.at(columns.first + static_cast<int>(i), y);
  }
  Image result(across.width, std::max(image.height / 2, 1));
  for (int y = 0; y < result.height; ++y) {
    const Shares rows = shares_of(y, image.height, result.height);
    for (int x = 0; x < result.width; ++x)
      for (size_t i = 0; i < rows.share.size(); ++i)
        result.at(x, y) += rows.share[i] * across.at(x, rows.first + static_cast<int>(i));
  }
  return result;
}

/// A coordinate within 0..1.
float wrapped(float t, TextureWrap wrap) {
  switch (wrap) {
    case TextureWrap::repeat:
      return t - std::floor(t);
    case TextureWrap::mirror:
      t = std::abs(t - 2 * std::floor(t / 2 + 0.5f));
      return t;
    case TextureWrap::clamp:
      break;
  }
  return std::clamp(t, 0.0f, 1.0f);
}

/// Two neighbouring pixels of a row, and how far from the first to the second.
struct Neighbours {
  int a = 0, b = 0;
  float fraction = 0;
};

Neighbours neighbours_of(float t, int pixels, TextureWrap wrap) {
  const float place = wrapped(t, wrap) * float(pixels) - 0.5f;
  const float below = std::floor(place);
  const int a = static_cast<int>(below);
  // At the edges of a mirrored picture it meets itself, as a clamped one does.
  const auto held = [&](int i) {
    if (wrap == TextureWrap::repeat) return (i + pixels) % pixels;
    return std::clamp(i, 0, pixels - 1);
  };
  return {held(a), held(a + 1), place - below};
}

Rgb bilinear(const Image& image, const Vector2<float>& uv, TextureWrap wrap) {
  const Neighbours x = neighbours_of(uv.x(), image.width, wrap);
  const Neighbours y = neighbours_of(uv.y(), image.height, wrap);
  // Rows are counted from the top.
  const int low = image.height - 1 - y.a, high = image.height - 1 - y.b;
  const Rgb lower = (1 - x.fraction) * image.at(x.a, low) + x.fraction * image.at(x.b, low);
  const Rgb upper = (1 - x.fraction) * image.at(x.a, high) + x.fraction * image.at(x.b, high);
  return (1 - y.fraction) * lower + y.fraction * upper;
}

}  // namespace

Texture make_texture(Image picture, TextureWrap wrap) {
  Texture texture;
  texture.wrap = wrap;
  texture.levels.push_back(std::move(picture));
  while (texture.levels.back().width > 1 || texture.levels.back().height > 1)
    texture.levels.push_back(halved(texture.levels.back()));
  return texture;
}

Rgb eval_texture(const Texture& texture, const Vector2<float>& uv, float width) noexcept {
  const Image& finest = texture.levels.front();
  // A bilinear lookup among pixels, which are means themselves, has three times the variance of a
  // pixel, t^2 / 4: that of the square for pixels of width / sqrt(3).
  const float pixels = width * std::sqrt(float(finest.width) * float(finest.height) * (1 / 3.0f));
  const float last = float(texture.levels.size() - 1);
  const float level = pixels > 1 ? std::min(std::log2(pixels), last) : 0.0f;
  const size_t fine = static_cast<size_t>(level);
  const float fraction = level - float(fine);
  const Rgb value = bilinear(texture.levels[fine], uv, texture.wrap);
  if (fraction == 0) return value;
  return (1 - fraction) * value + fraction * bilinear(texture.levels[fine + 1], uv, texture.wrap);
}

}  // namespace burnish
