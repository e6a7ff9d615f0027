#include "burnish/light/local_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/cap_cosine.h"
#include "burnish/sphere/lobe_domain.h"
#include "burnish/sphere/mean_resultant.h"
#include "burnish/sphere/solid_angle.h"

// Geometry is in double: the solid angle of a distant light is a difference of nearly equal angles.
namespace burnish {
namespace {

/// Lobes are no narrower: a deviation of two epsilons, about what a direction in float can tell.
constexpr float kMaxBandwidth = 1e13f;

/// Gives the lobe its color, for a light of a solid angle and an integral of the clamped cosine.
void set_energy(LightAtPoint& light, const Rgb& radiance, float solid_angle, float cosine) {
  light.reaches = true;
  light.radiance = radiance;
  light.integral = asg_integral_exact(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
  light.color = radiance * (solid_angle / light.integral);
  light.cosine_integral = solid_angle > 0 ? cosine * (light.integral / solid_angle) : 0.0f;
}

/// A cap of directions of a height 1 - cos(its radius) around a unit axis.
LightAtPoint light_of_cap(const Vector3f& axis, float height, float cosine, const Rgb& radiance) {
  LightAtPoint light;
  light.lobe.frame = frame_from_axis(axis);
  const float sharpness = sharpness_from_mean(resultant_from_complement(height / 2));
  light.lobe.bandwidth_x = light.lobe.bandwidth_y = std::min(sharpness / 2, kMaxBandwidth);
  // Of more than a hemisphere it is a difference.
  const float irradiance = std::max(cap_cosine_integral(height, cosine), 0.0f);
  set_energy(light, radiance, 2 * kPi<float> * height, irradiance);
  return light;
}

/// A rectangle as seen from a point that it shines on, in a frame of its own: z toward the side of
/// the point, the point at the origin.
struct SeenRectangle {
  Frame<double> frame;
  Vector3d center;
  double width = 0, height = 0;     ///< along x and y; corners that are close lose them
  std::array<Vector3d, 4> corners;  ///< clockwise about z
  bool visible = false;

  double extent() const { return std::max(width, height) / center.norm(); }

  SeenRectangle(const RectangleLight& light, const Vector3f& position) {
    const Vector3d edge_x = light.edge_x.cast<double>(), edge_y = light.edge_y.cast<double>();
    width = edge_x.norm();
    height = edge_y.norm();
    frame.x = edge_x / width;
    frame.y = edge_y / height;
    frame.z = frame.x.cross(frame.y);
    const Vector3d to_center = light.center.cast<double>() - position.cast<double>();
    double x = to_center.dot(frame.x);
    const double y = to_center.dot(frame.y);
    double z = to_center.dot(frame.z);
    if (light.two_sided && z > 0) {
      frame.x = -frame.x;
      frame.z = -frame.z;
      x = -x;
      z = -z;
    }
    visible = z < 0;
    center = {x, y, z};
    const double left = x - width / 2, right = x + width / 2;
    const double low = y - height / 2, high = y + height / 2;
    corners = {Vector3d(left, low, z), {left, high, z}, {right, high, z}, {right, low, z}};
  }
};

/// The inward normal of the arc between two directions, times the arc's angle.
Vector3d arc_normal(const Vector3d& from, const Vector3d& to) {
  const Vector3d normal = from.cross(to - from);
  const double length = normal.norm();
  if (!(length > 0)) return Vector3d::Zero();
  return normal * (std::atan2(length, from.dot(to)) / length);
}

/// Lambert's formula (baum1989formfactor) for what of the rectangle is above the horizon of a
/// normal in its frame.
double clipped_cosine_integral(const SeenRectangle& seen, const Vector3d& normal) {
  // Five corners at most, but for rounding where the plane of the horizon is that of the rectangle.
  std::array<Vector3d, 8> polygon;
  size_t count = 0;
  for (size_t i = 0; i < 4; ++i) {
    const Vector3d &from = seen.corners[i], &to = seen.corners[(i + 1) % 4];
    const double above = normal.dot(from), next = normal.dot(to);
    if (above >= 0) polygon[count++] = from;
    if ((above > 0 && next < 0) || (above < 0 && next > 0))
      polygon[count++] = from + (to - from) * (above / (above - next));
  }
  double sum = 0;
  for (size_t i = 0; i < count; ++i)
    sum += normal.dot(arc_normal(polygon[i], polygon[(i + 1) % count]));
  return std::clamp(sum / 2, 0.0, kPi<double>);
}

/// Solid angle and mean of a small rectangle by two Gauss nodes along each edge: off by its fourth
/// power over the distance's.
void add_nodes(const SeenRectangle& seen, RectangleMoments& moments) {
  const double node = 0.5 / std::sqrt(3.0);
  for (const double u : {-node, node}) {
    for (const double v : {-node, node}) {
      const Vector3d point = seen.center + Vector3d(u * seen.width, v * seen.height, 0);
      const double distance = point.norm();
      const Vector3d direction = point / distance;
      const double share =
          seen.width / distance * (seen.height / distance) * std::abs(direction.z()) / 4;
      moments.solid_angle += share;
      moments.mean += share * direction;
    }
  }
}

/// The same in closed form, and the sum over the arcs that the spread needs.
Eigen::Matrix3d add_arcs(const SeenRectangle& seen, RectangleMoments& moments) {
  const std::array<Vector3d, 4>& corners = seen.corners;
  std::array<Vector3d, 4> unit;
  for (size_t i = 0; i < 4; ++i) unit[i] = corners[i].normalized();
  moments.solid_angle = triangle_solid_angle(unit[0], unit[1], unit[2]) +
                        triangle_solid_angle(unit[2], unit[3], unit[0]);
  Eigen::Matrix3d arcs = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < 4; ++i) {
    const size_t j = (i + 1) % 4;
    const Vector3d normal = arc_normal(corners[i], corners[j]);
    moments.mean += normal / 2;
    // The integral of the arc's directions is along their bisector, and as long as their chord.
    arcs += (unit[i] - unit[j]).norm() * (unit[i] + unit[j]).normalized() *
            normal.normalized().transpose();
  }
  return arcs;
}

RectangleMoments moments_in_frame(const SeenRectangle& seen) {
  // Extent over distance below which the closed form of the spread cancels, and the rectangle is as
  // good as flat: both are off by 1e-6 here. Solid angle and mean lose 1e-16 over it.
  constexpr double kFlat = 1e-3;
  RectangleMoments moments;
  Eigen::Matrix3d arcs = Eigen::Matrix3d::Zero();
  if (seen.extent() < kFlat)
    add_nodes(seen, moments);
  else
    arcs = add_arcs(seen, moments);
  const Vector3d axis = moments.mean.normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - axis * axis.transpose();
  const double distance = seen.center.norm();
  const Vector3d x = across.col(0) * (seen.width / distance);
  const Vector3d y = across.col(1) * (seen.height / distance);
  if (std::max(x.norm(), y.norm()) < kFlat) {
    moments.spread = moments.solid_angle / 12 * (x * x.transpose() + y * y.transpose());
  } else {
    moments.spread =
        across * (moments.solid_angle * Eigen::Matrix3d::Identity() + arcs) * across / 3;
  }
  return moments;
}

/// Bandwidth of an ASG with this mean of (v . x)^2. For equal bandwidths b it is exactly (1 - A(b /
/// 2)) / 4, A the mean cosine of an SG. Those of needles, of which rounding leaves nothing, are
/// held to what it may be.
float bandwidth_of_second_moment(double moment) {
  const double complement = std::clamp(4 * moment, 0.0, 1.0);
  const double bandwidth = 2 * sharpness_from_mean(resultant_from_complement(complement));
  return static_cast<float>(std::min(bandwidth, double(kMaxBandwidth)));
}

bool is_positive(float value) { return std::isfinite(value) && value > 0; }

std::string finite_error(const char* name, const Rgb& value, bool may_be_negative) {
  for (int i = 0; i < 3; ++i) {
    const std::string error = internal::scalar_error(name, value[i], may_be_negative);
    if (!error.empty()) return error;
  }
  return {};
}

std::string brightness_error(const char* name, const Rgb& radiance) {
  const float most = radiance.abs().maxCoeff();
  if (most <= kMaxRadiance) return {};
  std::array<char, 80> text = {};
  std::snprintf(text.data(), text.size(), " is %g, expected at most %g", double(most),
                double(kMaxRadiance));
  return name + std::string(text.data());
}

std::string radiance_error(const Rgb& radiance) {
  const std::string error = finite_error("radiance", radiance, false);
  return error.empty() ? brightness_error("radiance", radiance) : error;
}

std::string finite_error(const char* name, const Vector3f& value) {
  return value.allFinite() ? "" : std::string(name) + " is not finite";
}

}  // namespace

LightAtPoint light_at(const SphereLight& light, const Vector3f& position,
                      const Vector3f& normal) noexcept {
  const Vector3d to_center = light.center.cast<double>() - position.cast<double>();
  const double distance = to_center.norm(), radius = light.radius;
  if (normal.cast<double>().dot(to_center) <= -radius) return {};
  Vector3f axis = distance > 0 ? Vector3f((to_center / distance).cast<float>()) : normal;
  const float cosine = std::clamp(axis.dot(normal), -1.0f, 1.0f);
  if (distance >= radius) {
    // 1 - cos of the cap's edge, without its cancellation for small spheres.
    const double square = radius * radius / (distance * distance);
    const double height = square / (1 + std::sqrt(1 - square));
    return light_of_cap(axis, static_cast<float>(height), cosine, light.radiance);
  }
  const double depth = (radius - distance) / radius / double(kSphereShell);
  const auto inside = static_cast<float>(std::min(depth, 1.0));
  // What lights a surface from all directions is before it.
  const Vector3f turned = (1 - inside) * axis + inside * normal;
  const float length = turned.norm();
  return light_of_cap(length > 0 ? Vector3f(turned / length) : normal, 1 + inside, cosine,
                      light.radiance);
}

LightAtPoint light_at(const DirectionalLight& light, const Vector3f& /*position*/,
                      const Vector3f& normal) noexcept {
  const float radius = shaded_angular_radius(light);
  const float sine = std::sin(radius), half_sine = std::sin(radius / 2);
  const float cosine = std::clamp(light.toward.dot(normal), -1.0f, 1.0f);
  if (cosine <= -sine) return {};
  return light_of_cap(light.toward, 2 * half_sine * half_sine, cosine,
                      radiance_of_disc(light.irradiance, radius));
}

RectangleMoments rectangle_moments(const RectangleLight& light, const Vector3f& position) noexcept {
  const SeenRectangle seen(light, position);
  if (!seen.visible) return {};
  RectangleMoments moments = moments_in_frame(seen);
  Eigen::Matrix3d world_from_frame;
  world_from_frame << seen.frame.x, seen.frame.y, seen.frame.z;
  moments.mean = world_from_frame * moments.mean;
  moments.spread = world_from_frame * moments.spread * world_from_frame.transpose();
  return moments;
}

LightAtPoint light_at(const RectangleLight& light, const Vector3f& position,
                      const Vector3f& normal) noexcept {
  const SeenRectangle seen(light, position);
  if (!seen.visible) return {};
  const Vector3d local_normal = seen.frame.to_local(normal.cast<double>());
  const auto is_above = [&](const Vector3d& corner) { return local_normal.dot(corner) > 0; };
  const auto above = std::count_if(seen.corners.begin(), seen.corners.end(), is_above);
  if (above == 0) return {};
  const RectangleMoments moments = moments_in_frame(seen);
  const double length = moments.mean.norm();
  if (!(moments.solid_angle > 0 && length > 0)) return {};

  // Principal axes of the spread in the tangent plane of the mean direction.
  const Frame<double> tangent = frame_from_axis<double>(moments.mean / length);
  const double xx = tangent.x.dot(moments.spread * tangent.x);
  const double yy = tangent.y.dot(moments.spread * tangent.y);
  const double xy = tangent.x.dot(moments.spread * tangent.y);
  const double half_difference = (xx - yy) / 2;
  const double radius = std::hypot(half_difference, xy);
  const double angle = 0.5 * std::atan2(xy, half_difference);
  const Vector3d x = std::cos(angle) * tangent.x + std::sin(angle) * tangent.y;
  const Frame<double> local = {x, tangent.z.cross(x), tangent.z};

  LightAtPoint result;
  result.lobe.frame = {seen.frame.to_world(local.x).cast<float>(),
                       seen.frame.to_world(local.y).cast<float>(),
                       seen.frame.to_world(local.z).cast<float>()};
  const double mean_square = (xx + yy) / 2;
  result.lobe.bandwidth_x =
      bandwidth_of_second_moment((mean_square + radius) / moments.solid_angle);
  result.lobe.bandwidth_y =
      bandwidth_of_second_moment(std::max(mean_square - radius, 0.0) / moments.solid_angle);
  // What the horizon cuts off a tiny light is within its extent of nothing; there, edges cancel.
  const double cosine = above == 4 || seen.extent() < 1e-7
                            ? std::max(local_normal.dot(moments.mean), 0.0)
                            : clipped_cosine_integral(seen, local_normal);
  set_energy(result, light.radiance, static_cast<float>(moments.solid_angle),
             static_cast<float>(cosine));
  return result;
}

std::string domain_error(const EnvironmentLobe& light) {
  std::string error = domain_error(light.lobe);
  if (error.empty()) error = finite_error("color", light.color, true);
  return error.empty()
             ? brightness_error("color times amplitude", light.color * light.lobe.amplitude)
             : error;
}

std::string domain_error(const SphereLight& light) {
  std::string error = finite_error("center", light.center);
  if (error.empty() && !is_positive(light.radius))
    error = "radius is " + std::to_string(light.radius) + ", expected a finite number > 0";
  return error.empty() ? radiance_error(light.radiance) : error;
}

std::string domain_error(const DirectionalLight& light) {
  std::string error = internal::unit_error("toward", light.toward);
  if (error.empty() &&
      !(light.angular_radius_rad >= 0 && light.angular_radius_rad <= kPi<float> / 2))
    error = "angular_radius_rad is " + std::to_string(light.angular_radius_rad) +
            ", expected 0 to pi / 2";
  if (error.empty()) error = finite_error("irradiance", light.irradiance, false);
  if (!error.empty()) return error;
  return brightness_error("radiance of the irradiance",
                          radiance_of_disc(light.irradiance, shaded_angular_radius(light)));
}

std::string domain_error(const RectangleLight& light) {
  std::string error = finite_error("center", light.center);
  for (const auto& [name, edge] : {std::pair{"edge_x", &light.edge_x}, {"edge_y", &light.edge_y}})
    if (error.empty() && !is_positive(edge->stableNorm()))
      error = std::string(name) + " has length " + std::to_string(edge->stableNorm()) +
              ", expected a finite number > 0";
  const Vector3d x = light.edge_x.cast<double>().stableNormalized();
  const Vector3d y = light.edge_y.cast<double>().stableNormalized();
  if (error.empty() && !(std::abs(x.dot(y)) <= kAxisTolerance))
    error = "edge_x and edge_y have cosine " + std::to_string(x.dot(y)) + ", expected 0";
  return error.empty() ? radiance_error(light.radiance) : error;
}

}  // namespace burnish
