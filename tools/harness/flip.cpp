// Based on: andersson2020flip, sections 4.1 (colour), 4.2 (features) and 4.3 (both). The filters
// are separable and are applied so, as in the authors' later releases; arithmetic is double.
#include "harness/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/texture_file.h"

namespace burnish {
namespace {

using Plane = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Color = Eigen::Array3d;
/// Three planes of a picture: Y, Cx, Cz, or linear RGB.
using Planes = std::array<Plane, 3>;
using Kernel = std::vector<double>;  // of an odd length, its middle at the pixel

constexpr double kColorExponent = 0.7, kFeatureExponent = 0.5;
constexpr double kKnee = 0.4, kKneeValue = 0.95;  // p_c, p_t
constexpr double kFeatureWidth_deg = 0.082;       // w, two standard deviations

Eigen::Matrix3d xyz_from_rgb() {
  Eigen::Matrix3d m;
  m << 10135552 / 24577794.0, 8788810 / 24577794.0, 4435075 / 24577794.0,  //
      2613072 / 12288897.0, 8788810 / 12288897.0, 887015 / 12288897.0,     //
      1425312 / 73733382.0, 8788810 / 73733382.0, 70074185 / 73733382.0;
  return m;
}

/// Linear RGB to XYZ of which white is 1, 1, 1.
const Eigen::Matrix3d& relative_xyz_from_rgb() {
  static const Eigen::Matrix3d m = [] {
    const Eigen::Matrix3d xyz = xyz_from_rgb();
    const Vector3d white = xyz.rowwise().sum();
    return Eigen::Matrix3d(white.cwiseInverse().asDiagonal() * xyz);
  }();
  return m;
}

Color opponent(const Color& xyz) {
  return {116 * xyz.y() - 16, 500 * (xyz.x() - xyz.y()), 200 * (xyz.y() - xyz.z())};
}

Color ycxcz_from_rgb(const Color& rgb) {
  return opponent((relative_xyz_from_rgb() * rgb.matrix()).array());
}

Color rgb_from_ycxcz(const Color& color) {
  static const Eigen::Matrix3d inverse = relative_xyz_from_rgb().inverse();
  const double y = (color.x() + 16) / 116;
  return (inverse * Vector3d(y + color.y() / 500, y, y - color.z() / 200)).array();
}

/// L*a*b* whose chroma grows with lightness, as the Hunt effect has it.
Color hunt_lab_from_rgb(const Color& rgb) {
  constexpr double kDelta = 6.0 / 29;
  const Color xyz = (relative_xyz_from_rgb() * rgb.matrix()).array();
  Color lab = opponent(xyz.unaryExpr([](double t) {
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
  }));
  lab.y() *= 0.01 * lab.x();
  lab.z() *= 0.01 * lab.x();
  return lab;
}

double hyab(const Color& a, const Color& b) {
  const Color d = a - b;
  return std::abs(d.x()) + std::hypot(d.y(), d.z());
}

/// The colour difference, 0..1: compressed, and most of the range given to what is not extreme.
double color_error(const Color& rgb_a, const Color& rgb_b) {
  static const double largest =
      std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), kColorExponent);
  const double knee = kKnee * largest;
  const double e =
      std::pow(hyab(hunt_lab_from_rgb(rgb_a), hunt_lab_from_rgb(rgb_b)), kColorExponent);
  if (e < knee) return e / knee * kKneeValue;
  return kKneeValue + (e - knee) / (largest - knee) * (1 - kKneeValue);
}

/// Correlates rows with `across` and columns with `down`; the border's pixels go on outside.
Plane filtered(const Plane& plane, const Kernel& across, const Kernel& down) {
  const Eigen::Index width = plane.cols(), height = plane.rows();
  Plane wide(height, width), result(height, width);
  const auto each_row = [&](const auto& work) {
    tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, height, 16), [&](const auto& range) {
      for (Eigen::Index y = range.begin(); y < range.end(); ++y) work(y);
    });
  };
  each_row([&](Eigen::Index y) {
    const auto radius = static_cast<Eigen::Index>(across.size() / 2);
    Eigen::Array<double, 1, Eigen::Dynamic> padded(width + 2 * radius);
    padded.segment(radius, width) = plane.row(y);
    padded.head(radius).setConstant(plane(y, 0));
    padded.tail(radius).setConstant(plane(y, width - 1));
    wide.row(y).setZero();
    for (size_t k = 0; k < across.size(); ++k)
      wide.row(y) += across[k] * padded.segment(static_cast<Eigen::Index>(k), width);
  });
  each_row([&](Eigen::Index y) {
    const auto radius = static_cast<Eigen::Index>(down.size() / 2);
    result.row(y).setZero();
    for (size_t k = 0; k < down.size(); ++k)
      result.row(y) += down[k] * wide.row(std::clamp<Eigen::Index>(
                                     y + static_cast<Eigen::Index>(k) - radius, 0, height - 1));
  });
  return result;
}

template <class F>
Kernel sampled(int radius, const F& f) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(f(double(i)));
  return kernel;
}

double sum(const Kernel& kernel) {
  double total = 0;
  for (const double weight : kernel) total += weight;
  return total;
}

/// A contrast sensitivity as a sum of Gaussians a sqrt(pi / b) exp(-pi^2 d^2 / b) of the distance d
/// in degrees, normalised over the square of its pixels.
struct Sensitivity {
  double a, b;
};
Plane filtered(const Plane& plane, std::span<const Sensitivity> terms, double pixels_per_degree) {
  constexpr double kLargestB = 0.04;  // of all channels, which share a radius
  const int radius =
      static_cast<int>(std::ceil(3 * std::sqrt(kLargestB / 2) / kPi<double> * pixels_per_degree));
  Plane result = Plane::Zero(plane.rows(), plane.cols());
  double total = 0;
  for (const auto& [a, b] : terms) {
    const double scale = kPi<double> * kPi<double> / (b * pixels_per_degree * pixels_per_degree);
    const Kernel kernel = sampled(radius, [&](double x) { return std::exp(-scale * x * x); });
    const double weight = a * std::sqrt(kPi<double> / b);
    result += weight * filtered(plane, kernel, kernel);
    total += weight * sum(kernel) * sum(kernel);
  }
  return result / total;
}

/// What the eye resolves, in linear RGB, held to 0..1.
Planes seen(const Planes& ycxcz, double pixels_per_degree) {
  constexpr std::array<Sensitivity, 1> kAchromatic = {{{1, 0.0047}}}, kRedGreen = {{{1, 0.0053}}};
  constexpr std::array<Sensitivity, 2> kBlueYellow = {{{34.1, 0.04}, {13.5, 0.025}}};
  Planes planes = {filtered(ycxcz[0], kAchromatic, pixels_per_degree),
                   filtered(ycxcz[1], kRedGreen, pixels_per_degree),
                   filtered(ycxcz[2], kBlueYellow, pixels_per_degree)};
  for (Eigen::Index i = 0; i < planes[0].size(); ++i) {
    const Color rgb =
        rgb_from_ycxcz({planes[0].data()[i], planes[1].data()[i], planes[2].data()[i]});
    for (int c = 0; c < 3; ++c)
      planes[static_cast<size_t>(c)].data()[i] = std::clamp(rgb[c], 0.0, 1.0);
  }
  return planes;
}

/// Positive weights sum to 1 and negative ones to -1.
void normalise_signs(Kernel& kernel) {
  double positive = 0, negative = 0;
  for (const double weight : kernel) (weight > 0 ? positive : negative) += weight;
  for (double& weight : kernel) weight /= weight > 0 ? positive : -negative;
}

/// Strengths of edges and points of the achromatic plane.
struct Features {
  Plane edges, points;
};
Features features(const Plane& y, double pixels_per_degree) {
  const double deviation = 0.5 * kFeatureWidth_deg * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3 * deviation));
  const double scale = 1 / (deviation * deviation);
  Kernel smooth = sampled(radius, [&](double x) { return std::exp(-scale * x * x / 2); });
  Kernel edge = sampled(radius, [&](double x) { return -x * std::exp(-scale * x * x / 2); });
  Kernel point =
      sampled(radius, [&](double x) { return (scale * x * x - 1) * std::exp(-scale * x * x / 2); });
  const double total = sum(smooth);
  for (double& weight : smooth) weight /= total;
  normalise_signs(edge);
  normalise_signs(point);
  const Plane luminance = (y + 16) / 116;
  const auto strength = [&](const Kernel& kernel) -> Plane {
    return (filtered(luminance, kernel, smooth).square() +
            filtered(luminance, smooth, kernel).square())
        .sqrt();
  };
  return {strength(edge), strength(point)};
}

struct Prepared {
  Planes rgb;  ///< as seen
  Features features;
};
Prepared prepare(const Image& picture, double pixels_per_degree) {
  Planes planes;
  planes.fill(Plane(picture.height, picture.width));
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    const Rgb linear = picture.pixels[i].unaryExpr(&linear_from_srgb);
    const Color color = ycxcz_from_rgb(linear.cast<double>());
    for (int c = 0; c < 3; ++c) planes[static_cast<size_t>(c)].data()[i] = color[c];
  }
  return {seen(planes, pixels_per_degree), features(planes[0], pixels_per_degree)};
}

Color color_at(const Planes& planes, Eigen::Index i) {
  return {planes[0].data()[i], planes[1].data()[i], planes[2].data()[i]};
}

}  // namespace

Image flip_map(const Image& test, const Image& reference, double pixels_per_degree) {
  const Prepared a = prepare(test, pixels_per_degree), b = prepare(reference, pixels_per_degree);
  const Plane feature = ((a.features.edges - b.features.edges)
                             .abs()
                             .max((a.features.points - b.features.points).abs()) /
                         std::sqrt(2.0))
                            .pow(kFeatureExponent);
  Image map(reference.width, reference.height);
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double color = color_error(color_at(a.rgb, at), color_at(b.rgb, at));
    map.pixels[i] = Rgb::Constant(static_cast<float>(std::pow(color, 1 - feature.data()[at])));
  }
  return map;
}

double flip_mean(const Image& map) {
  double total = 0;
  for (const Rgb& pixel : map.pixels) total += double(pixel.x());
  return total / double(map.pixels.size());
}

}  // namespace burnish
