#include "harness/environment_sampler.h"

#include <algorithm>
#include <cmath>

namespace burnish {
namespace {

/// Draws from cumulative weights: the index, and where within it, in [0, 1).
struct Choice {
  size_t index;
  double rest;
};

Choice choose(const double* end, size_t count, double uniform) {
  const double target = uniform * end[count - 1];
  // The last index of positive weight, should rounding lead past it.
  const size_t last = static_cast<size_t>(std::lower_bound(end, end + count, end[count - 1]) - end);
  const size_t index =
      std::min(static_cast<size_t>(std::upper_bound(end, end + count, target) - end), last);
  const double begin = index > 0 ? end[index - 1] : 0;
  return {index, std::clamp((target - begin) / (end[index] - begin), 0.0, 1 - 0x1p-53)};
}

}  // namespace

EnvironmentSampler::EnvironmentSampler(const Image& environment) : environment_(environment) {
  pixel_end_.reserve(environment.pixels.size());
  for (int y = 0; y < environment.height; ++y) {
    const double solid_angle = latlong_pixel_solid_angle(environment, y);
    double sum = 0;
    for (int x = 0; x < environment.width; ++x) {
      sum += double(luminance(environment.at(x, y))) * solid_angle;
      pixel_end_.push_back(sum);
    }
    total_ += sum;
    row_end_.push_back(total_);
  }
}

EnvironmentSampler::Sample EnvironmentSampler::sample(const Uniform2& uniform) const {
  const auto width = static_cast<size_t>(environment_.width);
  const Choice row = choose(row_end_.data(), row_end_.size(), uniform.u);
  const Choice column = choose(pixel_end_.data() + row.index * width, width, uniform.v);
  const double step = kPi<double> / environment_.height;
  const double top = std::cos(double(row.index) * step);  // sine of the latitude
  const double bottom = std::cos(double(row.index + 1) * step);
  const double height = top + row.rest * (bottom - top);
  const double horizontal = std::sqrt(std::max(1 - height * height, 0.0));
  const double longitude =
      (0.5 - (double(column.index) + column.rest) / double(width)) * 2 * kPi<double>;
  const Rgb& radiance =
      environment_.at(static_cast<int>(column.index), static_cast<int>(row.index));
  return {{horizontal * std::sin(longitude), height, horizontal * std::cos(longitude)},
          radiance,
          pdf_of_radiance(radiance)};
}

double EnvironmentSampler::pdf(const Vector3d& direction) const {
  return pdf_of_radiance(eval_environment(environment_, direction));
}

double EnvironmentSampler::pdf_of_radiance(const Rgb& radiance) const {
  return empty() ? 0 : double(luminance(radiance)) / total_;
}

}  // namespace burnish
