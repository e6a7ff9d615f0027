// Based on: the MERL database and its reader (matusik2003data). Angles of half and difference
// vectors (rusinkiewicz1998coordinates): half angles in 90 steps whose size grows from the normal
// on, difference angles in 90 of one degree, difference azimuths in 180 of one degree, folded by
// reciprocity.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "measured/measured_formats.h"

namespace burnish::detail {
namespace {

constexpr int kHalfAngles = 90, kDifferenceAngles = 90, kDifferenceAzimuths = 180;
constexpr std::size_t kBins = std::size_t{kHalfAngles} * kDifferenceAngles * kDifferenceAzimuths;
constexpr std::size_t kHeaderBytes = 3 * sizeof(std::int32_t);
constexpr std::size_t kFileBytes = kHeaderBytes + 3 * kBins * sizeof(double);
constexpr double kScale[3] = {1 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

int bin(double position, int count) {
  return std::clamp(static_cast<int>(position * count), 0, count - 1);
}

std::size_t merl_bin(const Vector3d& outgoing, const Vector3d& incoming) {
  const Vector3d half = (outgoing + incoming).normalized();
  const double half_sine = std::hypot(half.x(), half.y());
  const double half_angle = std::atan2(half_sine, half.z());
  // Turned so that h is the pole: about z by -azimuth, then about y by -angle.
  const double c = half_sine > 0 ? half.x() / half_sine : 1;
  const double s = half_sine > 0 ? half.y() / half_sine : 0;
  const double x = c * incoming.x() + s * incoming.y(), y = c * incoming.y() - s * incoming.x();
  const Vector3d difference(half.z() * x - half_sine * incoming.z(), y,
                            half_sine * x + half.z() * incoming.z());
  const double angle = std::atan2(std::hypot(difference.x(), difference.y()), difference.z());
  double azimuth = std::atan2(difference.y(), difference.x());
  if (azimuth < 0) azimuth += kPi<double>;
  const int i = bin(std::sqrt(2 / kPi<double> * half_angle), kHalfAngles);
  const int j = bin(2 / kPi<double> * angle, kDifferenceAngles);
  const int k = bin(azimuth / kPi<double>, kDifferenceAzimuths);
  return static_cast<std::size_t>((i * kDifferenceAngles + j) * kDifferenceAzimuths + k);
}

}  // namespace

bool starts_as_merl(std::string_view bytes) {
  std::int32_t dimensions[3] = {};
  if (bytes.size() < kHeaderBytes) return false;
  std::memcpy(dimensions, bytes.data(), kHeaderBytes);
  return dimensions[0] == kHalfAngles && dimensions[1] == kDifferenceAngles &&
         dimensions[2] == kDifferenceAzimuths;
}

MeasuredBrdf parse_merl_brdf(std::string_view bytes, const std::string& subject) {
  if (bytes.size() != kFileBytes)
    throw Error(
        ErrorKind::input, subject,
        fmt::format("has {} bytes, expected {} of a MERL file of {} x {} x {}", bytes.size(),
                    kFileBytes, kHalfAngles, kDifferenceAngles, kDifferenceAzimuths));
  const auto table = std::make_shared<std::vector<Rgb>>(kBins);
  bool any = false;
  for (std::size_t i = 0; i < kBins; ++i) {
    bool missing = false;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t place = kHeaderBytes + (c * kBins + i) * sizeof(double);
      double value;
      std::memcpy(&value, bytes.data() + place, sizeof(double));
      if (!(std::abs(value) <= 1e30))
        throw Error(ErrorKind::input, subject,
                    fmt::format("byte {}: found {}, expected a finite number", place, value));
      missing |= value < 0;
      (*table)[i][static_cast<int>(c)] = static_cast<float>(kScale[c] * value);
    }
    if (missing) (*table)[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    any |= !missing;
  }
  if (!any)
    throw Error(ErrorKind::input, subject, "all bins are negative (missing), expected some values");
  MeasuredBrdf brdf;
  brdf.format = "MERL";
  brdf.isotropic = true;
  brdf.eval = [table](const Vector3f& outgoing, const Vector3f& incoming) -> Rgb {
    if (outgoing.z() <= 0 || incoming.z() <= 0) return Rgb::Zero();
    return (*table)[merl_bin(outgoing.cast<double>(), incoming.cast<double>())];
  };
  return brdf;
}

}  // namespace burnish::detail
