#include "burnish/sphere/lobe_domain.h"

#include <functional>
#include <limits>

#include <gtest/gtest.h>

namespace burnish {
namespace {

template <class T>
class LobeDomain : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(LobeDomain, Scalars);

// What a change to a sound lobe is answered with; "accepted" for none.
template <class Lobe>
std::string answer(const std::function<void(Lobe&)>& change) {
  Lobe lobe;
  change(lobe);
  try {
    require_valid(lobe);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TYPED_TEST(LobeDomain, AcceptsEveryWidthAndAmplitude) {
  using T = TypeParam;
  using limits = std::numeric_limits<T>;
  for (const T value : {T(0), limits::denorm_min(), T(1), limits::max()}) {
    EXPECT_EQ(domain_error(SphericalGaussian<T>{Vector3<T>::UnitX(), value, -value}), "");
    EXPECT_EQ(domain_error(AnisotropicGaussian<T>{{}, value, value, -value}), "");
    EXPECT_EQ(domain_error(NormalisedAsg<T>{{}, value, value, -value}), "");
    EXPECT_EQ(domain_error(CircularGaussian<T>{-value, value, -value}), "");
    EXPECT_EQ(domain_error(LongitudinalGaussian<T>{-value, value, -value}), "");
  }
}

TYPED_TEST(LobeDomain, AcceptsAxesThatWereRotatedInTheirOwnPrecision) {
  using T = TypeParam;
  Frame<T> frame = frame_from_axis<T>(Vector3<T>(1, 2, 3).normalized());
  const Eigen::Matrix<T, 3, 3> turn =
      Eigen::AngleAxis<T>(T(0.37), Vector3<T>(3, -1, 2).normalized()).toRotationMatrix();
  for (int i = 0; i < 10; ++i) frame = {turn * frame.x, turn * frame.y, turn * frame.z};
  EXPECT_EQ(domain_error(AnisotropicGaussian<T>{frame, 1, 1, 1}), "");
}

TYPED_TEST(LobeDomain, RefusesAxesThatAreOffByMoreThanRounding) {
  using T = TypeParam;
  for (const double off : {2e-4, -2e-4, 1e-5}) {
    const Vector3<T> axis(0, 0, T(1 + off));
    EXPECT_NE(domain_error(SphericalGaussian<T>{axis, 1, 1}), "") << off;
    Frame<T> frame;
    frame.x = Vector3<T>(T(1 + off), 0, 0);
    EXPECT_NE(domain_error(AnisotropicGaussian<T>{frame, 1, 1, 1}), "") << off;
  }
  // Unit, but z not quite orthogonal to x.
  Frame<T> skewed;
  skewed.z = Vector3<T>(T(2e-4), 0, 1);
  EXPECT_NE(domain_error(AnisotropicGaussian<T>{skewed, 1, 1, 1}), "");
  // And half of the tolerance is borne.
  EXPECT_EQ(domain_error(SphericalGaussian<T>{Vector3<T>(0, 0, T(1 + 2.5e-6)), 1, 1}), "");
}

TYPED_TEST(LobeDomain, NamesTheFieldTheValueAndWhatIsExpected) {
  using T = TypeParam;
  using Sg = SphericalGaussian<T>;
  using Asg = AnisotropicGaussian<T>;
  using Nasg = NormalisedAsg<T>;
  const T nan = std::numeric_limits<T>::quiet_NaN(), infinity = std::numeric_limits<T>::infinity();
  EXPECT_EQ(answer<Sg>([](Sg& lobe) { lobe.sharpness = -1; }),
            "sharpness is -1.000000, expected a finite number >= 0");
  EXPECT_EQ(answer<Sg>([&](Sg& lobe) { lobe.sharpness = nan; }),
            "sharpness is nan, expected a finite number >= 0");
  EXPECT_EQ(answer<Sg>([&](Sg& lobe) { lobe.amplitude = infinity; }),
            "amplitude is inf, expected a finite number");
  EXPECT_EQ(answer<Sg>([](Sg& lobe) {
              lobe.axis = {0, 0, 2};
            }),
            "axis has length 2.000000, expected 1");
  EXPECT_EQ(answer<Sg>([&](Sg& lobe) {
              lobe.axis = {nan, 0, 1};
            }),
            "axis has length nan, expected 1");
  EXPECT_EQ(answer<Asg>([](Asg& lobe) { lobe.frame.x.setZero(); }),
            "frame.x has length 0.000000, expected 1");
  EXPECT_EQ(
      answer<Asg>([](Asg& lobe) { lobe.frame.z = -lobe.frame.z; }),
      "frame.z differs from the cross product of frame.x and frame.y by 2.000000, expected 0");
  EXPECT_EQ(answer<Asg>([](Asg& lobe) { lobe.bandwidth_x = -2; }),
            "bandwidth_x is -2.000000, expected a finite number >= 0");
  EXPECT_EQ(answer<Asg>([&](Asg& lobe) { lobe.bandwidth_y = infinity; }),
            "bandwidth_y is inf, expected a finite number >= 0");
  EXPECT_EQ(answer<CircularGaussian<T>>([&](CircularGaussian<T>& lobe) { lobe.center = nan; }),
            "center is nan, expected a finite number");
  EXPECT_EQ(
      answer<LongitudinalGaussian<T>>([](LongitudinalGaussian<T>& lobe) { lobe.sharpness = -3; }),
      "sharpness is -3.000000, expected a finite number >= 0");
  EXPECT_EQ(answer<Nasg>([](Nasg& lobe) { lobe.anisotropy = -1; }),
            "anisotropy is -1.000000, expected a finite number >= 0");
}

}  // namespace
}  // namespace burnish
