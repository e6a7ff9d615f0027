#include <cmath>

#include "burnish/sphere/batch.h"
#include "common/interrupt.h"
#include "harness/reference_integrator.h"
#include "harness/render.h"
#include "shade_tables.h"

namespace burnish::tools {
namespace {

/// Samples a vertex of the run by which the reference integrator's speed is told.
constexpr int kTimedSamples = 16;

Subject subject_of(const ShadeScene& scene, std::span<const Material> materials) {
  return {&scene.transfer, materials, {}, nullptr, &scene.prepared};
}

}  // namespace

std::vector<BenchRow> pixels_table(const ShadeBench& bench) {
  const ShadeScene& scene = bench.scene;
  const std::vector<Material> materials = {ashikhmin_8_800()};
  const Subject subject = subject_of(scene, materials);
  const SceneRays rays(scene.transfer);
  const PrimaryHits hits = trace_primary_rays(rays, {scene.camera, 720, 480, 1});
  size_t met = 0;
  for (const PrimaryHit& hit : hits.hits) met += hit.triangle != PrimaryHit::kMiss;
  std::vector<BenchRow> rows;
  for (const auto& [name, options] : all_options()) {
    PreparedLights lights;
    const Timing timing = measure(bench.options, [&, &shading = options] {
      prepare_lights(scene.rig, scene.prepared, shading, lights);
      render(subject, hits, {&lights, &scene.filtered}, {&scene.studio}, ShadePer::pixel, shading);
    });
    BenchRow row = {{"what", "pixels"}, {"row", name + ", map"}};
    row["vertices"] = scene.transfer.vertex_count();
    row["pixels"] = hits.hits.size();
    row["pixels_met"] = met;
    row["trace_ms"] = hits.trace_ms;
    add_timing(row, timing, bench.options);
    row["fps"] = 1 / timing.median_s;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<BenchRow> monte_carlo_table(const ShadeBench& bench) {
  ShadeScene& scene = bench.scene;
  const std::vector<Material> materials = {ashikhmin_8_800()};
  const Subject subject = subject_of(scene, materials);
  const SceneRays rays(scene.transfer);
  const auto reference = [&](int samples, std::uint64_t seed) {
    return shade_reference_vertices(subject, rays, scene.camera.origin, {{&scene.studio}, {}},
                                    {.samples = samples, .seed = seed}, bench.work.progress());
  };
  const VertexReference truth =
      reference(std::max(bench.subject.reference_samples, kTimedSamples), bench.subject.seed);
  const Stopwatch watch;
  const VertexReference rough = reference(kTimedSamples, bench.subject.seed + 1);
  const double rough_s = watch.seconds();
  throw_if_interrupted();
  // Its own standard error, from its variance.
  const double rough_error =
      relative_l2(rough.radiance, truth.radiance, rough.variance).truth_noise;

  std::vector<MovingFrame> frames;
  for (const NamedOptions& options : all_options())
    frames.push_back(scene_frame(scene, options, true));
  const std::vector<FrameTiming> timings = measure_frames(frames, bench.options);
  std::vector<BenchRow> rows;
  for (size_t i = 0; i < frames.size(); ++i) {
    draw_frame(frames[i], 0);
    const RelativeL2 error = relative_l2(frames[i].radiance, truth.radiance, truth.variance);
    BenchRow row = frame_row("monte-carlo", frames[i], timings[i], bench.options);
    row["relative_l2"] = error.without_noise;
    row["truth_noise"] = error.truth_noise;
    row["reference_samples"] = kTimedSamples;
    row["reference_l2"] = rough_error;
    row["reference_s"] = rough_s;
    // Not to be told where the frame's error drowns in the truth's noise.
    if (error.without_noise > 0) {
      const double more = std::pow(rough_error / error.without_noise, 2);
      row["samples_at_equal_error"] = kTimedSamples * more;
      row["reference_s_at_equal_error"] = rough_s * more;
      row["reference_over_frame"] = rough_s * more / timings[i].frame.median_s;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace burnish::tools
