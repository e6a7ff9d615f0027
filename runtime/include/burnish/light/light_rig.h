#pragma once

#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/anisotropic_gaussian.h"

namespace burnish {

/// One lobe of a distant environment: radiance `color` times a unit-amplitude ASG, in the rig's
/// frame.
struct EnvironmentLobe {
  AnisotropicGaussian<float> lobe;
  Rgb color = Rgb::Zero();  ///< radiance at the lobe's axis, >= 0
};

/// A uniformly bright sphere in the world.
struct SphereLight {
  Vector3f center = Vector3f::Zero();
  float radius = 1;            ///< world units, > 0
  Rgb radiance = Rgb::Zero();  ///< emitted, >= 0
};

/// The lights of a frame: an ASG mixture that stands for the distant environment, and local lights.
struct LightRig {
  std::vector<EnvironmentLobe> lobes;
  std::vector<SphereLight> spheres;
};

/// Radiance of the environment lobes in a direction of the rig's frame.
inline Rgb eval_lobes(const LightRig& rig, const Vector3f& direction) {
  Rgb sum = Rgb::Zero();
  for (const EnvironmentLobe& light : rig.lobes) sum += light.color * eval(light.lobe, direction);
  return sum;
}

/// Turns the environment lobes (not the local lights) by a rotation.
inline void rotate_lobes(LightRig& rig, const Eigen::Matrix3f& rotation) {
  for (EnvironmentLobe& light : rig.lobes) light.lobe = rotate(light.lobe, rotation);
}

}  // namespace burnish
