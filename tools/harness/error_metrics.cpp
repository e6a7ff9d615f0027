#include "harness/error_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace burnish {
namespace {

/// Sums from which a RelativeL2 follows.
struct Sums {
  double difference2 = 0;          // |a - b|^2
  double reference2 = 0;           // |b|^2
  double noise2 = 0;               // sum of variances
  double difference_variance = 0;  // of difference2
  size_t count = 0;

  void add(const Rgb& approximation, const Rgb& reference, const Rgb& variance) {
    const Eigen::Array3d b = reference.cast<double>(), v = variance.cast<double>();
    const Eigen::Array3d d = approximation.cast<double>() - b;
    difference2 += d.square().sum();
    reference2 += b.square().sum();
    noise2 += v.sum();
    // d^2 of b + noise varies by 4 d^2 var + 2 var^2 (normal noise). The squared measured d holds
    // one var too much on average; it stays, as an upper bound. One random path lights all
    // channels, so their deviations add up before they are squared.
    const double linear = 2 * (d.abs() * v.sqrt()).sum();
    const double squares = std::sqrt(2.0) * v.sum();
    difference_variance += linear * linear + squares * squares;
    ++count;
  }

  RelativeL2 result() const {
    RelativeL2 r;
    r.count = count;
    if (!(reference2 > 0)) {
      r.value = r.without_noise = difference2 > 0 ? std::numeric_limits<double>::infinity() : 0;
      return r;
    }
    r.value = std::sqrt(difference2 / reference2);
    r.truth_noise = std::sqrt(noise2 / reference2);
    r.without_noise = std::sqrt(std::max(difference2 - noise2, 0.0) / reference2);
    if (difference2 > 0)  // d sqrt(x) = dx / (2 sqrt(x))
      r.standard_error = std::sqrt(difference_variance / difference2 / reference2) / 2;
    return r;
  }
};

}  // namespace

RelativeL2 relative_l2(std::span<const Rgb> approximation, std::span<const Rgb> reference,
                       std::span<const Rgb> variance) {
  Sums sums;
  for (size_t i = 0; i < reference.size(); ++i)
    sums.add(approximation[i], reference[i], variance.empty() ? Rgb(Rgb::Zero()) : variance[i]);
  return sums.result();
}

RelativeL2 relative_l2(const Picture& approximation, const Picture& reference) {
  Sums sums;
  const std::vector<Rgb>& variance = reference.variance.pixels;
  for (size_t i = 0; i < reference.hit.size(); ++i) {
    if (!approximation.hit[i] || !reference.hit[i]) continue;
    sums.add(approximation.radiance.pixels[i], reference.radiance.pixels[i],
             variance.empty() ? Rgb(Rgb::Zero()) : variance[i]);
  }
  return sums.result();
}

Image side_by_side(std::span<const Image> pictures, int gap, const Rgb& fill) {
  int width = 0, height = 0;
  for (const Image& picture : pictures) {
    width += picture.width + (width > 0 ? gap : 0);
    height = std::max(height, picture.height);
  }
  Image result(width, height, fill);
  int left = 0;
  for (const Image& picture : pictures) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) result.at(left + x, y) = picture.at(x, y);
    left += picture.width + gap;
  }
  return result;
}

Image difference_picture(const Image& a, const Image& b, float gain) {
  Image result(a.width, a.height);
  for (size_t i = 0; i < result.pixels.size(); ++i)
    result.pixels[i] =
        Rgb::Constant(gain * std::abs(luminance(a.pixels[i]) - luminance(b.pixels[i])));
  return result;
}

}  // namespace burnish
