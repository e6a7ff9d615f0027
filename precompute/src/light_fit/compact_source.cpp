#include "light_fit/compact_source.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Eigenvalues>

#include "burnish/sphere/asg_integral.h"

namespace burnish {
namespace {

// A source ends where it falls below this share of its peak: the first that leaves it compact.
// Bloom around a sun should go with it.
constexpr double kEdges[] = {0.001, 0.005, 0.02, 0.1, 0.3};
// A source this small is a point to a diffuse surface; the sun's radius is 0.0047.
constexpr double kMaxRadiusRad = 0.035;
// Left in the map, the misfit of a source's outline (tens of per cent of its norm) is larger than
// all else when its own norm is.
constexpr double kMinShareOfSquare = 0.8;

struct Region {
  std::vector<int> pixels;  // indices
  std::vector<int> border;  // pixels that touch it
};

Vector3d pixel_direction(const Image& environment, int index) {
  return direction_from_latlong((index % environment.width + 0.5) / environment.width,
                                (index / environment.width + 0.5) / environment.height);
}

// The pixels connected to the brightest that are brighter than a share of it. Empty if one of them
// is farther from it than `reach_rad`.
Region grow_region(const Image& environment, int brightest, double share, double reach_rad) {
  const float threshold = static_cast<float>(share) * luminance(environment.pixels[brightest]);
  const Vector3d center = pixel_direction(environment, brightest);
  std::vector<char> seen(environment.pixels.size(), 0);
  Region region;
  region.pixels.push_back(brightest);
  seen[brightest] = 1;
  for (size_t next = 0; next < region.pixels.size(); ++next) {
    const int x = region.pixels[next] % environment.width;
    const int y = region.pixels[next] / environment.width;
    for (int dy = -1; dy <= 1; ++dy) {
      if (y + dy < 0 || y + dy >= environment.height) continue;
      for (int dx = -1; dx <= 1; ++dx) {
        const int wrapped = (x + dx + environment.width) % environment.width;
        const int index = (y + dy) * environment.width + wrapped;
        if (seen[index]) continue;
        seen[index] = 1;
        if (luminance(environment.pixels[index]) < threshold) {
          region.border.push_back(index);
        } else if (angle_between(center, pixel_direction(environment, index)) > reach_rad) {
          return {};
        } else {
          region.pixels.push_back(index);
        }
      }
    }
  }
  return region;
}

// Energy, centre and second moments of (radiance - background) over a region, as a lobe.
EnvironmentLobe lobe_of_region(const Image& environment, const Region& region,
                               const Eigen::Array3d& background, double max_bandwidth) {
  Eigen::Array3d energy = Eigen::Array3d::Zero();
  Vector3d centroid = Vector3d::Zero();
  const auto excess = [&](int index) -> Eigen::Array3d {
    return (environment.pixels[index].cast<double>() - background).max(0.0) *
           latlong_pixel_solid_angle(environment, index / environment.width);
  };
  for (const int index : region.pixels) {
    energy += excess(index);
    centroid += excess(index).sum() * pixel_direction(environment, index);
  }
  const Frame<double> around = frame_from_axis<double>(centroid.normalized());
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
  for (const int index : region.pixels) {
    const Vector3d local = around.to_local(pixel_direction(environment, index));
    const double own = latlong_pixel_solid_angle(environment, index / environment.width) / 12;
    moment += excess(index).sum() *
              (local.head<2>() * local.head<2>().transpose() + own * Eigen::Matrix2d::Identity());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(moment / energy.sum());
  const Vector3d x = around.x * eigen.eigenvectors()(0, 0) + around.y * eigen.eigenvectors()(1, 0);
  const auto bandwidth = [&](double variance) { return std::min(0.5 / variance, max_bandwidth); };
  AnisotropicGaussian<double> lobe;
  lobe.frame = {x, around.z.cross(x), around.z};
  lobe.bandwidth_x = bandwidth(eigen.eigenvalues()[0]);
  lobe.bandwidth_y = bandwidth(eigen.eigenvalues()[1]);
  EnvironmentLobe result;
  result.lobe.frame = lobe.frame.cast<float>();
  result.lobe.bandwidth_x = static_cast<float>(lobe.bandwidth_x);
  result.lobe.bandwidth_y = static_cast<float>(lobe.bandwidth_y);
  result.color = (energy / integral(lobe)).cast<float>();
  return result;
}

}  // namespace

std::optional<EnvironmentLobe> take_compact_source(Image& environment, double max_bandwidth) {
  int brightest = 0;
  double square = 0;
  for (int y = 0, index = 0; y < environment.height; ++y) {
    const double solid_angle = latlong_pixel_solid_angle(environment, y);
    for (int x = 0; x < environment.width; ++x, ++index) {
      const Rgb& pixel = environment.pixels[index];
      square += solid_angle * pixel.cast<double>().square().sum();
      if (luminance(pixel) > luminance(environment.pixels[brightest])) brightest = index;
    }
  }
  // On a coarse map a pixel and its neighbours may be all there is of a source.
  const double pixel_rad = kPi<double> / environment.height;
  if (pixel_rad > 2 * kMaxRadiusRad) return std::nullopt;
  Region region;
  for (const double share : kEdges) {
    region = grow_region(environment, brightest, share, std::max(kMaxRadiusRad, 1.5 * pixel_rad));
    if (!region.pixels.empty()) break;
  }
  if (region.pixels.empty() || region.border.empty()) return std::nullopt;

  Eigen::Array3d background = Eigen::Array3d::Zero();
  for (const int index : region.border) background += environment.pixels[index].cast<double>();
  background /= double(region.border.size());
  double excess_square = 0;
  for (const int index : region.pixels)
    excess_square += latlong_pixel_solid_angle(environment, index / environment.width) *
                     (environment.pixels[index].cast<double>() - background).square().sum();
  if (excess_square < kMinShareOfSquare * square) return std::nullopt;

  const EnvironmentLobe lobe = lobe_of_region(environment, region, background, max_bandwidth);
  for (const int index : region.pixels)
    environment.pixels[index] = environment.pixels[index].min(background.cast<float>());
  return lobe;
}

}  // namespace burnish
