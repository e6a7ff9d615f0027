#include <array>
#include <cmath>
#include <random>

#include <ceres/manifold.h>
#include <gtest/gtest.h>

#include "light_fit/environment_cells.h"
#include "light_fit/flux.h"
#include "light_fit/light_fit_error.h"
#include "light_fit/lobe_mixture_cost.h"
#include "light_fit/lobe_pursuit.h"
#include "light_fit/nonnegative_least_squares.h"
#include "light_fit/reduced_environment.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 20130613;

Image random_image(int width, int height, std::mt19937& random) {
  std::uniform_real_distribution<float> value(0, 1);
  Image image(width, height);
  for (Rgb& pixel : image.pixels) pixel = Rgb(value(random), value(random), value(random));
  return image;
}

LightFitTarget random_target(std::mt19937& random) {
  std::uniform_real_distribution<double> value(0, 1);
  std::normal_distribution<double> normal;
  constexpr int kCells = 200, kNormals = 20;
  LightFitTarget target;
  target.scale.resize(kCells);
  for (int i = 0; i < kCells; ++i) {
    target.direction.push_back(
        Vector3d(normal(random), normal(random), normal(random)).normalized());
    target.variance.push_back(0.02 * value(random));
    target.scale[i] = 0.5 + value(random);
  }
  target.irradiance.resize(kNormals, kCells);
  target.value.resize(kCells + kNormals, 3);
  for (double& x : target.irradiance.reshaped()) x = value(random) / kCells;
  for (double& x : target.value.reshaped()) x = value(random);
  return target;
}

LobeShape random_shape(std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> log_bandwidth(-1, 3);
  LobeShape shape;
  shape.rotation =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
          .normalized();
  shape.log_bandwidth = {log_bandwidth(random), log_bandwidth(random)};
  return shape;
}

Eigen::VectorXd sample(const LightFitTarget& target, const LobeShape& shape) {
  Eigen::VectorXd value(target.rows());
  sample_lobe(target, shape.rotation.coeffs().data(), shape.log_bandwidth.data(), value, nullptr);
  return value;
}

// The shape moved in one of its five degrees of freedom: three of the rotation, two bandwidths.
LobeShape moved(const LobeShape& shape, int freedom, double step) {
  LobeShape result = shape;
  if (freedom < 3) {
    const Eigen::Vector3d delta = step * Eigen::Vector3d::Unit(freedom);
    ceres::EigenQuaternionManifold().Plus(shape.rotation.coeffs().data(), delta.data(),
                                          result.rotation.coeffs().data());
  } else {
    result.log_bandwidth[freedom - 3] += step;
  }
  return result;
}

TEST(NonnegativeLeastSquares, MatchesTheBestOfAllSubsets) {
  std::mt19937 random(kSeed);
  std::normal_distribution<double> normal;
  constexpr int kRows = 12, kUnknowns = 6;
  int active_seen = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::MatrixXd a(kRows, kUnknowns);
    Eigen::VectorXd b(kRows);
    for (double& x : a.reshaped()) x = normal(random);
    for (double& x : b) x = normal(random);
    double best = b.squaredNorm();
    for (int set = 1; set < 1 << kUnknowns; ++set) {
      std::vector<int> columns;
      for (int i = 0; i < kUnknowns; ++i)
        if (set >> i & 1) columns.push_back(i);
      const Eigen::MatrixXd sub = a(Eigen::all, columns);
      const Eigen::VectorXd x = sub.colPivHouseholderQr().solve(b);
      if ((x.array() >= 0).all()) best = std::min(best, (sub * x - b).squaredNorm());
    }
    std::vector<int> passive;
    const Eigen::VectorXd x = solve_nonnegative(a.transpose() * a, a.transpose() * b, passive);
    EXPECT_GE(x.minCoeff(), 0);
    // Normal equations of well-conditioned matrices: rounding only.
    EXPECT_NEAR((a * x - b).squaredNorm(), best, 1e-10) << "seed " << kSeed << " trial " << trial;
    active_seen += passive.size() < kUnknowns;
  }
  EXPECT_GT(active_seen, 50);  // the constraint was at work
}

TEST(NonnegativeLeastSquares, LeavesOutAColumnThatDependsOnAnother) {
  Eigen::MatrixXd a(3, 3);
  a << 1, 2, 0, 0, 0, 1, 1, 2, 0;  // the second column is twice the first
  const Eigen::Vector3d b(1, 1, 1);
  std::vector<int> passive;
  const Eigen::VectorXd x = solve_nonnegative(a.transpose() * a, a.transpose() * b, passive);
  EXPECT_NEAR((a * x - b).norm(), 0, 1e-12);
  EXPECT_EQ(passive.size(), 2u);
}

TEST(SignedLeastSquares, MatchesADecompositionAndLeavesOutWhatDepends) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::normal_distribution<double> normal;
  int negative_seen = 0;
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::MatrixXd a(12, 5);
    Eigen::VectorXd b(12);
    for (double& x : a.reshaped()) x = normal(random);
    for (double& x : b) x = normal(random);
    a.col(3) = a.col(0) - 2 * a.col(2);
    std::vector<int> passive;
    const Eigen::VectorXd x = solve_signed(a.transpose() * a, a.transpose() * b, passive);
    EXPECT_EQ(passive, (std::vector<int>{0, 1, 2, 4}));
    EXPECT_EQ(x[3], 0);
    // Normal equations of well-conditioned columns: rounding only.
    const Eigen::VectorXd best = a.completeOrthogonalDecomposition().solve(b);
    EXPECT_NEAR((a * x - b).squaredNorm(), (a * best - b).squaredNorm(), 1e-10)
        << "seed " << kSeed << " trial " << trial;
    negative_seen += x.minCoeff() < 0;
  }
  EXPECT_GT(negative_seen, 10);
  std::vector<int> passive;
  EXPECT_EQ(solve_signed(Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(), passive).norm(), 0);
}

TEST(NonnegativeLeastSquares, ZeroColumnsAndRightSidesGiveZero) {
  std::vector<int> passive;
  EXPECT_EQ(solve_nonnegative(Eigen::Matrix2d::Zero(), Eigen::Vector2d::Zero(), passive).norm(), 0);
  EXPECT_EQ(solve_nonnegative(Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, -2), passive).norm(),
            0);
  EXPECT_TRUE(passive.empty());
}

TEST(EnvironmentCells, CoverTheSphereOnceWithExactMeans) {
  std::mt19937 random(kSeed);
  for (const auto& [width, height] : {std::pair{64, 32}, {37, 19}, {1, 1}, {1, 7}, {5, 1}}) {
    const Image image = random_image(width, height, random);
    Eigen::Array3d total = Eigen::Array3d::Zero(), truth = Eigen::Array3d::Zero();
    double solid_angle = 0, square = 0, square_truth = 0;
    for (const EnvironmentCell& cell : environment_cells(image, 12, 600)) {
      solid_angle += cell.solid_angle;
      total += cell.solid_angle * cell.radiance;
      square += cell.spread + cell.solid_angle * cell.radiance.square().sum();
    }
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double weight = latlong_pixel_solid_angle(image, y);
        truth += weight * image.at(x, y).cast<double>();
        square_truth += weight * image.at(x, y).cast<double>().square().sum();
      }
    // Sums of thousands of doubles.
    EXPECT_NEAR(solid_angle, 4 * kPi<double>, 1e-10) << width << " x " << height;
    EXPECT_LT((total - truth).abs().maxCoeff(), 1e-10) << width << " x " << height;
    EXPECT_NEAR(square, square_truth, 1e-10) << width << " x " << height;
  }
}

TEST(EnvironmentCells, OfCoarsePixelsAreWholeOnesOrEqualParts) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  for (const auto& [width, height] : {std::pair{20, 10}, {36, 18}, {37, 19}, {7, 23}}) {
    const Image image = random_image(width, height, random);
    for (const EnvironmentCell& cell : environment_cells(image, 12, 600)) {
      const double high = cell.row1 - cell.row0;
      EXPECT_NEAR(std::max(high, 1 / high), std::round(std::max(high, 1 / high)), 1e-9);
      // Parts begin anywhere in a pixel, whole ones at its edge.
      if (high > 0.75) {
        EXPECT_EQ(cell.row0, std::round(cell.row0)) << width << " x " << height;
      }
    }
  }
}

TEST(EnvironmentCells, SplitDownToTheOnlyBrightPixel) {
  Image image(128, 64, Rgb(1, 1, 1));
  image.at(77, 20) = Rgb(100, 50, 25);
  double spread = 0, brightest = 0;
  for (const EnvironmentCell& cell : environment_cells(image, 12, 400)) {
    spread += cell.spread;
    brightest = std::max(brightest, cell.radiance[0]);
  }
  EXPECT_NEAR(brightest, 100, 1e-9);
  EXPECT_NEAR(spread, 0, 1e-9);
}

TEST(Flux, MatchesTheIrradianceOfAUniformAndOfALinearEnvironment) {
  // Radiance 1: pi on every normal. One bright pixel above the horizon: cosine times solid angle.
  const Vector3d normal = Vector3d(1, 2, -3).normalized();
  const FluxVectors uniform = environment_flux(Image(3, 2, Rgb(1, 1, 1)));
  // Cells on the horizon are taken whole or not at all: their width squared, 1e-3, over 8.
  EXPECT_NEAR(irradiance_of_flux(uniform, normal)[0], kPi<double>, 5e-4);
  Image image(512, 256);
  image.at(100, 60) = Rgb(1000, 0, 0);
  const Vector3d direction = direction_from_latlong(100.5 / 512, 60.5 / 256);
  const Vector3d tilted = (direction + Vector3d(0.3, 0.4, 0.5)).normalized();
  const double expected = 1000 * latlong_pixel_solid_angle(image, 60) * tilted.dot(direction);
  // The pixel's 0.7 degrees: its direction varies by 1e-2, its mean differs by its square.
  EXPECT_NEAR(irradiance_of_flux(environment_flux(image), tilted)[0], expected, 1e-4 * expected);
}

TEST(Flux, OfANegativeLobeIsThatOfThePositiveOneNegated) {
  EnvironmentLobe light;
  light.lobe = {frame_from_axis(Vector3f(0.6f, 0.8f, 0)), 3, 20, 1};
  light.color = Rgb(1, 2, 3);
  FluxVectors positive, mixed;
  append_lobe_flux(light, positive);
  light.color = Rgb(1, -2, -3);
  append_lobe_flux(light, mixed);
  for (const Vector3d& normal : {Vector3d(0, 1, 0), Vector3d(1, 0, 0), Vector3d(0, 0, -1)}) {
    const Eigen::RowVector3d expected = irradiance_of_flux(positive, normal);
    EXPECT_GT(expected.minCoeff(), 0);
    EXPECT_EQ(irradiance_of_flux(mixed, normal),
              Eigen::RowVector3d(expected[0], -expected[1], -expected[2]));
  }
}

TEST(ReducedEnvironment, KeepsEnergyAndSquares) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  const auto integrals = [](const Image& image) {
    std::array<double, 2> sum = {};
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const double weight = latlong_pixel_solid_angle(image, y);
        sum[0] += weight * image.at(x, y).cast<double>().sum();
        sum[1] += weight * image.at(x, y).cast<double>().square().sum();
      }
    return sum;
  };
  // A whole number of pixels in one, not a whole number, and one side only.
  for (const auto& [width, height] : {std::pair{64, 32}, {70, 45}, {100, 8}, {5, 50}}) {
    const Image image = random_image(width, height, random);
    const ReducedEnvironment reduced = reduce_environment(image, 32);
    EXPECT_EQ(reduced.image.width, std::min(width, 32));
    EXPECT_EQ(reduced.image.height, std::min(height, 16));
    const auto before = integrals(image), after = integrals(reduced.image);
    // Each pixel is rounded to float.
    EXPECT_NEAR(after[0], before[0], 1e-6 * before[0]) << width << " x " << height;
    EXPECT_NEAR(after[1] + reduced.spread, before[1], 1e-6 * before[1]) << width << " x " << height;
    EXPECT_GT(reduced.spread, 0);
  }
  const Image small = random_image(32, 16, random);
  const ReducedEnvironment same = reduce_environment(small, 32);
  EXPECT_EQ(same.spread, 0);
  for (size_t i = 0; i < small.pixels.size(); ++i)
    EXPECT_TRUE((same.image.pixels[i] == small.pixels[i]).all());
}

TEST(ReducedEnvironment, HasTheErrorOfTheWholeMap) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  const Image image = random_image(64, 32, random);
  LightRig rig;
  EnvironmentLobe light;
  light.lobe = {frame_from_axis(Vector3f(0, 0.6f, 0.8f)), 1, 2, 1};
  light.color = Rgb(0.6f, 0.6f, 0.6f);
  rig.lobes.push_back(light);
  const LightFitError whole = measure_light_fit({image, 0}, rig);
  const LightFitError reduced = measure_light_fit(reduce_environment(image, 32), rig);
  // The lobe varies by a tenth within a pixel of the reduced map, in no way like the noise there.
  EXPECT_NEAR(reduced.relative_l2, whole.relative_l2, 2e-3 * whole.relative_l2);
  EXPECT_NEAR(reduced.irradiance_relative_l2, whole.irradiance_relative_l2,
              0.02 * whole.irradiance_relative_l2);
}

TEST(SampleLobe, DerivativesMatchDifferences) {
  std::mt19937 random(kSeed);
  const LightFitTarget target = random_target(random);
  for (int trial = 0; trial < 20; ++trial) {
    const LobeShape shape = random_shape(random);
    SampleDerivative derivative(target.rows(), 6);
    Eigen::VectorXd value(target.rows());
    sample_lobe(target, shape.rotation.coeffs().data(), shape.log_bandwidth.data(), value,
                derivative.data());
    Eigen::Matrix<double, 4, 3, Eigen::RowMajor> plus;
    ceres::EigenQuaternionManifold().PlusJacobian(shape.rotation.coeffs().data(), plus.data());
    Eigen::MatrixXd tangent(target.rows(), 5);
    tangent << derivative.leftCols<4>() * plus, derivative.rightCols<2>();
    for (int freedom = 0; freedom < 5; ++freedom) {
      constexpr double kStep = 1e-6;
      Eigen::VectorXd difference = (sample(target, moved(shape, freedom, kStep)) -
                                    sample(target, moved(shape, freedom, -kStep))) /
                                   (2 * kStep);
      // Central differences: kStep^2 of the third derivative (at most 1e3), and rounding / kStep.
      // A direction within kStep of the lobe's horizon would err by half the slope there: the
      // margin is the share of such directions, none with this seed.
      EXPECT_LT((difference - tangent.col(freedom)).cwiseAbs().maxCoeff(), 1e-8)
          << "seed " << kSeed << " trial " << trial << " freedom " << freedom;
    }
  }
}

TEST(SampleLobe, KeepsTheIntegralWhenWidened) {
  // A lobe of bandwidth 40 over equal cells: the widened lobe sums to the same energy.
  constexpr int kCount = 20000;
  LightFitTarget target;
  target.scale = Eigen::VectorXd::Ones(kCount);
  target.irradiance.resize(0, kCount);
  target.value.resize(kCount, 3);
  target.variance.assign(kCount, 0.01);
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1) / double(kCount);
    const double angle = i * kPi<double> * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    target.direction.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  LobeShape shape;
  shape.log_bandwidth = {std::log(40.0), std::log(20.0)};
  const double energy = sample(target, shape).sum() * 4 * kPi<double> / kCount;
  // The disc cuts the widened lobe (bandwidths 22 and 14) at exp(-14); spiral quadrature: 1e-4.
  EXPECT_NEAR(energy, kPi<double> / std::sqrt(40.0 * 20.0), 1e-4 * energy);
}

class LobeMixtureCostOf : public testing::TestWithParam<bool> {};

TEST_P(LobeMixtureCostOf, GradientMatchesDifferences) {
  std::mt19937 random(kSeed);
  LightFitTarget target = random_target(random);
  target.signed_colors = GetParam();
  constexpr int kLobes = 4;
  std::vector<LobeShape> shapes;
  for (int i = 0; i < kLobes; ++i) shapes.push_back(random_shape(random));
  const LobeMixtureCost cost(target, kLobes);
  const Eigen::Index rows = cost.num_residuals();
  const auto evaluate = [&](std::vector<LobeShape>& at, Eigen::VectorXd& residual,
                            double** jacobians) {
    std::vector<double*> parameters;
    for (LobeShape& shape : at) {
      parameters.push_back(shape.rotation.coeffs().data());
      parameters.push_back(shape.log_bandwidth.data());
    }
    residual.resize(rows);
    EXPECT_TRUE(cost.Evaluate(parameters.data(), residual.data(), jacobians));
    return residual.squaredNorm() / 2;
  };
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<RowMajor> jacobian;
  for (int i = 0; i < 2 * kLobes; ++i) jacobian.emplace_back(rows, i % 2 ? 2 : 4);
  std::vector<double*> pointers;
  for (RowMajor& block : jacobian) pointers.push_back(block.data());
  Eigen::VectorXd residual, unused;
  evaluate(shapes, residual, pointers.data());
  // The short residual has the norm of the long one, which is that of the mixture.
  EXPECT_NEAR(residual.norm(), mixture_residual(target, shapes).norm(), 1e-12 * residual.norm());
  for (int lobe = 0; lobe < kLobes; ++lobe) {
    Eigen::Matrix<double, 4, 3, Eigen::RowMajor> plus;
    ceres::EigenQuaternionManifold().PlusJacobian(shapes[lobe].rotation.coeffs().data(),
                                                  plus.data());
    Eigen::VectorXd gradient(5);
    gradient << plus.transpose() * (jacobian[2 * lobe].transpose() * residual),
        jacobian[2 * lobe + 1].transpose() * residual;
    for (int freedom = 0; freedom < 5; ++freedom) {
      constexpr double kStep = 1e-5;
      std::vector<LobeShape> forth = shapes, back = shapes;
      forth[lobe] = moved(shapes[lobe], freedom, kStep);
      back[lobe] = moved(shapes[lobe], freedom, -kStep);
      const double difference =
          (evaluate(forth, unused, nullptr) - evaluate(back, unused, nullptr)) / (2 * kStep);
      // The cost is of order 10 and smooth: differences are good to about kStep^2 and 1e-15 /
      // kStep.
      EXPECT_NEAR(gradient[freedom], difference, 1e-6)
          << "seed " << kSeed << " lobe " << lobe << " freedom " << freedom;
    }
  }
}

// Kaufman's J^T J, from the thousands of rows that the cost does not form.
TEST_P(LobeMixtureCostOf, NormalMatrixIsThatOfTheLongJacobian) {
  std::mt19937 random(kSeed + 1);
  LightFitTarget target = random_target(random);
  target.signed_colors = GetParam();
  constexpr int kLobes = 3;
  std::vector<LobeShape> shapes;
  std::vector<const double*> parameters;
  for (int i = 0; i < kLobes; ++i) shapes.push_back(random_shape(random));
  for (const LobeShape& shape : shapes) {
    parameters.push_back(shape.rotation.coeffs().data());
    parameters.push_back(shape.log_bandwidth.data());
  }
  const Eigen::MatrixXd lobes = sample_lobes(target, shapes);
  const LobeColors colors = solve_colors(target, lobes);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(6 * kLobes, 6 * kLobes);
  for (int c = 0; c < 3; ++c) {
    const Eigen::MatrixXd used = lobes(Eigen::all, colors.passive[c]);
    Eigen::MatrixXd jacobian(target.rows(), 6 * kLobes);
    for (int k = 0; k < kLobes; ++k) {
      SampleDerivative derivative(target.rows(), 6);
      Eigen::VectorXd value(target.rows());
      sample_lobe(target, parameters[2 * k], parameters[2 * k + 1], value, derivative.data());
      jacobian.middleCols<6>(6 * k) =
          -colors.color(k, c) *
          (derivative - used * used.householderQr().solve(Eigen::MatrixXd(derivative)));
    }
    expected += jacobian.transpose() * jacobian;
  }
  const LobeMixtureCost cost(target, kLobes);
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<RowMajor> blocks;
  for (int i = 0; i < 2 * kLobes; ++i) blocks.emplace_back(cost.num_residuals(), i % 2 ? 2 : 4);
  std::vector<double*> pointers;
  for (RowMajor& block : blocks) pointers.push_back(block.data());
  Eigen::VectorXd residual(cost.num_residuals());
  ASSERT_TRUE(cost.Evaluate(parameters.data(), residual.data(), pointers.data()));
  Eigen::MatrixXd found(cost.num_residuals(), 6 * kLobes);
  for (int k = 0; k < kLobes; ++k) found.middleCols<6>(6 * k) << blocks[2 * k], blocks[2 * k + 1];
  // Entries of order 10, by sums of hundreds of terms.
  EXPECT_LT((found.transpose() * found - expected).cwiseAbs().maxCoeff(),
            1e-11 * expected.cwiseAbs().maxCoeff())
      << "seed " << kSeed + 1;
}

INSTANTIATE_TEST_SUITE_P(SignedColors, LobeMixtureCostOf, testing::Bool());

}  // namespace
}  // namespace burnish
