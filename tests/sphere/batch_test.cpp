#include "burnish/sphere/batch.h"

#include <functional>
#include <limits>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "burnish/sphere/asg_convolution.h"
#include "burnish/sphere/asg_product.h"
#include "support/quadrature.h"

// Every test runs on each instruction set that this processor has.

namespace burnish {
namespace {

constexpr unsigned kSeed = 20;
constexpr float kMax = std::numeric_limits<float>::max();
constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
constexpr double kDotError = 2e-7;  // of unit vectors: three roundings of terms of at most 1
const std::vector<float> kExtremes = {0, kDenormal, 1e-8f, 1e-3f, 1, 1e3f, 1e8f, kMax};

/// Restores the best instruction set whatever happens.
class Batch : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(batch::use_instruction_set(GetParam())); }
  void TearDown() override { batch::use_instruction_set(""); }
};

std::vector<std::string> sets() {
  const auto views = batch::instruction_sets();
  return {views.begin(), views.end()};
}
INSTANTIATE_TEST_SUITE_P(On, Batch, testing::ValuesIn(sets()),
                         [](const auto& info) { return info.param; });

/// Numbers of every magnitude, and the extremes.
std::vector<float> magnitudes(int count, std::mt19937& random) {
  std::uniform_real_distribution<float> exponent(-10, 10);
  std::vector<float> values = kExtremes;
  for (int i = 0; i < count; ++i) values.push_back(std::pow(10.0f, exponent(random)));
  return values;
}

struct DirectionArrays {
  std::vector<float> x, y, z;
  batch::Directions spans() const { return {x, y, z}; }
  Vector3f at(size_t i) const { return {x[i], y[i], z[i]}; }
  void add(const Vector3d& v) {
    x.push_back(float(v.x()));
    y.push_back(float(v.y()));
    z.push_back(float(v.z()));
  }
};

/// Directions all over the sphere, and close to an axis and to its opposite.
DirectionArrays directions_around(const Vector3d& axis, int count, std::mt19937& random) {
  DirectionArrays directions;
  for (int i = 0; i < count; ++i) directions.add(test::random_direction(random));
  for (const double sign : {1.0, -1.0}) {
    directions.add(sign * axis);
    for (double distance = 1e-7; distance < 1; distance *= 3)
      directions.add((sign * axis + distance * test::random_direction(random)).normalized());
  }
  return directions;
}

TEST_P(Batch, ExpMatchesTheStandardLibrary) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-84.9f, 88);
  std::vector<float> x = {0, -0.0f, kDenormal, -kDenormal, 1e-8f, -1e-8f, 88, -84.9f};
  for (int i = 0; i < 20000; ++i) x.push_back(uniform(random));
  std::vector<float> results(x.size());
  batch::exp(x, results);
  double worst = 0;
  for (size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, std::abs(results[i] / std::exp(double(x[i])) - 1));
  // A last place is 2^-23 = 1.2e-7; the polynomial, the reduced argument and the result each round.
  EXPECT_LT(worst, 2e-7);
  const std::vector<float> far = {-85.1f, -1e4f, -kMax, -std::numeric_limits<float>::infinity()};
  std::vector<float> zeros(far.size(), 1);
  batch::exp(far, zeros);
  for (const float value : zeros) EXPECT_EQ(value, 0);
}

TEST_P(Batch, SphericalGaussianMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const float sharpness : magnitudes(20, random)) {
    const Vector3d axis = test::random_direction(random);
    const SphericalGaussian<float> lobe = {axis.cast<float>(), sharpness, 3};
    const DirectionArrays directions = directions_around(axis, 50, random);
    std::vector<float> results(directions.x.size());
    batch::eval(lobe, directions.spans(), results);
    for (size_t i = 0; i < results.size(); ++i) {
      const Vector3d v = directions.at(i).cast<double>(), p = lobe.axis.cast<double>();
      const double exponent = double(sharpness) / 2 * (v - p).squaredNorm();
      // Three roundings in the square of each difference, and those of exp; 0 below its range.
      const double bound = 3 * std::exp(-exponent) * (3e-7 + 4e-7 * exponent) + 3 * 1.4e-37;
      ASSERT_NEAR(results[i], 3 * std::exp(-exponent), bound) << sharpness << ", seed " << kSeed;
    }
  }
}

/// The value in double of a float lobe, and the error of a float evaluation: each dot product
/// errs by three roundings of terms of at most 1.
std::pair<double, double> asg_and_bound(const AnisotropicGaussian<float>& lobe, const Vector3f& v) {
  const Vector3d local = lobe.frame.cast<double>().to_local(v.cast<double>());
  const double bx = lobe.bandwidth_x, by = lobe.bandwidth_y, kDot = 3 * 6e-8 * 1.5;
  const double ex = bx * local.x() * local.x(), ey = by * local.y() * local.y();
  const double slack = 2 * kDot * (std::sqrt(ex * bx) + std::sqrt(ey * by)) +
                       kDot * kDot * (bx + by) + 4e-7 * (ex + ey);
  const double low = std::exp(-std::min(ex + ey + slack, 700.0)),
               high = std::exp(-std::max(ex + ey - slack, 0.0));
  const double z = std::max(local.z(), 0.0), value = z * std::exp(-(ex + ey));
  const double bound = std::max((z + kDot) * high - value, value - (z - kDot) * low);
  return {lobe.amplitude * value, std::abs(lobe.amplitude) * (bound + 3e-7 * value + 1.4e-37)};
}

TEST_P(Batch, AnisotropicGaussianMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const float bandwidth_x : magnitudes(10, random)) {
    for (const float bandwidth_y : kExtremes) {
      const Vector3d axis = test::random_direction(random);
      const AnisotropicGaussian<float> lobe = {test::random_frame(axis, random).cast<float>(),
                                               bandwidth_x, bandwidth_y, -2};
      const DirectionArrays directions = directions_around(axis, 20, random);
      std::vector<float> results(directions.x.size());
      batch::eval(lobe, directions.spans(), results);
      for (size_t i = 0; i < results.size(); ++i) {
        const auto [value, bound] = asg_and_bound(lobe, directions.at(i));
        ASSERT_NEAR(results[i], value, bound)
            << bandwidth_x << " " << bandwidth_y << ", seed " << kSeed;
      }
    }
  }
}

TEST_P(Batch, ManyLobesAreTheSameAsOneByOne) {
  std::mt19937 random(kSeed);
  DirectionArrays directions;
  for (int i = 0; i < 1500; ++i) directions.add(test::random_direction(random));
  const size_t size = directions.x.size();
  std::vector<AnisotropicGaussian<float>> asgs(3);
  std::vector<SphericalGaussian<float>> sgs(3);
  for (size_t l = 0; l < 3; ++l) {
    const Vector3d axis = test::random_direction(random);
    asgs[l] = {test::random_frame(axis, random).cast<float>(), 20, float(l), 1};
    sgs[l] = {axis.cast<float>(), float(l), 1};
  }
  std::vector<float> all(3 * size), one(size);
  batch::eval(asgs, directions.spans(), all);
  for (size_t l = 0; l < 3; ++l) {
    batch::eval(asgs[l], directions.spans(), one);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + l * size));
  }
  batch::eval(sgs, directions.spans(), all);
  for (size_t l = 0; l < 3; ++l) {
    batch::eval(sgs[l], directions.spans(), one);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + l * size));
  }
}

TEST_P(Batch, AsgIntegralMatchesTheExactFormInDouble) {
  std::mt19937 random(kSeed);
  std::vector<float> bx, by;
  for (const float x : magnitudes(40, random)) {
    for (const float y : magnitudes(10, random)) {
      bx.push_back(x);
      by.push_back(y);
    }
    for (const float ratio : {1.0f, 1 + 1e-7f, 10.0f, 1e6f}) {
      bx.push_back(x);
      by.push_back(x / ratio);
    }
  }
  std::vector<float> exact(bx.size()), fast(bx.size());
  batch::asg_integral(bx, by, AsgIntegral::exact, exact);
  batch::asg_integral(bx, by, AsgIntegral::fast, fast);
  for (size_t i = 0; i < bx.size(); ++i) {
    const double truth = asg_integral_exact(double(bx[i]), double(by[i]));
    // 7 midpoints err by 2e-7; a dozen roundings of positive terms.
    ASSERT_NEAR(exact[i] / truth, 1, 1e-6) << bx[i] << " " << by[i] << ", seed " << kSeed;
    const double quick = asg_integral_fast(double(bx[i]), double(by[i]));
    ASSERT_NEAR(fast[i] / quick, 1, 4e-7) << bx[i] << " " << by[i];
  }
}

/// Runs a visibility fraction over widths and distances; compares with the scalar form in double.
void expect_fractions(const std::function<void(std::span<const float>, std::span<const float>,
                                               std::span<float>)>& subject,
                      const std::function<double(double, double)>& scalar) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-1.6f, 1.6f);
  std::vector<float> widths, distances;
  for (const float width : magnitudes(300, random)) {
    for (float distance : {0.0f, 1e-7f, 1e-4f, 1.57079f, 1.5708f, 3.14159f, uniform(random),
                           uniform(random), uniform(random) / std::sqrt(1 + width)}) {
      for (const float sign : {1.0f, -1.0f}) {
        widths.push_back(width);
        distances.push_back(sign * distance);
      }
    }
  }
  std::vector<float> results(widths.size());
  subject(widths, distances, results);
  for (size_t i = 0; i < widths.size(); ++i) {
    const double truth = scalar(widths[i], distances[i]);
    ASSERT_NEAR(results[i], truth, 1e-6) << widths[i] << " " << distances[i] << ", seed " << kSeed;
    // The tail's exponent is at most 81; five roundings of its root.
    if (distances[i] < 0 && distances[i] > -1.5f && truth > 1e-35) {
      ASSERT_NEAR(results[i] / truth, 1, 81 * 2 * 5 * 6e-8 + 1e-6)
          << widths[i] << " " << distances[i] << ", seed " << kSeed;
    }
  }
}

TEST_P(Batch, DirectionalMatchesTheScalarForm) {
  expect_fractions(
      [](auto widths, auto distances, auto results) {
        batch::visible_fraction_directional(widths, distances, results);
      },
      [](double width, double distance) { return visible_fraction_directional(width, distance); });
}

TEST_P(Batch, HemisphereMatchesTheScalarForm) {
  expect_fractions(
      [](auto widths, auto distances, auto results) {
        batch::visible_fraction_hemisphere(widths, distances, results);
      },
      [](double width, double distance) { return visible_fraction_hemisphere(width, distance); });
}

TEST_P(Batch, ExactHemisphereMatchesTheScalarForm) {
  expect_fractions(
      [](auto widths, auto distances, auto results) {
        batch::visible_fraction_hemisphere(widths, distances, results, HemisphereLevel::exact);
      },
      [](double width, double distance) {
        return visible_fraction_hemisphere(width, distance, HemisphereLevel::exact);
      });
}

TEST_P(Batch, SgIntegralMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  const std::vector<float> sharpness = magnitudes(500, random);
  std::vector<float> results(sharpness.size());
  batch::sg_integral(sharpness, results);
  for (size_t i = 0; i < results.size(); ++i) {
    const double truth = integral(SphericalGaussian<double>{Vector3d::UnitZ(), sharpness[i], 1});
    // Five roundings; a denormal result (of the largest finite sharpness) has fewer digits.
    ASSERT_NEAR(results[i], truth, 6e-7 * truth + kDenormal) << sharpness[i] << ", seed " << kSeed;
  }
}

TEST_P(Batch, SgInnerProductMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const float sharpness : magnitudes(10, random)) {
    const Vector3d axis = test::random_direction(random);
    const SphericalGaussian<float> lobe = {axis.cast<float>(), sharpness, 2};
    for (const float other : magnitudes(10, random)) {
      const DirectionArrays axes = directions_around(axis, 20, random);
      const size_t size = axes.x.size();
      const std::vector<float> others(size, other), amplitudes(size, 3);
      std::vector<float> results(size);
      batch::inner_product(lobe, {axes.spans(), others, amplitudes}, results);
      for (size_t i = 0; i < size; ++i) {
        const SphericalGaussian<double> a = {lobe.axis.cast<double>(), sharpness, 2};
        const SphericalGaussian<double> b = {axes.at(i).cast<double>(), other, 3};
        const double truth = inner_product(a, b);
        const double low = std::min(a.sharpness, b.sharpness);
        const double exponent = low / 2 * (a.axis - b.axis).squaredNorm();  // or less, by half
        // Near opposite axes of like sharpness, the product's sharpness L errs by 1e-7 of theirs,
        // and its mass by 1e-7 low / (L + 1), besides the roundings of mass and exponential.
        const double sharp = product(a, b).sharpness;
        const double bound =
            truth * (1e-6 + 1e-6 * exponent + 6e-7 * low / (sharp + 1)) + 6 * 4 * 3.2 * 1.4e-37;
        ASSERT_NEAR(results[i], truth, bound)
            << sharpness << " " << other << " " << exponent << ", seed " << kSeed;
      }
    }
  }
}

TEST_P(Batch, AsgInnerProductMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const auto& [bx, by] : {std::pair{0.0f, 0.0f},
                               {1e-3f, 1e-8f},
                               {10.0f, 1.0f},
                               {300.0f, 3.0f},
                               {1e8f, 1.0f},
                               {1e16f, 1.0f},
                               {kMax, 1.0f},
                               {kMax, kMax}}) {
    const Vector3d axis = test::random_direction(random);
    const Frame<float> frame = test::random_frame(axis, random).cast<float>();
    const AnisotropicGaussian<float> lobe = {frame, bx, by, 2};
    DirectionArrays x, z;
    std::vector<float> bandwidth_x, bandwidth_y, amplitude;
    std::vector<AnisotropicGaussian<float>> others;
    const DirectionArrays axes = directions_around(axis, 50, random);
    for (size_t i = 0; i < axes.x.size(); ++i) {
      const Frame<double> other =
          test::random_frame(axes.at(i).cast<double>().normalized(), random);
      x.add(other.x);
      z.add(other.z);
      bandwidth_x.push_back(i % 3 == 0 ? 0 : i % 3 == 1 ? 5 : 200);
      bandwidth_y.push_back(i % 5 == 0 ? 1e-3f : 20);
      amplitude.push_back(3);
      others.push_back(
          {{x.at(i), z.at(i).cross(x.at(i)), z.at(i)}, bandwidth_x[i], bandwidth_y[i], 3});
    }
    std::vector<float> results(others.size());
    batch::inner_product(lobe, {x.spans(), z.spans(), bandwidth_x, bandwidth_y, amplitude},
                         results);
    for (size_t i = 0; i < others.size(); ++i) {
      const auto in_double = [](const AnisotropicGaussian<float>& a) {
        return AnisotropicGaussian<double>{a.frame.cast<double>(), a.bandwidth_x, a.bandwidth_y,
                                           a.amplitude};
      };
      const double truth = inner_product_closed_form(in_double(lobe), in_double(others[i]));
      // A dot product errs by 2e-7; the exponent is at most the smaller lobe's, its bandwidth 200.
      // The smooth factor errs by as much, absolutely, in each of its two terms; without it, the
      // product integrates to less than either lobe.
      const double relative = 1e-5 + 2 * 200 * kDotError;
      const double largest =
          6 * std::min(asg_integral_exact<double>(bx, by),
                       asg_integral_exact<double>(bandwidth_x[i], bandwidth_y[i]));
      // Bandwidths whose products are below the range of floats leave the magnitude only.
      const double absolute = bx / by > 1e30f ? 1 : 2 * kDotError;
      EXPECT_NEAR(results[i], truth, relative * truth + largest * absolute)
          << bx << " " << by << " " << bandwidth_x[i] << " " << bandwidth_y[i] << ", seed "
          << kSeed;
      EXPECT_GE(results[i], 0);
    }
  }
}

TEST_P(Batch, DotMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  DirectionArrays directions;
  for (int i = 0; i < 1000; ++i) directions.add(test::random_direction(random));
  const Vector3f vector = test::random_direction(random).cast<float>();
  std::vector<float> results(1000);
  batch::dot(vector, directions.spans(), results);
  for (size_t i = 0; i < 1000; ++i)
    // Three roundings of at most half of 2^-23 each.
    ASSERT_NEAR(results[i], vector.cast<double>().dot(directions.at(i).cast<double>()), 1.8e-7);
}

TEST_P(Batch, DirectionalBandwidthMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  std::vector<float> bx, by, gx, gy;
  for (const float x : magnitudes(20, random)) {
    for (const float y : magnitudes(5, random)) {
      for (const auto& [u, v] :
           {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, -3.0f}, {0.6f, 0.8f}, {1e-3f, 1.0f}}) {
        bx.push_back(x);
        by.push_back(y);
        gx.push_back(u);
        gy.push_back(v);
      }
    }
  }
  std::vector<float> results(bx.size());
  batch::directional_bandwidth(bx, by, gx, gy, results);
  for (size_t i = 0; i < bx.size(); ++i) {
    const AnisotropicGaussian<double> lobe = {{}, bx[i], by[i], 1};
    const double truth = directional_bandwidth(lobe, Vector3d(gx[i], gy[i], 0));
    // A dozen roundings; the difference of two inverses near 1 rounds absolutely. Denormals and
    // the ratio to the largest finite number have fewer digits.
    ASSERT_NEAR(results[i], truth, 1.5e-6 * truth + 1e-7)
        << bx[i] << " " << by[i] << " " << gx[i] << " " << gy[i] << ", seed " << kSeed;
  }
}

TEST_P(Batch, LobesEachAtItsDirectionMatchTheScalarForm) {
  std::mt19937 random(kSeed);
  const std::vector<float> widths = magnitudes(500, random);
  DirectionArrays x, z, directions;
  std::vector<AnisotropicGaussian<float>> lobes;
  std::vector<float> bandwidth_x, bandwidth_y, amplitude;
  for (const float width : widths) {
    const Vector3d axis = test::random_direction(random);
    const Frame<double> frame = test::random_frame(axis, random);
    x.add(frame.x);
    z.add(frame.z);
    directions.add(
        (axis + test::random_direction(random) / std::sqrt(1 + double(width))).normalized());
    bandwidth_x.push_back(width);
    bandwidth_y.push_back(widths[bandwidth_y.size() * 7 % widths.size()]);
    amplitude.push_back(float(bandwidth_y.size()));
    lobes.push_back({{x.at(x.x.size() - 1), z.at(z.x.size() - 1).cross(x.at(x.x.size() - 1)),
                      z.at(z.x.size() - 1)},
                     bandwidth_x.back(),
                     bandwidth_y.back(),
                     amplitude.back()});
  }
  std::vector<float> results(widths.size());
  batch::eval({x.spans(), z.spans(), bandwidth_x, bandwidth_y, amplitude}, directions.spans(),
              results);
  for (size_t i = 0; i < results.size(); ++i) {
    const auto [value, bound] = asg_and_bound(lobes[i], directions.at(i));
    // y = z x x is rounded once more here.
    ASSERT_NEAR(results[i], value, 2 * bound)
        << bandwidth_x[i] << " " << bandwidth_y[i] << ", seed " << kSeed;
  }
}

TEST_P(Batch, MeanClampedCosineMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const auto& [x, y] : {std::pair{0.0, 0.0},
                             {1e-3, 1e-3},
                             {4.0, 1.0},
                             {100.0, 1.0},
                             {1e3, 1e3},
                             {1e8, 1.0},
                             {1e8, 1e8}}) {
    const Vector3d axis = test::random_direction(random);
    const Frame<float> frame = test::random_frame(axis, random).cast<float>();
    const LobeMoments<float> moments = asg_moments(float(x), float(y));
    DirectionArrays normals = directions_around(axis, 300, random);
    // Where the cosine is cut: near the lobe's horizon.
    for (int i = 0; i < 200; ++i) {
      const Vector3d across = axis.cross(test::random_direction(random)).normalized();
      normals.add((across + test::random_direction(random) * std::pow(10.0, -i % 6)).normalized());
    }
    std::vector<float> results(normals.x.size());
    batch::mean_clamped_cosine(moments, frame, normals.spans(), results);
    for (size_t i = 0; i < results.size(); ++i) {
      const Vector3d local = frame.cast<double>().to_local(normals.at(i).cast<double>());
      const double truth = mean_clamped_cosine(moments.cast<double>(), local);
      // A sum of a dozen terms of at most 1, each after three roundings of a dot product.
      ASSERT_NEAR(results[i], truth, 2e-6) << x << " " << y << ", seed " << kSeed;
      ASSERT_GE(results[i], 0);
    }
  }
}

TEST_P(Batch, ClampedCosineIntegralMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const float sharpness : magnitudes(30, random)) {
    const Vector3d axis = test::random_direction(random);
    const PreparedClampedCosine<float> lobe =
        prepare_clamped_cosine(SphericalGaussian<float>{axis.cast<float>(), sharpness, 3});
    const PreparedClampedCosine<double> in_double = {lobe.axis.cast<double>(),
                                                     lobe.slope,
                                                     lobe.bump,
                                                     lobe.spread,
                                                     lobe.end,
                                                     lobe.behind,
                                                     lobe.mean};
    DirectionArrays normals = directions_around(axis, 200, random);
    // Where the horizon cuts the lobe.
    for (int i = 0; i < 100; ++i) {
      const Vector3d across = axis.cross(test::random_direction(random)).normalized();
      normals.add((across + test::random_direction(random) * std::pow(10.0, -i % 6)).normalized());
    }
    std::vector<float> results(normals.x.size());
    batch::clamped_cosine_integral(lobe, normals.spans(), results);
    for (size_t i = 0; i < results.size(); ++i) {
      const double truth =
          clamped_cosine_integral(in_double, Vector3d(normals.at(i).cast<double>()));
      // Three roundings of the dot product, and a few of terms of at most 1/2.
      const double highest = double(lobe.behind) + lobe.mean;
      ASSERT_NEAR(results[i], truth, 6e-7 * highest) << sharpness << ", seed " << kSeed;
      ASSERT_GE(results[i], 0);
    }
  }
}

TEST_P(Batch, ConvolutionMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  std::vector<float> bandwidths_x, bandwidths_y, kernels;
  for (const float x : magnitudes(20, random)) {
    for (const float y : magnitudes(5, random)) {
      for (const float sharpness : magnitudes(3, random)) {
        bandwidths_x.push_back(x);
        bandwidths_y.push_back(y);
        kernels.push_back(sharpness);
      }
    }
  }
  const size_t size = kernels.size();
  std::vector<float> x(size), y(size), amplitude(size);
  const auto expect_near = [&](size_t i) {
    const AnisotropicGaussian<double> lobe = {{}, bandwidths_x[i], bandwidths_y[i], 1};
    const auto truth = convolve(lobe, SphericalGaussian<double>{Vector3d::UnitZ(), kernels[i], 1});
    // Four roundings; those of the integral; denormals have fewer digits.
    const double kLeast = 4 * double(kDenormal);
    EXPECT_NEAR(x[i], truth.bandwidth_x, 4 * 6e-8 * truth.bandwidth_x + kLeast);
    EXPECT_NEAR(y[i], truth.bandwidth_y, 4 * 6e-8 * truth.bandwidth_y + kLeast);
    // Where a sum overflows, the form integrates the largest finite number.
    const auto sum = [&](double bandwidth) {
      return std::min(bandwidth + double(kernels[i]) / 2, double(kMax));
    };
    const double whole = asg_integral_exact(sum(bandwidths_x[i]), sum(bandwidths_y[i]));
    EXPECT_NEAR(amplitude[i], whole, 1e-6 * whole + kLeast);
    EXPECT_LE(truth.amplitude, whole * (1 + 1e-12));
  };
  batch::convolve(bandwidths_x, bandwidths_y, kernels, {x, y, amplitude});
  for (size_t i = 0; i < size; ++i) {
    expect_near(i);
    ASSERT_FALSE(HasFailure()) << bandwidths_x[i] << " " << bandwidths_y[i] << " " << kernels[i]
                               << ", seed " << kSeed;
  }
  for (const float sharpness : kExtremes) {
    kernels.assign(size, sharpness);
    batch::convolve(bandwidths_x, bandwidths_y, sharpness, {x, y, amplitude});
    for (size_t i = 0; i < size; ++i) expect_near(i);
    ASSERT_FALSE(HasFailure()) << sharpness << ", seed " << kSeed;
  }
}

/// Owns what batch::WarpedLobes points to.
struct WarpedArrays {
  explicit WarpedArrays(size_t size) : all(10, std::vector<float>(size)) {}
  batch::WarpedLobes spans() {
    return {{all[0], all[1], all[2]}, {all[3], all[4], all[5]}, all[6], all[7], all[8], all[9]};
  }
  WarpedLobe<double> at(size_t i) const {
    const Vector3d x(all[0][i], all[1][i], all[2][i]), z(all[3][i], all[4][i], all[5][i]);
    return {{{x, z.cross(x), z}, all[6][i], all[7][i], all[8][i]}, all[9][i]};
  }
  std::vector<std::vector<float>> all;
};

/// The exponent's matrix: in contrast to the axes, it is well conditioned for round lobes, too.
Eigen::Matrix3d exponent_matrix(const AnisotropicGaussian<double>& lobe) {
  return lobe.bandwidth_x * lobe.frame.x * lobe.frame.x.transpose() +
         lobe.bandwidth_y * lobe.frame.y * lobe.frame.y.transpose();
}

/// Half-vector frames, and views of them: all over the sphere, near the axis, near the horizon.
struct Views {
  DirectionArrays x, z, outgoing;
  batch::Frames frames() const { return {x.spans(), z.spans()}; }
  Frame<double> frame(size_t i) const {
    const Vector3d fx = x.at(i).cast<double>(), fz = z.at(i).cast<double>();
    return {fx, fz.cross(fx), fz};
  }
  double cosine(size_t i) const {
    return z.at(i).cast<double>().dot(outgoing.at(i).cast<double>());
  }
};

Views random_views(std::mt19937& random) {
  Views views;
  for (int i = 0; i < 400; ++i) {
    const Vector3d axis = test::random_direction(random);
    const Frame<double> frame = test::random_frame(axis, random);
    const Vector3d noise = std::pow(10.0, -(i / 8) % 8) * test::random_direction(random);
    views.x.add(frame.x);
    views.z.add(axis);
    const Vector3d start = i % 4 == 0 ? axis : i % 4 == 1 ? frame.x : i % 4 == 2 ? frame.y : noise;
    views.outgoing.add((start + noise).normalized());
  }
  return views;
}

/// `relative`: of the bandwidths, and of the exponent's matrix for its larger bandwidth.
void expect_warped(const WarpedLobe<double>& warped, const WarpedLobe<double>& truth,
                   double axis_error, double relative) {
  EXPECT_NEAR((warped.lobe.frame.z - truth.lobe.frame.z).norm(), 0, axis_error);
  // Products of three numbers near 1, after as many roundings.
  EXPECT_NEAR(warped.lobe.frame.x.norm(), 1, 6e-7);
  EXPECT_NEAR(warped.lobe.frame.x.dot(warped.lobe.frame.z), 0, 6e-7);
  const auto held = [](double bandwidth) { return std::min(bandwidth, double(kMax)); };
  const double x = held(truth.lobe.bandwidth_x), y = truth.lobe.bandwidth_y;
  EXPECT_NEAR(warped.lobe.bandwidth_x, x, relative * x + 4 * double(kDenormal));
  EXPECT_NEAR(warped.lobe.bandwidth_y, y, relative * y + 4 * double(kDenormal));
  if (truth.lobe.bandwidth_x < kMax && x > 1e-30) {
    const Eigen::Matrix3d difference = exponent_matrix(warped.lobe) - exponent_matrix(truth.lobe);
    EXPECT_LT((difference / x).norm(), relative + axis_error);
  }
  EXPECT_NEAR(warped.jacobian, truth.jacobian, 4 * kDotError + 2.4e-7);
}

TEST_P(Batch, WarpMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  const Views views = random_views(random);
  const size_t size = views.x.x.size();
  WarpedArrays results(size), each(size);
  for (const float bandwidth_x : magnitudes(4, random)) {
    for (const float bandwidth_y : magnitudes(4, random)) {
      batch::warp_to_incoming(bandwidth_x, bandwidth_y, views.frames(), views.outgoing.spans(),
                              results.spans());
      const std::vector<float> bx(size, bandwidth_x), by(size, bandwidth_y), amplitude(size, 3);
      batch::warp_to_incoming({views.x.spans(), views.z.spans(), bx, by, amplitude},
                              views.outgoing.spans(), each.spans());
      for (size_t i = 0; i < size; ++i) {
        const WarpedLobe<double> truth = warp_to_incoming(
            AnisotropicGaussian<double>{views.frame(i), bandwidth_x, bandwidth_y, 1},
            Vector3d(views.outgoing.at(i).cast<double>()));
        // Bandwidths go by 1 / c^2, and those of a long lobe by an angle over c; ten roundings.
        const double c = std::max(views.cosine(i), kMinWarpCosine);
        expect_warped(results.at(i), truth, 2 * kDotError, 1.2e-6 + 4 * kDotError / c);
        if (std::abs(views.cosine(i)) > kDotError) {
          EXPECT_EQ(results.all[8][i], truth.lobe.amplitude);
        }
        EXPECT_EQ(each.all[8][i], 3 * results.all[8][i]);
        for (const size_t array : {0, 1, 2, 3, 4, 5, 6, 7, 9})
          EXPECT_EQ(each.all[array][i], results.all[array][i]);
        ASSERT_FALSE(HasFailure()) << bandwidth_x << " " << bandwidth_y << ", cosine "
                                   << views.cosine(i) << ", seed " << kSeed;
      }
    }
  }
}

TEST_P(Batch, MeanWarpMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  const Views views = random_views(random);
  const size_t size = views.x.x.size();
  WarpedArrays results(size);
  for (const auto& [bandwidth_x, bandwidth_y] : {std::pair{0.0f, 0.0f},
                                                 {kDenormal, 1e-8f},
                                                 {1e-3f, 1e-8f},
                                                 {1.0f, 1.0f},
                                                 {4.0f, 50.0f},
                                                 {800.0f, 8.0f},
                                                 {1e3f, 1e3f},
                                                 {1e8f, 1.0f},
                                                 {1e8f, 1e8f},
                                                 {kMax, 1e3f},
                                                 {kMax, kMax}}) {
    const LobeShape<float> shape = make_lobe_shape(bandwidth_x, bandwidth_y);
    const LobeShape<double> shape_in_double = {shape.integral, shape.moments.cast<double>(),
                                               shape.in_plane_cosine};
    batch::warp_mean_to_incoming(bandwidth_x, bandwidth_y, shape, views.frames(),
                                 views.outgoing.spans(), results.spans());
    for (size_t i = 0; i < size; ++i) {
      for (const std::vector<float>& array : results.all) ASSERT_TRUE(std::isfinite(array[i]));
      const Vector3d outgoing = views.outgoing.at(i).cast<double>();
      const WarpedLobe<double> truth = warp_mean_to_incoming(
          AnisotropicGaussian<double>{views.frame(i), bandwidth_x, bandwidth_y, 1}, shape_in_double,
          outgoing);
      const Vector3d o = views.frame(i).to_local(outgoing);
      const LobeMoments<double>& m = shape_in_double.moments;
      const double deviation = std::sqrt(o.x() * o.x() * m.mean_xx + o.y() * o.y() * m.mean_yy +
                                         o.z() * o.z() * m.variance_z);
      // Where most of the lobe is out of sight, the mean of what is left is a difference of numbers
      // 20 times as large at 4 deviations, and its mean square one of numbers 16 times as large.
      const double ratio = o.z() * m.mean_z / std::max(deviation, kDotError);
      const double cut = ratio < -2 ? 20 * 16 : ratio < -1 ? 20 : 4;
      // The view's azimuth, whose direction the form has even at the axis.
      const double azimuth = kDotError / std::max(std::hypot(o.x(), o.y()), kDotError);
      const double c = std::max(truth.jacobian / 4, kMinWarpCosine);
      const double relative = cut * 1.2e-6 + 4 * kDotError / c + 4 * azimuth;
      const double axis_error = 2 * kDotError + cut * kDotError;
      expect_warped(results.at(i), truth, axis_error, relative);
      if (truth.lobe.bandwidth_x < kMax) {
        const double scale = double(shape.integral) /
                             asg_integral_exact(truth.lobe.bandwidth_x, truth.lobe.bandwidth_y);
        EXPECT_NEAR(results.all[8][i], truth.lobe.amplitude,
                    scale * (4 * kDotError + 2.4e-7 + relative * truth.jacobian));
      }
      ASSERT_FALSE(HasFailure()) << bandwidth_x << " " << bandwidth_y << ", view " << o.transpose()
                                 << ", ratio " << ratio << ", seed " << kSeed;
    }
  }
}

TEST_P(Batch, OctahedralMapMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  DirectionArrays directions;
  for (int i = 0; i < 3000; ++i) directions.add(test::random_direction(random));
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
    directions.add(axis);
    directions.add(-axis);
    for (int i = 0; i < 30; ++i)
      directions.add((axis + test::random_direction(random) * std::pow(10.0, -i)).normalized());
  }
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0}) directions.add(Vector3d(x, y, 0).normalized());
  std::vector<float> u(directions.x.size()), v(directions.x.size());
  batch::direction_to_octahedral(directions.spans(), u, v);
  for (size_t i = 0; i < u.size(); ++i) {
    const Vector2<double> truth =
        direction_to_octahedral(Vector3d(directions.at(i).cast<double>()));
    // Three roundings of numbers of at most 1; both are halved.
    ASSERT_NEAR(u[i], truth.x(), 2e-7) << directions.at(i).transpose() << ", seed " << kSeed;
    ASSERT_NEAR(v[i], truth.y(), 2e-7) << directions.at(i).transpose() << ", seed " << kSeed;
  }
}

/// Calls on lengths 0..40, from unaligned starts: each element the same as in one long call, and
/// what surrounds the results untouched.
TEST_P(Batch, AnyLengthAndAlignmentGivesTheSame) {
  std::mt19937 random(kSeed);
  std::vector<float> a(64), b(64), c(64), whole(64);
  for (size_t i = 0; i < 64; ++i) {
    const Vector3d v = test::random_direction(random);
    a[i] = float(std::abs(v.x()));
    b[i] = float(std::abs(v.y()));
    c[i] = float(v.z());
  }
  const AnisotropicGaussian<float> asg = {{}, 5, 2, 1};
  const SphericalGaussian<float> sg;
  const LobeMoments<float> moments = asg_moments(5.0f, 2.0f);
  const LobeShape<float> shape = make_lobe_shape(20.0f, 80.0f);
  const PreparedClampedCosine<float> prepared = prepare_clamped_cosine(sg);
  using Span = std::span<const float>;
  using Call = std::function<void(Span, Span, Span, std::span<float>)>;
  std::vector<std::pair<const char*, Call>> calls = {
      {"exp", [](Span, Span, Span z, auto out) { batch::exp(z, out); }},
      {"sg",
       [&](Span x, Span y, Span z, auto out) {
         batch::eval(sg, {x, y, z}, out);
       }},
      {"asg",
       [&](Span x, Span y, Span z, auto out) {
         batch::eval(asg, {x, y, z}, out);
       }},
      {"fast integral",
       [](Span x, Span y, Span, auto out) { batch::asg_integral(x, y, AsgIntegral::fast, out); }},
      {"exact integral",
       [](Span x, Span y, Span, auto out) { batch::asg_integral(x, y, AsgIntegral::exact, out); }},
      {"directional",
       [](Span x, Span, Span z, auto out) { batch::visible_fraction_directional(x, z, out); }},
      {"hemisphere",
       [](Span x, Span, Span z, auto out) { batch::visible_fraction_hemisphere(x, z, out); }},
      {"exact hemisphere",
       [](Span x, Span, Span z, auto out) {
         batch::visible_fraction_hemisphere(x, z, out, HemisphereLevel::exact);
       }},
      {"SG integral", [](Span x, Span, Span, auto out) { batch::sg_integral(x, out); }},
      {"SG inner product",
       [&](Span x, Span y, Span z, auto out) {
         batch::inner_product(sg, {{x, y, z}, x, y}, out);
       }},
      {"pairs",
       [&](Span x, Span y, Span z, auto out) {
         batch::eval({{x, y, z}, {y, x, z}, x, y, y}, {x, y, z}, out);
       }},
      {"ASG inner product",
       [&](Span x, Span y, Span z, auto out) {
         batch::inner_product(asg, {{x, y, z}, {y, x, z}, x, y, y}, out);
       }},
      {"dot",
       [&](Span x, Span y, Span z, auto out) {
         batch::dot(Vector3f(1, 2, 3), {x, y, z}, out);
       }},
      {"directional bandwidth",
       [&](Span x, Span y, Span z, auto out) { batch::directional_bandwidth(x, y, z, x, out); }},
      {"clamped cosine",
       [&](Span x, Span y, Span z, auto out) {
         batch::mean_clamped_cosine(moments, Frame<float>(), {x, y, z}, out);
       }},
      {"clamped cosine of an SG",
       [&](Span x, Span y, Span z, auto out) {
         batch::clamped_cosine_integral(prepared, {x, y, z}, out);
       }},
      {"octahedral u",
       [&](Span x, Span y, Span z, auto out) {
         std::vector<float> v(out.size());
         batch::direction_to_octahedral({x, y, z}, out, v);
       }},
      {"octahedral v",
       [&](Span x, Span y, Span z, auto out) {
         std::vector<float> u(out.size());
         batch::direction_to_octahedral({x, y, z}, u, out);
       }},
  };
  // Of those with several results, each in its turn; the others are of the exact length.
  for (int result = 0; result < 3; ++result) {
    calls.push_back({"convolution", [result](Span x, Span y, Span, auto out) {
                       std::vector<float> rest[3];
                       for (auto& array : rest) array.resize(out.size());
                       std::span<float> all[3] = {rest[0], rest[1], rest[2]};
                       all[result] = out;
                       batch::convolve(x, y, 3, {all[0], all[1], all[2]});
                     }});
    calls.push_back({"convolution with each", [result](Span x, Span y, Span, auto out) {
                       std::vector<float> rest[3];
                       for (auto& array : rest) array.resize(out.size());
                       std::span<float> all[3] = {rest[0], rest[1], rest[2]};
                       all[result] = out;
                       batch::convolve(x, y, y, {all[0], all[1], all[2]});
                     }});
  }
  for (int result = 0; result < 10; ++result) {
    const auto with_results = [result](std::span<float> out, auto call) {
      WarpedArrays rest(out.size());
      std::vector<std::span<float>> all(rest.all.begin(), rest.all.end());
      all[result] = out;
      call({{all[0], all[1], all[2]}, {all[3], all[4], all[5]}, all[6], all[7], all[8], all[9]});
    };
    calls.push_back({"warp", [=](Span x, Span y, Span z, auto out) {
                       with_results(out, [&](const batch::WarpedLobes& all) {
                         batch::warp_to_incoming(5, 2, {{x, y, z}, {y, x, z}}, {z, y, x}, all);
                       });
                     }});
    calls.push_back({"warp of each", [=](Span x, Span y, Span z, auto out) {
                       with_results(out, [&](const batch::WarpedLobes& all) {
                         batch::warp_to_incoming({{x, y, z}, {y, x, z}, x, y, y}, {z, y, x}, all);
                       });
                     }});
    calls.push_back(
        {"mean warp", [=](Span x, Span y, Span z, auto out) {
           with_results(out, [&](const batch::WarpedLobes& all) {
             batch::warp_mean_to_incoming(20, 80, shape, {{x, y, z}, {y, x, z}}, {z, y, x}, all);
           });
         }});
  }
  for (const auto& [name, call] : calls) {
    call(a, b, c, whole);
    for (size_t start = 0; start < 4; ++start) {
      for (size_t length = 0; length <= 40; ++length) {
        // Inputs of their own, so that the address sanitizer sees a read past their end.
        const std::vector<float> x(a.begin() + start, a.begin() + start + length),
            y(b.begin() + start, b.begin() + start + length),
            z(c.begin() + start, c.begin() + start + length);
        constexpr float kCanary = -77;
        std::vector<float> results(start + length + 20, kCanary);
        call(x, y, z, std::span(results).subspan(start, length));
        for (size_t i = 0; i < results.size(); ++i) {
          const bool inside = i >= start && i < start + length;
          ASSERT_EQ(results[i], inside ? whole[i] : kCanary)
              << name << ": element " << i << " of " << length << " from " << start;
        }
      }
    }
    // Over an input.
    std::vector<float> x = a, z = c;
    call(x, b, z, x);
    EXPECT_EQ(x, whole) << name;
  }
}

TEST_P(Batch, NaNAndInfinityDoNotHang) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity}) {
    const std::vector<float> x(20, bad);
    std::vector<float> results(20);
    batch::exp(x, results);
    batch::eval(AnisotropicGaussian<float>(), {x, x, x}, results);
    batch::eval(SphericalGaussian<float>(), {x, x, x}, results);
    batch::asg_integral(x, x, AsgIntegral::exact, results);
    batch::visible_fraction_directional(x, x, results);
    batch::visible_fraction_hemisphere(x, x, results);
    batch::visible_fraction_hemisphere(x, x, results, HemisphereLevel::exact);
    batch::sg_integral(x, results);
    batch::inner_product(SphericalGaussian<float>(), {{x, x, x}, x, x}, results);
    batch::eval({{x, x, x}, {x, x, x}, x, x, x}, {x, x, x}, results);
    batch::inner_product(AnisotropicGaussian<float>(), {{x, x, x}, {x, x, x}, x, x, x}, results);
    batch::directional_bandwidth(x, x, x, x, results);
    batch::mean_clamped_cosine(LobeMoments<float>(), Frame<float>(), {x, x, x}, results);
    std::vector<float> more(20);
    batch::direction_to_octahedral({x, x, x}, results, more);
    batch::clamped_cosine_integral({}, {x, x, x}, results);
    batch::convolve(x, x, x, {results, more, more});
    WarpedArrays warped(20);
    batch::warp_to_incoming({{x, x, x}, {x, x, x}, x, x, x}, {x, x, x}, warped.spans());
    batch::warp_mean_to_incoming(1, 1, {}, {{x, x, x}, {x, x, x}}, {x, x, x}, warped.spans());
  }
}

TEST(InstructionSets, UnknownNamesAreRefused) {
  EXPECT_FALSE(batch::instruction_sets().empty());
  EXPECT_FALSE(batch::use_instruction_set("Z80"));
}

}  // namespace
}  // namespace burnish
