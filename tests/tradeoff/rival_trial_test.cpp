#include <gtest/gtest.h>

#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/unshadowed_rival.h"
#include "harness/shapes.h"
#include "harness/studio_environment.h"
#include "tradeoff/grid.h"
#include "tradeoff/trial.h"

namespace burnish::tools {
namespace {

/// A matte ball over a floor under the studio, in few vertices.
TrialScene small_scene() {
  TrialScene scene;
  append_floor(scene.scene.mesh, 2, 8, 0.5);
  append_sphere(scene.scene.mesh, Vector3f(0, 0.9f, 0), 0.5, 12, 6);
  scene.scene.name = "ball";
  scene.scene.materials = {Material{}};
  scene.scene.camera.origin = Vector3f(1.5f, 2.5f, 2);
  scene.environment = "studio";
  scene.map = studio_environment();
  scene.eyes = eyes_around(scene.scene.camera, 2);
  return scene;
}

TrialOptions small_options() {
  TrialOptions options;
  options.vertices = 60;
  options.truth = {.noise = 0.05, .first_samples = 64, .most_samples = 256};
  options.cache.folder = "";
  options.frames = 1;
  options.most_terms = 16;
  return options;
}

Settings small_settings() {
  Settings settings;
  settings.bake = {.directions = 64, .resolution = 32, .terms = 16, .bases = 1, .ladder_terms = 16};
  settings.lobes = 4;
  return settings;
}

TEST(EyesAround, StandOnACircleAboutTheTarget) {
  const Camera camera = {Vector3f(1, 2, 3), Vector3f(0.5f, 0, 0)};
  const std::vector<Vector3f> eyes = eyes_around(camera, 4);
  ASSERT_EQ(eyes.size(), 4u);
  EXPECT_EQ(eyes[0], camera.origin);
  // Halfway round, the other side of the axis; roundings of a rotation.
  EXPECT_LT((eyes[2] - Vector3f(0, 2, -3)).norm(), 1e-5f);
  for (const Vector3f& eye : eyes) EXPECT_NEAR(eye.y(), 2, 1e-5);
}

TEST(WithTerms, KeepsTheFirstTermsOfEachVertexAndTexel) {
  Transfer transfer;
  transfer.positions.resize(2);
  transfer.coefficients = {1, 2, 3, 4, 5, 6};
  SsdfBasis basis;
  basis.terms = 3;
  basis.eigen = {1, 2, 3, 4, 5, 6};
  transfer.bases = {basis};
  const Transfer cut = with_terms(transfer, 2);
  EXPECT_EQ(cut.coefficients, (std::vector<float>{1, 2, 4, 5}));
  EXPECT_EQ(cut.bases[0].eigen, (std::vector<float>{1, 2, 4, 5}));
  EXPECT_EQ(cut.terms(), 2);
  EXPECT_EQ(with_terms(transfer, 9).coefficients, transfer.coefficients);
}

TEST(WithoutLadder, KeepsOnlyTheSsdf) {
  Transfer transfer;
  transfer.positions.resize(2);
  transfer.coefficients = {1, 2};
  transfer.ladder_coefficients = {3, 4};
  transfer.ladder_bases.resize(1);
  transfer.ladder_bases[0].terms = 1;
  transfer.ladder_crossover = 20;
  const Transfer cut = without_ladder(transfer);
  EXPECT_EQ(cut.coefficients, transfer.coefficients);
  EXPECT_TRUE(cut.ladder_coefficients.empty());
  EXPECT_EQ(cut.ladder_terms(), 0);
  EXPECT_EQ(cut.ladder_crossover, 0);
}

TEST(TrialOfABall, TellsWhatSettingsCostAndErr) {
  Trial trial(small_scene(), small_options());
  const TrialOutcome most = trial.run(small_settings());
  EXPECT_GT(most.frame_ms, 0);
  EXPECT_GE(most.frame_ms, most.prepare_ms);
  EXPECT_GT(most.frame_cpu_ms, 0);
  EXPECT_GT(most.bake_s, 0);
  EXPECT_GT(most.file_bytes, 1000u);
  EXPECT_EQ(most.error.count, 120u);  // 60 vertices of 2 eyes
  EXPECT_GT(most.error.value, 0);
  EXPECT_LT(most.error.value, 0.5);  // ours is not that bad, nor is it off by a scale

  Settings few = small_settings();
  few.bake.terms = few.bake.ladder_terms = 2;
  few.lobes = 1;
  const TrialOutcome least = trial.run(few);
  EXPECT_LT(least.bytes_per_vertex, most.bytes_per_vertex);
  EXPECT_LT(least.file_bytes, most.file_bytes);
  EXPECT_GT(least.error.value, most.error.value);
  // Run again: the same figures, but for times.
  EXPECT_EQ(trial.run(small_settings()).error.value, most.error.value);
}

TEST(TrialOfABall, ARivalThatIsTheRuntimeErrsAsTheRuntime) {
  Trial trial(small_scene(), small_options());
  const Settings settings = small_settings();
  const TrialOutcome ours = trial.run(settings);
  const auto make = [&](const RivalScene& scene) {
    return runtime_rival(scene, "ours", {settings.shading});
  };
  const TrialOutcome rival = trial.run_rival(settings, make);
  EXPECT_NEAR(rival.error.value, ours.error.value, 1e-4);  // blocks of other sizes round otherwise
  EXPECT_EQ(rival.error.count, ours.error.count);
  EXPECT_GT(rival.frame_ms, 0);
  // On a part of the first eye's vertices: all of them are half of those of both eyes.
  const TrialOutcome part = trial.run_rival(settings, make, 60);
  EXPECT_EQ(part.error.count, 60u);
  EXPECT_EQ(part.frame_ms, 0);
  EXPECT_GT(part.error.value, 0);
  EXPECT_LT(part.error.value, 2 * ours.error.value);
  // What casts no shadows errs more where there are some.
  const auto unshadowed = [](const RivalScene& scene) { return unshadowed_rival(scene); };
  EXPECT_GT(trial.run_rival(settings, unshadowed).error.value, ours.error.value);
}

TEST(TrialOfABall, PicturesAreCloseToTheTruth) {
  Trial trial(small_scene(), small_options());
  const View view = {small_scene().scene.camera, 24, 16, 1};
  const Picture shaded = trial.render(small_settings(), view);
  const Picture truth = trial.render_truth(view, {.noise = 0.05, .first_samples = 64});
  EXPECT_EQ(shaded.hit, truth.hit);
  const RelativeL2 error = relative_l2(shaded, truth);
  EXPECT_GT(error.count, 20u);
  EXPECT_LT(error.value, 0.5);
  // What is behind the mesh is the map in both.
  for (size_t i = 0; i < truth.hit.size(); ++i)
    if (!truth.hit[i] && i < 24) {
      EXPECT_TRUE((truth.radiance.pixels[i] > 0).any()) << i;
    }
}

TEST(TrialKey, DependsOnMaterialViewsAndGoal) {
  const std::string key = Trial(small_scene(), small_options()).key();
  EXPECT_EQ(Trial(small_scene(), small_options()).key(), key);
  TrialScene red = small_scene();
  red.scene.materials[0].diffuse = Rgb(1, 0, 0);
  EXPECT_NE(Trial(red, small_options()).key(), key);
  TrialScene alone = small_scene();
  alone.eyes.pop_back();
  EXPECT_NE(Trial(alone, small_options()).key(), key);
  TrialOptions options = small_options();
  options.truth.noise = 0.04;
  EXPECT_NE(Trial(small_scene(), options).key(), key);
  options = small_options();
  options.seed = 2;
  EXPECT_NE(Trial(small_scene(), options).key(), key);
}

TEST(TradeoffGrid, HasThePresetsAndThePapersOnceWhateverTheBase) {
  GridOptions options;
  options.base.bake.terms = 8;
  options.base.lobes = 5;
  Material shiny;
  shiny.model = SpecularModel::ward;
  shiny.specular = Rgb::Constant(0.5f);
  for (const Material& material : {Material{}, shiny})
    for (const char* name : {"fast", "balanced", "accurate", "paper", "paper, cap"}) {
      int found = 0;
      for (const GridPoint& point : tradeoff_grid({material}, options)) found += point.name == name;
      EXPECT_EQ(found, 1) << name;
    }
  const auto taps = [&](const Material& material) {
    int found = 0;
    for (const GridPoint& point : tradeoff_grid({material}, options))
      found += point.name.starts_with("taps");
    return found;
  };
  EXPECT_EQ(taps(Material{}), 0);
  EXPECT_GT(taps(shiny), 0);
}

}  // namespace
}  // namespace burnish::tools
