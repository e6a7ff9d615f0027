#include "burnish/formats/measured_brdf.h"

#include <algorithm>
#include <cmath>

#include "burnish/formats/error.h"
#include "burnish/sphere/frame.h"
#include "file_bytes.h"
#include "measured/measured_formats.h"
#include "measured/tensor_file.h"

namespace burnish {

double eval_tabulated_distribution(const TabulatedDistribution& distribution,
                                   const Vector3d& half) {
  const double angle = std::atan2(std::hypot(half.x(), half.y()), half.z());
  const double azimuth = std::atan2(half.y(), half.x());
  const double u = std::sqrt(std::min(2 / kPi<double> * angle, 1.0)) * (distribution.angles - 1);
  const double v = (azimuth / kPi<double> + 1) / 2 * (distribution.azimuths - 1);
  const int column = std::clamp(static_cast<int>(u), 0, distribution.angles - 2);
  const int row = std::clamp(static_cast<int>(v), 0, distribution.azimuths - 2);
  const float* corner = distribution.values.data() + row * distribution.angles + column;
  const double x = u - column, y = v - row;
  const auto along = [&](const float* p) { return (1 - x) * double(p[0]) + x * double(p[1]); };
  return (1 - y) * along(corner) + y * along(corner + distribution.angles);
}

namespace detail {

HalfDifference half_difference(const Vector3d& outgoing, const Vector3d& incoming) {
  const Vector3d sum = outgoing + incoming;
  const double length = sum.norm();
  const Vector3d half = length > 1e-12 ? Vector3d(sum / length) : Vector3d(Vector3d::UnitZ());
  return {half, minimal_rotation<double>(Vector3d::UnitZ(), half).transpose() * incoming};
}

}  // namespace detail

MeasuredBrdf parse_measured_brdf(std::string_view bytes, const std::string& subject) {
  if (bytes.empty()) throw Error(ErrorKind::input, subject, "is empty, expected a measured BRDF");
  if (bytes.starts_with(detail::kTensorMagic.substr(0, std::min(bytes.size(), size_t{12}))))
    return detail::parse_rgl_brdf(bytes, subject);
  if (detail::starts_as_merl(bytes)) return detail::parse_merl_brdf(bytes, subject);
  if (bytes.find('\0') != std::string_view::npos)
    throw Error(ErrorKind::input, subject,
                "is of an unknown format, expected an RGL tensor file (.bsdf), a MERL file "
                "(.binary) of 90 x 90 x 180 or a CSV table");
  return detail::parse_csv_brdf(bytes, subject);
}

MeasuredBrdf read_measured_brdf(const std::string& path) {
  return parse_measured_brdf(read_file_bytes(path), path);
}

}  // namespace burnish
