#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "burnish/precompute/fit_light.h"

/// Rigs and maps to fit.
namespace burnish::test {

inline constexpr unsigned kSeed = 20130705;

inline Eigen::Quaternionf random_rotation(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return Eigen::Quaternionf(normal(random), normal(random), normal(random), normal(random))
      .normalized();
}

// Lobes of bandwidths 4..100, axes at least 50 degrees apart, so that they are told apart.
inline LightRig random_rig(int count, std::mt19937& random) {
  std::uniform_real_distribution<float> color(0.2f, 2),
      log_bandwidth(std::log(4.0f), std::log(100.0f));
  LightRig rig;
  while (rig.lobes.size() < size_t(count)) {
    const Eigen::Matrix3f axes = random_rotation(random).toRotationMatrix();
    if (std::any_of(rig.lobes.begin(), rig.lobes.end(), [&](const EnvironmentLobe& other) {
          return angle_between<float>(other.lobe.frame.z, axes.col(2)) < 0.9f;
        }))
      continue;
    EnvironmentLobe light;
    light.lobe.frame = {axes.col(0), axes.col(1), axes.col(2)};
    light.lobe.bandwidth_x = std::exp(log_bandwidth(random));
    light.lobe.bandwidth_y = std::exp(log_bandwidth(random));
    light.color = Rgb(color(random), color(random), color(random));
    rig.lobes.push_back(light);
  }
  return rig;
}

// The mean of a rig over each pixel, by 4 x 4 points.
inline Image render(const LightRig& rig, int width, int height) {
  constexpr int kSub = 4;
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Rgb sum = Rgb::Zero();
      for (int j = 0; j < kSub; ++j)
        for (int i = 0; i < kSub; ++i)
          sum += eval_lobes(rig, direction_from_latlong((x + (i + 0.5) / kSub) / width,
                                                        (y + (j + 0.5) / kSub) / height)
                                     .cast<float>());
      image.at(x, y) = sum / (kSub * kSub);
    }
  return image;
}

// Irradiance by the midpoint rule, with nothing from the code under test.
template <class Radiance>
Eigen::Array3d brute_force_irradiance(const Radiance& radiance, const Vector3d& normal, int width,
                                      int height) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int y = 0; y < height; ++y) {
    const double weight = 2 * kPi<double> * kPi<double> / (double(width) * height) *
                          std::sin(kPi<double> * (y + 0.5) / height);
    for (int x = 0; x < width; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / width, (y + 0.5) / height);
      sum += weight * std::max(v.dot(normal), 0.0) * radiance(v);
    }
  }
  return sum;
}

inline Eigen::Array3d energy(const LightRig& rig) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const EnvironmentLobe& light : rig.lobes)
    sum += light.color.cast<double>() * double(light.lobe.amplitude) *
           asg_integral_exact<double>(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
  return sum;
}

inline Eigen::Array3d energy(const Image& image) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      sum += latlong_pixel_solid_angle(image, y) * image.at(x, y).cast<double>();
  return sum;
}

// A room: dim walls that differ, a wide window, a strip light and three lamps.
inline Image room(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vector3d v = direction_from_latlong((x + 0.5) / width, (y + 0.5) / height);
      Rgb& pixel = image.at(x, y);
      pixel = Rgb(0.3f, 0.25f, 0.2f) * float(1 + 0.5 * v.y() + 0.3 * v.x());
      if (v.z() > 0.5 && std::abs(v.x()) < 0.5 && v.y() > -0.1 && v.y() < 0.5) pixel = Rgb(6, 7, 8);
      if (v.y() > 0.7 && std::abs(v.z()) < 0.05) pixel = Rgb(30, 28, 24);
      for (const Vector3d& lamp :
           {Vector3d(-1, 0.4, -0.2), Vector3d(0.8, 0.2, -0.7), Vector3d(-0.3, 0.5, -0.9)})
        if (v.dot(lamp.normalized()) > 0.997) pixel = Rgb(60, 40, 20);
    }
  return image;
}

// For tests of what does not depend on the size of the problem.
inline LightFitOptions quick(int lobes = 5) {
  LightFitOptions options;
  options.lobes = lobes;
  options.cells = 512;
  return options;
}

inline bool same_bytes(const LightRig& a, const LightRig& b) {
  return a.lobes.size() == b.lobes.size() &&
         std::memcmp(a.lobes.data(), b.lobes.data(), a.lobes.size() * sizeof(EnvironmentLobe)) == 0;
}

}  // namespace burnish::test
