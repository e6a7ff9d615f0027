#include "light/map_pixels.h"

#include <algorithm>
#include <cmath>

namespace burnish {
namespace {

/// Share below x of a bell of three equal boxes, of half width `half`, centred at 0: a Gaussian to
/// within 0.7 %.
float bell_below(float x, float half) {
  const float t = std::clamp(1.5f * x / half, -1.5f, 1.5f), size = std::abs(t);
  const float upper = size < 0.5f ? 0.5f + size * (0.75f - size * size / 3)
                                  : 1 - (1.5f - size) * (1.5f - size) * (1.5f - size) / 6;
  return t < 0 ? 1 - upper : upper;
}

}  // namespace

Eigen::Array4f eval_map_pixels(const Image& map, const Vector3f& direction,
                               float variance) noexcept {
  using Texel = Eigen::Array4f;
  constexpr float kMostPixels = 4;
  const Vector2<double> uv = latlong_from_direction(direction.cast<double>());
  const float x = static_cast<float>(uv.x() * map.width);
  const float y = static_cast<float>(uv.y() * map.height);
  const float half = 3 * std::sqrt(variance);
  const float sine = std::sqrt(direction.x() * direction.x() + direction.z() * direction.z());
  const float half_y = std::min(half * static_cast<float>(map.height) / kPi<float>, kMostPixels);
  const float half_x =
      std::min(half * static_cast<float>(map.width) / (2 * kPi<float> * std::max(sine, 1e-3f)),
               kMostPixels / std::max(sine, 0.05f));
  const int last_x = static_cast<int>(std::floor(x + half_x));
  const int last_y = static_cast<int>(std::floor(y + half_y));
  const Rgb& middle =
      map.at(static_cast<int>(uv.x() * map.width), static_cast<int>(uv.y() * map.height));
  const Texel reference(middle.x(), middle.y(), middle.z(), 0);
  Texel sum = Texel::Zero();
  for (int j = static_cast<int>(std::floor(y - half_y)); j <= last_y; ++j) {
    const float top = static_cast<float>(j) - y;
    const float row_weight = bell_below(top + 1, half_y) - bell_below(top, half_y);
    // Beyond a pole is the other side.
    const bool beyond = j < 0 || j >= map.height;
    const int row = std::clamp(j < 0    ? -1 - j
                               : beyond ? 2 * map.height - 1 - j
                                        : j,
                               0, map.height - 1);
    for (int i = static_cast<int>(std::floor(x - half_x)); i <= last_x; ++i) {
      const float left = static_cast<float>(i) - x;
      const float weight = row_weight * (bell_below(left + 1, half_x) - bell_below(left, half_x));
      const int turned = i + (beyond ? map.width / 2 : 0);
      const Rgb& pixel = map.at((turned % map.width + map.width) % map.width, row);
      sum += weight * (Texel(pixel.x(), pixel.y(), pixel.z(), 0) - reference);
    }
  }
  return reference + sum;
}

}  // namespace burnish
