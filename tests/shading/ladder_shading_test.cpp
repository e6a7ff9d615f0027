#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "burnish/shading/shade.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/visibility_ladder.h"
#include "shading/small_transfer.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 8;
using Visible = std::function<bool(const Vector3d&)>;

bool above_horizon(const Vector3d& d) { return d.z() > 0; }

/// A floor before a wall whose top is 40 degrees above it, with a window.
bool beside_a_wall(const Vector3d& d) {
  if (d.z() <= 0) return false;
  const bool wall = d.x() > 0 && d.z() < std::tan(0.7) * d.x();
  const bool window = std::abs(d.y()) < 0.3 * d.x() && d.z() > 0.3 * d.x();
  return !wall || window;
}

/// A point with both kinds of visibility, without compression.
struct BakedPoint {
  SsdfBasis ssdf;
  LadderBasis ladder;

  explicit BakedPoint(const Visible& visible) {
    constexpr int kFine = 64, kCoarse = 32, kBands = 13;
    std::vector<Vector3d> open, blocked;
    std::vector<double> harmonics(kBands * kBands);
    std::vector<float> y(harmonics.size());
    // Four directions a texel, none on an axis or a diagonal of it, where the horizon is.
    constexpr double kPlaces[4][2] = {{.375, .125}, {.875, .375}, {.125, .625}, {.625, .875}};
    for (int i = 0; i < kFine * kFine; ++i) {
      for (const auto& [x, y_place] : kPlaces) {
        const Vector3d d =
            octahedral_to_direction<double>((i % kFine + x) / kFine, (i / kFine + y_place) / kFine);
        (visible(d) ? open : blocked).push_back(d);
        if (!visible(d)) continue;
        eval_harmonics(kBands, d.cast<float>(), y);
        for (size_t k = 0; k < y.size(); ++k) harmonics[k] += kPi<double> / (kFine * kFine) * y[k];
      }
    }
    ladder.bands = kBands;
    ladder.terms = ssdf.terms = 1;
    ladder.mean.assign(harmonics.begin(), harmonics.end());
    ladder.eigen.assign(harmonics.size(), 0);
    ssdf.resolution = kCoarse;
    ssdf.eigen.assign(kCoarse * kCoarse, 0);
    for (int i = 0; i < kCoarse * kCoarse; ++i) {
      const Vector3d d = octahedral_texel_direction<double>(i % kCoarse, i / kCoarse, kCoarse);
      double nearest = -1;
      for (const Vector3d& other : visible(d) ? blocked : open)
        nearest = std::max(nearest, other.dot(d));
      ssdf.mean.push_back(static_cast<float>((visible(d) ? 1 : -1) * std::acos(nearest)));
    }
  }
  PreparedTransfer transfer(float crossover) const {
    return test::prepare_exactly(test::vertex_that_sees(ssdf, ladder, crossover));
  }
};

LightRig one_lobe(const Frame<float>& frame, float bandwidth_x, float bandwidth_y) {
  LightRig rig;
  rig.lobes.resize(1);
  rig.lobes[0].lobe.frame = frame;
  rig.lobes[0].lobe.bandwidth_x = bandwidth_x;
  rig.lobes[0].lobe.bandwidth_y = bandwidth_y;
  rig.lobes[0].color = Rgb::Ones();
  return rig;
}

float diffuse(const PreparedTransfer& transfer, const LightRig& rig, const ShadingOptions& options,
              size_t vertex = 0) {
  Material white;
  white.diffuse = Rgb::Constant(kPi<float>);
  white.specular = Rgb::Zero();
  const PreparedLights lights = prepare_lights(rig, transfer, options);
  return shade_point(transfer, vertex_shading_point(transfer, vertex), Vector3f::UnitZ(),
                     prepare_material(white, {}), {&lights, nullptr}, options)
      .x();
}

double truth(const LightRig& rig, const Visible& visible) {
  const AnisotropicGaussian<float>& f = rig.lobes[0].lobe;
  const AnisotropicGaussian<double> lobe{f.frame.cast<double>(), f.bandwidth_x, f.bandwidth_y, 1};
  return test::integrate_sphere(
      [&](const Vector3d& v) { return visible(v) ? v.z() * eval(lobe, v) : 0.0; });
}

Frame<float> random_frame(std::mt19937& random) {
  Vector3d axis = test::random_direction(random);
  if (axis.z() < -0.3) axis = -axis;
  return test::random_frame(axis, random).cast<float>();
}

constexpr float kAlways = 1e6f;  ///< a crossover that no lobe here is near

TEST(LadderShading, UnoccludedIsAsWithoutABake) {
  const BakedPoint baked(above_horizon);
  const PreparedTransfer transfer = baked.transfer(kAlways);
  std::mt19937 random(kSeed);
  for (const float bandwidth : {0.1f, 1.0f, 4.0f}) {
    const float fit =
        2e-3f * prepare_lights(one_lobe({}, bandwidth, bandwidth), transfer, {}).lobes[0].integral;
    for (int i = 0; i < 50; ++i) {
      const LightRig rig = one_lobe(random_frame(random), bandwidth, bandwidth);
      const float bare = diffuse(test::kOpen, rig, {});
      // The table's irradiance is that of 31 harmonics of the cosine, with 13 bands of a map whose
      // texels the horizon crosses.
      EXPECT_NEAR(diffuse(transfer, rig, {}), bare, 6e-3 * bare) << bandwidth << " seed " << kSeed;
      // Without a bake, it is a fit, good to .002 of the lobe's integral.
      EXPECT_LE(diffuse(transfer, rig, {}), bare + fit);
    }
  }
}

TEST(LadderShading, BesideAWallErrsLessThanTheSsdf) {
  const BakedPoint baked(beside_a_wall);
  const PreparedTransfer transfer = baked.transfer(kAlways);
  ShadingOptions without;
  without.ladder = false;
  struct Case {
    float bandwidth_x, bandwidth_y;
    double bound;
  };
  // Measured on scanned meshes: 2 to 5 % for round lobes of these widths; one wall is simpler. The
  // bounds of the long lobes lie between reading them at three places and at one (.037, .028,
  // .044).
  for (const Case& c : {Case{0.25f, 0.25f, .05},
                        {1, 1, .05},
                        {4, 4, .05},
                        {16, 1, .03},
                        {16, 4, .023},
                        {32, 2, .03}}) {
    std::mt19937 random(kSeed);
    double error = 0, without_error = 0, norm = 0;
    for (int i = 0; i < 30; ++i) {
      const LightRig rig = one_lobe(random_frame(random), c.bandwidth_x, c.bandwidth_y);
      const double exact = truth(rig, beside_a_wall);
      error += std::pow(diffuse(transfer, rig, {}) - exact, 2);
      without_error += std::pow(diffuse(transfer, rig, without) - exact, 2);
      norm += exact * exact;
    }
    EXPECT_LT(std::sqrt(error / norm), c.bound) << c.bandwidth_x << " " << c.bandwidth_y;
    // Of one wall, the SSDF knows much; on scanned meshes its squared error is ten times as large.
    EXPECT_LT(error, without_error / 2) << c.bandwidth_x << " " << c.bandwidth_y;
  }
}

TEST(LadderShading, IsOffWhereAskedForOrWithoutOne) {
  const BakedPoint baked(beside_a_wall);
  std::mt19937 random(kSeed);
  const LightRig rig = one_lobe(random_frame(random), 1, 1);
  const PreparedTransfer none = test::prepare_exactly(test::vertex_that_sees(baked.ssdf));
  const float by_ssdf = diffuse(none, rig, {});
  EXPECT_NE(diffuse(baked.transfer(kAlways), rig, {}), by_ssdf);
  EXPECT_EQ(diffuse(baked.transfer(0), rig, {}), by_ssdf);
  ShadingOptions options;
  options.ladder = false;
  EXPECT_EQ(diffuse(baked.transfer(kAlways), rig, options), by_ssdf);
  options.ladder = true;
  options.cosine = CosineModel::constant;
  EXPECT_EQ(diffuse(baked.transfer(kAlways), rig, options), diffuse(none, rig, options));
}

TEST(LadderShading, FadesOutAcrossTheCrossover) {
  const BakedPoint baked(beside_a_wall);
  ShadingOptions without;
  without.ladder = false;
  ShadingOptions with;
  with.ladder_reach = 1;
  const Frame<float> frame =
      frame_from_axis<float>(Vector3f(0.5f, 0.1f, 0.6f).normalized());  // at the wall's top
  const LightRig rig = one_lobe(frame, 10, 10);
  const float by_ssdf = diffuse(baked.transfer(kAlways), rig, without);
  const float by_ladder = diffuse(baked.transfer(kAlways), rig, with);
  // Lobe times cosine has a bandwidth of about 11. The step is over at half and at twice that.
  EXPECT_EQ(diffuse(baked.transfer(5), rig, with), by_ssdf);
  EXPECT_EQ(diffuse(baked.transfer(24), rig, with), by_ladder);
  ASSERT_GT(std::abs(by_ssdf - by_ladder), 1e-3f);
  float last = 0;
  for (float crossover = 5; crossover < 24; crossover *= 1.05f) {
    const float share =
        (diffuse(baked.transfer(crossover), rig, with) - by_ssdf) / (by_ladder - by_ssdf);
    EXPECT_GE(share, last - 1e-3f) << crossover;  // rounding of the difference
    EXPECT_LE(share, last + 0.1f) << crossover;   // no step: its slope is 1.5 / 2 an octave
    last = share;
  }
}

TEST(LadderShading, ReachesLobesAsManyTimesSharper) {
  const BakedPoint baked(beside_a_wall);
  const LightRig rig =
      one_lobe(frame_from_axis<float>(Vector3f(0.5f, 0.1f, 0.6f).normalized()), 10, 10);
  ShadingOptions once, thrice;
  once.ladder_reach = 1;
  thrice.ladder_reach = 3;
  for (const float crossover : {2.0f, 4.0f, 6.0f})
    EXPECT_FLOAT_EQ(diffuse(baked.transfer(crossover), rig, thrice),
                    diffuse(baked.transfer(3 * crossover), rig, once))
        << crossover;
  EXPECT_NE(diffuse(baked.transfer(4), rig, thrice), diffuse(baked.transfer(4), rig, once));
}

TEST(LadderShading, VertexReadsItsOwnBasisAndCoefficients) {
  const BakedPoint walled(beside_a_wall), open(above_horizon);
  std::mt19937 random(kSeed);
  // Two bases that differ, of which a vertex sees the mean and half of an eigenvector.
  const auto vary = [&](std::vector<float>& eigen) {
    for (float& value : eigen) value = std::normal_distribution<float>(0, 0.1f)(random);
  };
  BakedPoint baked[2] = {walled, open};
  for (BakedPoint& basis : baked) {
    vary(basis.ssdf.eigen);
    vary(basis.ladder.eigen);
  }
  Transfer both = test::vertices_at_origin(2);
  both.basis_id = {1, 0};
  both.coefficients = {0.5f, -0.5f};
  both.ladder_coefficients = {-0.5f, 0.25f};
  both.ladder_crossover = 20;
  for (const BakedPoint& basis : baked) {
    both.bases.push_back(basis.ssdf);
    both.ladder_bases.push_back(basis.ladder);
  }
  const PreparedTransfer prepared = test::prepare_exactly(both);
  // One wide lobe, which the ladder sees, and one narrow one, which the SSDF sees; behind the wall.
  const Frame<float> behind = frame_from_axis<float>(Vector3f(0.7f, 0.5f, 0.5f).normalized());
  for (const float bandwidth : {2.0f, 200.0f}) {
    const LightRig rig = one_lobe(behind, bandwidth, bandwidth);
    float alone[2];
    for (size_t vertex = 0; vertex < 2; ++vertex) {
      const BakedPoint& own = baked[both.basis_id[vertex]];
      Transfer single = test::vertex_that_sees(own.ssdf, own.ladder, 20);
      single.coefficients = {both.coefficients[vertex]};
      single.ladder_coefficients = {both.ladder_coefficients[vertex]};
      alone[vertex] = diffuse(test::prepare_exactly(single), rig, {});
      EXPECT_EQ(diffuse(prepared, rig, {}, vertex), alone[vertex]) << bandwidth;
    }
    EXPECT_GT(std::abs(alone[0] - alone[1]), 0.01f * std::max(alone[0], alone[1])) << bandwidth;
  }
}

}  // namespace
}  // namespace burnish
