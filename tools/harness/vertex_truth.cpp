#include "harness/vertex_truth.h"

#include <algorithm>
#include <numeric>

#include "harness/error_metrics.h"
#include "harness/parallel_progress.h"

namespace burnish {
namespace {

/// The mean of two independent estimates by equally many samples.
void average(std::span<Rgb> mean, std::span<Rgb> variance, std::span<const Rgb> other_mean,
             std::span<const Rgb> other_variance) {
  for (size_t i = 0; i < mean.size(); ++i) {
    mean[i] = (mean[i] + other_mean[i]) / 2;
    variance[i] = (variance[i] + other_variance[i]) / 4;
  }
}

/// Estimates until the goal is met: `estimate(options)` gives one, `merge` averages the next one
/// into it, `noise` is what it has then. Every estimate has as many samples as all before it.
template <class Estimate, class Merge, class Noise>
auto run_to_goal(const TruthGoal& goal, TruthQuality& quality, const Estimate& estimate,
                 const Merge& merge, const Noise& noise) {
  const auto options = [&](std::uint64_t batch, int samples) {
    return ReferenceOptions{.samples = samples, .seed = mix_seed(goal.seed, batch)};
  };
  quality.samples = std::max(goal.first_samples, 1);
  auto truth = estimate(options(0, quality.samples));
  for (std::uint64_t batch = 1;; ++batch) {
    quality.noise = noise(truth);
    quality.reached = quality.noise <= goal.noise;
    if (quality.reached || quality.samples > goal.most_samples / 2) return truth;
    merge(truth, estimate(options(batch, quality.samples)));
    quality.samples *= 2;
  }
}

VertexReference estimate_points(const Subject& subject, const ReferenceIntegrator& integrator,
                                std::span<const TruthPoint> points, const ReferenceOptions& options,
                                const Progress& progress) {
  VertexReference result;
  result.radiance.resize(points.size());
  result.variance.resize(points.size());
  parallel_with_progress("reference", points.size(), 16, progress, [&](size_t i) {
    const SurfaceMaterial at = vertex_material(subject, points[i].vertex);
    const ReferenceIntegrator::Point point = integrator.prepare(
        subject.transfer->positions[points[i].vertex], at.frame, points[i].outgoing, at.material);
    const ReferenceEstimate estimate = estimate_radiance(integrator, {&point, 1}, i, options);
    result.radiance[i] = estimate.mean.cast<float>();
    result.variance[i] = estimate.variance.cast<float>();
  });
  return result;
}

double noise_of(std::span<const Rgb> radiance, std::span<const Rgb> variance) {
  return relative_l2(radiance, radiance, variance).truth_noise;
}

/// The quality of what an earlier run kept.
TruthQuality quality_of(const StoredTruth& stored, double noise, const TruthGoal& goal) {
  return {static_cast<int>(stored.samples), noise, noise <= goal.noise};
}

}  // namespace

std::vector<TruthPoint> points_seen_from(const Subject& subject,
                                         std::span<const std::uint32_t> vertices,
                                         const Vector3f& eye) {
  std::vector<TruthPoint> points;
  for (const std::uint32_t vertex : vertices)
    points.push_back({vertex, outgoing_toward(eye, subject.transfer->positions[vertex],
                                              vertex_material(subject, vertex).frame.z)});
  return points;
}

std::vector<TruthPoint> points_seen_from(const Subject& subject, const Vector3f& eye) {
  std::vector<std::uint32_t> all(subject.transfer->vertex_count());
  std::iota(all.begin(), all.end(), 0u);
  return points_seen_from(subject, all, eye);
}

VertexTruth vertex_truth(const Subject& subject, const SceneRays& rays,
                         std::span<const TruthPoint> points, const ReferenceLights& lights,
                         const TruthGoal& goal, const TruthCache& cache, const Progress& progress) {
  const std::string key = vertex_truth_key(subject, points, lights, goal);
  if (auto stored = load_truth(cache, key, points.size(), false)) {
    const double noise = noise_of(stored->radiance, stored->variance);
    const TruthQuality quality = quality_of(*stored, noise, goal);
    return {std::move(stored->radiance), std::move(stored->variance), quality};
  }
  const ReferenceIntegrator integrator(rays.shadowing(), lights);
  VertexTruth truth;
  VertexReference reference = run_to_goal(
      goal, truth.quality,
      [&](const ReferenceOptions& options) {
        return estimate_points(subject, integrator, points, options, progress);
      },
      [](VertexReference& sum, const VertexReference& next) {
        average(sum.radiance, sum.variance, next.radiance, next.variance);
      },
      [](const VertexReference& r) { return noise_of(r.radiance, r.variance); });
  truth.radiance = std::move(reference.radiance);
  truth.variance = std::move(reference.variance);
  store_truth(
      cache, key,
      {static_cast<std::uint32_t>(truth.quality.samples), truth.radiance, truth.variance, {}});
  return truth;
}

PictureTruth picture_truth(const Subject& subject, const SceneRays& rays, const PrimaryHits& hits,
                           const ReferenceLights& lights, const TruthGoal& goal,
                           const TruthCache& cache, const Progress& progress) {
  const auto noise = [](const Picture& p) { return relative_l2(p, p).truth_noise; };
  const View& view = hits.view;
  const std::string key = picture_truth_key(subject, view, lights, goal);
  const size_t pixels = static_cast<size_t>(view.width) * static_cast<size_t>(view.height);
  PictureTruth truth;
  if (auto stored = load_truth(cache, key, pixels, true)) {
    truth.picture.radiance = truth.picture.variance = Image(view.width, view.height);
    truth.picture.radiance.pixels = std::move(stored->radiance);
    truth.picture.variance.pixels = std::move(stored->variance);
    truth.picture.hit = std::move(stored->hit);
    truth.quality = quality_of(*stored, noise(truth.picture), goal);
    return truth;
  }
  truth.picture = run_to_goal(
      goal, truth.quality,
      [&](const ReferenceOptions& options) {
        return render_reference(subject, rays, hits, lights, options, progress);
      },
      [](Picture& sum, const Picture& next) {
        average(sum.radiance.pixels, sum.variance.pixels, next.radiance.pixels,
                next.variance.pixels);
      },
      noise);
  store_truth(cache, key,
              {static_cast<std::uint32_t>(truth.quality.samples), truth.picture.radiance.pixels,
               truth.picture.variance.pixels, truth.picture.hit});
  return truth;
}

}  // namespace burnish
