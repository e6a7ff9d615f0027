#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "burnish/light/light_rig.h"
#include "burnish/precompute/progress.h"
#include "harness/environment_sampler.h"
#include "harness/picture.h"
#include "harness/primary_hits.h"

/// The project's truth: direct lighting by Monte Carlo integration with the exact BRDF, exact
/// visibility by rays and the full environment map. Based on: veach1997, section 9.2 (multiple
/// importance sampling, balance heuristic).
namespace burnish {

/// Of all that decides a reference's values but its inputs, primary rays and normals included.
/// Raise it with every change of them, so that no kept truth is of the old code.
inline constexpr int kReferenceVersion = 1;

/// Which samples are taken. The single techniques exist to check the combined one.
enum class SamplingTechnique {
  combined,     ///< lights and BRDF, by the balance heuristic
  lights_only,  ///< directions drawn from the map and the other lights
  brdf_only,    ///< directions drawn from the BRDF
};

struct ReferenceOptions {
  int samples = 64;    ///< per pixel or vertex, >= 1; each is one ray by the BRDF and one to each
                       ///< light. Rounded up to a multiple of `replicates`, and in a picture to one
                       ///< of replicates x samples_per_axis^2.
  int replicates = 8;  ///< independent sequences that the variance is estimated from, >= 2
  std::uint64_t seed = 1;
  SamplingTechnique technique = SamplingTechnique::combined;
};

/// The lights the integrator sees, all in the world. Local lights do not occlude and are not seen
/// by cameras; a point inside a sphere receives its radiance from every direction. Directional
/// lights have the size that shading gives them (local_lights.h).
struct ReferenceLights {
  EnvironmentLight environment = {};
  std::span<const SphereLight> spheres = {};
  std::span<const DirectionalLight> directionals = {};
  std::span<const RectangleLight> rectangles = {};
};

/// Radiance of points toward a viewer. Thread-safe; keeps references to its arguments' data.
class ReferenceIntegrator {
 public:
  ReferenceIntegrator(const RayScene& shadowing, const ReferenceLights& lights);

  /// A point with all that its samples share.
  struct Point {
    Vector3f position;
    Frame<double> frame;
    Vector3f ray_origin;      ///< the position, off the surface along the normal
    Vector3f local_outgoing;  ///< unit, in the frame
    const Material* material;
    double diffuse_chance = 1;  ///< of drawing from the diffuse part of the BRDF
  };
  /// `outgoing` is a unit direction of the world; where it is below the horizon of the frame, all
  /// samples are black. `material` outlives the point.
  Point prepare(const Vector3f& position, const Frame<float>& frame, const Vector3f& outgoing,
                const Material& material) const;

  /// One unbiased sample of the point's radiance.
  Eigen::Array3d sample(const Point& point, const SampleSequence& sequence, std::uint32_t index,
                        SamplingTechnique technique) const;

 private:
  struct Incoming;
  Eigen::Array3d sample_environment(const Point&, const Uniform2&, SamplingTechnique) const;
  template <class LightView>
  Eigen::Array3d sample_light(const Point&, const LightView&, const Uniform2&,
                              SamplingTechnique) const;
  Eigen::Array3d sample_brdf(const Point&, const Uniform2&, double choice, SamplingTechnique) const;
  bool occluded(const Point& point, const Vector3d& direction, double distance) const;

  const RayScene& shadowing_;
  ReferenceLights lights_;
  Eigen::Matrix3d world_from_environment_;
  std::optional<EnvironmentSampler> environment_;  // absent for a black environment
};

/// A mean and the variance of that mean (the squared standard error), per channel.
struct ReferenceEstimate {
  Eigen::Array3d mean = Eigen::Array3d::Zero();
  Eigen::Array3d variance = Eigen::Array3d::Zero();
};

/// The mean over several points (the samples of a pixel). `stream` makes its random numbers differ
/// from those of other pixels or vertices.
ReferenceEstimate estimate_radiance(const ReferenceIntegrator& integrator,
                                    std::span<const ReferenceIntegrator::Point> points,
                                    std::uint64_t stream, const ReferenceOptions& options);

/// The picture of a view, with its variance. The same at any number of threads. Throws Cancelled
/// when `progress` asked to stop.
Picture render_reference(const Subject& subject, const SceneRays& rays, const PrimaryHits& hits,
                         const ReferenceLights& lights, const ReferenceOptions& options,
                         const Progress& progress = {});

/// What shade_vertices stands for, of all vertices.
struct VertexReference {
  std::vector<Rgb> radiance;  ///< #V
  std::vector<Rgb> variance;  ///< #V, of the mean
};
VertexReference shade_reference_vertices(const Subject& subject, const SceneRays& rays,
                                         const Vector3f& eye, const ReferenceLights& lights,
                                         const ReferenceOptions& options,
                                         const Progress& progress = {});

}  // namespace burnish
