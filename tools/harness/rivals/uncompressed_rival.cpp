#include "harness/rivals/uncompressed_rival.h"

#include <algorithm>
#include <chrono>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "burnish/precompute/spherical_distance_transform.h"
#include "burnish/precompute/visibility_sampler.h"
#include "burnish/shading/shade.h"
#include "burnish/visibility/visibility_ladder.h"
#include "harness/parallel_progress.h"
#include "harness/rivals/runtime_rival.h"

namespace burnish {
namespace {

/// A basis a vertex, and no terms: a vertex's id is one byte.
constexpr size_t kChunk = 256;

/// Calls work(vertex, mask) with what each vertex sees, in parallel.
void for_each_mask(const RivalScene& scene, const DirectionTable& directions,
                   const Progress& progress,
                   const std::function<void(size_t, const VisibilityMask&)>& work) {
  const Transfer& transfer = *scene.subject.transfer;
  const RayScene& rays = scene.rays->shadowing();
  const VisibilitySampler sampler(
      rays, directions, std::min(directions.resolution(), VisibilitySampler::kDefaultCoarsest));
  struct Scratch {
    VisibilityMask mask;
    VisibilitySampler::Scratch sampler;
  };
  tbb::enumerable_thread_specific<Scratch> scratches;
  parallel_with_progress("distances", transfer.vertex_count(), 16, progress, [&](size_t v) {
    Scratch& scratch = scratches.local();
    if (scratch.mask.resolution == 0) scratch.mask = VisibilityMask(directions.resolution());
    const Vector3f normal = view_vertex(transfer, v, transfer.positions[v]).frame.z;
    sampler.sample(transfer.positions[v] + rays.origin_offset() * normal, normal, scratch.mask,
                   scratch.sampler);
    work(v, scratch.mask);
  });
}

/// The harmonics of a mask's visibility, by its texels.
std::vector<float> mask_harmonics(const VisibilityMask& mask, const DirectionTable& directions,
                                  int bands) {
  const size_t count = static_cast<size_t>(bands) * static_cast<size_t>(bands);
  std::vector<double> sum(count, 0.0);
  std::vector<float> values(count), row(count);
  const int size = mask.resolution;
  for (int y = 0; y < size; ++y) {
    std::fill(row.begin(), row.end(), 0.0f);
    for (int x = 0; x < size; ++x) {
      if (!mask.visible(x, y)) continue;
      eval_harmonics(bands, directions.direction(x, y), values);
      for (size_t k = 0; k < count; ++k) row[k] += values[k];
    }
    for (size_t k = 0; k < count; ++k) sum[k] += double(row[k]);
  }
  for (size_t k = 0; k < count; ++k)
    values[k] = static_cast<float>(sum[k] * 4 * kPi<double> / (double(size) * size));
  return values;
}

struct Chunk {
  PreparedTransfer transfer;
  PreparedLights lights;
};

struct State {
  RivalScene scene;
  ShadingOptions options;
  std::vector<PreparedMaterial> materials;
  std::vector<Chunk> chunks;

  void prepare(const Eigen::Matrix3f& world_from_environment) {
    LightRig rig = scene.rig;
    rotate(rig, world_from_environment);
    tbb::parallel_for(size_t{0}, chunks.size(), [&](size_t i) {
      prepare_lights(rig, chunks[i].transfer, options, chunks[i].lights);
    });
    scene.filtered->environment_from_world = world_from_environment.transpose();
  }

  void shade(const Vector3f& eye, size_t first, std::span<Rgb> radiance) const {
    const std::span<const std::uint8_t> ids = scene.subject.material_id;
    for (size_t done = 0; done < radiance.size();) {
      const size_t chunk = (first + done) / kChunk, at = (first + done) % kChunk;
      const size_t count = std::min(kChunk - at, radiance.size() - done);
      shade_vertices(chunks[chunk].transfer, {&chunks[chunk].lights, scene.filtered.get()},
                     materials, ids.empty() ? ids : ids.subspan(chunk * kChunk), eye, options, at,
                     radiance.subspan(done, count));
      done += count;
    }
  }
};

/// The vertices of one chunk, each with a basis of its own.
Transfer chunk_transfer(const Transfer& all, size_t chunk, int resolution) {
  std::vector<std::uint32_t> vertices;
  for (size_t v = chunk * kChunk; v < std::min((chunk + 1) * kChunk, all.vertex_count()); ++v)
    vertices.push_back(static_cast<std::uint32_t>(v));
  Transfer places;
  places.positions = all.positions;
  places.normals = all.normals;
  places.tangents = all.tangents;
  Transfer transfer = vertex_subset(places, vertices);
  for (size_t i = 0; i < vertices.size(); ++i) {
    transfer.basis_id.push_back(static_cast<std::uint8_t>(i));
    SsdfBasis& basis = transfer.bases.emplace_back();
    basis.resolution = resolution;
    basis.mean.resize(static_cast<size_t>(resolution) * static_cast<size_t>(resolution));
  }
  return transfer;
}

}  // namespace

std::vector<float> vertex_ssdfs(const RivalScene& scene, int directions, int resolution,
                                const Progress& progress) {
  const DirectionTable table(directions);
  const SphericalDistanceTransform transform(table, resolution);
  const size_t texels = static_cast<size_t>(resolution) * static_cast<size_t>(resolution);
  std::vector<float> ssdfs(scene.vertex_count() * texels);
  tbb::enumerable_thread_specific<SphericalDistanceTransform::Scratch> scratches;
  for_each_mask(scene, table, progress, [&](size_t v, const VisibilityMask& mask) {
    transform.transform(mask, std::span(ssdfs).subspan(v * texels, texels), scratches.local());
  });
  return ssdfs;
}

Rival uncompressed_rival(const RivalScene& scene, const UncompressedOptions& options,
                         const Progress& progress) {
  require_complete(scene);
  const auto start = std::chrono::steady_clock::now();
  const Transfer& all = *scene.subject.transfer;
  const bool ladder = options.ladder && options.shading.ladder && !all.ladder_bases.empty();
  const int bands = ladder ? all.ladder_bases.front().bands : 0;
  std::vector<Transfer> transfers;
  for (size_t chunk = 0; chunk * kChunk < all.vertex_count(); ++chunk) {
    transfers.push_back(chunk_transfer(all, chunk, options.resolution));
    if (!ladder) continue;
    transfers.back().ladder_crossover = all.ladder_crossover;
    transfers.back().ladder_bases.resize(transfers.back().bases.size());
  }
  const DirectionTable table(options.directions);
  const SphericalDistanceTransform transform(table, options.resolution);
  tbb::enumerable_thread_specific<SphericalDistanceTransform::Scratch> scratches;
  for_each_mask(scene, table, progress, [&](size_t v, const VisibilityMask& mask) {
    Transfer& transfer = transfers[v / kChunk];
    transform.transform(mask, transfer.bases[v % kChunk].mean, scratches.local());
    if (!ladder) return;
    LadderBasis& basis = transfer.ladder_bases[v % kChunk];
    basis.bands = bands;
    basis.mean = mask_harmonics(mask, table, bands);
  });
  const auto state = std::make_shared<State>();
  state->scene = scene;
  state->options = options.shading;
  state->options.ladder = ladder;
  state->options.terms = 0;
  state->materials = prepare_materials(scene.subject.materials, options.shading);
  for (const Transfer& transfer : transfers)
    state->chunks.push_back({prepare_transfer(transfer, RowFormat::float32), {}});

  Rival rival;
  rival.name = ladder ? "no compression, with ladder" : "no compression";
  rival.bake_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto texels = static_cast<size_t>(options.resolution * options.resolution);
  rival.bytes_per_vertex =
      kPlaceBytes + sizeof(float) * (texels + static_cast<size_t>(bands * bands));
  rival.bytes_shared = shared_bytes(*scene.filtered);
  rival.prepare_lights = [state](const Eigen::Matrix3f& world_from_environment) {
    state->prepare(world_from_environment);
  };
  rival.shade = [state](const Vector3f& eye, size_t first, std::span<Rgb> radiance) {
    state->shade(eye, first, radiance);
  };
  return rival;
}

}  // namespace burnish
