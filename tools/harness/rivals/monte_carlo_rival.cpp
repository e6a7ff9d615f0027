#include "harness/rivals/monte_carlo_rival.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "harness/error_metrics.h"

namespace burnish {
namespace {

/// The scene's lights as they stand in the world. Stays where it is: the lights refer to the rig.
struct WorldLights {
  LightRig rig;
  ReferenceLights lights;

  WorldLights(const WorldLights&) = delete;
  WorldLights& operator=(const WorldLights&) = delete;

  WorldLights(const RivalScene& scene, const Eigen::Matrix3f& world_from_environment)
      : rig(scene.rig) {
    rotate(rig, world_from_environment);
    lights = {{scene.map, world_from_environment}, rig.spheres, rig.directionals, rig.rectangles};
  }
};

struct State {
  RivalScene scene;
  ReferenceOptions options;
  std::optional<WorldLights> lights;
  std::optional<ReferenceIntegrator> integrator;

  void shade(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const {
    const Transfer& transfer = *scene.subject.transfer;
    for (size_t i = 0; i < radiance.size(); ++i) {
      const Vector3f& position = transfer.positions[first + i];
      const SurfaceMaterial at = vertex_material(scene.subject, first + i);
      const ReferenceIntegrator::Point point = integrator->prepare(
          position, at.frame, outgoing_toward(eye, position, at.frame.z), at.material);
      radiance[i] =
          estimate_radiance(*integrator, {&point, 1}, first + i, options).mean.cast<float>();
    }
  }
};

}  // namespace

Rival monte_carlo_rival(const RivalScene& scene, int samples, std::uint64_t seed) {
  require_complete(scene);
  const auto state = std::make_shared<State>();
  state->scene = scene;
  // The variance is not asked for: as few sequences as there may be, which are the longest.
  state->options = {.samples = samples, .replicates = 2, .seed = seed};
  Rival rival;
  rival.name = fmt::format("Monte Carlo, {} samples", samples);
  rival.bytes_per_vertex = kPlaceBytes;
  rival.bytes_shared = scene.map->pixels.size() * sizeof(Rgb);
  rival.prepare_lights = [state](const Eigen::Matrix3f& world_from_environment) {
    state->lights.emplace(state->scene, world_from_environment);
    state->integrator.emplace(state->scene.rays->shadowing(), state->lights->lights);
  };
  rival.shade = [state](const Vector3f& eye, size_t first, std::span<Rgb> radiance) {
    state->shade(eye, first, radiance);
  };
  return rival;
}

MonteCarloRun run_monte_carlo(const RivalScene& scene,
                              const Eigen::Matrix3f& world_from_environment, const Vector3f& eye,
                              const ReferenceOptions& options, double norm2) {
  require_complete(scene);
  const WorldLights lights(scene, world_from_environment);
  const auto start = std::chrono::steady_clock::now();
  const VertexReference reference =
      shade_reference_vertices(scene.subject, *scene.rays, eye, lights.lights, options);
  MonteCarloRun run;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const int replicates = std::max(options.replicates, 2);
  run.samples = (options.samples + replicates - 1) / replicates * replicates;
  double variance = 0, square = 0;
  for (size_t v = 0; v < reference.radiance.size(); ++v) {
    variance += double(reference.variance[v].sum());
    square += double(reference.radiance[v].square().sum());
  }
  run.error = std::sqrt(variance / (norm2 > 0 ? norm2 : square));
  return run;
}

MonteCarloLaw monte_carlo_law(std::span<const MonteCarloRun> runs) {
  MonteCarloLaw law;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, seconds = 0, samples = 0;
  for (const MonteCarloRun& run : runs) {
    if (!(run.samples > 0 && run.seconds > 0 && run.error > 0))
      throw std::invalid_argument("a Monte Carlo run without samples, time or error");
    const double log_samples = std::log(run.samples), log_error = std::log(run.error);
    n += 1;
    x += log_samples;
    y += log_error;
    xx += log_samples * log_samples;
    xy += log_samples * log_error;
    seconds += run.seconds;
    samples += run.samples;
  }
  if (n == 0) throw std::invalid_argument("no Monte Carlo run");
  const double spread = xx - x * x / n;
  if (spread > 1e-9 * xx) law.exponent = -(xy - x * y / n) / spread;
  law.error_of_one = std::exp((y + law.exponent * x) / n);
  law.seconds_per_sample = seconds / samples;
  return law;
}

double monte_carlo_error_at(const MonteCarloLaw& law, double seconds) {
  return law.error_of_one * std::pow(seconds / law.seconds_per_sample, -law.exponent);
}

double monte_carlo_samples_at(const MonteCarloLaw& law, double error) {
  return std::pow(law.error_of_one / error, 1 / law.exponent);
}

double monte_carlo_seconds_at(const MonteCarloLaw& law, double error) {
  return law.seconds_per_sample * monte_carlo_samples_at(law, error);
}

}  // namespace burnish
