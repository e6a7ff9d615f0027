#include "json_values.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/format.h>

#include "burnish/formats/error.h"

namespace burnish {

int read_format_version(const JsonPlace& root, const JsonFormat& expected) {
  const JsonPlace format = root.at("format");
  if (format.string() != expected.name)
    format.fail(fmt::format("'{}', expected '{}'", format.string(), expected.name));
  const JsonPlace version = root.at("format_version");
  if (!version.value.is_number_integer() || version.number() < 1)
    version.fail("expected an integer, 1 or more");
  if (version.number() > expected.newest)
    throw Error(ErrorKind::unsupported, root.subject,
                fmt::format("{} format version {}, this build reads up to {}", expected.kind,
                            version.number(), expected.newest));
  return static_cast<int>(version.number());
}

double read_number(const JsonPlace& place, double low, double high) {
  const double found = place.number();
  if (!(found >= low && found <= high))
    place.fail(fmt::format("{}, expected {}..{}", found, low, high));
  return found;
}

double read_positive(const JsonPlace& place) {
  const double found = read_number(place);
  if (!(found > 0)) place.fail(fmt::format("{}, expected more than 0", found));
  return found;
}

int read_integer(const JsonPlace& place, int low, int high) {
  const double found = read_number(place, low, high);
  if (found != std::floor(found)) place.fail(fmt::format("{}, expected an integer", found));
  return static_cast<int>(found);
}

void fail_choice(const JsonPlace& place, std::span<const char* const> accepted) {
  std::string list;
  for (size_t i = 0; i < accepted.size(); ++i)
    list += (i == 0 ? "" : i + 1 < accepted.size() ? ", " : " or ") + std::string(accepted[i]);
  place.fail(fmt::format("'{}', expected {}", place.string(), list));
}

Vector3f read_vector(const JsonPlace& place, float low, float high) {
  place.expect_array(3);
  return {place.at(size_t{0}).float_in(low, high), place.at(1).float_in(low, high),
          place.at(2).float_in(low, high)};
}

Vector3d read_vector_double(const JsonPlace& place) {
  place.expect_array(3);
  const auto element = [&](size_t i) { return read_number(place.at(i)); };
  return {element(0), element(1), element(2)};
}

Rgb read_color(const JsonPlace& place, float low, float high) {
  return read_vector(place, low, high).array();
}

Rgb read_color_or_grey(const JsonPlace& place, float low, float high) {
  if (place.value.is_number()) return Rgb::Constant(place.float_in(low, high));
  return read_color(place, low, high);
}

Vector3f read_unit(const JsonPlace& place) {
  const Vector3f vector = read_vector(place);
  const float length = vector.stableNorm();
  if (!(std::abs(length - 1) <= kFrameTolerance))
    place.fail(fmt::format("length {}, expected 1 within {}", length, kFrameTolerance));
  return vector;
}

Frame<float> read_frame(const JsonPlace& axis_place, const JsonPlace& tangent_place) {
  const Vector3f axis = read_unit(axis_place), tangent = read_unit(tangent_place);
  const float cosine = axis.dot(tangent);
  if (!(std::abs(cosine) <= kFrameTolerance))
    tangent_place.fail(
        fmt::format("cosine {} with the axis, expected 0 within {}", cosine, kFrameTolerance));
  const auto is_rounding = [](float error) { return std::abs(error) <= kFrameRounding; };
  if (is_rounding(cosine) && is_rounding(axis.norm() - 1) && is_rounding(tangent.norm() - 1))
    return {tangent, axis.cross(tangent).normalized(), axis};
  return frame_from_normal_tangent<float>(axis.normalized(), tangent);
}

Eigen::Matrix3f read_rotation_matrix(const JsonPlace& place) {
  place.expect_array(3);
  Eigen::Matrix3f matrix;
  for (int row = 0; row < 3; ++row)
    matrix.row(row) =
        read_vector(place.at(static_cast<size_t>(row)), -1 - kFrameTolerance).transpose();
  const Eigen::Matrix3d exact = matrix.cast<double>();
  const Eigen::Matrix3d product = exact.transpose() * exact;
  const double error = (product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(error <= 2 * kFrameTolerance) || matrix.determinant() < 0)
    place.fail("not a rotation: expected orthonormal rows and determinant 1");
  if (error <= kFrameRounding) return matrix;  // rounding of a rotation: kept as written
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(exact, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return (svd.matrixU() * svd.matrixV().transpose()).cast<float>();
}

void expect_one_of(const JsonPlace& place, const char* first, const char* second) {
  if (place.has(first) == place.has(second))
    place.fail(fmt::format("expected one of the fields '{}' and '{}'", first, second));
}

std::optional<double> read_fit_error(const JsonPlace& root, const char* name) {
  if (!root.has(name) || root.at(name).value.is_null()) return {};
  const JsonPlace place = root.at(name);
  const double error = place.number();
  if (!(error >= 0)) place.fail(fmt::format("{}, expected 0 or more", error));
  return error;
}

std::string format_vector(const Vector3f& vector) {
  return fmt::format("[{}, {}, {}]", vector[0], vector[1], vector[2]);
}

void require_readable(const std::string& subject, const char* what,
                      const std::function<void()>& parse) {
  try {
    parse();
  } catch (const Error& error) {
    std::string message = error.what();
    message.erase(0, std::min(message.size(), subject.size() + 2));
    throw Error(ErrorKind::output, subject, fmt::format("{} cannot be stored: {}", what, message));
  }
}

}  // namespace burnish
