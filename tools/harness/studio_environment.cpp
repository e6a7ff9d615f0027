#include "harness/studio_environment.h"

#include <algorithm>
#include <cmath>

#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

/// A rectangular light panel on the sphere, given by the gnomonic projection about its middle.
struct SoftBox {
  double longitude_deg, latitude_deg;  ///< of its middle; longitude 0 is +z, 90 is +x
  double half_width, half_height;      ///< tangents of the half angles
  double softness;                     ///< width of the falloff at its edge, as a tangent
  Rgb radiance;
};

const SoftBox kSoftBoxes[] = {
    {50, 38, 0.34, 0.26, 0.10, Rgb(10.0f, 7.6f, 5.2f)},   // key, warm
    {-70, 22, 0.50, 0.38, 0.20, Rgb(0.8f, 1.2f, 1.8f)},   // fill, cool
    {-10, 80, 0.55, 0.40, 0.15, Rgb(1.1f, 1.1f, 1.1f)},   // overhead
    {180, 34, 1.40, 0.055, 0.03, Rgb(9.0f, 9.2f, 9.5f)},  // strip behind the object
};

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double coverage(const SoftBox& box, const Vector3d& direction) {
  const Vector3d axis =
      direction_from_latlong(0.5 - box.longitude_deg / 360, 0.5 - box.latitude_deg / 180);
  const double depth = direction.dot(axis);
  if (depth <= 0) return 0;
  const Vector3d right = Vector3d::UnitY().cross(axis).normalized();
  const double x = std::abs(direction.dot(right)) / depth;
  const double y = std::abs(direction.dot(axis.cross(right))) / depth;
  return smooth_step(box.half_width + box.softness, box.half_width - box.softness, x) *
         smooth_step(box.half_height + box.softness, box.half_height - box.softness, y);
}

Rgb studio_radiance(const Vector3d& direction) {
  const Rgb ground(0.022f, 0.020f, 0.018f), horizon(0.09f, 0.09f, 0.10f), top(0.17f, 0.18f, 0.20f);
  const auto height = static_cast<float>(direction.y());
  const float above = static_cast<float>(smooth_step(-0.15, 0.05, direction.y()));
  Rgb radiance = ground + above * (horizon - ground) + std::max(height, 0.0f) * (top - horizon);
  for (const SoftBox& box : kSoftBoxes)
    radiance += static_cast<float>(coverage(box, direction)) * box.radiance;
  return radiance;
}

}  // namespace

Image studio_environment(int width) {
  // Each pixel is the mean of a few points, so that edges do not shift with the resolution.
  constexpr int kSamples = 3;
  Image image(width, width / 2);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Rgb sum = Rgb::Zero();
      for (int j = 0; j < kSamples; ++j)
        for (int i = 0; i < kSamples; ++i)
          sum += studio_radiance(direction_from_latlong((x + (i + 0.5) / kSamples) / image.width,
                                                        (y + (j + 0.5) / kSamples) / image.height));
      image.at(x, y) = sum / float(kSamples * kSamples);
    }
  return image;
}

Eigen::Matrix3f world_from_environment(const Vector3f& up, double degrees) {
  const Eigen::AngleAxisd turn(degrees * kPi<double> / 180, Vector3d::UnitY());
  const Eigen::Quaterniond upright =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(), up.cast<double>());
  return (upright * turn).toRotationMatrix().cast<float>();
}

}  // namespace burnish
