#include "burnish/material/fitted_specular.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "burnish/sphere/lobe_domain.h"

namespace burnish {
namespace {

/// Of a table over angles that divide 0..pi/2 evenly.
template <class T>
T interpolate(const std::vector<T>& table, float cosine) {
  const float angle = std::acos(std::clamp(cosine, 0.0f, 1.0f));
  const size_t last = table.size() - 1;
  const float place = std::min(angle * (2 / kPi<float>), 1.0f) * float(last);
  const size_t cell = std::min(static_cast<size_t>(place), last - 1);
  const float fraction = place - float(cell);
  return table[cell] * (1 - fraction) + table[cell + 1] * fraction;
}

std::string size_error(const char* name, size_t size) {
  if (size >= 2 && size <= kMaxFittedTable) return {};
  return std::string(name) + " has " + std::to_string(size) + " entries, expected 2 to " +
         std::to_string(kMaxFittedTable);
}

std::string entry_error(const char* name, size_t index, float value) {
  const std::string entry = std::string(name) + "[" + std::to_string(index) + "]";
  return internal::scalar_error(entry.c_str(), value, false);
}

std::string lobe_error(const AnisotropicGaussian<float>& lobe) {
  std::string error = domain_error(lobe);
  for (const auto& [name, value] :
       {std::pair{"bandwidth_x", lobe.bandwidth_x}, {"bandwidth_y", lobe.bandwidth_y}})
    if (error.empty() && value == 0) error = std::string(name) + " is 0, expected > 0";
  return error.empty() ? internal::scalar_error("amplitude", lobe.amplitude, false) : error;
}

/// Of entries that are each in range.
std::string bound_error(const FittedSpecular& fitted) {
  double distribution = 0, color = 0, masking = 0;
  for (const auto& lobe : fitted.lobes) distribution += double(lobe.amplitude);
  for (const Rgb& entry : fitted.color_by_difference)
    color = std::max(color, double(entry.maxCoeff()));
  for (const float entry : fitted.masking) masking = std::max(masking, double(entry));
  const double bound = distribution * color * masking * masking;
  if (bound <= double(kMaxFittedValue)) return {};
  std::ostringstream text;
  text << "the sum of amplitudes times the largest entries of color_by_difference and of masking, "
          "squared, is "
       << bound << ", expected at most " << kMaxFittedValue;
  return text.str();
}

}  // namespace

float eval_distribution(const FittedSpecular& fitted, const Vector3f& half) {
  if (half.z() <= 0) return 0;
  float sum = 0;
  for (const AnisotropicGaussian<float>& lobe : fitted.lobes) sum += eval(lobe, half);
  return sum;
}

Rgb eval_smooth_factor(const FittedSpecular& fitted, float cos_outgoing, float cos_incoming,
                       float cos_difference) {
  return interpolate(fitted.color_by_difference, cos_difference) *
         (interpolate(fitted.masking, cos_outgoing) * interpolate(fitted.masking, cos_incoming));
}

std::string domain_error(const FittedSpecular& fitted) {
  const size_t count = fitted.lobes.size();
  if (count < 1 || count > kMaxFittedLobes)
    return "lobes has " + std::to_string(count) + " entries, expected 1 to " +
           std::to_string(kMaxFittedLobes);
  for (size_t i = 0; i < count; ++i) {
    const std::string error = lobe_error(fitted.lobes[i]);
    if (!error.empty()) return "lobes[" + std::to_string(i) + "]: " + error;
  }
  std::string error =
      internal::first_error({size_error("color_by_difference", fitted.color_by_difference.size()),
                             size_error("masking", fitted.masking.size())});
  for (size_t i = 0; error.empty() && i < fitted.masking.size(); ++i)
    error = entry_error("masking", i, fitted.masking[i]);
  for (size_t i = 0; error.empty() && i < fitted.color_by_difference.size(); ++i)
    for (const float channel : fitted.color_by_difference[i])
      if (error.empty()) error = entry_error("color_by_difference", i, channel);
  return error.empty() ? bound_error(fitted) : error;
}

}  // namespace burnish
