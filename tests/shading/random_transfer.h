#pragma once

#include <cmath>
#include <random>

#include "burnish/light/light_rig.h"
#include "burnish/shading/transfer.h"
#include "burnish/sphere/octahedral_map.h"
#include "support/quadrature.h"

/// Scenes without a meaning, which are all of what shading has to read.
namespace burnish::test {

struct TransferSize {
  size_t vertices = 1;
  int terms = 0, bases = 1;
  int ladder_terms = 0, ladders = 0;  ///< ladders: 0, 1 or as many as bases
  float amplitude_rad = 0;
};

/// Values of unit variance times a scale.
inline std::vector<float> random_values(size_t count, float scale, std::mt19937& random) {
  std::normal_distribution<float> normal(0, scale);
  std::vector<float> values(count);
  for (float& value : values) value = normal(random);
  return values;
}

inline Vector3f random_unit(std::mt19937& random) { return random_direction(random).cast<float>(); }

/// Vertices on the unit sphere, of any normals. SSDFs: a horizon that terms move by about .5.
inline Transfer random_transfer(const TransferSize& size, std::mt19937& random) {
  constexpr int kResolution = 16, kBands = 6;
  Transfer transfer;
  for (size_t i = 0; i < size.vertices; ++i) {
    transfer.positions.push_back(random_unit(random));
    transfer.normals.push_back(random_unit(random));
    transfer.tangents.push_back(frame_from_axis(transfer.normals.back()).x);
    transfer.basis_id.push_back(static_cast<std::uint8_t>(random() % unsigned(size.bases)));
  }
  const size_t texels = size_t{kResolution} * kResolution;
  const size_t terms = static_cast<size_t>(size.terms);
  for (int b = 0; b < size.bases; ++b) {
    SsdfBasis basis{kResolution, size.terms, size.amplitude_rad, {}, {}};
    const Vector3f up = random_unit(random);
    for (size_t i = 0; i < texels; ++i) {
      const float sine = up.dot(octahedral_texel_direction<float>(
          static_cast<int>(i) % kResolution, static_cast<int>(i) / kResolution, kResolution));
      const float distance = 0.1f + std::asin(std::min(std::max(sine, -1.0f), 1.0f));
      basis.mean.push_back(size.amplitude_rad > 0 ? std::tanh(distance / size.amplitude_rad)
                                                  : distance);
    }
    basis.eigen =
        random_values(texels * terms, 0.5f / std::sqrt(static_cast<float>(terms)), random);
    transfer.bases.push_back(std::move(basis));
  }
  transfer.coefficients = random_values(size.vertices * terms, 1, random);
  const size_t harmonics = size_t{kBands} * kBands;
  const size_t ladder_terms = static_cast<size_t>(size.ladder_terms);
  for (int b = 0; b < size.ladders; ++b) {
    LadderBasis ladder{kBands, size.ladder_terms, random_values(harmonics, 0.1f, random), {}};
    ladder.mean[0] += 0.7f * std::sqrt(4 * kPi<float>);
    ladder.eigen = random_values(harmonics * ladder_terms,
                                 0.1f / std::sqrt(static_cast<float>(ladder_terms)), random);
    transfer.ladder_bases.push_back(std::move(ladder));
  }
  if (size.ladders > 0) {
    transfer.ladder_crossover = 8;
    transfer.ladder_coefficients = random_values(size.vertices * ladder_terms, 1, random);
  }
  return transfer;
}

/// Wide and narrow lobes, and lights near the unit sphere.
inline LightRig random_rig(std::mt19937& random) {
  LightRig rig;
  for (const float bandwidth : {0.3f, 2.0f, 6.0f, 12.0f, 50.0f, 300.0f, 20.0f}) {
    EnvironmentLobe light;
    light.lobe.frame = random_frame(random_direction(random), random).cast<float>();
    light.lobe.bandwidth_x = bandwidth;
    light.lobe.bandwidth_y = bandwidth * (random() % 2 ? 1.0f : 0.2f);
    light.color = Rgb(1, 0.5f, 0.25f) * (1 + bandwidth / 10);
    rig.lobes.push_back(light);
  }
  rig.directionals.push_back({random_unit(random), 0.05f, Rgb(1, 2, 3)});
  rig.spheres.push_back({2 * random_unit(random), 0.4f, Rgb(3, 2, 1)});
  const Frame<float> frame = frame_from_axis(random_unit(random));
  rig.rectangles.push_back({2 * frame.z, frame.x, frame.y, Rgb(1, 1, 2), true});
  return rig;
}

}  // namespace burnish::test
