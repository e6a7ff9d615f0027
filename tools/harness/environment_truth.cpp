#include "harness/environment_truth.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace burnish {
namespace {

/// Points and weights of an interval: 2 Gauss points in each of `parts` equal parts.
struct Points {
  std::vector<double> place, weight;

  Points(double from, double to, int parts) {
    const double step = (to - from) / parts, offset = step / (2 * std::sqrt(3.0));
    for (int i = 0; i < parts; ++i)
      for (const double side : {-offset, offset}) {
        place.push_back(from + (i + 0.5) * step + side);
        weight.push_back(step / 2);
      }
  }
};

/// Half the longitudes, in radians, within `reach` of a direction on the ring of a colatitude.
double longitude_reach(double colatitude, double ring, double reach) {
  const double sines = std::sin(colatitude) * std::sin(ring);
  const double rest = std::cos(reach) - std::cos(colatitude) * std::cos(ring);
  if (rest >= sines) return 0;
  return rest <= -sines ? kPi<double> : std::acos(rest / sines);
}

}  // namespace

Eigen::Array3d integrate_environment(const Image& environment,
                                     const AnisotropicGaussian<double>& lobe) {
  const int width = environment.width, height = environment.height;
  const double wide = std::min(lobe.bandwidth_x, lobe.bandwidth_y);
  const double narrow = std::max(lobe.bandwidth_x, lobe.bandwidth_y);
  const double fine = std::sqrt(0.5 / std::max(narrow, 1.0)) / 3;
  const double sine_reach = 7 * std::sqrt(0.5 / std::max(wide, 1e-9));  // exp(-24) is left out
  const double reach = sine_reach < 1 ? std::asin(sine_reach) : kPi<double> / 2;
  const Vector3d& axis = lobe.frame.z;
  const double colatitude = std::atan2(std::hypot(axis.x(), axis.z()), axis.y());
  const double column = latlong_from_direction(axis).x() * width;

  Eigen::Array3d sum = Eigen::Array3d::Zero();
  double whole = 0;
  const double step = kPi<double> / height;
  for (int y = 0; y < height; ++y) {
    if (y * step > colatitude + reach || (y + 1) * step < colatitude - reach) continue;
    // Across a row the reach is widest at its nearest or its farthest ring, or in between.
    double half = longitude_reach(colatitude, (y + 0.5) * step, reach + step) / (2 * kPi<double>);
    const int columns = std::min(static_cast<int>(half * width) + 2, width);
    const bool all = 2 * columns + 1 >= width;
    const Points down(y * step, (y + 1) * step, static_cast<int>(std::ceil(step / fine)));
    const double across =
        2 * kPi<double> / width * std::sin(std::clamp(kPi<double> / 2, y * step, (y + 1) * step));
    const int parts = static_cast<int>(std::ceil(across / fine));
    const int first = all ? 0 : static_cast<int>(std::floor(column)) - columns;
    for (int i = first; i < first + (all ? width : 2 * columns + 1); ++i) {
      const int x = ((i % width) + width) % width;
      const Points over(double(x) / width, (x + 1.0) / width, parts);
      double weight = 0;
      for (size_t u = 0; u < over.place.size(); ++u) {
        const double longitude = (0.5 - over.place[u]) * 2 * kPi<double>;
        const double s = std::sin(longitude), c = std::cos(longitude);
        for (size_t v = 0; v < down.place.size(); ++v) {
          const double ring = std::sin(down.place[v]);
          weight += over.weight[u] * down.weight[v] * ring *
                    eval(lobe, Vector3d(ring * s, std::cos(down.place[v]), ring * c));
        }
      }
      sum += weight * environment.at(x, y).cast<double>();
      whole += weight;
    }
  }
  return sum / whole;
}

}  // namespace burnish
