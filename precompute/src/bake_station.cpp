#include "bake_station.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "bake_input.h"
#include "burnish/visibility/ssdf.h"

namespace burnish {
namespace {

using Clock = std::chrono::steady_clock;

// A mask of the right size; what was in it does not matter.
VisibilityMask& sized(VisibilityMask& mask, int resolution) {
  if (mask.resolution != resolution) mask = VisibilityMask(resolution);
  return mask;
}

}  // namespace

BakeStation::BakeStation(const TriangleMesh& receiver, const RayScene& scene,
                         const BakeOptions& options)
    : mesh_(receiver),
      scene_(scene),
      normals_(usable_normals(receiver)),
      offset_(options.origin_offset > 0 ? options.origin_offset : scene.origin_offset()),
      amplitude_rad_(static_cast<float>(options.amplitude_rad)),
      directions_(options.directions),
      sampler_(scene, directions_, std::min(options.coarsest, options.directions)),
      transform_(directions_, options.resolution) {}

Vector3f BakeStation::origin(std::uint32_t vertex) const {
  return mesh_.positions[vertex] + static_cast<float>(offset_) * normals_[vertex];
}

std::uint64_t BakeStation::trace(std::uint32_t vertex, BakeWorker& worker) const {
  const Clock::time_point start = Clock::now();
  VisibilityMask& mask = sized(worker.mask, directions_.resolution());
  const std::uint64_t rays =
      sampler_.sample(origin(vertex), normals_[vertex], mask, worker.sampler);
  worker.rays += rays;
  worker.rays_s += std::chrono::duration<double>(Clock::now() - start).count();
  return rays;
}

void BakeStation::derive(const VisibilityMask& mask, std::size_t row, VisibilityRows& rows,
                         BakeWorker& worker) const {
  const Clock::time_point start = Clock::now();
  transform_.transform(mask, rows.ssdf(row), worker.distance);
  rows.count_coverage(mask, row);
  worker.distance_s += std::chrono::duration<double>(Clock::now() - start).count();
}

void BakeStation::derive_encoded(const VisibilityMask& mask, std::size_t row, VisibilityRows& rows,
                                 BakeWorker& worker) const {
  derive(mask, row, rows, worker);
  const Clock::time_point start = Clock::now();
  encode_ssdf(rows.ssdf(row), amplitude_rad_);
  worker.project_s += std::chrono::duration<double>(Clock::now() - start).count();
}

bool BakeStation::sees_all(std::uint32_t vertex) const {
  return scene_.hemisphere_is_empty(origin(vertex), normals_[vertex]);
}

bool BakeStation::is_occluded(std::uint32_t vertex, const VisibilityMask& mask) const {
  const int across = directions_.resolution() / 4;
  for (std::size_t t = 0; t < directions_.tiles().size(); ++t) {
    const std::uint32_t above = above_horizon(directions_.tiles()[t], normals_[vertex]);
    const int x = static_cast<int>(t) % across * 4, y = static_cast<int>(t) / across * 4;
    std::uint32_t visible = 0;
    for (int row = 0; row < 4; ++row) {
      const auto texel =
          static_cast<std::size_t>(y + row) * static_cast<std::size_t>(directions_.resolution()) +
          static_cast<std::size_t>(x);
      visible |= static_cast<std::uint32_t>(mask.bits[texel / 64] >> (texel % 64) & 15)
                 << (4 * row);
    }
    if (visible != above) return true;
  }
  return false;
}

VertexVerification BakeStation::verify(std::uint32_t vertex, BakeWorker& worker) const {
  const int resolution = transform_.resolution();
  const VisibilityCheck check =
      check_visibility(scene_, directions_, sampler_, origin(vertex), normals_[vertex],
                       sized(worker.mask, directions_.resolution()),
                       sized(worker.other_mask, directions_.resolution()), worker.sampler);
  std::vector<float> sampled(static_cast<std::size_t>(resolution * resolution)), truth(sampled);
  transform_.transform(worker.mask, sampled, worker.distance);
  transform_.transform(worker.other_mask, truth, worker.distance);
  VertexVerification result{check.directions, check.differing, 0};
  for (std::size_t i = 0; i < truth.size(); ++i)
    result.worst_ssdf_error_rad =
        std::max(result.worst_ssdf_error_rad, std::abs(double(sampled[i]) - truth[i]));
  return result;
}

}  // namespace burnish
