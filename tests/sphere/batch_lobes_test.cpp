// The batch forms of operators on many lobes.

#include "burnish/sphere/asg_convolution.h"
#include "burnish/sphere/asg_product.h"
#include "sphere/batch_support.h"

namespace burnish::test {
namespace {

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
    const Vector3d axis = random_direction(random);
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
    const Vector3d axis = random_direction(random);
    const Frame<float> frame = random_frame(axis, random).cast<float>();
    const AnisotropicGaussian<float> lobe = {frame, bx, by, 2};
    DirectionArrays x, z;
    std::vector<float> bandwidth_x, bandwidth_y, amplitude;
    std::vector<AnisotropicGaussian<float>> others;
    const DirectionArrays axes = directions_around(axis, 50, random);
    for (size_t i = 0; i < axes.x.size(); ++i) {
      const Frame<double> other = random_frame(axes.at(i).cast<double>().normalized(), random);
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
  for (int i = 0; i < 1000; ++i) directions.add(random_direction(random));
  const Vector3f vector = random_direction(random).cast<float>();
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
    const Vector3d axis = random_direction(random);
    const Frame<double> frame = random_frame(axis, random);
    x.add(frame.x);
    z.add(frame.z);
    directions.add((axis + random_direction(random) / std::sqrt(1 + double(width))).normalized());
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
    const Vector3d axis = random_direction(random);
    const Frame<float> frame = random_frame(axis, random).cast<float>();
    const LobeMoments<float> moments = asg_moments(float(x), float(y));
    DirectionArrays normals = directions_around(axis, 300, random);
    // Where the cosine is cut: near the lobe's horizon.
    for (int i = 0; i < 200; ++i) {
      const Vector3d across = axis.cross(random_direction(random)).normalized();
      normals.add((across + random_direction(random) * std::pow(10.0, -i % 6)).normalized());
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
    const Vector3d axis = random_direction(random);
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
      const Vector3d across = axis.cross(random_direction(random)).normalized();
      normals.add((across + random_direction(random) * std::pow(10.0, -i % 6)).normalized());
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

}  // namespace
}  // namespace burnish::test
