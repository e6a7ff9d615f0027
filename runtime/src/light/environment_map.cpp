#include "burnish/light/environment_map.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/solid_angle.h"

namespace burnish {

Vector2<double> latlong_from_direction(const Vector3d& d) {
  const double longitude = std::atan2(d.x(), d.z());
  const double latitude = std::atan2(d.y(), std::hypot(d.x(), d.z()));
  const double below_one = std::nextafter(1.0, 0.0);
  return {std::clamp(0.5 - longitude / (2 * kPi<double>), 0.0, below_one),
          std::clamp(0.5 - latitude / kPi<double>, 0.0, below_one)};
}

Vector3d direction_from_latlong(double u, double v) {
  const double longitude = (0.5 - u) * 2 * kPi<double>;
  const double latitude = (0.5 - v) * kPi<double>;
  const double horizontal = std::cos(latitude);
  return {horizontal * std::sin(longitude), std::sin(latitude), horizontal * std::cos(longitude)};
}

double latlong_pixel_solid_angle(const Image& environment, int row) {
  return latlong_pixel_solid_angle<double>(row, environment.width, environment.height);
}

const Rgb& eval_environment(const Image& environment, const Vector3d& direction) {
  const Vector2<double> uv = latlong_from_direction(direction);
  return environment.at(static_cast<int>(uv.x() * environment.width),
                        static_cast<int>(uv.y() * environment.height));
}

}  // namespace burnish
