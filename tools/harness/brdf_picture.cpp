#include "harness/brdf_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "burnish/sphere/frame.h"
#include "harness/error_metrics.h"

namespace burnish {
namespace {

constexpr std::array<double, kBrdfPanelRows> kViewDegrees = {0, 20, 40, 60, 75};

Vector3d polar(double angle, double azimuth) {
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth),
          std::cos(angle)};
}

Rgb nowhere() { return Rgb::Constant(std::numeric_limits<float>::quiet_NaN()); }

/// f cos over a panel; NaN where there is nothing to show.
template <class Eval>
Image panel(const Vector3d& outgoing, double radius, const Eval& eval) {
  const Vector3d mirror(-outgoing.x(), -outgoing.y(), outgoing.z());
  // x of the panel lies in the plane of incidence, away from the viewer.
  const Frame<double> frame = frame_from_normal_tangent<double>(
      mirror, outgoing.z() < 1 - 1e-9 ? Vector3d(mirror - outgoing) : Vector3d(1, 0, 0));
  Image image(kBrdfPanelSize, kBrdfPanelSize);
  for (int y = 0; y < kBrdfPanelSize; ++y)
    for (int x = 0; x < kBrdfPanelSize; ++x) {
      const double u = (2 * x + 1.0) / kBrdfPanelSize - 1, v = 1 - (2 * y + 1.0) / kBrdfPanelSize;
      const double distance = std::hypot(u, v);
      const Vector3f incoming =
          frame.to_world(polar(radius * distance, std::atan2(v, u))).cast<float>();
      image.at(x, y) = distance > 1 || incoming.z() <= 0
                           ? nowhere()
                           : Rgb(incoming.z() * eval(outgoing.cast<float>(), incoming));
    }
  return image;
}

float quantile(const Image& image, double part) {
  std::vector<float> values;
  for (const Rgb& pixel : image.pixels)
    if (pixel.isFinite().all()) values.push_back(pixel.maxCoeff());
  if (values.empty()) return 1;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(part * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at > 0 ? *at : 1;
}

Image difference(const Image& a, const Image& b) {
  Image result(a.width, a.height);
  for (size_t i = 0; i < a.pixels.size(); ++i) result.pixels[i] = (a.pixels[i] - b.pixels[i]).abs();
  return result;
}

void expose(Image& image, float scale) {
  for (Rgb& pixel : image.pixels)
    pixel = pixel.isFinite().all() ? Rgb((scale * pixel).min(1.0f)) : Rgb::Constant(0.2f);
}

/// Pictures of one width below each other.
Image stacked(const std::vector<Image>& rows, int gap) {
  const int width = rows[0].width, step = rows[0].height + gap;
  Image image(width, step * static_cast<int>(rows.size()) - gap, Rgb::Ones());
  for (size_t k = 0; k < rows.size(); ++k)
    for (int y = 0; y < rows[k].height; ++y)
      for (int x = 0; x < width; ++x)
        image.at(x, static_cast<int>(k) * step + y) = rows[k].at(x, y);
  return image;
}

}  // namespace

double brdf_panel_radius(const Material& material) {
  constexpr int kAzimuths = 16, kSteps = 500;
  constexpr double kLeast = 1e-4, kGreatest = kPi<double> / 2;
  double reach = kLeast, peak = 0;
  for (const double least : {-1.0, 0.01})  // the peak first
    for (int j = 0; j < kAzimuths; ++j)
      for (int k = 0; k <= kSteps; ++k) {
        const double angle = kLeast * std::pow(kGreatest / kLeast, double(k) / kSteps);
        const double value = double(eval_distribution(
            material, polar(angle, 2 * kPi<double> * j / kAzimuths).cast<float>()));
        if (least < 0) peak = std::max(peak, value);
        if (least > 0 && value > least * peak) reach = std::max(reach, angle);
      }
  return std::min(2 * reach, kPi<double> / 2);
}

Image draw_brdf_fit(const MeasuredBrdf& measured, const std::vector<Material>& materials,
                    double view_azimuth_rad) {
  const double radius = materials.empty() ? kPi<double> / 2 : brdf_panel_radius(materials[0]);
  std::vector<Image> rows;
  for (const double degrees : kViewDegrees) {
    const Vector3d outgoing = polar(degrees * kPi<double> / 180, view_azimuth_rad);
    std::vector<Image> panels = {panel(outgoing, radius, measured.eval)};
    for (const Material& material : materials)
      panels.push_back(panel(outgoing, radius, [&](const Vector3f& o, const Vector3f& i) {
        return eval_brdf(material, o, i);
      }));
    if (!materials.empty()) panels.push_back(difference(panels[1], panels[0]));
    const float scale = 1 / quantile(panels[0], 0.995);
    for (Image& image : panels) expose(image, scale);
    rows.push_back(side_by_side(panels, kBrdfPanelGap));
  }
  return stacked(rows, kBrdfPanelGap);
}

}  // namespace burnish
