#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/light/prefiltered_environment.h"
#include "burnish/precompute/progress.h"
#include "harness/error_metrics.h"
#include "harness/procedural_scenes.h"
#include "harness/rivals/rival.h"
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
  int frames = 3;       ///< timed for each eye, of which the shortest counts
  int most_terms = 48;  ///< of SSDFs that any trial asks for: fewer are cut from those
};

struct TrialOutcome {
  double bake_s = 0;            ///< of a bake with as many terms as any trial has, and a ladder
  size_t file_bytes = 0;        ///< 0: it has no file
  size_t bytes_per_vertex = 0;  ///< of a prepared transfer
  size_t bytes_shared = 0;
  double prepare_ms = 0;    ///< of the lights
  double frame_ms = 0;      ///< of all vertices on all threads, lights included; 0: not measured
  double frame_cpu_ms = 0;  ///< processor time of a frame, summed over threads
  RelativeL2 error;         ///< over the drawn vertices of all eyes
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

  /// The same of another way to shade, made from the bake and the lights of `settings`. With
  /// `vertices`, only on so many of those drawn for the first eye, and no frame is timed: for
  /// rivals that are too large for a whole mesh.
  using MakeRival = std::function<Rival(const RivalScene& scene)>;
  TrialOutcome run_rival(const Settings& settings, const MakeRival& make, int vertices = 0);

  /// A view of the scene, shaded by vertex, and the truth about it, both under the map.
  /// @{
  Picture render(const Settings& settings, const View& view);
  Picture render_truth(const View& view, const TruthGoal& goal);
  /// @}

  /// A name for all that errors depend on but the settings: a hash of mesh, materials, map, eyes,
  /// drawn vertices and the truth's goal.
  std::string key() const;

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
  const SceneRays& rays_for(const Transfer& geometry);
  Subject subject_of(const Transfer& transfer, const PreparedTransfer* prepared) const;
  static std::vector<TruthPoint> points_of(const Subject& subject, const Views& views);
  using Shade = std::function<std::vector<Rgb>(const Vector3f& eye)>;
  /// Frames of all eyes: their times, and errors at the drawn vertices.
  void measure(const std::function<void()>& prepare, const Shade& shade, const Views& views,
               const VertexTruth& truth, TrialOutcome& outcome) const;
  /// `places` are those of the truth that were shaded.
  static void compare(const std::vector<Rgb>& shaded, const VertexTruth& truth,
                      const std::vector<size_t>& places, TrialOutcome& outcome);

  TrialScene scene_;
  TrialOptions options_;
  Progress progress_;
  std::shared_ptr<PrefilteredEnvironment> filtered_;
  std::map<std::string, std::unique_ptr<Baked>> baked_;
  std::map<int, std::unique_ptr<Fitted>> fitted_;
  std::unique_ptr<Views> views_, check_views_;
  std::optional<SceneRays> rays_;
  Baked* last_ = nullptr;
};

/// The first terms of a transfer's SSDFs: as if it had been baked with so many, but for the
/// ladder's crossover and, of several bases, for which vertex is in which.
Transfer with_terms(const Transfer& transfer, int terms);
Transfer without_ladder(Transfer transfer);

}  // namespace burnish::tools
