#include "tradeoff/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/fit_light.h"
#include "harness/parallel_prefilter.h"
#include "harness/render.h"
#include "harness/rivals/rival.h"
#include "harness/rivals/runtime_rival.h"

namespace burnish::tools {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Rows of `size` numbers cut to the first `kept`.
std::vector<float> cut(const std::vector<float>& rows, size_t size, size_t kept) {
  std::vector<float> result;
  result.reserve(size == 0 ? 0 : rows.size() / size * kept);
  for (size_t first = 0; first + size <= rows.size() && size > 0; first += size)
    result.insert(result.end(), rows.begin() + static_cast<std::ptrdiff_t>(first),
                  rows.begin() + static_cast<std::ptrdiff_t>(first + kept));
  return result;
}

/// The size of the file that a transfer becomes.
size_t file_bytes_of(const Transfer& transfer) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() /
      fmt::format("burnish-trial-{}.h5",
                  std::chrono::steady_clock::now().time_since_epoch().count());
  write_transfer(transfer, path.string());
  const size_t bytes = static_cast<size_t>(std::filesystem::file_size(path));
  std::filesystem::remove(path);
  return bytes;
}

/// The lights' lobes as a map, fine enough for those that a fit makes.
Image map_of(const LightRig& rig) {
  Image map(1024, 512);
  tbb::parallel_for(0, map.height, [&](int y) {
    for (int x = 0; x < map.width; ++x)
      map.at(x, y) = eval_lobes(
          rig, direction_from_latlong((x + 0.5) / map.width, (y + 0.5) / map.height).cast<float>());
  });
  return map;
}

}  // namespace

std::vector<Vector3f> eyes_around(const Camera& camera, int count) {
  std::vector<Vector3f> eyes;
  for (int i = 0; i < count; ++i) {
    const Eigen::AngleAxisf turn(2 * kPi<float> * static_cast<float>(i) / static_cast<float>(count),
                                 Vector3f::UnitY());
    eyes.push_back(camera.target + turn * (camera.origin - camera.target));
  }
  return eyes;
}

Transfer with_terms(const Transfer& transfer, int terms) {
  Transfer result = transfer;
  const auto kept = static_cast<size_t>(std::min(terms, transfer.terms()));
  const auto size = static_cast<size_t>(transfer.terms());
  result.coefficients = cut(transfer.coefficients, size, kept);
  for (SsdfBasis& basis : result.bases) {
    basis.eigen = cut(basis.eigen, size, kept);
    basis.terms = static_cast<int>(kept);
  }
  return result;
}

/// A bake, and what of it was shaded last.
struct Trial::Baked {
  Transfer whole;
  double seconds = 0;
  int terms = -1;  ///< of the rest
  Transfer transfer;
  PreparedTransfer prepared;
  std::map<int, size_t> file_bytes = {};  ///< by terms
};

struct Trial::Fitted {
  LightRig rig;
};

/// Where errors are measured.
struct Trial::Views {
  std::vector<Vector3f> eyes;
  std::vector<std::vector<std::uint32_t>> drawn;  ///< [eyes][vertices]
  std::map<int, VertexTruth> truths;              ///< by lobes; 0: of the map
};

std::unique_ptr<Trial::Views> Trial::draw(const std::vector<Vector3f>& eyes, size_t vertices,
                                          std::uint64_t seed) const {
  auto views = std::make_unique<Views>();
  views->eyes = eyes;
  const size_t count = scene_.scene.mesh.positions.size();
  for (size_t i = 0; i < eyes.size(); ++i)
    views->drawn.push_back(draw_vertices(count, vertices > 0 ? vertices : count, seed + i));
  return views;
}

Trial::Trial(TrialScene scene, const TrialOptions& options, const Progress& progress)
    : scene_(std::move(scene)),
      options_(options),
      progress_(progress),
      filtered_(prefilter_in_parallel(scene_.map)) {
  const auto vertices = static_cast<size_t>(std::max(options.vertices, 0));
  constexpr std::uint64_t kOtherSeeds = 1000;
  views_ = draw(scene_.eyes, vertices, options.seed);
  check_views_ = draw(scene_.check_eyes, 3 * vertices, options.seed + kOtherSeeds);
}

Trial::~Trial() = default;

const Transfer& Trial::transfer() const { return last_->transfer; }

Trial::Baked& Trial::baked_for(const BakeOptions& bake_options) {
  BakeOptions most = bake_options;
  most.terms = std::max(options_.most_terms, bake_options.terms);
  Settings key;
  key.bake = most;
  std::unique_ptr<Baked>& baked = baked_[settings_json(key)["bake"].dump()];
  if (!baked) {
    baked = std::make_unique<Baked>();
    const auto start = std::chrono::steady_clock::now();
    baked->whole = bake(scene_.scene.mesh, {}, most, {.progress = progress_});
    baked->seconds = seconds_since(start);
  }
  if (baked->terms != bake_options.terms) {
    baked->transfer = with_terms(baked->whole, bake_options.terms);
    baked->prepared = prepare_transfer(baked->transfer);
    baked->terms = bake_options.terms;
  }
  return *baked;
}

Trial::Fitted& Trial::fitted_for(int lobes) {
  std::unique_ptr<Fitted>& fitted = fitted_[lobes];
  if (!fitted) {
    LightFitOptions options;
    options.lobes = lobes;
    fitted = std::make_unique<Fitted>(Fitted{fit_light(scene_.map, options, progress_).rig});
  }
  return *fitted;
}

const VertexTruth& Trial::truth_for(const Transfer& geometry, int lobes, Views& views) {
  const int key = options_.fitted_truth ? lobes : 0;
  const auto found = views.truths.find(key);
  if (found != views.truths.end()) return found->second;
  const Subject subject = {&geometry, scene_.scene.materials, scene_.scene.material_id};
  std::vector<TruthPoint> points;
  for (size_t i = 0; i < views.eyes.size(); ++i) {
    const std::vector<TruthPoint> seen = points_seen_from(subject, views.drawn[i], views.eyes[i]);
    points.insert(points.end(), seen.begin(), seen.end());
  }
  const Image lit = options_.fitted_truth ? map_of(fitted_for(lobes).rig) : Image();
  const SceneRays rays(geometry);
  const ReferenceLights lights = {{options_.fitted_truth ? &lit : &scene_.map}};
  return views.truths
      .emplace(key, vertex_truth(subject, rays, points, lights, options_.truth, options_.cache,
                                 progress_))
      .first->second;
}

TrialOutcome Trial::run(const Settings& settings) { return run_on(settings, *views_); }

TrialOutcome Trial::check(const Settings& settings) { return run_on(settings, *check_views_); }

TrialOutcome Trial::run_on(const Settings& settings, Views& views) {
  Baked& baked = baked_for(settings.bake);
  last_ = &baked;
  const Transfer& transfer = baked.transfer;
  const VertexTruth& truth = truth_for(transfer, settings.lobes, views);
  const LightRig& rig = fitted_for(settings.lobes).rig;
  const Subject subject = {&transfer, scene_.scene.materials, scene_.scene.material_id, nullptr,
                           &baked.prepared};
  TrialOutcome outcome;
  outcome.bake_s = baked.seconds;
  size_t& bytes = baked.file_bytes[baked.terms];
  if (bytes == 0) bytes = file_bytes_of(transfer);
  outcome.file_bytes = bytes;
  outcome.bytes_per_vertex = baked.prepared.bytes_per_vertex();
  outcome.bytes_shared = shared_bytes(baked.prepared);

  PreparedLights lights;
  const Lighting lighting = {&lights, settings.specular_from_map ? &filtered_ : nullptr};
  std::vector<double> prepare_ms, frame_ms;
  std::vector<Rgb> shaded;
  for (size_t i = 0; i < views.eyes.size(); ++i) {
    std::vector<Rgb> radiance;
    for (int frame = 0; frame < options_.frames; ++frame) {
      const auto start = std::chrono::steady_clock::now();
      begin_lights(rig, baked.prepared, settings.shading, lights);
      tbb::parallel_for(size_t{0}, baked.prepared.bases.size(), [&](size_t basis) {
        finish_lights(baked.prepared, settings.shading, basis, lights);
      });
      prepare_ms.push_back(seconds_since(start) * 1e3);
      radiance = shade_all_vertices(subject, lighting, views.eyes[i], settings.shading);
      frame_ms.push_back(seconds_since(start) * 1e3);
    }
    for (const std::uint32_t vertex : views.drawn[i]) shaded.push_back(radiance[vertex]);
  }
  outcome.prepare_ms = median(prepare_ms);
  outcome.frame_ms = median(frame_ms);
  outcome.error = relative_l2(shaded, truth.radiance, truth.variance);
  outcome.absolute = absolute_errors(shaded, truth.radiance, truth.variance);
  return outcome;
}

}  // namespace burnish::tools
