#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "harness/reference_integrator.h"
#include "harness/truth_cache.h"
#include "harness/truth_goal.h"

/// The truth to a stated error, by the reference integrator, kept between runs.
///
///     const std::vector<TruthPoint> points = points_seen_from(subject, vertices, eye);
///     const VertexTruth truth = vertex_truth(subject, rays, points, lights, {.noise = 0.002}, {});
///     const RelativeL2 error = relative_l2(shaded, truth.radiance, truth.variance);
///     if (!above_noise(error)) ...  // the truth cannot tell how large the error is
namespace burnish {

/// A vertex and the direction in which its radiance is asked for.
struct TruthPoint {
  std::uint32_t vertex = 0;
  Vector3f outgoing = Vector3f::UnitZ();  ///< unit, of the world
};

/// The vertices as shade_vertices sees them from `eye`.
std::vector<TruthPoint> points_seen_from(const Subject& subject,
                                         std::span<const std::uint32_t> vertices,
                                         const Vector3f& eye);
/// All of them.
std::vector<TruthPoint> points_seen_from(const Subject& subject, const Vector3f& eye);

struct VertexTruth {
  std::vector<Rgb> radiance;  ///< one a point
  std::vector<Rgb> variance;  ///< as long, of the mean
  TruthQuality quality;
};

/// Runs the integrator until the goal is met, or reads what an earlier run kept. The same at any
/// number of threads, and bit for bit the same when it is read. Throws Cancelled when `progress`
/// asked to stop.
VertexTruth vertex_truth(const Subject& subject, const SceneRays& rays,
                         std::span<const TruthPoint> points, const ReferenceLights& lights,
                         const TruthGoal& goal, const TruthCache& cache,
                         const Progress& progress = {});

/// The same of a picture, as render_reference makes it.
struct PictureTruth {
  Picture picture;
  TruthQuality quality;
};
PictureTruth picture_truth(const Subject& subject, const SceneRays& rays, const PrimaryHits& hits,
                           const ReferenceLights& lights, const TruthGoal& goal,
                           const TruthCache& cache, const Progress& progress = {});

/// Names under which truths are kept: hashes of all they depend on, that is the geometry with its
/// occluders, the materials, the lights, the points or the view, the goal, and kReferenceVersion.
/// @{
std::string vertex_truth_key(const Subject& subject, std::span<const TruthPoint> points,
                             const ReferenceLights& lights, const TruthGoal& goal);
std::string picture_truth_key(const Subject& subject, const View& view,
                              const ReferenceLights& lights, const TruthGoal& goal);
/// @}

}  // namespace burnish
