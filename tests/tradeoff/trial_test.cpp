// What settings are said to cost and to err by.

#include "tradeoff/trial.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "burnish/formats/transfer_file.h"
#include "formats/files.h"
#include "harness/render.h"
#include "harness/studio_environment.h"
#include "tradeoff/grid.h"

namespace burnish::tools {
namespace {

Settings small_settings() {
  Settings settings;
  settings.bake.directions = 64;
  settings.bake.resolution = 16;
  settings.bake.terms = settings.bake.ladder_terms = 12;
  settings.bake.bases = 2;
  settings.bake.training_vertices = 256;
  settings.lobes = 4;
  return settings;
}

TrialScene small_scene() {
  ProceduralScene scene = make_knot(1500);
  const std::vector<Vector3f> eyes = eyes_around(scene.camera, 2);
  return {std::move(scene), "studio", studio_environment(), eyes};
}

TrialOptions small_options() {
  TrialOptions options;
  options.vertices = 100;
  options.truth = {.noise = 0, .first_samples = 64, .most_samples = 64};
  options.cache.folder.clear();
  options.frames = 1;
  options.most_terms = 12;
  return options;
}

/// All vertices: the error is that of shade_all_vertices against the integrator.
TEST(Trial, ErrorIsThatOfAllVerticesAgainstTheTruth) {
  TrialOptions options = small_options();
  options.vertices = 0;
  Trial trial(small_scene(), options);
  const TrialOutcome outcome = trial.run(small_settings());
  const TrialScene& scene = trial.scene();
  EXPECT_EQ(outcome.error.count, 2 * scene.scene.mesh.positions.size());
  EXPECT_GT(outcome.error.value, 0.01);
  EXPECT_LT(outcome.error.value, 1);
  EXPECT_GT(outcome.absolute.percentile_95, outcome.absolute.mean);
  const test::TemporaryFolder folder;
  write_transfer(trial.transfer(), folder.file("a.h5"));
  EXPECT_EQ(outcome.file_bytes, std::filesystem::file_size(folder.file("a.h5")));
  EXPECT_EQ(outcome.bytes_per_vertex, 3 * 12 + 1 + 2 * (12u + 12u));
  EXPECT_GT(outcome.bake_s, 0);
  EXPECT_GT(outcome.frame_ms, outcome.prepare_ms);
}

TEST(Trial, DrawnVerticesTellAboutAll) {
  TrialOptions options = small_options();
  Trial some(small_scene(), options);
  options.vertices = 0;
  Trial all(small_scene(), options);
  const double found = some.run(small_settings()).error.value;
  const double truth = all.run(small_settings()).error.value;
  // 200 of 3000 values: the error's own deviation is some 10 % where few vertices hold most of it.
  EXPECT_NEAR(found, truth, 0.4 * truth);
}

TEST(Trial, FewerTermsAreThoseOfABakeWithFewer) {
  Trial trial(small_scene(), small_options());
  Settings fewer = small_settings();
  fewer.bake.terms = 5;
  trial.run(fewer);
  const Transfer cut = trial.transfer();
  ASSERT_EQ(cut.terms(), 5);
  EXPECT_EQ(cut.ladder_terms(), 12);
  trial.run(small_settings());
  const Transfer whole = trial.transfer();
  ASSERT_EQ(whole.terms(), 12);
  for (size_t vertex = 0; vertex < whole.vertex_count(); vertex += 97)
    for (int k = 0; k < 5; ++k)
      EXPECT_EQ(cut.vertex_coefficients(vertex)[k], whole.vertex_coefficients(vertex)[k]);
}

TEST(Trial, WithoutTheFitsErrorLittleIsLeft) {
  TrialOptions options = small_options();
  Settings settings = small_settings();
  settings.lobes = 2;  // a poor fit
  TrialScene scene = small_scene();
  for (Material& material : scene.scene.materials) material.model = SpecularModel::none;
  Trial under_map(scene, options);
  options.fitted_truth = true;
  Trial under_lobes(scene, options);
  EXPECT_LT(under_lobes.run(settings).error.without_noise,
            0.8 * under_map.run(settings).error.without_noise);
}

TEST(Grid, VariesWhatTheMaterialsHave) {
  const GridOptions options{small_settings()};
  const Material diffuse;
  Material glossy;
  glossy.model = SpecularModel::ward;
  const auto names = [&](const Material& material) {
    std::string text;
    for (const GridPoint& point : tradeoff_grid({material}, options)) text += point.name + "\n";
    return text;
  };
  for (const char* dial : {"terms 8\n", "ladder terms 16\n", "bases 4\n", "resolution 64\n",
                           "lobes 24\n", "visibility cap\n", "cosine constant\n", "integral fast\n",
                           "paper\n", "fast", "balanced", "accurate"}) {
    EXPECT_NE(names(diffuse).find(dial), std::string::npos) << dial;
    EXPECT_NE(names(glossy).find(dial), std::string::npos) << dial;
  }
  for (const char* dial : {"taps 9\n", "map taps 3\n", "highlights from lobes\n"}) {
    EXPECT_EQ(names(diffuse).find(dial), std::string::npos) << dial;
    EXPECT_NE(names(glossy).find(dial), std::string::npos) << dial;
  }
  EXPECT_LT(tuning_grid({diffuse}, options).size(), tuning_grid({glossy}, options).size());
}

}  // namespace
}  // namespace burnish::tools
