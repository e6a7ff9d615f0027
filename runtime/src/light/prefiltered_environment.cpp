#include "burnish/light/prefiltered_environment.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/octahedral_map.h"

// A lobe's mean radiance is a 2-D Gaussian average over the unit disc of the orthographic plane,
// because (v . z) dv = dx dy. Both steps below are sums over taps in that plane.
namespace burnish {
namespace {

struct OctahedralImage {
  int resolution = 0;
  std::vector<Rgb> texels;
};

double texel_angle(int resolution) { return std::sqrt(4 * kPi<double>) / resolution; }

Rgb bilinear(const std::vector<Rgb>& texels, int resolution, const Vector3f& direction) {
  const auto footprint = octahedral_footprint(direction_to_octahedral(direction), resolution);
  Rgb sum = Rgb::Zero();
  for (int i = 0; i < 4; ++i) sum += footprint.weight[i] * texels[footprint.texel[i]];
  return sum;
}

/// The lat-long map, area-averaged onto an octahedral map fine enough to hold all of it.
OctahedralImage octahedral_from_latlong(const Image& environment) {
  constexpr int kSubsamples = 4;
  constexpr int kMaxResolution = 2048;
  OctahedralImage image;
  image.resolution = 16;
  while (image.resolution < kMaxResolution &&
         texel_angle(image.resolution) > kPi<double> / environment.height)
    image.resolution *= 2;
  const int n = image.resolution;
  image.texels.resize(static_cast<size_t>(n) * n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      Rgb sum = Rgb::Zero();
      for (int s = 0; s < kSubsamples * kSubsamples; ++s) {
        const double u = (x + (s % kSubsamples + 0.5) / kSubsamples) / n;
        const double v = (y + (s / kSubsamples + 0.5) / kSubsamples) / n;
        sum += eval_environment(environment, octahedral_to_direction(u, v));
      }
      image.texels[static_cast<size_t>(y) * n + x] = sum / float(kSubsamples * kSubsamples);
    }
  }
  return image;
}

OctahedralImage half_resolution(const OctahedralImage& fine) {
  OctahedralImage coarse{fine.resolution / 2, {}};
  coarse.texels.reserve(fine.texels.size() / 4);
  for (int y = 0; y < coarse.resolution; ++y) {
    for (int x = 0; x < coarse.resolution; ++x) {
      const Rgb* row = fine.texels.data() + static_cast<size_t>(2 * y) * fine.resolution + 2 * x;
      coarse.texels.push_back((row[0] + row[1] + row[fine.resolution] + row[fine.resolution + 1]) /
                              4);
    }
  }
  return coarse;
}

struct Tap {
  float x, y, z, weight;
};

/// Taps of a Gaussian of this variance on a square grid of the orthographic disc; weights sum to
/// one.
std::vector<Tap> disc_taps(double variance, double spacing) {
  const int radius = static_cast<int>(std::ceil(std::min(3 * std::sqrt(variance), 1.0) / spacing));
  std::vector<Tap> taps;
  double sum = 0;
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      const double x = i * spacing, y = j * spacing, r2 = x * x + y * y;
      if (r2 >= 1 || r2 > 9 * variance) continue;
      const double weight = std::exp(-r2 / (2 * variance));
      taps.push_back({float(x), float(y), float(std::sqrt(1 - r2)), float(weight)});
      sum += weight;
    }
  }
  for (Tap& tap : taps) tap.weight /= float(sum);
  return taps;
}

PrefilteredEnvironment::Level filter_level(const std::vector<OctahedralImage>& pyramid,
                                           double bandwidth) {
  const double variance = 1 / (2 * bandwidth);
  const double sigma = std::sqrt(variance);
  // The finest source whose texels the taps still cover without gaps; wide lobes also have to
  // resolve the disc's edge.
  const double target = std::min(0.7 * sigma, 0.1);
  size_t source = 0;
  while (source + 1 < pyramid.size() && texel_angle(pyramid[source + 1].resolution) <= target)
    ++source;
  const double spacing = texel_angle(pyramid[source].resolution);

  PrefilteredEnvironment::Level level;
  level.bandwidth = static_cast<float>(bandwidth);
  level.resolution = std::max(64, 2 * static_cast<int>(std::ceil(2.9 * std::sqrt(bandwidth))));
  // Source texels (box and tent: spacing^2 / 4) and this level's own bilinear lookup (texel^2 / 6)
  // already blur by so much; at most half of the lobe's variance is taken off for them.
  const double output = texel_angle(level.resolution);
  const double own = spacing * spacing / 4 + output * output / 6;
  const std::vector<Tap> taps = disc_taps(std::max(variance - own, variance / 2), spacing);

  const int n = level.resolution;
  level.radiance.resize(static_cast<size_t>(n) * n);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const Frame<float> frame = frame_from_axis(octahedral_texel_direction<float>(x, y, n));
      Rgb sum = Rgb::Zero();
      for (const Tap& tap : taps)
        sum += tap.weight * bilinear(pyramid[source].texels, pyramid[source].resolution,
                                     frame.to_world({tap.x, tap.y, tap.z}));
      level.radiance[static_cast<size_t>(y) * n + x] = sum;
    }
  }
  return level;
}

/// Mean radiance under an isotropic lobe: linear in the logarithm of the bandwidth between two
/// levels.
Rgb eval_isotropic(const PrefilteredEnvironment& environment, const Vector3f& direction,
                   float bandwidth) {
  const auto& levels = environment.levels;
  const auto upper = std::upper_bound(levels.begin(), levels.end(), bandwidth,
                                      [](float value, const PrefilteredEnvironment::Level& level) {
                                        return value < level.bandwidth;
                                      });
  const auto& wide = upper == levels.begin() ? levels.front() : *(upper - 1);
  const Rgb wide_radiance = bilinear(wide.radiance, wide.resolution, direction);
  if (upper == levels.begin() || upper == levels.end()) return wide_radiance;
  const float fraction =
      std::log2(bandwidth / wide.bandwidth) / std::log2(upper->bandwidth / wide.bandwidth);
  return wide_radiance +
         fraction * (bilinear(upper->radiance, upper->resolution, direction) - wide_radiance);
}

}  // namespace

PrefilteredEnvironment prefilter_environment(const Image& environment) {
  std::vector<OctahedralImage> pyramid{octahedral_from_latlong(environment)};
  while (pyramid.back().resolution > 32) pyramid.push_back(half_resolution(pyramid.back()));

  PrefilteredEnvironment result;
  // The map itself is the last level: what its texels blur is a lobe of this bandwidth. Filtered
  // levels stop well before, where they stop paying for their time.
  constexpr double kLastFiltered = 8192;
  OctahedralImage& finest = pyramid.front();
  const double texel = texel_angle(finest.resolution);
  const double own_bandwidth = 1 / (2 * texel * texel * (1.0 / 12 + 1.0 / 6));
  for (double bandwidth = 0.25; bandwidth <= std::min(own_bandwidth / 4, kLastFiltered);
       bandwidth *= 2)
    result.levels.push_back(filter_level(pyramid, bandwidth));
  result.levels.push_back(
      {static_cast<float>(own_bandwidth), finest.resolution, std::move(finest.texels)});
  return result;
}

Rgb eval_prefiltered(const PrefilteredEnvironment& environment,
                     const AnisotropicGaussian<float>& lobe, int max_taps) {
  const bool x_is_long = lobe.bandwidth_x < lobe.bandwidth_y;
  const float narrow = std::max(x_is_long ? lobe.bandwidth_y : lobe.bandwidth_x, 1e-3f);
  const float wide = std::max(x_is_long ? lobe.bandwidth_x : lobe.bandwidth_y, 1e-3f);
  const Frame<float> frame = {environment.environment_from_world * lobe.frame.x,
                              environment.environment_from_world * lobe.frame.y,
                              environment.environment_from_world * lobe.frame.z};
  const Vector3f& axis = x_is_long ? frame.x : frame.y;

  // The lobe is a round one of the narrow bandwidth, spread along the long axis by a Gaussian of
  // the variance that is missing. Round lobes 1.75 deviations apart still add up smoothly (ripple
  // 0.3 %).
  const float deviation = std::sqrt(0.5f / narrow);
  const float spread = std::sqrt(std::max(0.5f / wide - 0.5f / narrow, 0.0f));
  if (spread < 0.25f * deviation)
    return eval_isotropic(environment, frame.z, std::sqrt(narrow * wide));
  const float reach = std::min(2.75f * spread, 0.999f);
  const int wanted = 1 + 2 * static_cast<int>(std::ceil(reach / (1.75f * deviation)));
  const int taps = std::clamp(wanted, 1, std::max(max_taps, 1));
  if (taps < 3) return eval_isotropic(environment, frame.z, std::sqrt(narrow * wide));
  const float spacing = 2 * reach / static_cast<float>(taps - 1);
  // With fewer taps than wanted the round lobes are widened until they meet.
  const float tap_deviation = std::max(deviation, spacing / 1.75f);
  const float tap_bandwidth = 0.5f / (tap_deviation * tap_deviation);

  Rgb sum = Rgb::Zero();
  float weight_sum = 0;
  for (int i = 0; i < taps; ++i) {
    const float y = -reach + spacing * static_cast<float>(i);
    const float z = std::sqrt(1 - y * y);
    // The Gaussian along the axis, and the share of its slab that lies inside the disc.
    const float weight =
        std::exp(-0.5f * (y / spread) * (y / spread)) * std::erf(std::sqrt(narrow) * z);
    sum += weight * eval_isotropic(environment, y * axis + z * frame.z, tap_bandwidth);
    weight_sum += weight;
  }
  return sum / weight_sum;
}

}  // namespace burnish
