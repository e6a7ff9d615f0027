#include "harness/rivals/rival.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <stdexcept>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/shading/shade.h"

namespace burnish {
namespace {

/// Entries of `values`, `stride` of them a vertex; nothing of an empty array.
template <class T>
std::vector<T> rows_of(const std::vector<T>& values, std::span<const std::uint32_t> vertices,
                       size_t stride = 1) {
  std::vector<T> rows;
  if (values.empty()) return rows;
  rows.reserve(vertices.size() * stride);
  for (const std::uint32_t vertex : vertices) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(vertex * stride);
    rows.insert(rows.end(), first, first + static_cast<std::ptrdiff_t>(stride));
  }
  return rows;
}

}  // namespace

void require_complete(const RivalScene& scene) {
  const Subject& subject = scene.subject;
  if (!subject.transfer || !subject.prepared || !scene.rays || !scene.map || !scene.filtered)
    throw std::invalid_argument("a rival's scene lacks its transfer, rays or environment");
  if (subject.materials.empty() || subject.varying)
    throw std::invalid_argument("a rival's scene has one or more materials that do not vary");
}

std::vector<Rgb> shade_vertices(const Rival& rival, size_t vertices, const Vector3f& eye) {
  constexpr size_t kGrain = 512;
  std::vector<Rgb> radiance(vertices);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, vertices, kGrain), [&](const auto& range) {
    rival.shade(eye, range.begin(), std::span(radiance).subspan(range.begin(), range.size()));
  });
  return radiance;
}

std::vector<std::uint32_t> draw_vertices(size_t count, size_t wanted, std::uint64_t seed) {
  std::vector<std::uint32_t> all(count), drawn;
  std::iota(all.begin(), all.end(), 0u);
  std::mt19937_64 random(seed);
  std::sample(all.begin(), all.end(), std::back_inserter(drawn), wanted, random);
  return drawn;  // in order: std::sample keeps it
}

Transfer vertex_subset(const Transfer& transfer, std::span<const std::uint32_t> vertices) {
  Transfer subset;
  subset.positions = rows_of(transfer.positions, vertices);
  subset.normals = rows_of(transfer.normals, vertices);
  subset.tangents = rows_of(transfer.tangents, vertices);
  subset.file_vertex = rows_of(transfer.file_vertex, vertices);
  subset.texcoords = rows_of(transfer.texcoords, vertices);
  subset.bases = transfer.bases;
  subset.basis_id = rows_of(transfer.basis_id, vertices);
  subset.coefficients =
      rows_of(transfer.coefficients, vertices, static_cast<size_t>(transfer.terms()));
  subset.ladder_bases = transfer.ladder_bases;
  subset.ladder_coefficients =
      rows_of(transfer.ladder_coefficients, vertices, static_cast<size_t>(transfer.ladder_terms()));
  subset.ladder_crossover = transfer.ladder_crossover;
  subset.provenance = transfer.provenance;
  return subset;
}

VertexView view_vertex(const Transfer& transfer, size_t vertex, const Vector3f& eye) {
  const Frame<float> frame =
      frame_from_normal_tangent(transfer.normals[vertex], transfer.tangents[vertex]);
  return {frame, frame.to_local(outgoing_toward(eye, transfer.positions[vertex], frame.z))};
}

}  // namespace burnish
