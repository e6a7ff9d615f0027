#include "harness/material_picture.h"

#include <algorithm>
#include <cmath>

#include "harness/error_metrics.h"
#include "harness/sample_sequence.h"

namespace burnish {
namespace {

constexpr float kDifferenceGain = 10;

/// Lobes for a view, in the local frame.
class Slice {
 public:
  Slice(const Material& material, const SpecularOptions& options)
      : prepared_(prepare_material(material, options)) {}

  void look_from(const Vector3f& outgoing) { count_ = specular_slice(prepared_, outgoing, lobes_); }

  Rgb eval(const Vector3f& incoming) const {
    Rgb sum = Rgb::Zero();
    for (int i = 0; i < count_; ++i)
      sum += lobes_[size_t(i)].weight * burnish::eval(lobes_[size_t(i)].lobe, incoming);
    return sum;
  }

 private:
  PreparedMaterial prepared_;
  std::array<SliceLobe, kMaxSpecularTeeth> lobes_;
  int count_ = 0;
};

Vector3f view_direction(float view_deg) {
  const float polar = view_deg * (kPi<float> / 180);
  const float azimuth = kLobeViewAzimuthDeg * (kPi<float> / 180);
  return {std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
          std::cos(polar)};
}

Rgb exact_value(const Material& material, const Vector3f& outgoing, const Vector3f& incoming) {
  return eval_specular_brdf(material, outgoing, incoming) * std::max(incoming.z(), 0.0f);
}

Vector3f sample_hemisphere(const Uniform2& u) {
  const double sine = std::sqrt(u.u * (2 - u.u)), azimuth = 2 * kPi<double> * u.v;
  return Vector3d(sine * std::cos(azimuth), sine * std::sin(azimuth), 1 - u.u).cast<float>();
}

SliceError slice_error(const Material& material, const Slice& slice, const Vector3f& outgoing) {
  constexpr std::uint32_t kPoints = 1 << 14;  // of each of two ways to spread them
  const SampleSequence points(1);
  double difference = 0, norm = 0, exact_sum = 0, lobes_sum = 0;
  const auto add = [&](const Vector3f& incoming) {
    if (incoming.z() <= 0) return;
    const double density = pdf_specular_brdf(material, outgoing, incoming) + 0.5 / kPi<double>;
    const Rgb exact = exact_value(material, outgoing, incoming), lobes = slice.eval(incoming);
    difference += double((lobes - exact).square().sum()) / density;
    norm += double(exact.square().sum()) / density;
    exact_sum += luminance(exact) / density;
    lobes_sum += luminance(lobes) / density;
  };
  for (std::uint32_t i = 0; i < kPoints; ++i) {
    const Uniform2 u = points(i, 0);
    add(sample_specular_brdf(material, outgoing, static_cast<float>(u.u),
                             std::min(static_cast<float>(u.v), 0x1.fffffep-1f)));
    add(sample_hemisphere(points(i, 1)));
  }
  SliceError error;
  error.albedo = exact_sum / kPoints;
  error.lobes_albedo = lobes_sum / kPoints;
  error.relative_l2 = norm == 0 && difference == 0 ? 0 : std::sqrt(difference / norm);
  return error;
}

/// Of a function of the incoming direction.
template <class Value>
Image draw_panel(const Value& value) {
  Image panel(kLobePanel, kLobePanel, Rgb::Constant(0.2f));
  for (int y = 0; y < kLobePanel; ++y)
    for (int x = 0; x < kLobePanel; ++x) {
      const float right = (2 * float(x) + 1) / kLobePanel - 1;
      const float up = 1 - (2 * float(y) + 1) / kLobePanel;
      const float height2 = 1 - right * right - up * up;
      if (height2 > 0) panel.at(x, y) = value(Vector3f(right, up, std::sqrt(height2)));
    }
  return panel;
}

Image draw_row(const Material& material, const Slice& slice, const Vector3f& outgoing) {
  const auto exact = [&](const Vector3f& incoming) {
    return exact_value(material, outgoing, incoming);
  };
  // The grey around the disc is no value.
  float most = 0;
  draw_panel([&](const Vector3f& incoming) {
    const Rgb value = exact(incoming);
    most = std::max(most, value.maxCoeff());
    return value;
  });
  const float scale = most > 0 ? 1 / most : 0;
  const std::array panels = {
      draw_panel([&](const Vector3f& incoming) { return Rgb(scale * exact(incoming)); }),
      draw_panel([&](const Vector3f& incoming) { return Rgb(scale * slice.eval(incoming)); }),
      draw_panel([&](const Vector3f& incoming) {
        return Rgb(kDifferenceGain * scale * (slice.eval(incoming) - exact(incoming)).abs());
      })};
  return side_by_side(panels, kLobePanelGap);
}

}  // namespace

std::vector<SliceError> slice_errors(const Material& material, const SpecularOptions& options) {
  Slice slice(material, options);
  std::vector<SliceError> errors;
  for (const float view_deg : kLobeViewsDeg) {
    const Vector3f outgoing = view_direction(view_deg);
    slice.look_from(outgoing);
    errors.push_back(slice_error(material, slice, outgoing));
    errors.back().view_deg = view_deg;
  }
  return errors;
}

Image draw_material_lobes(const Material& material, const SpecularOptions& options) {
  Slice slice(material, options);
  const int step = kLobePanel + kLobePanelGap;
  Image picture(3 * step + kLobePanelGap,
                static_cast<int>(kLobeViewsDeg.size()) * step + kLobePanelGap, Rgb::Ones());
  int top = kLobePanelGap;
  for (const float view_deg : kLobeViewsDeg) {
    const Vector3f outgoing = view_direction(view_deg);
    slice.look_from(outgoing);
    const Image row = draw_row(material, slice, outgoing);
    for (int y = 0; y < row.height; ++y)
      for (int x = 0; x < row.width; ++x) picture.at(kLobePanelGap + x, top + y) = row.at(x, y);
    top += step;
  }
  return picture;
}

}  // namespace burnish
