#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/spherical_gaussian.h"

/// A sphere operator at every combination of extreme inputs: is each result finite, of the right
/// sign and monotone, and how far is float from double?
namespace burnish::test {

/// One combination. A lobe has the axis `frame.z`; a second one lies at `angle` from it.
template <class T>
struct Extreme {
  T narrow = 1;        ///< sharpness, or the larger bandwidth
  T wide = 1;          ///< the smaller bandwidth
  T ratio = 1;         ///< of the two
  T other_narrow = 1;  ///< of a second lobe
  T other_wide = 1;
  T angle = 0;     ///< radians, 0..pi; from the lobe's axis, or of a boundary
  T distance = 0;  ///< angle - pi / 2: of a boundary from the lobe's axis
  T azimuth = 0;   ///< of `direction` from the axis of `narrow`
  T amplitude = 1;
  Frame<T> frame;  ///< the lobe's: the world's, and a turned one, rounded to T
  Vector3<T> direction = Vector3<T>::UnitZ();  ///< at `angle` and `azimuth`, rounded to T
  Frame<T> other_frame;                        ///< around it, rounded to T

  template <class U>
  Extreme<U> cast() const {
    return {U(narrow),
            U(wide),
            U(ratio),
            U(other_narrow),
            U(other_wide),
            U(angle),
            U(distance),
            U(azimuth),
            U(amplitude),
            frame.template cast<U>(),
            direction.template cast<U>(),
            other_frame.template cast<U>()};
  }
};

template <class T>
std::string describe(const Extreme<T>& x) {
  std::ostringstream text;
  text << x.narrow << "/" << x.wide << ", " << x.other_narrow << "/" << x.other_wide << ", angle "
       << x.angle << ", azimuth " << x.azimuth << ", amplitude " << x.amplitude;
  return text.str();
}

/// Which inputs an operator has; the others keep their defaults.
enum Uses : unsigned { kRatio = 1, kOther = 2, kAngle = 4, kAmplitude = 8 };

/// How an operator's values change while the angle grows and all else is the same.
enum class Trend { none, rises, falls };

/// What is said of an operator. `float_bound` holds for |float - double| over the larger of
/// |double| and the operator's scale, both at the same single-precision inputs.
struct Claims {
  const char* name;
  unsigned uses;
  double float_bound;
  bool non_negative = true;
  Trend trend = Trend::none;
  double trend_slack = 0;  ///< a step against the trend that its own error explains
};

/// What was found.
struct Findings {
  size_t cases = 0;
  double worst = 0;         ///< |float - double| over the scale
  std::string where;        ///< the input of the worst
  std::string first_fault;  ///< empty where every result was sound
};

/// Frames and directions from the angles, in a world that is turned, rounded to T.
template <class T>
void place(Extreme<T>& x, const Eigen::Matrix3d& world) {
  const double s = std::sin(double(x.angle)), c = std::cos(double(x.angle));
  const Vector3d along(std::cos(double(x.azimuth)), std::sin(double(x.azimuth)), 0);
  const Vector3d tilted = c * along - s * Vector3d::UnitZ();
  const Vector3d axis = s * along + c * Vector3d::UnitZ();
  const auto turned = [&](const Vector3d& v) { return Vector3d(world * v).cast<T>().eval(); };
  x.frame = {turned(Vector3d::UnitX()), turned(Vector3d::UnitY()), turned(Vector3d::UnitZ())};
  x.direction = turned(axis);
  x.other_frame = {turned(tilted), turned(axis.cross(tilted)), turned(axis)};
}

template <class T>
std::vector<Extreme<T>> all_extremes(unsigned uses) {
  using limits = std::numeric_limits<T>;
  const T pi = kPi<T>, half_pi = pi / 2;
  const std::vector<T> widths = {0,      limits::denorm_min(), T(1e-8), T(1e-3), 1, T(1e3),
                                 T(1e8), limits::max()};
  const std::vector<T> some_ratios = {1, 1 + limits::epsilon(), 10, T(1e6)};
  const std::vector<T> some_angles = {0,
                                      limits::epsilon(),
                                      T(1e-4),
                                      std::nextafter(half_pi, T(0)),
                                      half_pi,
                                      std::nextafter(half_pi, T(4)),
                                      std::nextafter(pi, T(0)),
                                      pi};
  const auto used = [uses](Uses what, const std::vector<T>& values, T otherwise) {
    return uses & what ? values : std::vector<T>{otherwise};
  };
  const auto ratios = used(kRatio, some_ratios, 1);
  const auto other_ratios = uses & kOther ? ratios : std::vector<T>{1};
  // Rounding hides in the world's own axes.
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.9, Vector3d(1, -2, 3).normalized()).toRotationMatrix();
  std::vector<Extreme<T>> all;
  for (const Eigen::Matrix3d& world : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), turn})
    for (const T width : widths)
      for (const T ratio : ratios)
        for (const T other_width : used(kOther, widths, 1))
          for (const T other_ratio : other_ratios)
            for (const T azimuth : used(kRatio, {0, T(0.7), half_pi}, 0))
              for (const T amplitude :
                   used(kAmplitude, {0, limits::denorm_min(), 1, T(1e30), T(-2)}, 1))
                // Innermost, so that neighbours in the list show the trend.
                for (const T angle : used(kAngle, some_angles, 0)) {
                  Extreme<T> x;
                  x.narrow = width;
                  x.wide = width / ratio;
                  x.ratio = ratio;
                  x.other_narrow = other_width;
                  x.other_wide = other_width / other_ratio;
                  x.angle = angle;
                  x.distance = angle - half_pi;
                  x.azimuth = azimuth;
                  x.amplitude = amplitude;
                  place(x, world);
                  all.push_back(x);
                }
  return all;
}

/// Values of `Operator` in T at every combination; notes what is unsound in `findings`.
template <class Operator, class T>
void check_soundness(Findings& findings) {
  const Claims& claims = Operator::kClaims;
  std::vector<T> last;
  T last_angle = 0;
  const auto fault = [&](const std::string& what, const Extreme<T>& x, T value) {
    if (!findings.first_fault.empty()) return;
    std::ostringstream text;
    text << (sizeof(T) == 4 ? "float" : "double") << ": " << what << " " << value << " at "
         << describe(x);
    findings.first_fault = text.str();
  };
  for (const Extreme<T>& x : all_extremes<T>(claims.uses)) {
    const std::vector<T> values = Operator::values(x);
    if (values.empty()) fault("no value", x, 0);
    const T sign = x.amplitude < 0 ? T(-1) : T(1);
    for (size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) fault("not finite:", x, values[i]);
      if (claims.non_negative && sign * values[i] < 0) fault("negative:", x, values[i]);
      if (claims.trend == Trend::none || !(x.angle > last_angle) || last.empty()) continue;
      const T step = sign * (values[i] - last[i]);
      // Rounding may turn a plateau into a step of a few units in the last place.
      const T rounding =
          8 * std::numeric_limits<T>::epsilon() * std::abs(values[i]) + T(claims.trend_slack);
      if (claims.trend == Trend::rises ? step < -rounding : step > rounding)
        fault("not monotone:", x, values[i]);
    }
    last = values;
    last_angle = x.angle;
    ++findings.cases;
  }
}

/// Both precisions' soundness, and the distance between them.
template <class Operator>
Findings examine() {
  Findings findings;
  check_soundness<Operator, float>(findings);
  check_soundness<Operator, double>(findings);
  for (const Extreme<float>& x : all_extremes<float>(Operator::kClaims.uses)) {
    const Extreme<double> exact = x.cast<double>();
    const std::vector<float> in_float = Operator::values(x);
    const std::vector<double> in_double = Operator::values(exact);
    for (size_t i = 0; i < in_float.size(); ++i) {
      // A result beyond float's range is the largest finite number at best.
      const double largest = std::numeric_limits<float>::max();
      const double truth = std::clamp(in_double[i], -largest, largest);
      const double scale = std::max(
          {std::abs(truth), Operator::scale(exact), double(std::numeric_limits<float>::min())});
      const double difference = std::abs(in_float[i] - truth) / scale;
      if (!std::isfinite(in_double[i]) && findings.first_fault.empty())
        findings.first_fault = "double of float inputs: not finite at " + describe(x);
      if (!(difference > findings.worst)) continue;
      findings.worst = difference;
      findings.where = describe(x);
    }
  }
  return findings;
}

/// A line of the table.
struct Row {
  Claims claims;
  Findings findings;
};

template <class... Operators>
std::vector<Row> examine_all() {
  return {Row{Operators::kClaims, examine<Operators>()}...};
}

/// The rows of a family of operators, each in a file of its own.
/// @{
std::vector<Row> sg_rows();
std::vector<Row> asg_rows();
std::vector<Row> visibility_rows();
std::vector<Row> direction_rows();
/// @}

// Bounds of float against double, relative to the result or, where a result may be small, to what
// it is a part of. An operator of a handful of float operations keeps 16 roundings; an exponent k
// that is wrong by n roundings makes exp(-k) wrong by n k exp(-k) <= n / e of its peak.
inline constexpr double kRounding = 6e-8;
inline constexpr double kFewRoundings = 16 * kRounding;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class T>
SphericalGaussian<T> sg(const Extreme<T>& x) {
  return {x.frame.z, x.narrow, x.amplitude};
}
template <class T>
SphericalGaussian<T> other_sg(const Extreme<T>& x) {
  return {x.direction, x.other_narrow, T(1)};
}
template <class T>
AnisotropicGaussian<T> asg(const Extreme<T>& x) {
  return {x.frame, x.narrow, x.wide, x.amplitude};
}
template <class T>
AnisotropicGaussian<T> other_asg(const Extreme<T>& x) {
  return {x.other_frame, x.other_wide, x.other_narrow, T(1)};
}

struct Relative {
  static double scale(const Extreme<double>&) { return 0; }
};
struct ToAmplitude {
  static double scale(const Extreme<double>& x) { return std::abs(x.amplitude); }
};
struct ToOne {
  static double scale(const Extreme<double>&) { return 1; }
};

}  // namespace burnish::test
