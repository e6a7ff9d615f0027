#pragma once

#include <cstdint>
#include <vector>

#include "burnish/light/environment_map.h"

namespace burnish {

/// What a camera saw.
struct Picture {
  Image radiance;                 ///< linear, W sr^-1 m^-2 up to the lights' own scale
  std::vector<std::uint8_t> hit;  ///< per pixel: 1 where every sample of it met the mesh, else 0
  Image variance;  ///< of the mean `radiance`, per channel; empty (0 x 0) where radiance is exact
};

/// A distant environment as it stands in the world. Without a map it is black.
struct EnvironmentLight {
  const Image* map = nullptr;  ///< lat-long; finite, >= 0
  Eigen::Matrix3f world_from_environment = Eigen::Matrix3f::Identity();
};

/// Radiance that arrives from a unit direction of the world.
inline Rgb eval_environment_light(const EnvironmentLight& light, const Vector3f& direction) {
  if (!light.map) return Rgb::Zero();
  const Vector3f local = light.world_from_environment.transpose() * direction;
  return eval_environment(*light.map, local.cast<double>());
}

}  // namespace burnish
