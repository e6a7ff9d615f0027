#include "measured/spectrum_rgb.h"

#include <cmath>

namespace burnish::detail {
namespace {

/// A Gaussian of two widths, as factors of the offset in nm.
double lobe(double wavelength, double center, double left, double right) {
  const double t = (wavelength - center) * (wavelength < center ? left : right);
  return std::exp(-0.5 * t * t);
}

Eigen::Array3d matching_rgb(double nm) {
  const double x = 1.056 * lobe(nm, 599.8, 1 / 37.9, 1 / 31.0) +
                   0.362 * lobe(nm, 442.0, 1 / 16.0, 1 / 26.7) -
                   0.065 * lobe(nm, 501.1, 1 / 20.4, 1 / 26.2);
  const double y =
      0.821 * lobe(nm, 568.8, 1 / 46.9, 1 / 40.5) + 0.286 * lobe(nm, 530.9, 1 / 16.3, 1 / 31.1);
  const double z =
      1.217 * lobe(nm, 437.0, 1 / 11.8, 1 / 36.0) + 0.681 * lobe(nm, 459.0, 1 / 26.0, 1 / 13.8);
  return {3.2404542 * x - 1.5371385 * y - 0.4985314 * z,
          -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
          0.0556434 * x - 0.2040259 * y + 1.0572252 * z};
}

}  // namespace

std::vector<Rgb> rgb_weights(const std::vector<float>& wavelengths_nm) {
  constexpr double kFirst = 360, kLast = 830;
  std::vector<Eigen::Array3d> weights(wavelengths_nm.size(), Eigen::Array3d::Zero());
  Eigen::Array3d white = Eigen::Array3d::Zero();
  std::size_t node = 0;
  for (double nm = kFirst + 0.5; nm < kLast && wavelengths_nm.size() >= 2; nm += 1) {
    if (nm < wavelengths_nm.front() || nm > wavelengths_nm.back()) continue;
    while (node + 2 < wavelengths_nm.size() && wavelengths_nm[node + 1] < nm) ++node;
    const double low = wavelengths_nm[node], high = wavelengths_nm[node + 1];
    const double upper = (nm - low) / (high - low);
    const Eigen::Array3d response = matching_rgb(nm);
    weights[node] += (1 - upper) * response;
    weights[node + 1] += upper * response;
    white += response;
  }
  std::vector<Rgb> result(weights.size(), Rgb::Zero());
  if ((white > 0).all())
    for (std::size_t i = 0; i < weights.size(); ++i) result[i] = (weights[i] / white).cast<float>();
  return result;
}

}  // namespace burnish::detail
