// Visible fractions at extreme inputs.

#include "burnish/sphere/half_space.h"
#include "burnish/sphere/lobe_comb.h"
#include "burnish/sphere/visibility_taps.h"
#include "sphere/extremes.h"

namespace burnish::test {
namespace {

template <HemisphereLevel level>
struct Hemisphere : ToOne {
  static constexpr Claims kClaims = {
      level == HemisphereLevel::fast ? "hemisphere, fast" : "hemisphere, exact",
      kAngle,
      kFewRoundings,
      true,
      Trend::rises,
      1e-12};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {visible_fraction_hemisphere(x.narrow, x.distance, level)};
  }
};

struct Cap : ToOne {
  static constexpr Claims kClaims = {"cap", kAngle, kFewRoundings, true, Trend::rises};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {visible_fraction_cap(x.narrow, x.angle)};
  }
};

struct Directional : ToOne {
  static constexpr Claims kClaims = {"directional", kAngle, kFewRoundings, true, Trend::rises};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {visible_fraction_directional(x.narrow, x.distance)};
  }
};

struct BandwidthAcross : Relative {
  static constexpr Claims kClaims = {"bandwidth across a boundary", kRatio, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {bandwidth_across(asg(x), x.other_frame.x),
            bandwidth_across(asg(x), Vector3<T>(Vector3<T>::Zero()))};
  }
};

constexpr const char* name_of(VisibilityModel model) {
  return model == VisibilityModel::cap          ? "ASG: visible integral, cap"
         : model == VisibilityModel::hemisphere ? "ASG: visible integral, hemisphere"
                                                : "ASG: visible integral, directional";
}

struct DirectionalBandwidth : Relative {
  static constexpr Claims kClaims = {"directional bandwidth", kRatio, kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    return {directional_bandwidth(asg(x), x.other_frame.x),
            directional_bandwidth(asg(x), Vector3<T>(Vector3<T>::Zero()))};
  }
};

template <VisibilityModel model>
struct VisibleIntegral {
  static double scale(const Extreme<double>& x) { return std::abs(integral(asg(x))); }
  static constexpr Claims kClaims = {name_of(model), kRatio | kAngle | kAmplitude,
                                     2 * kFewRoundings, true, Trend::rises};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const Vector3<T> gradient = std::cos(x.azimuth) * x.frame.x + std::sin(x.azimuth) * x.frame.y;
    return {visible_integral(model, asg(x), x.distance, gradient)};
  }
};

/// The teeth's integrals sum to the lobe's.
struct CombIntegral : Relative {
  static constexpr Claims kClaims = {"comb: integral of the teeth", kRatio, 2 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const auto comb = make_lobe_comb(x.narrow, x.wide, 5);
    T sum = 0;
    for (int k = 0; k < comb.taps.count; ++k) sum += integral(comb_tooth(comb, asg(x), k));
    return {sum, comb.taps.tap[0].bandwidth, comb.taps.tap[4].sine};
  }
};

/// A boundary at x.distance from the lobe's axis.
template <bool quantile, int count>
struct Taps {
  // A tap's distance from the boundary has the rounding of a direction, of which the lobe makes
  // sqrt(bandwidth) times as much.
  static double scale(const Extreme<double>& x) { return 1 + std::sqrt(x.narrow); }
  static constexpr const char* kName = quantile ? "quantile taps" : "comb taps";
  static constexpr Claims kClaims = {kName, kRatio | kAngle, 4 * kFewRoundings};
  template <class T>
  static std::vector<T> values(const Extreme<T>& x) {
    const AnisotropicGaussian<T> lobe = asg(x);
    static const QuantileTapTable<T> table = make_quantile_taps<T>(count);
    const auto taps = quantile ? quantile_taps(table, lobe)
                               : make_lobe_comb(lobe.bandwidth_x, lobe.bandwidth_y, count).taps;
    const Vector3<T> normal = x.direction;  // of the boundary's plane
    struct Boundary {
      T distance;
      Vector3<T> gradient;
    };
    return {visible_fraction(VisibilityModel::directional, lobe, taps, [&](const Vector3<T>& v) {
      const T sine = std::clamp(v.dot(normal), T(-1), T(1));
      return Boundary{std::asin(sine), normal - sine * v};
    })};
  }
};

}  // namespace

std::vector<Row> visibility_rows() {
  return examine_all<
      Hemisphere<HemisphereLevel::fast>, Hemisphere<HemisphereLevel::exact>, Cap, Directional,
      BandwidthAcross, DirectionalBandwidth, VisibleIntegral<VisibilityModel::cap>,
      VisibleIntegral<VisibilityModel::hemisphere>, VisibleIntegral<VisibilityModel::directional>,
      CombIntegral, Taps<false, 5>, Taps<true, 5>>();
}

}  // namespace burnish::test
