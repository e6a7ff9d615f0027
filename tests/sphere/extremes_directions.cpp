// Directions, solid angles and the octahedral map at extreme inputs.

#include "burnish/sphere/octahedral_map.h"
#include "burnish/sphere/solid_angle.h"
#include "sphere/extremes.h"

namespace burnish::test {
namespace {

struct AngleBetween : Relative {
  static constexpr Claims kClaims = {"angle between directions", kAngle, kFewRoundings, true,
                                     Trend::rises};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {angle_between(x.frame.z, x.direction)};
  }
};

struct TriangleSolidAngle : Relative {
  static constexpr Claims kClaims = {"solid angle of a triangle", kAngle, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {triangle_solid_angle(x.frame.z, x.direction, x.frame.y)};
  }
};

struct OctahedralPoint : ToOne {
  static constexpr Claims kClaims = {"octahedral map of a direction", kRatio | kAngle,
                                     kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const Vector2<T> uv = direction_to_octahedral(x.direction);
    return {uv.x(), uv.y()};
  }
};

struct OctahedralTangentsSpanTheArea {
  static double scale(const Extreme<double>&) { return 4 * kPi<double>; }
  // Next to a pole the coordinates' last places decide: two of 6e-8 each in a step of 1e-6.
  static constexpr Claims kClaims = {"octahedral map: area of the tangents", kRatio | kAngle, 0.12};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const Vector2<T> uv = direction_to_octahedral(x.direction);
    const auto tangents = octahedral_tangents(uv.x(), uv.y());
    const Vector3<T> gradient = octahedral_gradient(x.direction, uv, T(1), T(1));
    const T area = tangents.du.cross(tangents.dv).norm();
    return {area, gradient.norm() > 0 ? T(1) : T(0)};
  }
};

struct MinimalRotation : ToOne {
  static constexpr Claims kClaims = {"minimal rotation", kAngle, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const Eigen::Matrix<T, 3, 3> turn = minimal_rotation(x.frame.z, x.direction);
    return {turn.determinant(), (turn * x.frame.z).dot(x.direction), turn.col(0).norm(),
            turn.col(1).norm(), turn.col(2).norm()};
  }
};

}  // namespace

std::vector<Row> direction_rows() {
  return examine_all<AngleBetween, TriangleSolidAngle, OctahedralPoint,
                     OctahedralTangentsSpanTheArea, MinimalRotation>();
}

}  // namespace burnish::test
