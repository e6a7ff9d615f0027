#include "tradeoff/trial.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/fit_light.h"
#include "harness/parallel_prefilter.h"
#include "harness/render.h"
#include "harness/rivals/rival.h"
#include "harness/rivals/runtime_rival.h"
#include "tradeoff/grid.h"

namespace burnish::tools {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double least(const std::vector<double>& values) {
  return *std::min_element(values.begin(), values.end());
}

/// Times of frames: the least of many, which what else the machine does disturbs least.
class FrameTimes {
 public:
  /// A frame: the lights, then the vertices.
  void measure(const std::function<void()>& prepare, const std::function<void()>& shade) {
    const auto start = std::chrono::steady_clock::now();
    const std::clock_t cpu_start = std::clock();
    prepare();
    prepare_ms_.push_back(seconds_since(start) * 1e3);
    shade();
    frame_ms_.push_back(seconds_since(start) * 1e3);
    cpu_ms_.push_back(static_cast<double>(std::clock() - cpu_start) * 1e3 / CLOCKS_PER_SEC);
  }
  void tell(TrialOutcome& outcome) const {
    outcome.prepare_ms = least(prepare_ms_);
    outcome.frame_ms = least(frame_ms_);
    outcome.frame_cpu_ms = least(cpu_ms_);
  }

 private:
  std::vector<double> prepare_ms_, frame_ms_, cpu_ms_;
};

/// At most `wanted` of `count` indices, evenly spread.
std::vector<size_t> spread(size_t count, size_t wanted) {
  std::vector<size_t> indices;
  wanted = std::min(count, wanted);
  for (size_t i = 0; i < wanted; ++i) indices.push_back(i * count / wanted);
  return indices;
}

/// The entries of `values` at `indices`.
template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<size_t>& indices) {
  std::vector<T> result;
  for (const size_t index : indices) result.push_back(values[index]);
  return result;
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

Transfer without_ladder(Transfer transfer) {
  transfer.ladder_bases.clear();
  transfer.ladder_coefficients.clear();
  transfer.ladder_crossover = 0;
  return transfer;
}

/// A bake, and what of it was shaded last.
struct Trial::Baked {
  /// Terms, and whether there is a ladder.
  using Part = std::pair<int, bool>;
  Transfer whole;
  double seconds = 0;
  Part part = {-1, false};  ///< which is the rest
  Transfer transfer;
  PreparedTransfer prepared;
  std::map<Part, size_t> file_bytes = {};
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
      filtered_(std::make_shared<PrefilteredEnvironment>(prefilter_in_parallel(scene_.map))) {
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
  const bool ladder = bake_options.ladder_terms > 0;
  if (!ladder) most.ladder_terms = BakeOptions{}.ladder_terms;
  Settings key;
  key.bake = most;
  std::unique_ptr<Baked>& baked = baked_[settings_json(key)["bake"].dump()];
  if (!baked) {
    baked = std::make_unique<Baked>();
    const auto start = std::chrono::steady_clock::now();
    baked->whole = bake(scene_.scene.mesh, {}, most, {.progress = progress_});
    baked->seconds = seconds_since(start);
  }
  const Baked::Part part = {bake_options.terms, ladder};
  if (baked->part != part) {
    baked->transfer = with_terms(baked->whole, bake_options.terms);
    if (!ladder) baked->transfer = without_ladder(std::move(baked->transfer));
    baked->prepared = prepare_transfer(baked->transfer);
    baked->part = part;
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

const SceneRays& Trial::rays_for(const Transfer& geometry) {
  if (!rays_) rays_.emplace(geometry);
  return *rays_;
}

Subject Trial::subject_of(const Transfer& transfer, const PreparedTransfer* prepared) const {
  return {&transfer, scene_.scene.materials, scene_.scene.material_id, nullptr, prepared};
}

std::vector<TruthPoint> Trial::points_of(const Subject& subject, const Views& views) {
  std::vector<TruthPoint> points;
  for (size_t i = 0; i < views.eyes.size(); ++i) {
    const std::vector<TruthPoint> seen = points_seen_from(subject, views.drawn[i], views.eyes[i]);
    points.insert(points.end(), seen.begin(), seen.end());
  }
  return points;
}

std::string Trial::key() const {
  Transfer geometry;
  geometry.positions = scene_.scene.mesh.positions;
  geometry.normals = scene_.scene.mesh.normals;
  geometry.tangents = scene_.scene.mesh.tangents;
  geometry.triangles = scene_.scene.mesh.triangles;
  const Subject subject = subject_of(geometry, nullptr);
  const std::string truth =
      vertex_truth_key(subject, points_of(subject, *views_), {{&scene_.map}}, options_.truth);
  return options_.fitted_truth ? truth + "-fitted" : truth;
}

const VertexTruth& Trial::truth_for(const Transfer& geometry, int lobes, Views& views) {
  const int key = options_.fitted_truth ? lobes : 0;
  const auto found = views.truths.find(key);
  if (found != views.truths.end()) return found->second;
  const Subject subject = subject_of(geometry, nullptr);
  const Image lit = options_.fitted_truth ? map_of(fitted_for(lobes).rig) : Image();
  const ReferenceLights lights = {{options_.fitted_truth ? &lit : &scene_.map}};
  return views.truths
      .emplace(key, vertex_truth(subject, rays_for(geometry), points_of(subject, views), lights,
                                 options_.truth, options_.cache, progress_))
      .first->second;
}

void Trial::compare(const std::vector<Rgb>& shaded, const VertexTruth& truth,
                    const std::vector<size_t>& places, TrialOutcome& outcome) {
  const std::vector<Rgb> radiance = picked(truth.radiance, places);
  const std::vector<Rgb> variance = picked(truth.variance, places);
  outcome.error = relative_l2(shaded, radiance, variance);
  outcome.absolute = absolute_errors(shaded, radiance, variance);
}

void Trial::measure(const std::function<void()>& prepare, const Shade& shade, const Views& views,
                    const VertexTruth& truth, TrialOutcome& outcome) const {
  FrameTimes times;
  std::vector<Rgb> shaded;
  for (size_t i = 0; i < views.eyes.size(); ++i) {
    std::vector<Rgb> radiance;
    for (int frame = 0; frame < options_.frames; ++frame)
      times.measure(prepare, [&] { radiance = shade(views.eyes[i]); });
    for (const std::uint32_t vertex : views.drawn[i]) shaded.push_back(radiance[vertex]);
  }
  times.tell(outcome);
  compare(shaded, truth, spread(shaded.size(), shaded.size()), outcome);
}

TrialOutcome Trial::run(const Settings& settings) { return run_on(settings, *views_); }

TrialOutcome Trial::check(const Settings& settings) { return run_on(settings, *check_views_); }

TrialOutcome Trial::run_on(const Settings& settings, Views& views) {
  Baked& baked = baked_for(settings.bake);
  last_ = &baked;
  const Transfer& transfer = baked.transfer;
  const VertexTruth& truth = truth_for(transfer, settings.lobes, views);
  const LightRig& rig = fitted_for(settings.lobes).rig;
  const Subject subject = subject_of(transfer, &baked.prepared);
  TrialOutcome outcome;
  outcome.bake_s = baked.seconds;
  size_t& bytes = baked.file_bytes[baked.part];
  if (bytes == 0) bytes = file_bytes_of(transfer);
  outcome.file_bytes = bytes;
  outcome.bytes_per_vertex = baked.prepared.bytes_per_vertex();
  outcome.bytes_shared = shared_bytes(baked.prepared);
  if (settings.specular_from_map && any_specular(scene_.scene.materials))
    outcome.bytes_shared += shared_bytes(*filtered_);

  PreparedLights lights;
  const Lighting lighting = {&lights, settings.specular_from_map ? filtered_.get() : nullptr};
  const auto prepare = [&] {
    begin_lights(rig, baked.prepared, settings.shading, lights);
    tbb::parallel_for(size_t{0}, baked.prepared.bases.size(), [&](size_t basis) {
      finish_lights(baked.prepared, settings.shading, basis, lights);
    });
  };
  const auto shade = [&](const Vector3f& eye) {
    return shade_all_vertices(subject, lighting, eye, settings.shading);
  };
  measure(prepare, shade, views, truth, outcome);
  return outcome;
}

TrialOutcome Trial::run_rival(const Settings& settings, const MakeRival& make, int vertices) {
  Baked& baked = baked_for(settings.bake);
  last_ = &baked;
  const VertexTruth& truth = truth_for(baked.transfer, settings.lobes, *views_);
  RivalScene scene;
  scene.subject = subject_of(baked.transfer, &baked.prepared);
  scene.rays = &rays_for(baked.transfer);
  scene.map = &scene_.map;
  scene.rig = fitted_for(settings.lobes).rig;
  scene.filtered = filtered_;
  scene.transfer_bake_s = baked.seconds;

  const std::vector<std::uint32_t>& drawn = views_->drawn[0];
  // A part stands in for the whole where only that is affordable.
  const std::vector<size_t> places =
      spread(drawn.size(), vertices > 0 ? static_cast<size_t>(vertices) : drawn.size());
  Transfer part;
  PreparedTransfer prepared_part;
  std::vector<std::uint8_t> part_materials;
  if (vertices > 0) {
    part = vertex_subset(baked.transfer, picked(drawn, places));
    prepared_part = prepare_transfer(part);
    for (const std::uint32_t vertex : picked(drawn, places))
      part_materials.push_back(static_cast<std::uint8_t>(scene.subject.material_of(vertex)));
    scene.subject = {&part, scene_.scene.materials, part_materials, nullptr, &prepared_part};
  }
  const Rival rival = make(scene);
  TrialOutcome outcome;
  outcome.bake_s = rival.bake_s;
  outcome.bytes_per_vertex = rival.bytes_per_vertex;
  outcome.bytes_shared = rival.bytes_shared;
  const auto prepare = [&] { rival.prepare_lights(Eigen::Matrix3f::Identity()); };
  const auto shade = [&](const Vector3f& eye) {
    return shade_vertices(rival, scene.vertex_count(), eye);
  };
  if (vertices > 0) {
    prepare();
    compare(shade(scene_.eyes[0]), truth, places, outcome);
    return outcome;
  }
  measure(prepare, shade, *views_, truth, outcome);
  return outcome;
}

Picture Trial::render(const Settings& settings, const View& view) {
  Baked& baked = baked_for(settings.bake);
  last_ = &baked;
  const PrimaryHits hits = trace_primary_rays(rays_for(baked.transfer), view);
  const PreparedLights lights =
      prepare_lights(fitted_for(settings.lobes).rig, baked.prepared, settings.shading);
  return burnish::render(subject_of(baked.transfer, &baked.prepared), hits,
                         {&lights, settings.specular_from_map ? filtered_.get() : nullptr},
                         {&scene_.map}, ShadePer::vertex, settings.shading);
}

Picture Trial::render_truth(const View& view, const TruthGoal& goal) {
  const Transfer& geometry = last_ ? last_->transfer : baked_for({}).transfer;
  const SceneRays& rays = rays_for(geometry);
  PictureTruth truth =
      picture_truth(subject_of(geometry, nullptr), rays, trace_primary_rays(rays, view),
                    {{&scene_.map}}, goal, options_.cache, progress_);
  return truth.picture;
}

}  // namespace burnish::tools
