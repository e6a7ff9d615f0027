#include "harness/light_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "harness/error_metrics.h"

namespace burnish {
namespace {

Rgb line_color() { return {1.0f, 0.8f, 0.0f}; }

// Mean of the map over each pixel of a panel, by as many points as it has pixels there.
Image environment_panel(const Image& environment, float scale) {
  const int across = environment.width / kPanelWidth + 1;
  const int down = environment.height / kPanelHeight + 1;
  Image panel(kPanelWidth, kPanelHeight);
  const auto nearest = [](int i, int count, int pixels) {
    return static_cast<int>((2 * std::int64_t{i} + 1) * pixels / (2 * std::int64_t{count}));
  };
  for (int y = 0; y < kPanelHeight; ++y)
    for (int x = 0; x < kPanelWidth; ++x) {
      Eigen::Array3d sum = Eigen::Array3d::Zero();
      for (int j = 0; j < down; ++j)
        for (int i = 0; i < across; ++i)
          sum += environment
                     .at(nearest(x * across + i, kPanelWidth * across, environment.width),
                         nearest(y * down + j, kPanelHeight * down, environment.height))
                     .cast<double>();
      panel.at(x, y) = (sum * (double(scale) / (across * down))).cast<float>();
    }
  return panel;
}

Vector3d panel_direction(int x, int y) {
  return direction_from_latlong((x + 0.5) / kPanelWidth, (y + 0.5) / kPanelHeight);
}

Image lobes_panel(const LightRig& rig, float scale) {
  Image panel(kPanelWidth, kPanelHeight);
  for (int y = 0; y < kPanelHeight; ++y)
    for (int x = 0; x < kPanelWidth; ++x)
      panel.at(x, y) = scale * eval_lobes(rig, panel_direction(x, y).cast<float>());
  return panel;
}

// A square pen of `size` pixels; columns wrap around.
void draw_point(Image& panel, const Vector2<double>& at, int size, const Rgb& color) {
  const int left = static_cast<int>(std::floor(at.x() - 0.5 * (size - 1)));
  const int top = static_cast<int>(std::floor(at.y() - 0.5 * (size - 1)));
  for (int y = std::max(top, 0); y < std::min(top + size, panel.height); ++y)
    for (int x = left; x < left + size; ++x) panel.at((x + panel.width) % panel.width, y) = color;
}

Vector2<double> panel_position(const Vector3d& direction) {
  const Vector2<double> uv = latlong_from_direction(direction);
  return {uv.x() * kPanelWidth, uv.y() * kPanelHeight};
}

// How far apart two places are, the short way around.
double panel_distance(const Vector2<double>& a, const Vector2<double>& b) {
  const double across = std::abs(a.x() - b.x());
  return std::max(std::min(across, kPanelWidth - across), std::abs(a.y() - b.y()));
}

// Points of a contour between two angles, closer than a pixel. Through a pole itself, where the map
// is torn, no division brings them closer.
void append_contour(const AnisotropicGaussian<float>& lobe, double begin, double end, int divisions,
                    std::vector<Vector2<double>>& points) {
  const Vector2<double> first = panel_position(lobe_contour(lobe, begin));
  const Vector2<double> last = panel_position(lobe_contour(lobe, end));
  points.push_back(first);
  if (divisions == 0 || panel_distance(first, last) < 0.7) return;
  const double middle = (begin + end) / 2;
  points.pop_back();
  append_contour(lobe, begin, middle, divisions - 1, points);
  append_contour(lobe, middle, end, divisions - 1, points);
}

std::vector<Vector2<double>> lobe_points(const AnisotropicGaussian<float>& lobe) {
  std::vector<Vector2<double>> points;
  constexpr int kParts = 64, kDivisions = 10;
  for (int i = 0; i < kParts; ++i)
    append_contour(lobe, 2 * kPi<double> * i / kParts, 2 * kPi<double> * (i + 1) / kParts,
                   kDivisions, points);
  const Vector2<double> axis = panel_position(lobe.frame.z.cast<double>());
  for (int i = -2; i <= 2; ++i) {
    points.push_back(axis + Vector2<double>(i, 0));
    points.push_back(axis + Vector2<double>(0, i));
  }
  return points;
}

void draw_lobes(const LightRig& rig, Image& panel) {
  std::vector<Vector2<double>> points;
  for (const EnvironmentLobe& light : rig.lobes) {
    const auto own = lobe_points(light.lobe);
    points.insert(points.end(), own.begin(), own.end());
  }
  // A dark rim first: the lines show on any ground.
  for (const Vector2<double>& point : points) draw_point(panel, point, 3, Rgb::Zero());
  for (const Vector2<double>& point : points) draw_point(panel, point, 1, line_color());
}

}  // namespace

float picture_exposure_stops(const Image& environment) {
  double mean = 0, weights = 0;
  for (int y = 0; y < environment.height; ++y) {
    const double weight = latlong_pixel_solid_angle(environment, y);
    for (int x = 0; x < environment.width; ++x) {
      mean += weight * luminance(environment.at(x, y));
      weights += weight;
    }
  }
  mean /= weights;
  if (!(mean > 0)) return 0;
  double log_sum = 0, log_weights = 0;
  for (int y = 0; y < environment.height; ++y) {
    const double weight = latlong_pixel_solid_angle(environment, y);
    for (int x = 0; x < environment.width; ++x) {
      const double value = luminance(environment.at(x, y));
      if (value < 1e-6 * mean) continue;
      log_sum += weight * std::log2(value);
      log_weights += weight;
    }
  }
  return static_cast<float>(std::log2(0.18) - log_sum / log_weights);
}

Vector3d lobe_contour(const AnisotropicGaussian<float>& lobe, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const double bandwidth = lobe.bandwidth_x * c * c + lobe.bandwidth_y * s * s;
  const double from_axis = support_angle(bandwidth, std::exp(-0.5));
  const Frame<double> frame = lobe.frame.cast<double>();
  return std::cos(from_axis) * frame.z + std::sin(from_axis) * (c * frame.x + s * frame.y);
}

Image draw_light_fit(const Image& environment, const LightRig& rig, float exposure_stops) {
  const float scale = std::exp2(exposure_stops);
  std::vector<Image> panels = {environment_panel(environment, scale), lobes_panel(rig, scale),
                               Image(kPanelWidth, kPanelHeight)};
  for (size_t i = 0; i < panels[2].pixels.size(); ++i)
    panels[2].pixels[i] = (panels[1].pixels[i] - panels[0].pixels[i]).abs();
  draw_lobes(rig, panels[1]);
  return side_by_side(panels, kPanelGap);
}

}  // namespace burnish
