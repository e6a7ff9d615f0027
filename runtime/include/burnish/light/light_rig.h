#pragma once

#include <cmath>
#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/anisotropic_gaussian.h"

namespace burnish {

/// One lobe of a distant environment: radiance `color` times a unit-amplitude ASG, in the rig's
/// frame.
struct EnvironmentLobe {
  AnisotropicGaussian<float> lobe;
  Rgb color = Rgb::Zero();  ///< radiance at the lobe's axis; >= 0 but for fits with signed colours
};

/// A distant, uniformly bright disc, such as the sun, in the rig's frame.
struct DirectionalLight {
  Vector3f toward = Vector3f::UnitZ();  ///< unit, from the scene toward the light
  float angular_radius_rad = 0.00465f;  ///< 0..pi/2; the default is the sun's. Shading takes at
                                        ///< least kMinAngularRadius (local_lights.h)
  Rgb irradiance = Rgb::Zero();         ///< of a surface that faces the light, W m^-2, >= 0
};

/// A uniformly bright sphere in the world.
struct SphereLight {
  Vector3f center = Vector3f::Zero();
  float radius = 1;            ///< world units, > 0
  Rgb radiance = Rgb::Zero();  ///< emitted, W sr^-1 m^-2, >= 0
};

/// A uniformly bright rectangle in the world. It shines toward edge_x x edge_y.
struct RectangleLight {
  Vector3f center = Vector3f::Zero();
  Vector3f edge_x = Vector3f::UnitX();  ///< from side to side, world units; not 0
  Vector3f edge_y = Vector3f::UnitY();  ///< orthogonal to edge_x; not 0
  Rgb radiance = Rgb::Zero();           ///< emitted, W sr^-1 m^-2, >= 0
  bool two_sided = false;               ///< shines toward both sides
};

/// The lights of a frame. The distant ones (an ASG mixture that stands for the environment, and
/// directional lights) turn together; the local ones have their places in the world.
struct LightRig {
  std::vector<EnvironmentLobe> lobes;
  std::vector<DirectionalLight> directionals;
  std::vector<SphereLight> spheres;
  std::vector<RectangleLight> rectangles;
};

/// Radiance of the environment lobes in a direction of the rig's frame.
inline Rgb eval_lobes(const LightRig& rig, const Vector3f& direction) {
  Rgb sum = Rgb::Zero();
  for (const EnvironmentLobe& light : rig.lobes) sum += light.color * eval(light.lobe, direction);
  return sum;
}

/// What may change from frame to frame without another fit, in place. A blend of two rigs is each
/// scaled by its share, then added. Turn a copy of the first frame's rig: rounding would add up.
/// @{

/// Turns the distant lights: the lobes and the directional lights. Local lights stay.
inline void rotate(LightRig& rig, const Eigen::Matrix3f& rotation) {
  for (EnvironmentLobe& light : rig.lobes) light.lobe = rotate(light.lobe, rotation);
  for (DirectionalLight& light : rig.directionals) light.toward = rotation * light.toward;
}

/// Multiplies what every light sends by a factor >= 0.
inline void scale(LightRig& rig, float factor) {
  for (EnvironmentLobe& light : rig.lobes) light.color *= factor;
  for (DirectionalLight& light : rig.directionals) light.irradiance *= factor;
  for (SphereLight& light : rig.spheres) light.radiance *= factor;
  for (RectangleLight& light : rig.rectangles) light.radiance *= factor;
}

/// Appends the lights of `other`, which may be the rig itself.
inline void add(LightRig& rig, const LightRig& other) {
  const auto append = [](auto& to, const auto& from) {
    const size_t count = from.size();
    to.reserve(to.size() + count);
    for (size_t i = 0; i < count; ++i) to.push_back(from[i]);
  };
  append(rig.lobes, other.lobes);
  append(rig.directionals, other.directionals);
  append(rig.spheres, other.spheres);
  append(rig.rectangles, other.rectangles);
}
/// @}

/// Photometry of the lights above: power in W over all directions, of a Lambertian emitter.
/// @{
inline Rgb radiance_of_sphere(const Rgb& power, float radius) {
  const float root = 2 * kPi<float> * radius;
  return power / root / root;
}
inline Rgb power_of_sphere(const Rgb& radiance, float radius) {
  const float root = 2 * kPi<float> * radius;
  return radiance * root * root;
}
/// Power of both sides together, if it shines toward both.
inline Rgb radiance_of_rectangle(const Rgb& power, float width, float height, bool two_sided) {
  return power / (kPi<float> * (two_sided ? 2.0f : 1.0f)) / width / height;
}
inline Rgb power_of_rectangle(const Rgb& radiance, float width, float height, bool two_sided) {
  return radiance * (kPi<float> * (two_sided ? 2.0f : 1.0f)) * width * height;
}
/// Irradiance of a surface that faces a disc of a radiance: pi sin^2(angular radius) of it.
inline Rgb irradiance_of_disc(const Rgb& radiance, float angular_radius_rad) {
  const float sine = std::sin(angular_radius_rad);
  return radiance * (kPi<float> * sine * sine);
}
/// Its inverse: infinite for a point.
inline Rgb radiance_of_disc(const Rgb& irradiance, float angular_radius_rad) {
  const float sine = std::sin(angular_radius_rad);
  return irradiance / kPi<float> / sine / sine;
}
/// @}

}  // namespace burnish
