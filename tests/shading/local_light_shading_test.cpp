#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "burnish/shading/shade.h"
#include "burnish/sphere/octahedral_map.h"
#include "shading/small_transfer.h"
#include "support/quadrature.h"
#include "support/rectangle_nodes.h"

namespace burnish {
namespace {

using test::kOpen;

constexpr unsigned kSeed = 41;

Material white_diffuse() { return {.diffuse = Rgb::Constant(kPi<float>)}; }  // shows irradiance

Material metal(float alpha_x, float alpha_y) {
  return {.diffuse = Rgb::Zero(),
          .specular = Rgb::Constant(0.8f),
          .model = SpecularModel::ward,
          .alpha_x = alpha_x,
          .alpha_y = alpha_y};
}

/// In the default frame, z up.
ShadingPoint at_origin() {
  ShadingPoint point;
  point.position = Vector3f::Zero();
  return point;
}

Rgb shade(const PreparedTransfer& transfer, const ShadingPoint& point, const LightRig& rig,
          const Material& material, const Vector3f& outgoing, const ShadingOptions& options = {}) {
  const PreparedLights lights = prepare_lights(rig, transfer, options);
  return shade_point(transfer, point, outgoing, prepare_material(material, options.specular),
                     {&lights, nullptr}, options);
}

/// Directions of a cap around an axis, with weights that sum to its solid angle.
std::vector<test::Node> cap_nodes(const Vector3d& axis, double radius, int steps) {
  const Frame<double> frame = frame_from_axis(axis);
  std::vector<test::Node> nodes;
  for (const auto& [z, weight] : test::gauss_legendre(steps, std::cos(radius), 1)) {
    for (int i = 0; i < 2 * steps; ++i) {
      const double phi = kPi<double> * (i + 0.5) / steps, sine = std::sqrt(1 - z * z);
      nodes.push_back({frame.to_world({sine * std::cos(phi), sine * std::sin(phi), z}),
                       weight * kPi<double> / steps});
    }
  }
  return nodes;
}

/// Radiance by the exact BRDF in the default frame, the light's own radiance being 1.
double specular_truth(const Material& material, const Vector3f& outgoing,
                      const std::vector<test::Node>& nodes) {
  double sum = 0;
  for (const auto& [direction, weight] : nodes) {
    const Vector3f incoming = direction.cast<float>();
    if (incoming.z() > 0)
      sum += weight * eval_specular_brdf(material, outgoing, incoming).x() * incoming.z();
  }
  return sum;
}

/// Directions from a mirrored view to up to two widths of lobe and light away.
std::vector<Vector3f> offsets_from(double view, double width) {
  std::vector<Vector3f> axes;
  for (double offset = 0; offset <= 2; offset += 0.25)
    axes.push_back(Vector3d(std::sin(view + offset * width), 0, std::cos(view + offset * width))
                       .cast<float>());
  return axes;
}

/// The form whose lobe is exact at the middle of a highlight seen along the normal.
const ShadingOptions kAtPeak = {.specular = {SpecularForm::peak, 1, 1}};

TEST(LocalLightHighlight, OfADiscKeepsItsStatedError) {
  struct Case {
    float alpha;
    double radius, error;
  };
  // docs/maths.md, "Local lights": the lobe's error where the light is smaller than the lobe, the
  // Gaussian's soft edge where it is larger. Relative L2 over offsets, rounded up.
  for (const Case& c : {Case{0.02f, 0.02, 0.02},
                        {0.02f, 0.1, 0.1},
                        {0.02f, 0.3, 0.25},
                        {0.1f, 0.02, 0.02},
                        {0.1f, 0.1, 0.02},
                        {0.1f, 0.3, 0.15},
                        {0.3f, 0.02, 0.02},
                        {0.3f, 0.1, 0.02},
                        {0.3f, 0.3, 0.04}}) {
    double error = 0, norm = 0;
    for (const Vector3f& axis : offsets_from(0, 0.7 * (c.radius + 1.4 * c.alpha))) {
      LightRig rig;
      const auto radius = float(c.radius);
      rig.directionals.push_back({axis, radius, irradiance_of_disc(Rgb::Ones(), radius)});
      const Material m = metal(c.alpha, c.alpha);
      const double found = shade(kOpen, at_origin(), rig, m, Vector3f::UnitZ(), kAtPeak).x();
      const double truth =
          specular_truth(m, Vector3f::UnitZ(), cap_nodes(axis.cast<double>(), c.radius, 60));
      error += (found - truth) * (found - truth);
      norm += truth * truth;
    }
    EXPECT_LT(std::sqrt(error / norm), c.error) << c.alpha << " " << c.radius;
  }
}

TEST(LocalLightHighlight, OfARectangleKeepsItsStatedError) {
  struct Case {
    float alpha_x, alpha_y, width, height, error;
  };
  // As above; long lights and long lobes, along and across each other.
  for (const Case& c : {Case{0.1f, 0.1f, 0.2f, 0.02f, 0.02f},
                        {0.1f, 0.03f, 0.02f, 0.2f, 0.15f},
                        {0.3f, 0.03f, 0.2f, 0.02f, 0.02f},
                        {0.1f, 0.1f, 0.5f, 0.5f, 0.15f}}) {
    double error = 0, norm = 0;
    for (const Vector3f& axis : offsets_from(0, 0.5 * (c.width + 1.4 * c.alpha_x))) {
      LightRig rig;
      rig.rectangles.push_back({.center = axis,
                                .edge_x = c.width * Vector3f(axis.z(), 0, -axis.x()),
                                .edge_y = c.height * Vector3f::UnitY(),
                                .radiance = Rgb::Ones(),
                                .two_sided = true});
      const Material m = metal(c.alpha_x, c.alpha_y);
      const double found = shade(kOpen, at_origin(), rig, m, Vector3f::UnitZ(), kAtPeak).x();
      const double truth = specular_truth(
          m, Vector3f::UnitZ(), test::rectangle_nodes(rig.rectangles[0], Vector3d::Zero(), 80));
      error += (found - truth) * (found - truth);
      norm += truth * truth;
    }
    EXPECT_LT(std::sqrt(error / norm), c.error)
        << c.alpha_x << " " << c.alpha_y << " " << c.width << " " << c.height;
  }
}

TEST(LocalLightHighlight, OfManyTeethKeepsItsStatedErrorAtEveryView) {
  // A light of its lobe's size, so that its soft edge does not show; docs/maths.md, "Local lights".
  struct Case {
    double view_deg, error;
  };
  for (const Case& c : {Case{0, 0.03}, {40, 0.05}, {60, 0.11}, {75, 0.18}}) {
    const double view = c.view_deg * kPi<double> / 180, radius = 0.1;
    const Vector3f outgoing = Vector3d(-std::sin(view), 0, std::cos(view)).cast<float>();
    const Material m = metal(0.15f, 0.05f);
    double error = 0, peak_error = 0, norm = 0;
    for (const Vector3f& axis : offsets_from(view, -0.7 * (radius + 1.4 * 0.15))) {
      LightRig rig;
      rig.directionals.push_back(
          {axis, float(radius), irradiance_of_disc(Rgb::Ones(), float(radius))});
      const ShadingOptions nine = {.specular = {SpecularForm::moments, 9, 3}};
      const double truth = specular_truth(m, outgoing, cap_nodes(axis.cast<double>(), radius, 60));
      error += std::pow(shade(kOpen, at_origin(), rig, m, outgoing, nine).x() - truth, 2);
      peak_error += std::pow(shade(kOpen, at_origin(), rig, m, outgoing, kAtPeak).x() - truth, 2);
      norm += truth * truth;
    }
    EXPECT_LT(std::sqrt(error / norm), c.error) << c.view_deg;
    EXPECT_LT(error, peak_error) << c.view_deg;
  }
}

TEST(LocalLightHighlight, InsideASphereIsThatOfAConstantEnvironment) {
  const Image map(8, 4, Rgb::Constant(2));
  const PrefilteredEnvironment environment = prefilter_environment(map);
  const PreparedLights none;
  const Material m = metal(0.2f, 0.1f);
  LightRig rig;
  rig.spheres.push_back({Vector3f(0.1f, 0.2f, -0.3f), 1, Rgb::Constant(2)});
  for (const Vector3f& outgoing : {Vector3f(0, 0, 1), Vector3f(0.6f, 0, 0.8f)}) {
    const Rgb truth = shade_point(kOpen, at_origin(), outgoing, prepare_material(m, {}),
                                  {&none, &environment}, {});
    // The map gives its constant to 1e-5, the sphere its radiance.
    EXPECT_LT((shade(kOpen, at_origin(), rig, m, outgoing) / truth - 1).abs().maxCoeff(), 2e-5);
  }
}

/// A transfer of one vertex that sees what is above the horizon on the side of `wall`, as a map of
/// distances to the nearer of the two great circles.
struct WalledPoint {
  Vector3f wall = Vector3f(1, 0, 0.3f).normalized();
  PreparedTransfer transfer;

  WalledPoint() {
    SsdfBasis basis{64, 1, 0, {}, std::vector<float>(64 * 64, 0.0f)};
    for (int i = 0; i < 64 * 64; ++i) {
      const Vector3f d = octahedral_texel_direction<float>(i % 64, i / 64, 64);
      basis.mean.push_back(
          std::min(std::asin(d.z()), std::asin(std::clamp(wall.dot(d), -1.0f, 1.0f))));
    }
    transfer = test::prepare_exactly(test::vertex_that_sees(basis));
  }
  bool sees(const Vector3d& d) const { return d.z() > 0 && wall.cast<double>().dot(d) > 0; }
};

TEST(LocalLightShadow, BesideAWallIsNearTheTruth) {
  const WalledPoint walled;
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (const float size : {0.2f, 0.6f, 1.2f}) {
    double error[2] = {}, norm[2] = {};
    for (int i = 0; i < 40; ++i) {
      const Vector3f axis = test::random_direction(random).cast<float>();
      const Frame<float> frame = test::random_frame(axis.cast<double>(), random).cast<float>();
      LightRig rigs[2];
      rigs[0].spheres.push_back({2 * axis, size, Rgb::Ones()});
      rigs[1].rectangles.push_back(
          {2 * axis, 2 * size * frame.x, size * frame.y, Rgb::Ones(), true});
      const std::vector<test::Node> nodes[2] = {
          cap_nodes(axis.cast<double>(), std::asin(double(size) / 2), 60),
          test::rectangle_nodes(rigs[1].rectangles[0], Vector3d::Zero(), 80)};
      for (int kind = 0; kind < 2; ++kind) {
        double truth = 0;
        for (const auto& [d, weight] : nodes[kind])
          if (walled.sees(d)) truth += weight * d.z();
        const double found =
            shade(walled.transfer, at_origin(), rigs[kind], white_diffuse(), Vector3f::UnitZ()).x();
        error[kind] += (found - truth) * (found - truth);
        norm[kind] += truth * truth;
      }
    }
    // One great circle cuts a disc or a rectangle that is taken as a Gaussian: at worst by .1 of
    // the whole (a disc), halfway to its edge. Few of the lights are cut.
    for (int kind = 0; kind < 2; ++kind)
      EXPECT_LT(std::sqrt(error[kind] / norm[kind]), 0.06) << "size " << size << " kind " << kind;
  }
}

Vector3f random_direction(std::mt19937& random) {
  return test::random_direction(random).cast<float>();
}

LightRig some_lights(std::mt19937& random) {
  const auto direction = [&] { return random_direction(random); };
  LightRig rig;
  for (int i = 0; i < 3; ++i) {
    EnvironmentLobe lobe;
    lobe.lobe.frame = frame_from_axis(direction());
    lobe.lobe.bandwidth_x = 3;
    lobe.lobe.bandwidth_y = 20;
    lobe.color = Rgb(1, 2, 3);
    rig.lobes.push_back(lobe);
    rig.directionals.push_back({direction(), 0.1f, Rgb(2, 1, 0)});
    rig.spheres.push_back({2 * direction(), 0.5f, Rgb(3, 4, 5)});
    const Frame<float> frame = frame_from_axis(direction());
    rig.rectangles.push_back({2 * frame.z, frame.x, 0.5f * frame.y, Rgb(6, 5, 4), i != 0});
  }
  return rig;
}

Material glossy() {
  Material m = metal(0.3f, 0.1f);
  m.diffuse = Rgb::Constant(0.5f);
  return m;
}

TEST(LightRigOperations, RotateTurnsTheDistantLightsAgainstTheScene) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  for (int i = 0; i < 10; ++i) {
    LightRig rig = some_lights(random);
    rig.spheres.clear();
    rig.rectangles.clear();
    const Eigen::Matrix3f turn =
        minimal_rotation(random_direction(random), random_direction(random));
    ShadingPoint point = at_origin(), turned = point;
    turned.frame = {turn * point.frame.x, turn * point.frame.y, turn * point.frame.z};
    const Vector3f outgoing = Vector3f(0.2f, 0.3f, 1).normalized();
    const Rgb before = shade(kOpen, point, rig, glossy(), outgoing);
    rotate(rig, turn);
    // The rounding of a rotation, magnified by exponents of up to 50.
    EXPECT_LT((shade(kOpen, turned, rig, glossy(), turn * outgoing) / before - 1).abs().maxCoeff(),
              1e-4);
    EXPECT_GT((shade(kOpen, point, rig, glossy(), outgoing) / before - 1).abs().maxCoeff(), 1e-3);
  }
}

TEST(LightRigOperations, RotateLeavesLocalLights) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  LightRig rig = some_lights(random);
  const LightRig before = rig;
  rotate(rig, minimal_rotation<float>(Vector3f::UnitX(), Vector3f::UnitY()));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(rig.spheres[i].center, before.spheres[i].center);
    EXPECT_EQ(rig.rectangles[i].edge_x, before.rectangles[i].edge_x);
    EXPECT_NE(rig.directionals[i].toward, before.directionals[i].toward);
  }
}

TEST(LightRigOperations, AddAndScaleAreLinear) {
  std::mt19937 random(kSeed + 1);
  SCOPED_TRACE(kSeed + 1);
  const Vector3f outgoing = Vector3f(0.2f, 0.3f, 1).normalized();
  const auto of = [&](const LightRig& rig) {
    return shade(kOpen, at_origin(), rig, glossy(), outgoing);
  };
  for (int i = 0; i < 10; ++i) {
    const LightRig a = some_lights(random), b = some_lights(random);
    LightRig blend = a, share = b;
    scale(blend, 0.75f);
    scale(share, 0.25f);
    add(blend, share);
    const Rgb truth = 0.75f * of(a) + 0.25f * of(b);
    ASSERT_GT(truth.minCoeff(), 0);
    EXPECT_LT((of(blend) / truth - 1).abs().maxCoeff(), 1e-5);  // two dozen sums of floats
    LightRig twice = a;
    add(twice, twice);
    EXPECT_EQ(twice.rectangles.size(), 6u);
    EXPECT_LT((of(twice) / (2 * of(a)) - 1).abs().maxCoeff(), 1e-5);
  }
}

TEST(LocalLights, ThatDoNotReachAPointAddNothing) {
  LightRig rig;
  rig.spheres.push_back({Vector3f(0, 0.5f, -2), 1, Rgb::Ones()});             // below
  rig.directionals.push_back({Vector3f(0, 0.6f, -0.8f), 0.1f, Rgb::Ones()});  // below
  rig.rectangles.push_back({Vector3f(0, 0, -1), {1, 0, 0}, {0, 1, 0}, Rgb::Ones(), true});
  rig.rectangles.push_back({Vector3f(0, 0, 1), {1, 0, 0}, {0, 1, 0}, Rgb::Ones(), false});
  const Vector3f outgoing = Vector3f(0.2f, 0.3f, 1).normalized();
  for (const CosineModel cosine : {CosineModel::constant, CosineModel::horizon_normalised})
    EXPECT_EQ(shade(kOpen, at_origin(), rig, glossy(), outgoing, {.cosine = cosine}).maxCoeff(), 0);
  // Turned to the point, the last one does.
  rig.rectangles[1].two_sided = true;
  EXPECT_GT(shade(kOpen, at_origin(), rig, glossy(), outgoing).minCoeff(), 0.1);
}

TEST(LocalLights, AreFiniteWhereverTheyAre) {
  std::mt19937 random(kSeed + 2);
  SCOPED_TRACE(kSeed + 2);
  const WalledPoint walled;
  Material sharp = glossy();
  sharp.alpha_x = kMinAlpha;
  for (const float scale : {1e-30f, 1e-6f, 1.0f, 1e6f, 1e18f}) {
    for (const float size : {1e-12f, 1e-6f, 1.0f, 1e6f}) {
      LightRig rig;
      const auto place = [&]() -> Vector3f { return scale * random_direction(random); };
      const Frame<float> frame = frame_from_axis(random_direction(random));
      const float extent = std::clamp(scale * size, 1e-37f, 1e24f);
      rig.spheres.push_back({place(), extent, Rgb::Ones()});
      rig.spheres.push_back({Vector3f::Zero(), extent, Rgb::Ones()});        // around the point
      rig.spheres.push_back({Vector3f(0, 0, extent), extent, Rgb::Ones()});  // touches it
      rig.directionals.push_back({random_direction(random), size < 1 ? size : 1.5f, Rgb::Ones()});
      rig.rectangles.push_back({place(), extent * frame.x, frame.y * scale, Rgb::Ones(), true});
      rig.rectangles.push_back(
          {Vector3f::Zero(), extent * frame.x, extent * frame.y, Rgb::Ones(), true});
      for (const Material& material : {glossy(), sharp})
        for (const PreparedTransfer* transfer : {&kOpen, &walled.transfer}) {
          const Rgb radiance = shade(*transfer, at_origin(), rig, material, Vector3f::UnitZ());
          EXPECT_TRUE(radiance.allFinite() && (radiance >= 0).all()) << scale << " " << size;
        }
    }
  }
}

TEST(PrepareLights, RefusesLightsByTheirNumberAndDropsBlackOnes) {
  const auto error_of = [](const LightRig& rig) -> std::string {
    try {
      prepare_lights(rig, kOpen, {});
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  };
  LightRig rig;
  rig.spheres.resize(2);
  rig.spheres[1].radius = 0;
  EXPECT_EQ(error_of(rig), "sphere light 1: radius is 0.000000, expected a finite number > 0");
  rig = {};
  rig.directionals.resize(1);
  rig.directionals[0].toward.setZero();
  EXPECT_EQ(error_of(rig), "directional light 0: toward has length 0.000000, expected 1");
  rig = {};
  rig.rectangles.resize(1);
  rig.rectangles[0].edge_x.setZero();
  EXPECT_EQ(error_of(rig),
            "rectangle light 0: edge_x has length 0.000000, expected a finite number > 0");
  rig = {};
  rig.spheres.resize(3);
  rig.spheres[1].radiance.y() = 1;
  rig.lobes.resize(3);
  rig.lobes[1].color.z() = -1;
  const PreparedLights lights = prepare_lights(rig, kOpen, {});
  EXPECT_EQ(lights.spheres.size(), 1u);
  EXPECT_EQ(lights.lobes.size(), 1u);
}

}  // namespace
}  // namespace burnish
