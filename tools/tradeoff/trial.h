#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/light/prefiltered_environment.h"
#include "burnish/precompute/progress.h"
#include "harness/error_metrics.h"
#include "harness/procedural_scenes.h"
#include "harness/vertex_truth.h"
#include "tradeoff/settings.h"

/// What settings cost on a scene, and how far they are from the truth.
namespace burnish::tools {

/// A scene, a light, and from where it is seen.
struct TrialScene {
  ProceduralScene scene;
  std::string environment;                ///< its name, for people
  Image map;                              ///< lat-long
  std::vector<Vector3f> eyes;             ///< one or more
  std::vector<Vector3f> check_eyes = {};  ///< for Trial::check
};

/// Eyes around a camera's target, the camera's own first, the others a turn about the upward axis
/// apart.
std::vector<Vector3f> eyes_around(const Camera& camera, int count);

struct TrialOptions {
  int vertices = 1500;  ///< drawn by `seed` for each eye, on which the error is measured; 0: all
  std::uint64_t seed = 1;
  TruthGoal truth = {.noise = 0.01, .first_samples = 64, .most_samples = 4096};
  TruthCache cache;
  /// The truth is lit by the fitted lights, at the number of lobes of each trial, instead of the
  /// map: what is measured is then the error without that of the fit.
  bool fitted_truth = false;
  int frames = 3;       ///< timed for each eye, of which the median is told
  int most_terms = 48;  ///< of SSDFs that any trial asks for: fewer are cut from those
};

struct TrialOutcome {
  double bake_s = 0;  ///< of a bake with as many terms as any trial has
  size_t file_bytes = 0;
  size_t bytes_per_vertex = 0;  ///< of a prepared transfer
  size_t bytes_shared = 0;
  double prepare_ms = 0;  ///< of the lights
  double frame_ms = 0;    ///< of all vertices on all threads, lights included
  RelativeL2 error;       ///< over the drawn vertices of all eyes
  AbsoluteErrors absolute;
};

/// Tries settings on one scene. Bakes, fits and truths are made at their first use and kept.
class Trial {
 public:
  /// Throws Error for a scene that cannot be shaded.
  Trial(TrialScene scene, const TrialOptions& options, const Progress& progress = {});
  ~Trial();

  /// Throws Cancelled when `progress` asked to stop.
  TrialOutcome run(const Settings& settings);
  /// The same on other vertices, three times as many, seen from the check_eyes: what was chosen by
  /// run() is told of without the luck that made it be chosen.
  TrialOutcome check(const Settings& settings);

  const TrialScene& scene() const { return scene_; }
  /// The transfer that run() last shaded.
  const Transfer& transfer() const;

 private:
  struct Baked;
  struct Fitted;
  struct Views;
  Baked& baked_for(const BakeOptions& bake);
  Fitted& fitted_for(int lobes);
  const VertexTruth& truth_for(const Transfer& geometry, int lobes, Views& views);
  TrialOutcome run_on(const Settings& settings, Views& views);
  std::unique_ptr<Views> draw(const std::vector<Vector3f>& eyes, size_t vertices,
                              std::uint64_t seed) const;

  TrialScene scene_;
  TrialOptions options_;
  Progress progress_;
  PrefilteredEnvironment filtered_;
  std::map<std::string, std::unique_ptr<Baked>> baked_;
  std::map<int, std::unique_ptr<Fitted>> fitted_;
  std::unique_ptr<Views> views_, check_views_;
  Baked* last_ = nullptr;
};

/// The first terms of a transfer's SSDFs, as if it had been baked with so many; the ladder and its
/// crossover stay.
Transfer with_terms(const Transfer& transfer, int terms);

}  // namespace burnish::tools
