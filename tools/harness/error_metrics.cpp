#include "harness/error_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "harness/flip.h"
#include "harness/tone_map.h"

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

/// Calls f(pixel) for the pixels that the mesh fills in both pictures.
template <class F>
void for_each_common_pixel(const Picture& a, const Picture& b, const F& f) {
  for (size_t i = 0; i < b.hit.size(); ++i)
    if (a.hit[i] && b.hit[i]) f(i);
}

Rgb variance_of(std::span<const Rgb> variance, size_t i) {
  return variance.empty() ? Rgb(Rgb::Zero()) : variance[i];
}

/// From which AbsoluteErrors follow.
struct AbsoluteSums {
  std::vector<double> errors;
  double reference = 0, noise = 0;

  void add(const Rgb& approximation, const Rgb& truth, const Rgb& variance) {
    const Eigen::Array3d b = truth.cast<double>();
    errors.push_back((approximation.cast<double>() - b).abs().mean());
    reference += b.mean();
    noise += variance.cast<double>().sqrt().mean();
  }

  /// Sorts `errors` in part.
  double percentile(size_t per_mille) {
    const size_t rank = std::max<size_t>((errors.size() * per_mille + 999) / 1000, 1);
    const auto place = errors.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(errors.begin(), place, errors.end());
    return *place;
  }

  AbsoluteErrors result() {
    AbsoluteErrors r;
    r.count = errors.size();
    if (errors.empty()) return r;
    const double count = double(errors.size());
    r.mean_radiance = reference / count;
    const auto relative = [&](double error) { return error > 0 ? error / r.mean_radiance : 0; };
    for (const double error : errors) r.mean += error / count;
    r.mean = relative(r.mean);
    r.percentile_95 = relative(percentile(950));
    r.percentile_999 = relative(percentile(999));
    r.truth_noise = relative(std::sqrt(2 / kPi<double>) * noise / count);  // the mean of |normal|
    return r;
  }
};

}  // namespace

RelativeL2 relative_l2(std::span<const Rgb> approximation, std::span<const Rgb> reference,
                       std::span<const Rgb> variance) {
  Sums sums;
  for (size_t i = 0; i < reference.size(); ++i)
    sums.add(approximation[i], reference[i], variance_of(variance, i));
  return sums.result();
}

RelativeL2 relative_l2(const Picture& approximation, const Picture& reference) {
  Sums sums;
  for_each_common_pixel(approximation, reference, [&](size_t i) {
    sums.add(approximation.radiance.pixels[i], reference.radiance.pixels[i],
             variance_of(reference.variance.pixels, i));
  });
  return sums.result();
}

AbsoluteErrors absolute_errors(std::span<const Rgb> approximation, std::span<const Rgb> reference,
                               std::span<const Rgb> variance) {
  AbsoluteSums sums;
  for (size_t i = 0; i < reference.size(); ++i)
    sums.add(approximation[i], reference[i], variance_of(variance, i));
  return sums.result();
}

AbsoluteErrors absolute_errors(const Picture& approximation, const Picture& reference) {
  AbsoluteSums sums;
  for_each_common_pixel(approximation, reference, [&](size_t i) {
    sums.add(approximation.radiance.pixels[i], reference.radiance.pixels[i],
             variance_of(reference.variance.pixels, i));
  });
  return sums.result();
}

double display_mse(const Picture& approximation, const Picture& reference) {
  const float exposure = exposure_of(reference);
  const Image a = tone_map(approximation.radiance, exposure);
  const Image b = tone_map(reference.radiance, exposure);
  double squares = 0;
  size_t count = 0;
  for_each_common_pixel(approximation, reference, [&](size_t i) {
    squares += (a.pixels[i] - b.pixels[i]).cast<double>().square().mean();
    ++count;
  });
  return count > 0 ? squares / double(count) : 0;
}

double psnr_db(const Picture& approximation, const Picture& reference) {
  const double mse = display_mse(approximation, reference);
  return mse > 0 ? -10 * std::log10(mse) : std::numeric_limits<double>::infinity();
}

FlipError flip_error(const Picture& approximation, const Picture& reference) {
  const float exposure = exposure_of(reference);
  FlipError error;
  if (reference.hit.empty()) return error;
  error.map =
      flip_map(tone_map(approximation.radiance, exposure), tone_map(reference.radiance, exposure));
  double sum = 0;
  size_t count = 0;
  for_each_common_pixel(approximation, reference, [&](size_t i) {
    sum += double(error.map.pixels[i].x());
    ++count;
  });
  error.mean = count > 0 ? sum / double(count) : 0;
  return error;
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
