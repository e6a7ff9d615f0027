// The private vector forms on lanes of double, against the scalar forms in double: what is left is
// the error of the approximations.

#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "burnish/sphere/asg_product.h"
#include "burnish/sphere/batch.h"
#include "burnish/sphere/sg_half_space.h"
#include "sphere/block.h"
#include "sphere/simd.h"
#include "support/quadrature.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sphere/double_lanes_test.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sphere/half_space-inl.h"
#include "sphere/lobes-inl.h"
#include "sphere/warp-inl.h"

#ifndef BURNISH_TESTS_DOUBLE_LANES_ONCE
#define BURNISH_TESTS_DOUBLE_LANES_ONCE
namespace burnish::test {

struct DoubleLanes {
  BlockArray<double> bandwidth_x, bandwidth_y, distance, gradient_x, gradient_y;
  BlockVector3<double> direction;
  BlockArray<double> asg, directional, hemisphere, across, cosine, product, u, v, warped;
};

}  // namespace burnish::test
#endif

HWY_BEFORE_NAMESPACE();
namespace burnish {
namespace HWY_NAMESPACE {
namespace {

using DoubleTag = hn::ScalableTag<double>;
using DoubleVector = hn::VFromD<DoubleTag>;

void evaluate(const burnish::LobeMoments<double>& m, test::DoubleLanes& lanes) {
  const DoubleTag d;
  const auto all = [d](double x) HWY_ATTR { return hn::Set(d, x); };
  const LobeMoments<DoubleVector> moments = {
      all(m.mean_z),    all(m.mean_xx),   all(m.mean_yy),   all(m.variance_z), all(m.mean_xxz),
      all(m.mean_yyz),  all(m.mean_zzz),  all(m.mean_xxxx), all(m.mean_yyyy),  all(m.mean_zzzz),
      all(m.mean_xxyy), all(m.mean_xxzz), all(m.mean_yyzz)};
  const DoubleVector zero = hn::Zero(d), one = all(1);
  const Frame<DoubleVector> frame = {{one, zero, zero}, {zero, one, zero}, {zero, zero, one}};
  for (size_t i = 0; i < kBlock; i += hn::Lanes(d)) {
    const auto load = [&](const BlockArray<double>& array)
                          HWY_ATTR { return hn::Load(d, array.data() + i); };
    const auto store = [&](DoubleVector value, BlockArray<double>& array)
                           HWY_ATTR { hn::Store(value, d, array.data() + i); };
    const DoubleVector bx = load(lanes.bandwidth_x), by = load(lanes.bandwidth_y);
    const DoubleVector distance = load(lanes.distance);
    const Vector3<DoubleVector> v = {load(lanes.direction.x), load(lanes.direction.y),
                                     load(lanes.direction.z)};
    store(asg_integral_exact(d, bx, by), lanes.asg);
    store(visible_fraction_directional(d, bx, distance), lanes.directional);
    store(visible_fraction_hemisphere(d, bx, distance), lanes.hemisphere);
    store(directional_bandwidth(d, bx, by, load(lanes.gradient_x), load(lanes.gradient_y)),
          lanes.across);
    store(mean_clamped_cosine(d, moments, v), lanes.cosine);
    store(asg_inner_product(d, AnisotropicGaussian<DoubleVector>{frame.x, frame.y, frame.z, bx, by},
                            AnisotropicGaussian<DoubleVector>{frame.z, frame.x, frame.y, by, bx}),
          lanes.product);
    const Vector2<DoubleVector> uv = direction_to_octahedral(d, v);
    store(uv.x, lanes.u);
    store(uv.y, lanes.v);
    store(warp_to_incoming(d, frame, bx, by, v).bandwidth_x, lanes.warped);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace burnish
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace burnish {
HWY_EXPORT(evaluate);

namespace test {
namespace {

constexpr unsigned kSeed = 64;

class DoubleLanesOn : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(batch::use_instruction_set(GetParam())); }
  void TearDown() override { batch::use_instruction_set(""); }
};

std::vector<std::string> sets() {
  const auto views = batch::instruction_sets();
  return {views.begin(), views.end()};
}
INSTANTIATE_TEST_SUITE_P(Sets, DoubleLanesOn, testing::ValuesIn(sets()),
                         [](const auto& info) { return info.param; });

DoubleLanes random_lanes(std::mt19937& random) {
  std::uniform_real_distribution<double> exponent(-2, 4), distance(-1.5, 1.5);
  DoubleLanes lanes;
  for (size_t k = 0; k < kBlock; ++k) {
    lanes.bandwidth_x[k] = std::pow(10, exponent(random));
    lanes.bandwidth_y[k] = std::pow(10, exponent(random));
    lanes.distance[k] = distance(random);
    const Vector3d v = random_direction(random), gradient = random_direction(random);
    lanes.direction.x[k] = v.x();
    lanes.direction.y[k] = v.y();
    lanes.direction.z[k] = v.z();
    lanes.gradient_x[k] = gradient.x();
    lanes.gradient_y[k] = gradient.y();
  }
  return lanes;
}

TEST_P(DoubleLanesOn, FormsMatchTheScalarOnesInDouble) {
  std::mt19937 random(kSeed);
  const LobeMoments<double> moments = asg_moments(20.0, 3.0);
  for (int round = 0; round < 50; ++round) {
    DoubleLanes lanes = random_lanes(random);
    HWY_DYNAMIC_DISPATCH(evaluate)(moments, lanes);
    for (size_t k = 0; k < kBlock; ++k) {
      const double bx = lanes.bandwidth_x[k], by = lanes.bandwidth_y[k], s = lanes.distance[k];
      const Vector3d v(lanes.direction.x[k], lanes.direction.y[k], lanes.direction.z[k]);
      AnisotropicGaussian<double> lobe, other;
      lobe.bandwidth_x = other.bandwidth_y = bx;
      lobe.bandwidth_y = other.bandwidth_x = by;
      other.frame = {Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY()};
      SCOPED_TRACE("seed " + std::to_string(kSeed));
      // The errors that batch.h states, without the rounding of float.
      EXPECT_NEAR(lanes.asg[k] / asg_integral_exact(bx, by), 1, 1e-6);
      EXPECT_NEAR(lanes.directional[k], visible_fraction_directional(bx, s), 1e-6);
      EXPECT_NEAR(lanes.hemisphere[k], visible_fraction_hemisphere(bx, s), 1e-6);
      const Vector3d gradient(lanes.gradient_x[k], lanes.gradient_y[k], 0);
      EXPECT_NEAR(lanes.across[k] / directional_bandwidth(lobe, gradient), 1, 1e-6);
      EXPECT_NEAR(lanes.cosine[k], mean_clamped_cosine(moments, v), 2e-6);
      const double product = inner_product_closed_form(lobe, other);
      EXPECT_NEAR(lanes.product[k], product, 1e-5 * product + 1e-30);
      const Vector2<double> uv = direction_to_octahedral(v);
      EXPECT_NEAR(lanes.u[k], uv.x(), 2e-7);
      EXPECT_NEAR(lanes.v[k], uv.y(), 2e-7);
      EXPECT_NEAR(lanes.warped[k] / warp_to_incoming(lobe, v).lobe.bandwidth_x, 1, 1e-6);
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace burnish
#endif
