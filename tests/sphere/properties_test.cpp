// What must hold for any lobe, on inputs that RapidCheck makes and shrinks. Accuracy against
// quadrature is tested beside each operator; here are the identities between operators.

#include <gtest/gtest.h>

#include "burnish/sphere/asg_convolution.h"
#include "burnish/sphere/asg_product.h"
#include "burnish/sphere/half_space.h"
#include "burnish/sphere/spherical_warp.h"
#include "support/property.h"

namespace burnish {
namespace {

using test::any_between;
using test::any_direction;
using test::any_direction_near;
using test::any_frame;
using test::any_log_between;
using test::any_rotation;

SphericalGaussian<double> any_sg(double low = 1e-3, double high = 1e3) {
  return {any_direction(), any_log_between(low, high), any_between(0.1, 2)};
}

AnisotropicGaussian<double> any_asg(double low = 1e-3, double high = 1e3) {
  return {any_frame(any_direction()), any_log_between(low, high), any_log_between(low, high),
          any_between(0.1, 2)};
}

// Equal up to `bound` of the larger of |expected| and `scale`.
void assert_near(double value, double expected, double bound, double scale = 0) {
  RC_ASSERT(std::abs(value - expected) <= bound * std::max(std::abs(expected), scale));
}

// Rotation turns unit vectors into unit vectors up to a few epsilon, which exponents of 2e3 at most
// magnify.
constexpr double kRotated = 2e3 * 16 * std::numeric_limits<double>::epsilon();

RC_GTEST_PROP(RotationInvariance, OfSgValuesAndIntegrals, ()) {
  const auto a = any_sg(), b = any_sg();
  const Eigen::Matrix3d turn = any_rotation();
  const Vector3d v = any_direction();
  assert_near(eval(rotate(a, turn), Vector3d(turn * v)), eval(a, v), kRotated, 1e-30);
  assert_near(inner_product(rotate(a, turn), rotate(b, turn)), inner_product(a, b), kRotated,
              1e-30);
}

RC_GTEST_PROP(RotationInvariance, OfAsgValuesProductsAndConvolutions, ()) {
  const auto a = any_asg(), b = any_asg();
  const Eigen::Matrix3d turn = any_rotation();
  const Vector3d v = any_direction();
  const Vector3d turned = turn * v;
  assert_near(eval(rotate(a, turn), turned), eval(a, v), kRotated, 1e-30);
  assert_near(inner_product(rotate(a, turn), rotate(b, turn)), inner_product(a, b), kRotated,
              1e-20);
  // The product's axes come from eigenvectors: as exact as the gap between eigenvalues allows, so
  // values are compared on the scale of the two lobes.
  const double scale = a.amplitude * b.amplitude;
  assert_near(eval(product(rotate(a, turn), rotate(b, turn)), turned), eval(product(a, b), v), 1e-8,
              scale);
  const SphericalGaussian<double> kernel = any_sg();
  assert_near(eval(convolve(rotate(a, turn), kernel), turned), eval(convolve(a, kernel), v),
              kRotated, 1e-30);
}

RC_GTEST_PROP(RotationInvariance, OfTheWarp, ()) {
  const auto half = any_asg(1, 1e3);
  const Vector3d outgoing = any_direction_near(half.frame.z, 1.4);
  const Eigen::Matrix3d turn = any_rotation();
  const Vector3d v = any_direction();
  const auto warped = warp_to_incoming(half, outgoing);
  const auto turned = warp_to_incoming(rotate(half, turn), Vector3d(turn * outgoing));
  // 1 / cos^2(1.4) = 35 magnifies the exponent's rounding further.
  assert_near(eval(turned.lobe, Vector3d(turn * v)), eval(warped.lobe, v), 35 * kRotated,
              half.amplitude);
  assert_near(turned.jacobian, warped.jacobian, kRotated);
}

RC_GTEST_PROP(Products, OfSgsCommute, ()) {
  const auto a = any_sg(), b = any_sg();
  const Vector3d v = any_direction();
  assert_near(eval(product(a, b), v), eval(product(b, a), v), kRotated, 1e-30);
  assert_near(inner_product(a, b), inner_product(b, a), kRotated, 1e-30);
}

RC_GTEST_PROP(Products, OfAsgsCommute, ()) {
  const auto a = any_asg(), b = any_asg();
  const Vector3d v = any_direction();
  // The eigenvector of the smallest eigenvalue, once from A + B and once from B + A.
  assert_near(eval(product(a, b), v), eval(product(b, a), v), 1e-8, a.amplitude * b.amplitude);
}

RC_GTEST_PROP(Products, OfSgsHaveTheInnerProductAsIntegral, ()) {
  const auto a = any_sg(), b = any_sg();
  assert_near(integral(product(a, b)), inner_product(a, b), kRotated, 1e-30);
}

// A plane Gaussian's convolution keeps the mass. On the disc, the integral of a lobe misses at most
// exp(-bandwidth) of the plane's (docs/maths.md, "ASG integral"), of which there are three
// here; the widest lobe is the result.
double mass_bound(const AnisotropicGaussian<double>& result) {
  return 3 * std::exp(-std::min(result.bandwidth_x, result.bandwidth_y)) + 1e-12;
}

RC_GTEST_PROP(Mass, OfAnAsgConvolvedWithAnSgIsTheProductOfTheMasses, ()) {
  const auto lobe = any_asg(2, 1e3);
  const SphericalGaussian<double> kernel = any_sg(4, 2e3);
  const auto result = convolve(lobe, kernel);
  assert_near(integral(result), integral(lobe) * integral(kernel), mass_bound(result));
}

RC_GTEST_PROP(Mass, OfAnAsgConvolvedWithAnAsgIsTheProductOfTheMasses, ()) {
  const auto lobe = any_asg(2, 1e3), kernel = any_asg(2, 1e3);
  const auto result = convolve(lobe, kernel);
  assert_near(integral(result), integral(lobe) * integral(kernel), mass_bound(result));
}

RC_GTEST_PROP(Mass, OfTwoSgsConvolvedIsTheProductOfTheMasses, ()) {
  const auto a = any_sg(1e-6, 1e6), b = any_sg(1e-6, 1e6);
  assert_near(integral(convolve(a, b)), integral(a) * integral(b), 1e-12);
}

RC_GTEST_PROP(Warp, OfAnIsotropicLobeSeenAlongItsAxisHasAQuarterOfTheBandwidth, ()) {
  // h = (i + o) / |i + o| halves the angle from the axis.
  const Vector3d axis = any_direction();
  const double bandwidth = any_log_between(1e-3, 1e6);
  const auto warped = warp_to_incoming({any_frame(axis), bandwidth, bandwidth, 1}, axis);
  assert_near(warped.lobe.bandwidth_x, bandwidth / 4, 1e-12);
  assert_near(warped.lobe.bandwidth_y, bandwidth / 4, 1e-12);
  RC_ASSERT((warped.lobe.frame.z - axis).norm() < 1e-12);
  assert_near(warped.jacobian, 4, 1e-12);
}

RC_GTEST_PROP(Warp, KeepsTheProductOfTheBandwidthsUpToTheView, ()) {
  const auto half = any_asg();
  const Vector3d outgoing = any_direction_near(half.frame.z, 1.4);
  const double cosine = outgoing.dot(half.frame.z);
  const auto lobe = warp_to_incoming(half, outgoing).lobe;
  assert_near(std::sqrt(lobe.bandwidth_x) * std::sqrt(lobe.bandwidth_y),
              std::sqrt(half.bandwidth_x) * std::sqrt(half.bandwidth_y) / (4 * cosine), 1e-9);
}

RC_GTEST_PROP(SgLimit, OfAsgValuesIntegralsAndInnerProducts, ()) {
  // An ASG of equal bandwidths nu and the SG of sharpness 2 nu differ by cos t = 1 - t^2 / 2 and by
  // nu (2 (1 - cos t) - sin^2 t) = nu t^4 / 4 in the exponent, at angles t up to a few 1 /
  // sqrt(nu).
  SphericalGaussian<double> a = any_sg(200, 2e4), b = any_sg(200, 2e4);
  b.axis = any_direction_near(a.axis, 2 / std::sqrt(a.sharpness + b.sharpness));
  const auto asg_a = asg_from_sg(a), asg_b = asg_from_sg(b);
  const double nu_a = a.sharpness / 2, nu = std::min(a.sharpness, b.sharpness) / 2;
  const Vector3d in_a = any_direction_near(a.axis, 1 / std::sqrt(nu_a));
  assert_near(eval(asg_a, in_a), eval(a, in_a), 1 / nu_a);  // .5 / nu + .25 / nu at t^2 = 1 / nu
  assert_near(integral(asg_a), integral(a), 1e-12);         // both pi / nu
  // Of two lobes, three deviations apart: t^2 up to 3 / nu, in the axes' distance as in the lobes.
  assert_near(inner_product(asg_a, asg_b), inner_product(a, b), 8 / nu);
  // The convolution is as wide as the wider lobe.
  const Vector3d in_both = any_direction_near(a.axis, 1 / std::sqrt(nu));
  assert_near(eval(convolve(asg_a, b), in_both), eval(convolve(a, b), in_both), 8 / nu,
              integral(a) * integral(b) * nu);
}

RC_GTEST_PROP(HalfSpaces, OfBothSidesAddUpToTheWholeLobe, ()) {
  const double bandwidth = any_log_between(1e-6, 1e6);
  const double distance = any_between(-kPi<double>, kPi<double>);
  assert_near(visible_fraction_hemisphere(bandwidth, distance) +
                  visible_fraction_hemisphere(bandwidth, -distance),
              1, 1e-14);
  assert_near(visible_fraction_directional(bandwidth, distance) +
                  visible_fraction_directional(bandwidth, -distance),
              1, 1e-14);
}

}  // namespace
}  // namespace burnish
