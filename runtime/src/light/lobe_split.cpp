#include "burnish/light/lobe_split.h"

#include <algorithm>

#include "burnish/sphere/lobe_comb.h"

namespace burnish {
namespace {

float long_bandwidth(const AnisotropicGaussian<float>& lobe) {
  return std::min(lobe.bandwidth_x, lobe.bandwidth_y);
}

/// The comb with the fewest teeth whose middle is narrow enough.
LobeComb<float> comb_of(const AnisotropicGaussian<float>& lobe, float min_bandwidth) {
  LobeComb<float> comb = make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, 2);
  for (int count = 3; count <= kMaxTaps && comb.taps.tap[(count - 1) / 2].bandwidth < min_bandwidth;
       ++count)
    comb = make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, count);
  return comb;
}

void append_parts(const EnvironmentLobe& light, float min_bandwidth, int axes,
                  std::vector<EnvironmentLobe>& parts) {
  if (axes == 0 || long_bandwidth(light.lobe) >= min_bandwidth) {
    parts.push_back(light);
    return;
  }
  const LobeComb<float> comb = comb_of(light.lobe, min_bandwidth);
  for (int k = 0; k < comb.taps.count; ++k) {
    EnvironmentLobe part = light;
    part.lobe = comb_tooth(comb, light.lobe, k);
    append_parts(part, min_bandwidth, axes - 1, parts);
  }
}

}  // namespace

std::vector<EnvironmentLobe> split_wide_lobes(const std::vector<EnvironmentLobe>& lobes,
                                              float min_bandwidth) {
  std::vector<EnvironmentLobe> parts;
  for (const EnvironmentLobe& light : lobes) append_parts(light, min_bandwidth, 2, parts);
  return parts;
}

}  // namespace burnish
