#include "harness/camera.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

struct ViewAxes {
  Vector3d right, up, forward;
};

ViewAxes view_axes(const Vector3d& forward, const Vector3d& up) {
  Vector3d right = forward.cross(up);
  // A view along `up`: any upright will do, but it must not be noise. 1e-6 is well above the
  // rounding of the float coordinates the directions come from.
  if (right.norm() < 1e-6 * up.norm()) right = frame_from_axis(forward).x;
  right.normalize();
  return {right, right.cross(forward), forward};
}

[[noreturn]] void reject(std::string_view text, const std::string& why) {
  throw std::invalid_argument(fmt::format(
      "camera \"{}\": {}; expected \"ox,oy,oz,tx,ty,tz,fov\" (world units, degrees)", text, why));
}

float parse_number(std::string_view text, std::string_view item) {
  while (!item.empty() && item.front() == ' ') item.remove_prefix(1);
  while (!item.empty() && item.back() == ' ') item.remove_suffix(1);
  if (item.size() > 1 && item.front() == '+' && item[1] != '-') item.remove_prefix(1);
  float value = 0;
  const auto [end, error] = std::from_chars(item.data(), item.data() + item.size(), value);
  if (error != std::errc() || end != item.data() + item.size() || !std::isfinite(value))
    reject(text, fmt::format("\"{}\" is not a finite number", item));
  return value;
}

}  // namespace

Camera parse_camera(std::string_view text, const Vector3f& up) {
  std::array<float, 7> values{};
  const auto found = 1 + static_cast<size_t>(std::count(text.begin(), text.end(), ','));
  if (found != values.size()) reject(text, fmt::format("{} values, not 7", found));
  std::string_view rest = text;
  for (float& value : values) {
    const size_t comma = std::min(rest.find(','), rest.size());
    value = parse_number(text, rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  const Camera camera{
      {values[0], values[1], values[2]}, {values[3], values[4], values[5]}, up, values[6]};
  if (camera.origin == camera.target) reject(text, "origin and target are the same point");
  if (!(camera.vertical_fov_deg > 0 && camera.vertical_fov_deg < 180))
    reject(text, fmt::format("fov {} is not between 0 and 180", camera.vertical_fov_deg));
  return camera;
}

std::string format_camera(const Camera& camera) {
  const Vector3f &o = camera.origin, &t = camera.target;
  return fmt::format("{},{},{},{},{},{},{}", o.x(), o.y(), o.z(), t.x(), t.y(), t.z(),
                     camera.vertical_fov_deg);
}

Camera frame_bounds(const Vector3f& lower, const Vector3f& upper, float aspect,
                    const Vector3f& up) {
  constexpr double kMargin = 1.08;  // the picture's half height over the box's
  Camera camera;
  camera.up = up;
  const Vector3d center = (lower.cast<double>() + upper.cast<double>()) / 2;
  Vector3d half = (upper.cast<double>() - lower.cast<double>()) / 2;
  if (half.norm() == 0) half = Vector3d::Constant(0.5);

  // Front, as a viewer who keeps `up` upright sees it: +z for y up, -y for z up, as modelling
  // programs have it.
  const Vector3d u = up.cast<double>().normalized();
  Vector3d front = Vector3d::UnitX().cross(u);
  if (front.norm() < 1e-6) front = Vector3d::UnitZ();
  front.normalize();
  const Vector3d side = u.cross(front);
  const Vector3d toward_camera = (front + 0.45 * side + 0.5 * u).normalized();

  const ViewAxes axes = view_axes(-toward_camera, u);
  const double tan_y = std::tan(camera.vertical_fov_deg * kPi<double> / 360);
  const double tan_x = tan_y * aspect;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d p(corner & 1 ? half.x() : -half.x(), corner & 2 ? half.y() : -half.y(),
                     corner & 4 ? half.z() : -half.z());
    const double extent =
        std::max(std::abs(p.dot(axes.right)) / tan_x, std::abs(p.dot(axes.up)) / tan_y);
    distance = std::max(distance, kMargin * extent - p.dot(axes.forward));
  }
  camera.origin = (center + distance * toward_camera).cast<float>();
  camera.target = center.cast<float>();
  return camera;
}

Camera turned(const Camera& camera, const Vector3f& up, double angle_rad) {
  Camera result = camera;
  if (angle_rad == 0) return result;  // to the bit
  const Eigen::AngleAxisf turn(static_cast<float>(angle_rad), up);
  result.origin = camera.target + turn * (camera.origin - camera.target);
  return result;
}

PrimaryRays primary_rays(const Camera& camera, int width, int height) {
  const Vector3d forward =
      (camera.target.cast<double>() - camera.origin.cast<double>()).normalized();
  const ViewAxes axes = view_axes(forward, camera.up.cast<double>());
  const double half_height = std::tan(camera.vertical_fov_deg * kPi<double> / 360);
  const double pixel = 2 * half_height / height;
  return {camera.origin, axes.forward + half_height * axes.up - pixel * width / 2 * axes.right,
          pixel * axes.right, -pixel * axes.up};
}

}  // namespace burnish
