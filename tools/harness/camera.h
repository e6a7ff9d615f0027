#pragma once

#include <string>
#include <string_view>

#include "burnish/sphere/direction.h"

namespace burnish {

/// A pinhole camera in world units.
struct Camera {
  Vector3f origin = Vector3f(0, 0, 1);
  Vector3f target = Vector3f::Zero();  ///< the middle of the picture; differs from origin
  Vector3f up = Vector3f::UnitY();     ///< unit; another is taken when it is along the view
  float vertical_fov_deg = 40;         ///< from the bottom to the top edge, above 0, below 180
};

/// A camera in the form of the command line: "ox,oy,oz,tx,ty,tz,fov", with `up` as given. Throws
/// std::invalid_argument, whose text says what was found and what is accepted.
Camera parse_camera(std::string_view text, const Vector3f& up = Vector3f::UnitY());

/// The inverse of parse_camera: parsing it gives the same floats.
std::string format_camera(const Camera& camera);

/// A camera that frames a box from the front, a little to the right and above: all of the box is
/// inside the picture and touches its margin. `aspect` is width / height, above 0. A box that is a
/// single point is framed as if it had size 1.
Camera frame_bounds(const Vector3f& lower, const Vector3f& upper, float aspect,
                    const Vector3f& up = Vector3f::UnitY());

/// The eye turned about an axis through the target, along the unit vector `up`.
Camera turned(const Camera& camera, const Vector3f& up, double angle_rad);

/// The rays of a camera through a picture plane of width x height pixels. Continuous pixel
/// coordinates: (0, 0) is the top left corner, (width, height) the bottom right.
struct PrimaryRays {
  Vector3f origin;
  Vector3d top_left;     ///< from the origin to the corner, at unit distance along the view
  Vector3d pixel_right;  ///< one pixel to the right
  Vector3d pixel_down;   ///< one pixel down

  /// Unit direction through a point of the picture plane.
  Vector3f direction(double x, double y) const {
    return (top_left + x * pixel_right + y * pixel_down).normalized().cast<float>();
  }
};

PrimaryRays primary_rays(const Camera& camera, int width, int height);

}  // namespace burnish
