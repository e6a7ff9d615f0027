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
    return {angle_between(Vector3<T>(Vector3<T>::UnitZ()), x.direction)};
  }
};

struct TriangleSolidAngle : Relative {
  static constexpr Claims kClaims = {"solid angle of a triangle", kAngle, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {triangle_solid_angle(Vector3<T>(Vector3<T>::UnitZ()), x.direction,
                                 Vector3<T>(Vector3<T>::UnitY()))};
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

}  // namespace

std::vector<Row> direction_rows() {
  return examine_all<AngleBetween, TriangleSolidAngle, OctahedralPoint>();
}

}  // namespace burnish::test
