#pragma once

#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/direction.h"

namespace burnish {

/// A picture of linear RGB pixels, row-major from the top left.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Rgb> pixels;  ///< width * height

  Image() = default;
  Image(int w, int h, const Rgb& fill = Rgb::Zero())
      : width(w), height(h), pixels(static_cast<size_t>(w) * h, fill) {}
  Rgb& at(int x, int y) { return pixels[static_cast<size_t>(y) * width + x]; }
  const Rgb& at(int x, int y) const { return pixels[static_cast<size_t>(y) * width + x]; }
};

/// A distant environment: a lat-long picture in OpenEXR's orientation (ImfEnvmap.h, LatLongMap): +y
/// is up, the middle column looks along +z, longitude atan2(x, z) falls from left (pi) to right
/// (-pi). Pixels are areas: column i spans [i, i + 1) / width, and radiance is constant over a
/// pixel, so that fitting, filtering and the reference integrator see exactly the same light.
/// Directions are in the environment's own frame; a caller rotates.
/// @{
Vector2<double> latlong_from_direction(
    const Vector3d& direction);  ///< (u, v) in [0, 1), v from the top
Vector3d direction_from_latlong(double u, double v);
double latlong_pixel_solid_angle(const Image& environment, int row);  ///< sr, exact
const Rgb& eval_environment(const Image& environment, const Vector3d& direction);
/// @}

}  // namespace burnish
