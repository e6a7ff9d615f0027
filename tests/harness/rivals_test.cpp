// The rivals that share most with our runtime, and those that share nothing.

#include <cmath>

#include <gtest/gtest.h>

#include "burnish/visibility/ssdf.h"
#include "harness/error_metrics.h"
#include "harness/rivals/monte_carlo_rival.h"
#include "harness/rivals/rival.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/uncompressed_rival.h"
#include "harness/rivals/unshadowed_rival.h"
#include "harness/rivals/view_table.h"
#include "rival_scenes.h"

namespace burnish {
namespace {

using test::SmallScene;

VertexReference reference_of(const SmallScene& small, int samples) {
  return shade_reference_vertices(small.scene.subject, small.rays, small.eye, {{&small.map}},
                                  {.samples = samples});
}

TEST(RuntimeRival, IsTheRuntime) {
  const SmallScene small(test::floor_mesh(), test::shiny(0.3f, 0.1f), studio_environment(128));
  const ShadingOptions options = shading_options(Quality::accurate);
  const Eigen::Matrix3f turn = test::some_turn();
  const std::vector<Rgb> values =
      test::shaded(runtime_rival(small.scene, "accurate", {options}), small, turn);
  LightRig rig = small.scene.rig;
  rotate(rig, turn);
  const PreparedLights lights = prepare_lights(rig, small.prepared, options);
  PrefilteredEnvironment filtered = *small.scene.filtered;
  filtered.environment_from_world = turn.transpose();
  std::vector<Rgb> truth(values.size());
  shade_vertices(small.prepared, {&lights, &filtered}, prepare_materials(small.materials, options),
                 {}, small.eye, options, 0, truth);
  for (size_t v = 0; v < truth.size(); ++v) ASSERT_TRUE((values[v] == truth[v]).all()) << v;
}

TEST(RivalScene, APartOfTheVerticesIsShadedAsTheWhole) {
  const SmallScene small(test::floor_mesh(), test::shiny(0.3f, 0.1f), studio_environment(128));
  const std::vector<std::uint32_t> drawn = draw_vertices(small.transfer.vertex_count(), 40, 3);
  ASSERT_EQ(drawn.size(), 40u);
  EXPECT_TRUE(std::is_sorted(drawn.begin(), drawn.end()));
  EXPECT_EQ(draw_vertices(5, 40, 3).size(), 5u);
  EXPECT_NE(drawn, draw_vertices(small.transfer.vertex_count(), 40, 4));
  const Transfer part = vertex_subset(small.transfer, drawn);
  const PreparedTransfer prepared = prepare_transfer(part, RowFormat::float32);
  RivalScene scene = small.scene;
  scene.subject.transfer = &part;
  scene.subject.prepared = &prepared;
  const ShadingOptions options;
  const std::vector<Rgb> all = test::shaded(runtime_rival(small.scene, "all", {options}), small);
  const Rival rival = runtime_rival(scene, "part", {options});
  rival.prepare_lights(Eigen::Matrix3f::Identity());
  const std::vector<Rgb> some = shade_vertices(rival, drawn.size(), small.eye);
  for (size_t i = 0; i < drawn.size(); ++i) EXPECT_TRUE((some[i] == all[drawn[i]]).all()) << i;
}

TEST(RivalScene, IncompleteOnesAreRefused) {
  SmallScene small(test::ball_mesh(), test::matte(), studio_environment(64));
  EXPECT_NO_THROW(require_complete(small.scene));
  small.scene.filtered = nullptr;
  EXPECT_THROW(unshadowed_rival(small.scene), std::invalid_argument);
  EXPECT_THROW(monte_carlo_rival(small.scene, 4), std::invalid_argument);
}

TEST(UncompressedRival, DiffuseIsThatOfTheSsdfItself) {
  const SmallScene small(test::floor_mesh(), test::matte(), studio_environment(128));
  UncompressedOptions options;
  options.shading = paper_shading_options();
  options.directions = 128;
  options.resolution = 64;
  const std::vector<Rgb> values = test::shaded(uncompressed_rival(small.scene, options), small);
  const std::vector<float> ssdfs = vertex_ssdfs(small.scene, 128, 64);
  std::vector<Rgb> truth;
  for (size_t v = 0; v < values.size(); ++v) {
    Rgb irradiance = Rgb::Zero();
    for (const EnvironmentLobe& light : small.scene.rig.lobes) {
      const Vector3f& axis = light.lobe.frame.z;
      const double sharpness = effective_sharpness(light.lobe);
      const double distance = lookup_ssdf(ssdfs.data() + v * 64 * 64, 64, axis).distance;
      irradiance +=
          light.color *
          float(integral(light.lobe) * std::max(axis.dot(small.transfer.normals[v]), 0.0f) *
                visible_fraction_hemisphere(sharpness, distance, HemisphereLevel::exact));
    }
    truth.push_back(small.materials[0].diffuse / kPi<float> * irradiance);
  }
  // The fast level of the visible fraction.
  EXPECT_LT(relative_l2(values, truth).value, 5e-3);
}

TEST(UncompressedRival, ComesNearerToTheTruthThanFewTerms) {
  const SmallScene small(test::floor_mesh(), test::shiny(0.2f, 0.2f), studio_environment(128));
  const VertexReference truth = reference_of(small, 256);
  const auto error_of = [&](const Rival& rival) {
    return relative_l2(test::shaded(rival, small), truth.radiance, truth.variance).without_noise;
  };
  UncompressedOptions options;
  options.directions = 256;
  ShadingOptions few;
  few.terms = 2;
  for (const bool ladder : {false, true}) {
    options.ladder = ladder;
    EXPECT_LT(error_of(uncompressed_rival(small.scene, options)),
              0.8 * error_of(runtime_rival(small.scene, "two terms", {few})));
  }
}

TEST(UncompressedRival, VerticesOfSeveralChunksKeepTheirOrder) {
  TriangleMesh mesh;  // 441 vertices, in two chunks
  append_floor(mesh, 2, 20, 0.5);
  append_sphere(mesh, Vector3f(0, 0.9f, 0), 0.5, 8, 4);
  const SmallScene small(mesh, test::matte(), studio_environment(64));
  const Rival rival = uncompressed_rival(small.scene, {.directions = 64, .resolution = 32});
  const std::vector<Rgb> all = test::shaded(rival, small);
  ASSERT_GT(all.size(), 300u);
  std::vector<Rgb> part(20);
  rival.shade(small.eye, 246, part);
  for (size_t i = 0; i < part.size(); ++i) EXPECT_TRUE((part[i] == all[246 + i]).all()) << i;
}

TEST(UnshadowedRival, IsTheReferenceOfAConvexMeshForWhatItIsMadeFor) {
  const auto error_of = [](const Material& material) {
    const SmallScene small(test::ball_mesh(), material, studio_environment(128));
    const VertexReference truth = reference_of(small, 256);
    const RelativeL2 error = relative_l2(test::shaded(unshadowed_rival(small.scene), small),
                                         truth.radiance, truth.variance);
    EXPECT_LT(error.truth_noise, 0.025);
    return error.without_noise;
  };
  // The filtered map's own error, and what the noise leaves: a quarter of itself.
  EXPECT_LT(error_of(test::matte()), 0.012);
  // The lobe's shape at slanting views is left out: more of a wider one.
  EXPECT_LT(error_of(test::shiny(0.05f, 0.05f)), 0.15);
}

TEST(UnshadowedRival, SeesNoShadow) {
  const SmallScene open(test::ball_mesh(), test::matte(), studio_environment(128));
  const SmallScene small(test::floor_mesh(), test::matte(), studio_environment(128));
  const std::vector<Rgb> values = test::shaded(unshadowed_rival(small.scene), small);
  const VertexReference truth = reference_of(small, 128);
  double dark = 0;
  for (size_t v = 0; v < values.size(); ++v)
    dark = std::max(dark, double(values[v].x() / std::max(truth.radiance[v].x(), 1e-6f)));
  EXPECT_GT(dark, 3) << "some vertex between ball and floor sees little";
}

TEST(UnshadowedRival, LocalLightsShine) {
  SmallScene small(test::ball_mesh(), test::matte(), Image(64, 32, Rgb::Zero()));
  small.scene.rig = {};
  const SphereLight lamp = {Vector3f(0, 4, 0), 0.3f, Rgb::Constant(20)};
  small.scene.rig.spheres = {lamp};
  const std::vector<Rgb> values = test::shaded(unshadowed_rival(small.scene), small);
  const VertexReference truth = shade_reference_vertices(small.scene.subject, small.rays, small.eye,
                                                         {{}, {&lamp, 1}}, {.samples = 64});
  // A sphere light cut by the horizon is approximated by less than 1 %.
  EXPECT_LT(relative_l2(values, truth.radiance, truth.variance).value, 0.02);
}

TEST(ViewTable, IsLinearInBetweenAndClosesAroundTheNormal) {
  const ViewTable table(2, [](const Vector3f& outgoing, std::span<float> values) {
    values[0] = 1 + outgoing.x();
    values[1] = outgoing.z();
  });
  for (const float angle : {0.0f, 0.3f, 1.0f, 1.5f})
    for (const float azimuth : {-3.1f, -0.01f, 0.01f, 2.0f, 3.14f}) {
      const Vector3f outgoing(std::sin(angle) * std::cos(azimuth),
                              std::sin(angle) * std::sin(azimuth), std::cos(angle));
      float values[2];
      table.eval(outgoing, values);
      // Steps of 1/20 and 1/30 rad: h^2 / 8.
      EXPECT_NEAR(values[0], 1 + outgoing.x(), 5e-4) << angle << " " << azimuth;
      EXPECT_NEAR(values[1], std::max(outgoing.z(), 0.02f), 5e-4) << angle << " " << azimuth;
    }
}

TEST(ViewTable, AlbedoIsThatOfAWhiteFurnace) {
  const Material material = test::shiny(0.4f, 0.15f);
  const SmallScene small(test::ball_mesh(), material, Image(32, 16, Rgb::Ones()));
  const VertexReference truth = reference_of(small, 256);
  const ViewTable table = albedo_table(material);
  std::vector<Rgb> values(truth.radiance.size());
  for (size_t v = 0; v < values.size(); ++v)
    table.eval(view_vertex(small.transfer, v, small.eye).outgoing, {values[v].data(), 3});
  const RelativeL2 error = relative_l2(values, truth.radiance, truth.variance);
  EXPECT_LT(error.truth_noise, 0.02);
  EXPECT_LT(error.without_noise, 0.01);  // of two sets of samples, and half the noise
}

TEST(MonteCarloLaw, IsThatOfIndependentSamples) {
  const SmallScene small(test::floor_mesh(), test::shiny(0.3f, 0.1f), studio_environment(128));
  std::vector<MonteCarloRun> runs;
  // A sequence of one sample each: independent ones.
  for (const int samples : {16, 64, 256})
    runs.push_back(run_monte_carlo(small.scene, Eigen::Matrix3f::Identity(), small.eye,
                                   {.samples = samples, .replicates = samples}));
  for (size_t i = 1; i < runs.size(); ++i) {
    const double predicted =
        monte_carlo_law({runs.data(), 1}).error_of_one / std::sqrt(runs[i].samples);
    // Some 300 vertices' variances, each known to a third from 16 samples.
    EXPECT_NEAR(runs[i].error / predicted, 1, 0.1) << runs[i].samples;
  }
  EXPECT_NEAR(monte_carlo_law(runs).exponent, 0.5, 0.04);
}

TEST(MonteCarloLaw, StatesTheErrorOfTheRival) {
  const SmallScene small(test::floor_mesh(), test::shiny(0.3f, 0.1f), studio_environment(128));
  const VertexReference truth = reference_of(small, 2048);
  const std::vector<Rgb> values = test::shaded(monte_carlo_rival(small.scene, 16, 99), small);
  const double error = relative_l2(values, truth.radiance, truth.variance).without_noise;
  std::vector<MonteCarloRun> runs;
  for (const int samples : {64, 256})
    runs.push_back(run_monte_carlo(small.scene, Eigen::Matrix3f::Identity(), small.eye,
                                   {.samples = samples, .replicates = 8}));
  const MonteCarloLaw law = monte_carlo_law(runs);
  EXPECT_GE(law.exponent, 0.45);
  // 64 samples in 8 sequences of 8: as well spread as 16 in two.
  EXPECT_NEAR(error / (runs[0].error * 2), 1, 0.25);
}

TEST(MonteCarloLaw, SolvesForTimeAndError) {
  const std::vector<MonteCarloRun> one = {{16, 2, 0.1}};
  const MonteCarloLaw law = monte_carlo_law(one);
  EXPECT_DOUBLE_EQ(law.exponent, 0.5);
  EXPECT_NEAR(monte_carlo_error_at(law, 8), 0.05, 1e-12);
  EXPECT_NEAR(monte_carlo_seconds_at(law, 0.05), 8, 1e-9);
  EXPECT_NEAR(monte_carlo_samples_at(law, 0.05), 64, 1e-9);
  const MonteCarloLaw steep = monte_carlo_law(
      std::vector<MonteCarloRun>{{16, 2, 0.1}, {64, 8, 0.1 / 3}, {256, 32, 0.1 / 9}});
  EXPECT_NEAR(steep.exponent, std::log(3.0) / std::log(4.0), 1e-9);
  EXPECT_NEAR(monte_carlo_error_at(steep, 8), 0.1 / 3, 1e-9);
  EXPECT_THROW(monte_carlo_law({}), std::invalid_argument);
  EXPECT_THROW(monte_carlo_law(std::vector<MonteCarloRun>{{16, 2, 0}}), std::invalid_argument);
}

}  // namespace
}  // namespace burnish
