#include "bench/reproduce/figure_drawing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "harness/error_metrics.h"
#include "harness/tone_map.h"

namespace burnish::tools {
namespace {

constexpr int kGap = 4;  ///< pixels between panels

/// Values at a disc's pixels, NaN outside.
std::vector<double> sample_disc(const SphereFunction& f, const Frame<double>& frame) {
  std::vector<double> values(kDiscSize * kDiscSize, std::numeric_limits<double>::quiet_NaN());
  tbb::parallel_for(0, kDiscSize, [&](int row) {
    for (int column = 0; column < kDiscSize; ++column) {
      const double x = (2 * column + 1.0) / kDiscSize - 1, y = 1 - (2 * row + 1.0) / kDiscSize;
      const double height = 1 - x * x - y * y;  // cosine of the polar angle
      if (height <= 0) continue;
      const double stretch = std::sqrt(1 + height);
      values[static_cast<size_t>(row * kDiscSize + column)] =
          f(frame.to_world({x * stretch, y * stretch, height}));
    }
  });
  return values;
}

/// Over the peak; 0 for a black disc.
double scale_of(const std::vector<double>& values) {
  double peak = 0;
  for (const double value : values)
    if (value > peak) peak = value;
  return peak > 0 ? 1 / peak : 0;
}

Image disc_picture(const std::vector<double>& values, double scale) {
  Image linear(kDiscSize, kDiscSize, Rgb(0.2f, 0.2f, 0.25f));
  for (size_t i = 0; i < values.size(); ++i)
    if (!std::isnan(values[i]))
      linear.pixels[i] = Rgb::Constant(static_cast<float>(scale * values[i]));
  return tone_map(linear, 1);
}

/// A plot's pixels along an axis.
double position(double value, const Range& range, int pixels) {
  return std::log(value / range.low) / std::log(range.high / range.low) * pixels;
}

void draw_line(Image& picture, double from_x, double from_y, double to_x, double to_y,
               const Rgb& color) {
  const int steps =
      1 + static_cast<int>(2 * std::max(std::abs(to_x - from_x), std::abs(to_y - from_y)));
  for (int i = 0; i <= steps; ++i) {
    const double t = double(i) / steps;
    const int x = static_cast<int>(std::floor(from_x + t * (to_x - from_x)));
    const int y = static_cast<int>(std::floor(from_y + t * (to_y - from_y)));
    for (int down = 0; down < 2; ++down)  // two pixels thick
      if (x >= 0 && x < picture.width && y + down >= 0 && y + down < picture.height)
        picture.at(x, y + down) = color;
  }
}

}  // namespace

Image draw_disc(const SphereFunction& f, const Frame<double>& frame) {
  const std::vector<double> values = sample_disc(f, frame);
  return disc_picture(values, scale_of(values));
}

Image draw_approximation(std::span<const SphereFunction> operands, const SphereFunction& truth,
                         const SphereFunction& approximation, const Frame<double>& frame) {
  std::vector<Image> panels;
  for (const SphereFunction& operand : operands) panels.push_back(draw_disc(operand, frame));
  const std::vector<double> exact = sample_disc(truth, frame);
  std::vector<double> found = sample_disc(approximation, frame);
  const double scale = scale_of(exact);
  panels.push_back(disc_picture(exact, scale));
  panels.push_back(disc_picture(found, scale));
  for (size_t i = 0; i < found.size(); ++i) found[i] = std::abs(found[i] - exact[i]);
  panels.push_back(disc_picture(found, kDifferenceGain * scale));
  return side_by_side(panels, kGap);
}

Image stacked(std::span<const Image> pictures) {
  int width = 0, height = -kGap;
  for (const Image& picture : pictures) {
    width = std::max(width, picture.width);
    height += picture.height + kGap;
  }
  Image result(width, std::max(height, 0), Rgb::Ones());
  int top = 0;
  for (const Image& picture : pictures) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) result.at(x, top + y) = picture.at(x, y);
    top += picture.height + kGap;
  }
  return result;
}

Image halved(const Image& picture) {
  Image result(picture.width / 2, picture.height / 2);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      result.at(x, y) = 0.25f * (picture.at(2 * x, 2 * y) + picture.at(2 * x + 1, 2 * y) +
                                 picture.at(2 * x, 2 * y + 1) + picture.at(2 * x + 1, 2 * y + 1));
  return result;
}

Image draw_curves(std::span<const Curve> curves, const Range& x, const Range& y) {
  constexpr int kWidth = 360, kHeight = 240;
  constexpr double kTolerance = 1e-9;  // a power of ten at the end of a range is in it
  Image picture(kWidth, kHeight, Rgb::Ones());
  const Rgb grid = Rgb::Constant(0.85f);
  const auto powers = [&](const Range& range, const auto& draw) {
    const double last = std::floor(std::log10(range.high) + kTolerance);
    for (double e = std::ceil(std::log10(range.low) - kTolerance); e <= last; ++e)
      draw(std::pow(10, e));
  };
  powers(x, [&](double value) {
    const double at = std::min(position(value, x, kWidth), kWidth - 1.0);
    draw_line(picture, at, 0, at, kHeight, grid);
  });
  powers(y, [&](double value) {
    const double at = std::min(kHeight - position(value, y, kHeight), kHeight - 2.0);
    draw_line(picture, 0, at, kWidth, at, grid);
  });
  for (const Curve& curve : curves)
    for (size_t i = 1; i < curve.points.size(); ++i) {
      const auto& [from_x, from_y] = curve.points[i - 1];
      const auto& [to_x, to_y] = curve.points[i];
      if (!(std::min(from_y, to_y) > 0)) continue;
      draw_line(picture, position(from_x, x, kWidth), kHeight - position(from_y, y, kHeight),
                position(to_x, x, kWidth), kHeight - position(to_y, y, kHeight), curve.color);
    }
  return picture;
}

}  // namespace burnish::tools
