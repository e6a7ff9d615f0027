#include "burnish/light/prefiltered_environment.h"

#include <algorithm>
#include <cmath>

#include "light/cube_faces.h"

// A lobe's mean radiance is a 2-D Gaussian average over the unit disc of the orthographic plane,
// because (v . z) dv = dx dy. All means are formed as a + t (b - a), which is a where b = a.
namespace burnish {
namespace {

using Texel = Eigen::Array4f;

Texel mix(const Texel& a, const Texel& b, float t) { return a + t * (b - a); }

/// Value on the second of three coefficients of a quadratic B-spline, t in [0, 1] along it.
Texel spline(const Texel* c, float t) {
  return mix(mix(c[0], c[1], 0.5f * (1 + t)), mix(c[1], c[2], 0.5f * t), t);
}

Texel eval_level(const PrefilteredEnvironment::Level& level, const CubePoint& point) {
  const int n = level.resolution;
  const float half = 0.5f * static_cast<float>(n);
  const float px = (point.x + 1) * half, py = (point.y + 1) * half;
  const int x = std::clamp(static_cast<int>(px), 0, n - 1);
  const int y = std::clamp(static_cast<int>(py), 0, n - 1);
  const float tx = px - static_cast<float>(x), ty = py - static_cast<float>(y);
  const size_t stride = n + 2;
  const Texel* corner =
      level.coefficients.data() + (point.face * stride + y) * stride + static_cast<size_t>(x);
  const Texel rows[3] = {spline(corner, tx), spline(corner + stride, tx),
                         spline(corner + 2 * stride, tx)};
  return spline(rows, ty);
}

/// Mean square of a sine from the axis in one direction, for a lobe that the unit disc cuts off.
float disc_variance(float bandwidth) {
  if (bandwidth < 1e-2f) return 0.25f - bandwidth / 24;
  if (bandwidth > 16) return 0.5f / bandwidth;
  return (1 - bandwidth / std::expm1(bandwidth)) / (2 * bandwidth);
}

/// Share below x of a bell of three equal boxes, of half width `half`, centred at 0: a Gaussian to
/// within 0.7 %.
float bell_below(float x, float half) {
  const float t = std::clamp(1.5f * x / half, -1.5f, 1.5f), size = std::abs(t);
  const float upper = size < 0.5f ? 0.5f + size * (0.75f - size * size / 3)
                                  : 1 - (1.5f - size) * (1.5f - size) * (1.5f - size) / 6;
  return t < 0 ? 1 - upper : upper;
}

/// The map itself, whose pixels have edges, blurred by a bell of this variance along the meridian
/// and across it: narrow lobes see few pixels.
Texel eval_pixels(const Image& map, const Vector3f& direction, float variance) {
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

/// Two neighbouring levels and the share of the narrower, which is made of the map's own pixels
/// beyond the last level.
struct Blend {
  const PrefilteredEnvironment::Level* wide;
  const PrefilteredEnvironment::Level* narrow;  ///< null: the map's pixels
  float narrow_variance;
  float share;  ///< of the narrower

  Blend(const PrefilteredEnvironment& environment, float bandwidth) {
    const auto& levels = environment.levels;
    auto above = std::upper_bound(levels.begin() + 1, levels.end(), bandwidth,
                                  [](float value, const PrefilteredEnvironment::Level& level) {
                                    return value < level.bandwidth;
                                  });
    wide = &*(above - 1);
    narrow = above == levels.end() ? nullptr : &*above;
    const float variance = disc_variance(bandwidth);
    narrow_variance = narrow ? narrow->variance : std::min(0.7f * wide->variance, variance);
    // Blurring adds to what is seen in proportion to the variance added, where it adds little.
    share =
        std::clamp((wide->variance - variance) / (wide->variance - narrow_variance), 0.0f, 1.0f);
    // Between two deviations of a factor of 2^(1/4) the narrower adds less than that.
    share -= 0.22f * share * (1 - share);
  }
};

Texel eval_round(const PrefilteredEnvironment& environment, const Blend& blend,
                 const Vector3f& direction) {
  if (!blend.narrow && blend.share >= 1)
    return eval_pixels(environment.map, direction, blend.narrow_variance);
  const CubePoint point = cube_from_direction(direction);
  const Texel wide = eval_level(*blend.wide, point);
  return mix(wide,
             blend.narrow ? eval_level(*blend.narrow, point)
                          : eval_pixels(environment.map, direction, blend.narrow_variance),
             blend.share);
}

/// The bandwidth k for which round lobes of bandwidth `round`, spread by exp(-k sine^2) along an
/// axis, make the lobe (round, wide): that of planes, 1 / k = 1 / wide - 1 / round, and what the
/// disc's edge adds (half of what would keep the variance: the form by that, the half by the
/// error).
float spread_bandwidth(float round, float wide) {
  const float n = std::max(round, 2.0f);
  const float planar = round * wide / (round - wide);
  const float edge = 1.15f * std::pow(wide, 0.7f) * std::exp(-0.04f * wide * wide);
  return std::max(planar + edge * (1 + 4 / n) / n, 1e-3f);
}

Rgb rgb(const Texel& texel) { return texel.head<3>(); }

}  // namespace

Rgb eval_prefiltered(const PrefilteredEnvironment& environment,
                     const AnisotropicGaussian<float>& lobe, int max_taps) noexcept {
  const bool x_is_long = lobe.bandwidth_x < lobe.bandwidth_y;
  const float narrow = std::max(x_is_long ? lobe.bandwidth_y : lobe.bandwidth_x, 1e-3f);
  const float wide = std::max(x_is_long ? lobe.bandwidth_x : lobe.bandwidth_y, 1e-3f);
  const Vector3f axis = environment.environment_from_world * lobe.frame.z;

  // The lobe is a round one, spread along the long axis by a Gaussian of the variance that is
  // missing, over taps of equal angles. Taps 2 d s / sqrt(d^2 + s^2) apart, d and s the deviations
  // of the round lobe and of the spread, add up smoothly.
  constexpr float kReach = 3.3f;
  const float wanted = std::ceil(kReach * std::sqrt(narrow / wide));
  const float taps = std::min(wanted, static_cast<float>(std::max(max_taps, 1)));
  // Fewer taps than wanted are widened, not quite until they meet.
  const float stretch = std::pow(std::max(kReach / taps * std::sqrt(narrow / wide), 1.0f), 0.4f);
  const float round = narrow / (stretch * stretch);
  if (round < 1.05f * wide)
    return rgb(eval_round(environment, {environment, std::sqrt(narrow * wide)}, axis));
  const Blend blend(environment, round + 0.55f * std::exp(-0.6f * wide));
  const float falloff = spread_bandwidth(round, wide);
  const float deviation = std::sqrt(0.5f / falloff);
  const bool cut = kReach * deviation > kPi<float> / 2;  // by the disc, not by the taps
  const float reach = cut ? kPi<float> / 2 : kReach * deviation;
  // What the taps do not reach is 1.1 % of the variance.
  const float slope = cut ? falloff : falloff / 1.0114f;
  const Vector3f along =
      environment.environment_from_world * (x_is_long ? lobe.frame.x : lobe.frame.y);

  const int count = static_cast<int>(taps);
  const float spacing = 2 * reach / taps;
  const bool odd = count % 2 == 1;
  const auto tap = [&](float sine, float cosine) {
    return eval_round(environment, blend, cosine * axis + sine * along);
  };
  Texel reference = Texel::Zero(), sum = Texel::Zero();
  float weight_sum = 0;
  if (odd) {
    reference = tap(0, 1);
    weight_sum = std::erf(std::sqrt(narrow));
  }
  for (int i = 0; i < count / 2; ++i) {
    const float angle = spacing * (static_cast<float>(i) + (odd ? 1.0f : 0.5f));
    const float sine = std::sin(angle), cosine = std::cos(angle);
    // The Gaussian along the axis, and the share of its slab that lies inside the disc.
    const float edge = std::sqrt(narrow) * cosine;
    const float weight =
        std::exp(-slope * sine * sine) * cosine * (edge < 3 ? std::erf(edge) : 1.0f);
    const Texel right = tap(sine, cosine), left = tap(-sine, cosine);
    if (weight_sum == 0) reference = right;
    sum += weight * ((right - reference) + (left - reference));
    weight_sum += 2 * weight;
  }
  return rgb(reference + sum / weight_sum);
}

}  // namespace burnish
