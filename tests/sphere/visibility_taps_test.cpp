#include "burnish/sphere/visibility_taps.h"

#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class VisibilityTaps : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(VisibilityTaps, Scalars);

template <class T>
struct Boundary {
  T distance;
  Vector3<T> gradient;
};

/// What hides: the union or the intersection of caps (half-spaces among them), with the exact
/// signed distance to the boundary: the nearest of each circle's nearest point and of the circles'
/// crossings, as far as these lie on the boundary.
struct Occluders {
  struct Cap {
    Vector3d axis;
    double radius;
  };
  std::vector<Cap> caps;
  bool intersection = false;

  bool inside(const Vector3d& v, size_t cap) const {
    return v.dot(caps[cap].axis) > std::cos(caps[cap].radius);
  }

  bool hidden(const Vector3d& v) const {
    for (size_t i = 0; i < caps.size(); ++i)
      if (inside(v, i) != intersection) return !intersection;
    return intersection;
  }

  /// Whether a point of circle i (and j) is on the boundary: no other cap decides there.
  bool on_boundary(const Vector3d& v, size_t i, size_t j) const {
    for (size_t k = 0; k < caps.size(); ++k)
      if (k != i && k != j && inside(v, k) != intersection) return false;
    return true;
  }

  Boundary<double> lookup(const Vector3d& v) const {
    double nearest = 10;
    Vector3d point = v;
    const auto consider = [&](const Vector3d& p, size_t i, size_t j) {
      const double angle = angle_between<double>(v, p);
      if (angle >= nearest || !on_boundary(p, i, j)) return;
      nearest = angle;
      point = p;
    };
    for (size_t i = 0; i < caps.size(); ++i) {
      const Vector3d& a = caps[i].axis;
      const double cos_a = std::cos(caps[i].radius);
      consider(cos_a * a + std::sin(caps[i].radius) * (v - v.dot(a) * a).normalized(), i, i);
      for (size_t j = 0; j < i; ++j) {
        const Vector3d& b = caps[j].axis;
        const double cos_b = std::cos(caps[j].radius), ab = a.dot(b);
        const Vector3d normal = a.cross(b);
        const double square = normal.squaredNorm();
        if (square < 1e-12) continue;
        const Vector3d middle = ((cos_a - ab * cos_b) * a + (cos_b - ab * cos_a) * b) / square;
        const double rest = 1 - middle.squaredNorm();
        if (rest < 0) continue;
        for (const double side : {-1.0, 1.0})
          consider(middle + side * std::sqrt(rest / square) * normal, i, j);
      }
    }
    const double sign = hidden(v) ? -1 : 1;
    return {sign * nearest, (sign * (v.dot(point) * v - point)).normalized()};
  }
};

/// The visible fraction by a midpoint rule over cells of equal weight along x, in 48 x 48.
double true_fraction(const AnisotropicGaussian<double>& lobe, const Occluders& occluders) {
  constexpr int kSteps = 48;
  const double root_x = std::sqrt(lobe.bandwidth_x), root_y = std::sqrt(lobe.bandwidth_y);
  double visible = 0, all = 0;
  for (int j = 0; j < kSteps; ++j) {
    const double y = inverse_erf((2 * (j + 0.5) / kSteps - 1) * std::erf(root_y)) / root_y;
    const double weight = std::erf(root_x * std::sqrt(1 - y * y));
    for (int i = 0; i < kSteps; ++i) {
      const double x = inverse_erf((2 * (i + 0.5) / kSteps - 1) * weight) / root_x;
      const double z = std::sqrt(std::max(1 - x * x - y * y, 0.0));
      all += weight;
      if (!occluders.hidden(lobe.frame.to_world({x, y, z}))) visible += weight;
    }
  }
  return visible / all;
}

/// One of five kinds near a lobe: a half-space, a disc, a slit between two, four discs, a wedge.
Occluders random_occluders(int kind, const AnisotropicGaussian<double>& lobe,
                           std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto frame_near = [&](double deviations) {
    const double x = std::min(deviations / std::sqrt(2 * lobe.bandwidth_x), 1.0) * normal(random);
    const double y = std::min(deviations / std::sqrt(2 * lobe.bandwidth_y), 1.0) * normal(random);
    const Vector3d point = lobe.frame.z + x * lobe.frame.x + y * lobe.frame.y;
    return test::random_frame(point.normalized(), random);
  };
  const auto disc = [&](double radius, double deviations) {
    const Frame<double> f = frame_near(deviations);  // the point is on the disc's rim
    return Occluders::Cap{std::cos(radius) * f.z + std::sin(radius) * f.x, radius};
  };
  constexpr double kHalfPi = kPi<double> / 2;
  if (kind == 0) return {{disc(kHalfPi, 1.5)}};
  if (kind == 1) return {{disc(0.05 + 0.75 * uniform(random), 1)}};
  if (kind == 2) {
    const Frame<double> f = frame_near(0.7);
    const double half_width = 0.03 + 0.4 * uniform(random);
    return {{{f.x, kHalfPi - half_width}, {-f.x, kHalfPi - half_width}}};
  }
  if (kind == 3) {
    Occluders several;
    for (int i = 0; i < 4; ++i) several.caps.push_back(disc(0.05 + 0.3 * uniform(random), 1.5));
    return several;
  }
  return {{disc(kHalfPi, 1.5), disc(kHalfPi, 1.5)}, uniform(random) < 0.5};
}

/// Mean absolute error of the visible fraction over scenes of bandwidths 20..2000 (geometric mean);
/// a count of 0 is one reading in the hemisphere model.
std::vector<double> mean_errors(double anisotropy, const std::vector<int>& counts, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<double> errors(counts.size());
  std::vector<QuantileTapTable<double>> tables;
  for (const int count : counts) tables.push_back(make_quantile_taps<double>(count));
  constexpr int kScenes = 250;
  for (int scene = 0; scene < kScenes; ++scene) {
    const double bandwidth =
        20 * std::pow(100, std::uniform_real_distribution<double>(0, 1)(random));
    AnisotropicGaussian<double> lobe{{}, bandwidth * anisotropy, bandwidth / anisotropy, 1};
    lobe.frame = test::random_frame(test::random_direction(random), random);
    const Occluders occluders = random_occluders(scene % 5, lobe, random);
    const double truth = true_fraction(lobe, occluders);
    for (size_t i = 0; i < counts.size(); ++i) {
      const auto model =
          counts[i] == 0 ? VisibilityModel::hemisphere : VisibilityModel::directional;
      const double fraction =
          visible_fraction(model, lobe, quantile_taps(tables[i], lobe),
                           [&](const Vector3d& v) { return occluders.lookup(v); });
      errors[i] += std::abs(fraction - truth) / kScenes;
    }
  }
  return errors;
}

// The stated errors are means over 2000 scenes (docs/maths.md, "Visible fraction"). The errors'
// deviation is 1.5 times their mean, so that a mean of 250 has a standard error of a tenth: three
// of those.
TEST(VisibilityTaps, FiveTapsKeepTheirStatedError) {
  const struct {
    double anisotropy, hemisphere, directional, five;
  } rows[] = {
      {1, .029, .029, .017}, {3, .064, .038, .011}, {10, .113, .058, .013}, {30, .157, .075, .018}};
  const unsigned seed = 77;
  for (const auto& row : rows) {
    SCOPED_TRACE(testing::Message() << "anisotropy " << row.anisotropy << ", seed " << seed);
    const std::vector<double> error = mean_errors(row.anisotropy, {0, 1, 5}, seed);
    EXPECT_NEAR(error[0] / row.hemisphere, 1, .3);
    EXPECT_NEAR(error[1] / row.directional, 1, .3);
    EXPECT_LE(error[2], 1.3 * row.five);
  }
}

TYPED_TEST(VisibilityTaps, OneTapReadsAtTheAxis) {
  using T = TypeParam;
  const AnisotropicGaussian<T> lobe{Frame<T>{}, T(40), T(5), T(1)};
  const LobeTaps<T> taps = quantile_taps(make_quantile_taps<T>(1), lobe);
  const Boundary<T> boundary{T(0.1), Vector3<T>::UnitX()};
  const T one = visible_fraction(VisibilityModel::directional, lobe, taps, [&](const auto& v) {
    EXPECT_EQ(v, lobe.frame.z);
    return boundary;
  });
  EXPECT_EQ(one, visible_fraction(VisibilityModel::directional, lobe, boundary.distance,
                                  boundary.gradient));
}

TYPED_TEST(VisibilityTaps, OpenIsOneAndHiddenIsZeroExactly) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  std::vector<QuantileTapTable<T>> tables;
  for (int count = 0; count <= kMaxTaps; ++count) tables.push_back(make_quantile_taps<T>(count));
  for (const T x :
       {T(0), Limits::denorm_min(), T(1e-8), T(1e-3), T(1), T(1e3), T(1e8), Limits::max()}) {
    for (const double ratio : {1.0, 1 + double(Limits::epsilon()), 10.0, 1e6}) {
      const AnisotropicGaussian<T> lobe{Frame<T>{}, x, T(x / ratio), T(1)};
      for (int count = 1; count <= kMaxTaps; ++count) {
        const LobeTaps<T> quantiles = quantile_taps(tables[count], lobe);
        const LobeTaps<T> teeth = make_lobe_comb<T>(lobe.bandwidth_x, lobe.bandwidth_y, count).taps;
        for (const LobeTaps<T>& taps : {quantiles, teeth}) {
          for (const Vector3<T>& gradient :
               {Vector3<T>(0, 1, 0), Vector3<T>(1, 0, 0), Vector3<T>(T(0.6), T(0.8), 0)}) {
            const auto fraction = [&](T signed_distance) {
              return visible_fraction(VisibilityModel::directional, lobe, taps,
                                      [&](const Vector3<T>& v) {
                                        EXPECT_NEAR(v.norm(), 1, 4 * Limits::epsilon());
                                        return Boundary<T>{signed_distance, gradient};
                                      });
            };
            EXPECT_EQ(fraction(kPi<T>), 1) << x << " " << ratio << " " << count;
            EXPECT_EQ(fraction(kPi<T> / 2), 1) << x << " " << ratio << " " << count;
            EXPECT_EQ(fraction(-kPi<T>), 0) << x << " " << ratio << " " << count;
            EXPECT_EQ(fraction(-kPi<T> / 2), 0) << x << " " << ratio << " " << count;
            // Halves stay halves: weights sum to one.
            EXPECT_NEAR(fraction(0), 0.5, 4 * Limits::epsilon());
          }
        }
      }
    }
  }
}

TYPED_TEST(VisibilityTaps, HaveTheMomentsOfTheirSlabsAtEveryBandwidth) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  for (int count = 2; count <= kMaxTaps; ++count) {
    const auto table = make_quantile_taps<T>(count);
    for (double bandwidth = 1e-9; bandwidth < 1e10; bandwidth *= 1.7) {
      const AnisotropicGaussian<T> lobe{Frame<T>{}, Limits::max(), T(bandwidth), T(1)};
      const LobeTaps<T> taps = quantile_taps(table, lobe);
      // Midpoint sum of y^2 exp(-bandwidth y^2) over the diameter.
      const double edge = std::min(1.0, 7 / std::sqrt(bandwidth));
      double mass = 0, square = 0, sum = 0;
      for (int i = 0; i < 2000; ++i) {
        const double y = edge * (i + 0.5) / 2000, density = std::exp(-bandwidth * y * y);
        mass += density;
        square += density * y * y;
      }
      for (int k = 0; k < count; ++k) {
        const LobeTap<T>& tap = taps.tap[k];
        const double sine = tap.sine;
        EXPECT_NEAR(tap.weight, 1.0 / count, Limits::epsilon());
        EXPECT_NEAR(sine, -taps.tap[count - 1 - k].sine, 1e-4 * edge);
        if (k > 0) {
          EXPECT_GT(sine, taps.tap[k - 1].sine);
        }
        sum += tap.weight * (sine * sine + (1 - sine * sine) / (2 * tap.bandwidth));
      }
      // The law of total variance. Linear interpolation in the table errs by an eighth of its
      // second difference, 2e-3 of the variance at most (32 intervals); float adds less.
      EXPECT_NEAR(sum / (square / mass), 1, 3e-3) << bandwidth << " " << count;
    }
  }
}

TYPED_TEST(VisibilityTaps, RowsOfTheTableHoldTheMomentsOfTheirSlabs) {
  using T = TypeParam;
  for (const int count : {2, 5, kMaxTaps}) {
    const QuantileTapTable<T> table = make_quantile_taps<T>(count);
    for (int i = 1; i < QuantileTapTable<T>::kIntervals; ++i) {
      const double u = double(i) / QuantileTapTable<T>::kIntervals, root = u / (1 - u);
      // Of exp(-root^2 y^2) on [-1, 1]: a slab's mean from its ends' values, and the variance.
      const double mass = std::sqrt(kPi<double>) / root * std::erf(root);
      const auto falls = [&](int k) {  // the value at the lower end of slab k
        if (k == 0 || k == count) return std::exp(-root * root);
        const double at = inverse_erf((2.0 * k / count - 1) * std::erf(root));
        return std::exp(-at * at);
      };
      const double variance = 1 / (2 * root * root) - std::exp(-root * root) / (root * root * mass);
      double sum = 0;
      for (int k = 0; k < count; ++k) {
        const double mean = count * (falls(k) - falls(k + 1)) / (2 * root * root * mass);
        const double sine = table.row[i].sine[k] / (1 + root);
        const double deviation = table.row[i].deviation[k] / (1 + root);
        sum += (sine * sine + deviation * deviation) / count;
        // Midpoints: a slab's mean to 3e-6 of its width, which is 8.5 deviations at most.
        EXPECT_NEAR(sine, mean, 3e-5 * std::sqrt(variance)) << root << " " << k << " of " << count;
      }
      EXPECT_NEAR(sum / variance, 1, 1e-4) << root << " " << count;
    }
  }
}

TYPED_TEST(VisibilityTaps, FindTheLongAxisWhereverItIs) {
  using T = TypeParam;
  const auto table = make_quantile_taps<T>(3);
  for (const bool along_x : {false, true}) {
    const AnisotropicGaussian<T> lobe{Frame<T>{}, T(along_x ? 200 : 4000), T(along_x ? 4000 : 200),
                                      T(1)};
    const AnisotropicGaussian<T> end = tap_lobe(lobe, quantile_taps(table, lobe).tap[2]);
    EXPECT_EQ(along_x ? end.frame.z.y() : end.frame.z.x(), 0);
    // The last third of a normal variable has the mean 3 density(.43073) = 1.0908; the table
    // interpolates within 2e-3.
    EXPECT_NEAR((along_x ? end.frame.z.x() : end.frame.z.y()) * 20, 1.0908, 2e-3);
    EXPECT_EQ(along_x ? end.bandwidth_y : end.bandwidth_x, 4000);
  }
}

TEST(VisibilityTaps, FloatAgreesWithDouble) {
  const auto single = make_quantile_taps<float>(5);
  const auto exact = make_quantile_taps<double>(5);
  for (float bandwidth = 1e-30f; bandwidth < 1e30f; bandwidth *= 3) {
    const auto of_float = quantile_taps<float>(single, {{}, 1e38f, bandwidth, 1});
    const auto of_double = quantile_taps<double>(exact, {{}, 1e38, bandwidth, 1});
    for (int k = 0; k < 5; ++k) {
      // The place in the table rounds at 1, 32 intervals away from the bandwidth's own rounding.
      EXPECT_NEAR(of_float.tap[k].bandwidth / of_double.tap[k].bandwidth, 1, 1e-5);
      EXPECT_NEAR(of_float.tap[k].sine, of_double.tap[k].sine,
                  1e-6 * std::max(std::abs(of_double.tap[4].sine), 1e-30));
    }
  }
}

}  // namespace
}  // namespace burnish
