#include "bench/slice_light_error.h"

#include <array>
#include <cmath>

#include "bench/specular_truth.h"

namespace burnish::tools {
namespace {

constexpr std::array kAzimuths_deg = {3.0, 25.0, 47.0, 66.0, 88.0};

/// Smooth lights all around above the surface, and a little below.
std::vector<SphericalGaussian<double>> smooth_lights() {
  std::vector<SphericalGaussian<double>> lights;
  constexpr int kLights = 24;
  constexpr double kGoldenAngle = 2.399963229728653;
  for (int k = 0; k < kLights; ++k) {
    const double z = 1 - (k + 0.5) / kLights * 1.6, sine = std::sqrt(1 - z * z);
    const double azimuth = k * kGoldenAngle;
    lights.push_back(
        {{sine * std::cos(azimuth), sine * std::sin(azimuth), z}, k % 2 == 0 ? 12.0 : 2.0, 1.0});
  }
  return lights;
}

Vector3f view_direction(double polar_deg, double azimuth_deg) {
  const double polar = polar_deg * kPi<double> / 180, azimuth = azimuth_deg * kPi<double> / 180;
  return Vector3<double>(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                         std::cos(polar))
      .cast<float>();
}

}  // namespace

std::vector<SliceLightError> slice_light_errors(const Material& material, double view_deg,
                                                std::span<const SpecularOptions> forms) {
  const auto lights = smooth_lights();
  std::vector<SliceLightError> errors(forms.size());
  std::vector<double> squares(forms.size(), 0.0);
  double truth_squares = 0;
  std::vector<PreparedMaterial> prepared;
  for (const SpecularOptions& form : forms) prepared.push_back(prepare_material(material, form));
  for (const double azimuth_deg : kAzimuths_deg) {
    const Vector3f outgoing = view_direction(view_deg, azimuth_deg);
    const Reflected truth = integrate_brdf(material, outgoing, lights);
    for (const double value : truth.by_light) truth_squares += value * value;
    for (size_t f = 0; f < forms.size(); ++f) {
      std::array<SliceLobe, kMaxSpecularTeeth> slice;
      const int count = specular_slice(prepared[f], outgoing, slice);
      const Reflected found = integrate_slice(std::span(slice).first(static_cast<size_t>(count)),
                                              forms[f].form, lights);
      for (size_t l = 0; l < lights.size(); ++l) {
        const double error = found.by_light[l] - truth.by_light[l];
        squares[f] += error * error;
      }
      const double energy = found.energy / truth.energy - 1;
      if (std::abs(energy) > std::abs(errors[f].energy)) errors[f].energy = energy;
    }
  }
  for (size_t f = 0; f < forms.size(); ++f)
    errors[f].relative_rms = std::sqrt(squares[f] / truth_squares);
  return errors;
}

}  // namespace burnish::tools
