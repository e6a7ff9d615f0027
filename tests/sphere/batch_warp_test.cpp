// The batch forms of the spherical warp.

#include <algorithm>

#include "sphere/batch_support.h"

namespace burnish::test {
namespace {

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
    const Vector3d axis = random_direction(random);
    const Frame<double> frame = random_frame(axis, random);
    const Vector3d noise = std::pow(10.0, -(i / 8) % 8) * random_direction(random);
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

TEST_P(Batch, MeanWarpOfManyIsThatOfPieces) {
  // More than its blocks hold; pieces that fill no vector.
  std::mt19937 random(kSeed);
  const Views views = random_views(random);
  const size_t size = views.x.x.size();
  constexpr size_t kPiece = 37;
  for (const auto& [bandwidth_x, bandwidth_y] : {std::pair{4.0f, 50.0f}, {800.0f, 90.0f}}) {
    const LobeShape<float> shape = make_lobe_shape(bandwidth_x, bandwidth_y);
    WarpedArrays whole(size), pieces(size);
    batch::warp_mean_to_incoming(bandwidth_x, bandwidth_y, shape, views.frames(),
                                 views.outgoing.spans(), whole.spans());
    for (size_t i = 0; i < size; i += kPiece) {
      const size_t count = std::min(kPiece, size - i);
      const auto part = [&](const DirectionArrays& all) {
        const batch::Directions d = all.spans();
        return batch::Directions{d.x.subspan(i, count), d.y.subspan(i, count),
                                 d.z.subspan(i, count)};
      };
      WarpedArrays piece(count);
      batch::warp_mean_to_incoming(bandwidth_x, bandwidth_y, shape, {part(views.x), part(views.z)},
                                   part(views.outgoing), piece.spans());
      for (size_t a = 0; a < piece.all.size(); ++a)
        std::copy(piece.all[a].begin(), piece.all[a].end(), pieces.all[a].begin() + long(i));
    }
    EXPECT_EQ(whole.all, pieces.all) << bandwidth_x;
  }
}

}  // namespace
}  // namespace burnish::test
