#include "visibility/harmonic_grid.h"

#include "burnish/sphere/octahedral_map.h"

namespace burnish {

const HarmonicGrid& harmonic_grid() {
  static const HarmonicGrid grid = [] {
    HarmonicGrid result;
    result.harmonics.resize(kLadderDirections * kGridHarmonics);
    for (size_t i = 0; i < kLadderDirections; ++i) {
      const auto direction =
          octahedral_texel_direction<float>(static_cast<int>(i % kGridResolution),
                                            static_cast<int>(i / kGridResolution), kGridResolution);
      result.x.push_back(direction.x());
      result.y.push_back(direction.y());
      result.z.push_back(direction.z());
      eval_harmonics(kMaxLadderBands, direction,
                     std::span(result.harmonics).subspan(i * kGridHarmonics, kGridHarmonics));
    }
    return result;
  }();
  return grid;
}

}  // namespace burnish
