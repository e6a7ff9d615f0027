#pragma once

#include <string>

#include "burnish/light/light_rig.h"

/// Lights that a point sees as one bright region of its directions: a lobe for each light and
/// point. Derivations and errors: docs/maths.md, "Local lights".
namespace burnish {

/// A light as a point of a surface sees it.
struct LightAtPoint {
  /// Some of the light is above the point's horizon. If not, nothing else is set.
  bool reaches = false;
  AnisotropicGaussian<float> lobe;  ///< unit amplitude, about the mean direction of the light
  float integral = 0;               ///< of the lobe
  Rgb color = Rgb::Zero();     ///< color * integral is the light's radiance times its solid angle
  float cosine_integral = 0;   ///< color * cosine_integral is the unshadowed irradiance
  Rgb radiance = Rgb::Zero();  ///< of the light itself
};

/// A light for a point with a unit normal. The irradiance is exact (to 2e-6 of what the same light
/// would give overhead), whatever the horizon cuts off; the lobe stands for the whole light.
/// Finite, and continuous in the position but where it crosses a rectangle.
/// - Sphere: the spherical Gaussian of its energy and mean cosine (wang2009svbrdf). Seen from its
///   surface it is a hemisphere; from there it grows, within kSphereShell radii, to all directions,
///   so that geometry that pierces a light has no seam.
/// - Directional: the same, of a fixed size.
/// - Rectangle: exact energy and mean direction; bandwidths by the exact second moments. A point in
///   its plane, or behind it if it is one-sided, does not see it.
/// @{
LightAtPoint light_at(const SphereLight& light, const Vector3f& position,
                      const Vector3f& normal) noexcept;
LightAtPoint light_at(const DirectionalLight& light, const Vector3f& position,
                      const Vector3f& normal) noexcept;
LightAtPoint light_at(const RectangleLight& light, const Vector3f& position,
                      const Vector3f& normal) noexcept;
/// @}

/// Depth below a sphere's surface, in radii, from which on it is seen in all directions.
inline constexpr float kSphereShell = 1.0f / 64;

/// A fiftieth of the sun's, and as narrow as a material's narrowest lobe: smaller discs look alike.
inline constexpr float kMinAngularRadius = 1e-4f;

/// The radius that shading gives a directional light.
inline float shaded_angular_radius(const DirectionalLight& light) {
  return light.angular_radius_rad > kMinAngularRadius ? light.angular_radius_rad
                                                      : kMinAngularRadius;
}

/// Moments of the directions v in which a point sees a rectangle; all 0 if it does not see it.
struct RectangleMoments {
  double solid_angle = 0;            ///< sr, 0..2 pi
  Vector3d mean = Vector3d::Zero();  ///< integral of v: the vector irradiance
  /// Integral of u u^T, u the part of v orthogonal to `mean`.
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
};

/// Exact to 1e-9 of what it would be if the rectangle faced the point (`spread` to 1e-5), from any
/// distance and of any size. Based on: arvo1995moments.
RectangleMoments rectangle_moments(const RectangleLight& light, const Vector3f& position) noexcept;

/// Largest radiance of a light, W sr^-1 m^-2: its products with solid angles and reflectances, and
/// sums of many lights, stay in a float's range.
inline constexpr float kMaxRadiance = 1e30f;

/// What is wrong with a light, as "radius is -1.000000, expected a finite number > 0"; empty when
/// nothing is. None may be brighter than kMaxRadiance; a directional light as it is shaded.
/// @{
std::string domain_error(const EnvironmentLobe& light);
std::string domain_error(const SphereLight& light);
std::string domain_error(const DirectionalLight& light);
std::string domain_error(const RectangleLight& light);
/// @}

}  // namespace burnish
