#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "burnish/formats/measured_brdf.h"

/// The readers of measured BRDFs, by format. Each throws Error about `subject`.
namespace burnish::detail {

bool starts_as_merl(std::string_view bytes);

MeasuredBrdf parse_rgl_brdf(std::string_view bytes, const std::string& subject);
MeasuredBrdf parse_merl_brdf(std::string_view bytes, const std::string& subject);
MeasuredBrdf parse_csv_brdf(std::string_view bytes, const std::string& subject);

/// A pair of directions as a half vector and, seen from it, the incoming direction: h is turned to
/// the normal by the smallest rotation, and what that makes of `incoming` is the difference vector
/// (rusinkiewicz1998coordinates, but for its azimuth, which has no seam here).
struct HalfDifference {
  Vector3d half, difference;
};
HalfDifference half_difference(const Vector3d& outgoing, const Vector3d& incoming);

}  // namespace burnish::detail
