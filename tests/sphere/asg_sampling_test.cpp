#include "burnish/sphere/asg_sampling.h"

#include <random>

#include <gtest/gtest.h>

#include "support/chi_square.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

template <class T>
class AsgSampling : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(AsgSampling, Scalars);

constexpr int kBins = 10;  // along either axis

/// Edges of bins of a coordinate of the disc that follow a Gaussian of this bandwidth.
std::vector<double> bin_edges(double bandwidth) {
  const double reach = bandwidth > 0 ? std::min(1.0, 2.5 / std::sqrt(2 * bandwidth)) : 1.0;
  std::vector<double> edges(kBins + 1);
  for (int i = 0; i <= kBins; ++i) edges[i] = reach * (2.0 * i / kBins - 1);
  edges.front() = -1;
  edges.back() = 1;
  return edges;
}

/// Mass of exp(-bandwidth t^2) between two points, without cancellation.
double gaussian_mass(double bandwidth, double from, double to) {
  if (to <= from) return 0;
  const double root = std::sqrt(bandwidth);
  if (root < 1e-6) return to - from;
  if (from > 0)
    return std::sqrt(kPi<double>) / (2 * root) * (std::erfc(root * from) - std::erfc(root * to));
  if (to < 0) return gaussian_mass(bandwidth, -to, -from);
  return std::sqrt(kPi<double>) / (2 * root) * (std::erf(root * to) - std::erf(root * from));
}

/// Share of a lobe whose local x and y lie in each bin: x in closed form, y by Gauss-Legendre over
/// its bin's angle. Independent of the azimuth that the sampler inverts. Kinks where the disc's
/// edge crosses a bin's leave 1e-5.
std::vector<double> expected_shares(double bandwidth_x, double bandwidth_y) {
  const auto x_edges = bin_edges(bandwidth_x), y_edges = bin_edges(bandwidth_y);
  std::vector<double> shares(kBins * kBins, 0.0);
  double whole = 0;
  for (int j = 0; j < kBins; ++j) {
    // The outermost bins reach to the edge of the disc, of which a narrow lobe sees nothing.
    const double far = bandwidth_y > 100 ? 7 / std::sqrt(bandwidth_y) : 1.0;
    const double from = std::asin(std::max(y_edges[j], -far));
    const double to = std::asin(std::min(y_edges[j + 1], far));
    for (const auto& [angle, weight] : test::gauss_legendre(100, from, to)) {
      const double y = std::sin(angle), chord = std::cos(angle);
      const double density = weight * chord * std::exp(-bandwidth_y * y * y);
      for (int i = 0; i < kBins; ++i) {
        const double mass = density * gaussian_mass(bandwidth_x, std::max(x_edges[i], -chord),
                                                    std::min(x_edges[i + 1], chord));
        shares[j * kBins + i] += mass;
        whole += mass;
      }
    }
  }
  for (double& share : shares) share /= whole;
  return shares;
}

struct Shape {
  double bandwidth_x, bandwidth_y;
};
const Shape kShapes[] = {{1e-8, 1e-8}, {0, 0},     {1, 1},     {0.5, 20}, {100, 0.01},
                         {1e6, 1},     {1e4, 1e4}, {1e2, 1e8}, {40, 4},   {300, 0}};

TYPED_TEST(AsgSampling, FollowsTheLobe) {
  using T = TypeParam;
  constexpr unsigned kSeed = 17;
  // Twenty tests in two types: a false alarm in one run of ten thousand.
  const double level = test::sidak_level(1e-4, 2 * std::size(kShapes));
  for (const Shape& shape : kShapes) {
    // Narrow lobes are cheap to sample, wide ones are not.
    const int samples = std::min(shape.bandwidth_x, shape.bandwidth_y) > 40 ? 200000 : 50000;
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<T> uniform(0, 1);
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(shape.bandwidth_x);
    lobe.bandwidth_y = T(shape.bandwidth_y);
    const auto x_edges = bin_edges(shape.bandwidth_x), y_edges = bin_edges(shape.bandwidth_y);
    const auto bin = [](const std::vector<double>& edges, double value) {
      const auto at = std::upper_bound(edges.begin() + 1, edges.end() - 1, value);
      return at - edges.begin() - 1;
    };
    std::vector<double> observed(kBins * kBins, 0.0);
    for (int i = 0; i < samples; ++i) {
      const T u = uniform(random);
      const Vector3<T> v = sample(lobe, u, uniform(random));
      ++observed[bin(y_edges, v.y()) * kBins + bin(x_edges, v.x())];
    }
    std::vector<double> expected = expected_shares(shape.bandwidth_x, shape.bandwidth_y);
    for (double& share : expected) share *= samples;
    const test::ChiSquare result = test::chi_square(observed, expected);
    EXPECT_GT(result.p_value, level) << shape.bandwidth_x << " " << shape.bandwidth_y << " seed "
                                     << kSeed << " " << result.report("asg_sampling");
  }
}

/// Stated in asg_sampling.h.
template <class T>
constexpr double kDistributionError = std::is_same_v<T, float> ? 1.3e-6 : 5e-11;

/// Share of a lobe's quarter turn from x on that is at a smaller azimuth than (x, y). By quadrature
/// over the angle psi with tan(psi) = tan(azimuth) sqrt((bandwidth_y + 1) / (bandwidth_x + 1)), in
/// which long lobes are smooth (not the subject's angle, and 1280 points: rounding only).
double quarter_share(double bandwidth_x, double bandwidth_y, double x, double y) {
  static const auto rule = test::gauss_legendre(20, 0, 1);
  const double squeeze = std::sqrt((bandwidth_y + 1) / (bandwidth_x + 1));
  constexpr int kPanels = 64;
  const auto mass_up_to = [&](double end) {
    double sum = 0;
    for (int panel = 0; panel < kPanels; ++panel) {
      for (const auto& [t, weight] : rule) {
        const double psi = end / kPanels * (panel + t);
        const double c = squeeze * std::cos(psi), s = std::sin(psi), square = c * c + s * s;
        sum += weight / square *
               one_minus_exp_over(bandwidth_x * c * c / square + bandwidth_y * s * s / square);
      }
    }
    return sum * end;
  };
  return mass_up_to(std::atan2(squeeze * y, x)) / mass_up_to(kPi<double> / 2);
}

TYPED_TEST(AsgSampling, InvertsTheDistributionOfLongLobesToItsStatedError) {
  using T = TypeParam;
  // The worst shapes, at which the rule has the fewest digits, and some ordinary ones.
  for (const Shape& shape : {Shape{1e8, 0.1}, {1e3, 0}, {1e4, 1e-8}, {1e6, 3}, {100, 16}, {2, 1}}) {
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(shape.bandwidth_x);
    lobe.bandwidth_y = T(shape.bandwidth_y);
    for (int i = 1; i < 64; ++i) {
      const Vector3<T> v = sample(lobe, T(i) / 256, T(0.5));
      EXPECT_NEAR(quarter_share(lobe.bandwidth_x, lobe.bandwidth_y, v.x(), v.y()), i / 64.0,
                  kDistributionError<T>)
          << shape.bandwidth_x << " " << shape.bandwidth_y << " " << i;
    }
  }
}

TYPED_TEST(AsgSampling, TheAzimuthRunsFromTheLargerBandwidthToTheOther) {
  using T = TypeParam;
  for (const auto& [bx, by] : {std::pair{20, 2}, {2, 20}, {400, 50}, {50, 400}}) {
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(bx);
    lobe.bandwidth_y = T(by);
    const auto narrow_and_wide = [&, x_is_narrow = bx > by](double u) {
      const Vector3<T> v = sample(lobe, T(u), T(0.5));
      return x_is_narrow ? Vector2<T>(v.x(), v.y()) : Vector2<T>(v.y(), v.x());
    };
    const T tolerance = 8 * std::numeric_limits<T>::epsilon();
    EXPECT_GT(narrow_and_wide(0).x(), 0);
    EXPECT_NEAR(narrow_and_wide(0).y(), 0, tolerance);
    EXPECT_NEAR(narrow_and_wide(0.25).x(), 0, tolerance);
    EXPECT_GT(narrow_and_wide(0.25).y(), 0);
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Vector2<T> v = narrow_and_wide(0.125 + 0.25 * quarter);
      EXPECT_EQ(v.x() > 0, quarter == 0 || quarter == 3) << bx << " " << by << " " << quarter;
      EXPECT_EQ(v.y() > 0, quarter < 2) << bx << " " << by << " " << quarter;
    }
  }
}

TYPED_TEST(AsgSampling, InvertsTheAzimuthsDistribution) {
  using T = TypeParam;
  // Equal steps of u hold equal shares of the lobe: in a sector between two sampled azimuths, by
  // quadrature of (1 - e^-k) / (2 k) over the angle.
  const double tolerance = 2 * kDistributionError<T>;  // at the sector's two ends
  static const auto rule = test::gauss_legendre(60, 0, 1);
  for (const Shape& shape : {Shape{0, 0}, {1, 1}, {3, 0.2}, {30, 2}, {60, 40}, {9, 9}}) {
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(shape.bandwidth_x);
    lobe.bandwidth_y = T(shape.bandwidth_y);
    const double whole = asg_integral_exact(shape.bandwidth_x, shape.bandwidth_y);
    double from = 0;
    for (int i = 1; i <= 16; ++i) {
      const Vector3<T> v = sample(lobe, T(T(i) / 16), T(0.5));
      double to = std::atan2(double(v.y()), double(v.x()));
      if (to < from - 1e-3) to += 2 * kPi<double>;
      double share = 0;
      for (const auto& [t, weight] : rule) {
        const double angle = from + (to - from) * t;
        const double k = shape.bandwidth_x * std::pow(std::cos(angle), 2) +
                         shape.bandwidth_y * std::pow(std::sin(angle), 2);
        share += weight * (to - from) * one_minus_exp_over(k) / 2;
      }
      EXPECT_NEAR(share / whole, 1.0 / 16, tolerance)
          << shape.bandwidth_x << " " << shape.bandwidth_y << " sector " << i;
      from = to;
    }
  }
}

TYPED_TEST(AsgSampling, AnyNumbersGiveUnitDirectionsWhereTheLobeIs) {
  using T = TypeParam;
  const T eps = std::numeric_limits<T>::epsilon();
  const T extremes[] = {0,      std::numeric_limits<T>::denorm_min(), T(1e-8), T(1e-3), 1, T(1e3),
                        T(1e8), std::numeric_limits<T>::max()};
  const T numbers[] = {0, std::numeric_limits<T>::denorm_min(), eps, T(0.25), T(0.5), 1 - eps, 1};
  std::mt19937 random(5);
  const Frame<T> frame =
      test::random_frame(test::random_direction(random), random).template cast<T>();
  for (const T bx : extremes) {
    for (const T by : extremes) {
      AnisotropicGaussian<T> lobe{frame, bx, by, T(1)};
      const T peak = pdf(lobe, frame.z);
      EXPECT_TRUE(std::isfinite(peak) && peak >= 1 / (kPi<T> * (1 + 8 * eps))) << bx << " " << by;
      for (const T u : numbers) {
        for (const T v : numbers) {
          const Vector3<T> direction = sample(lobe, T(u), T(v));
          // The frame's own rounding and three products.
          EXPECT_NEAR(direction.norm(), 1, 16 * eps) << bx << " " << by << " " << u << " " << v;
          EXPECT_GE(direction.dot(frame.z), -8 * eps) << bx << " " << by << " " << u << " " << v;
        }
      }
    }
  }
}

TYPED_TEST(AsgSampling, PdfIntegratesToOneWhateverTheAmplitude) {
  using T = TypeParam;
  for (const Shape& shape : {Shape{0, 0}, {1, 1}, {30, 0.5}}) {
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(shape.bandwidth_x);
    lobe.bandwidth_y = T(shape.bandwidth_y);
    lobe.amplitude = 7;
    const double whole = test::integrate_sphere(
        [&](const Vector3d& v) { return double(pdf(lobe, Vector3<T>(v.cast<T>()))); },
        Vector3d::UnitZ(), 48);
    // The rule's own error at the horizon's kink is below float's rounding and at double's 1e-10.
    const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-10;
    EXPECT_NEAR(whole, 1, tolerance);
  }
}

TYPED_TEST(AsgSampling, IsContinuousInItsNumbers) {
  using T = TypeParam;
  // Stratified and quasi-random points keep their distances: across the seams of the quarter turns,
  // a step of 1e-4 in u moves the direction by no more than a few steps.
  for (const Shape& shape : kShapes) {
    AnisotropicGaussian<T> lobe;
    lobe.bandwidth_x = T(shape.bandwidth_x);
    lobe.bandwidth_y = T(shape.bandwidth_y);
    for (const T seam : {T(0), T(0.25), T(0.5), T(0.75)}) {
      const T before = seam == 0 ? T(1) - T(1e-4) : seam - T(1e-4);
      const Vector3<T> a = sample(lobe, before, T(0.9));
      const Vector3<T> b = sample(lobe, seam, T(0.9));
      EXPECT_LT((a - b).norm(), 2e-3) << shape.bandwidth_x << " " << shape.bandwidth_y;
    }
  }
}

}  // namespace
}  // namespace burnish
