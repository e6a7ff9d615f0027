#include "burnish/precompute/mesh_refinement.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <numeric>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/formats/mesh_frames.h"
#include "burnish/precompute/visibility_mask.h"
#include "progress_monitor.h"
#include "subdivision_edges.h"

namespace burnish {
namespace {

constexpr int kResolution = 32;
constexpr std::size_t kTiles = kResolution * kResolution / 16;
constexpr std::size_t kBlock = 64;  // vertices, between two reports of progress

// What a vertex sees, roughly: a bit a direction, 16 a tile, four tiles a word.
struct CoarseView {
  std::array<std::uint64_t, kTiles / 4> above{}, visible{};
};

class ViewCaster {
 public:
  ViewCaster(const RayScene& scene, double origin_offset)
      : scene_(scene),
        offset_(origin_offset > 0 ? origin_offset : double(scene.origin_offset())),
        table_(kResolution) {}

  // Sees nothing, above an empty horizon, where position or normal are not usable. Returns rays.
  std::uint16_t cast(const Vector3f& position, const Vector3f& normal, CoarseView& view) const {
    view = {};
    const double length = normal.cast<double>().norm();
    if (!position.allFinite() || !std::isfinite(length) || !(length > 0)) return 0;
    const Vector3d unit = normal.cast<double>() / length;
    const Vector3f n = unit.cast<float>();
    const Vector3f origin = (position.cast<double>() + offset_ * unit).cast<float>();
    int rays = 0;
    for (std::size_t t = 0; t < kTiles; ++t) {
      const DirectionTile& tile = table_.tiles()[t];
      std::uint32_t above = 0;
      for (int i = 0; i < 16; ++i)
        above |= static_cast<std::uint32_t>(
                     tile.x[i] * n.x() + tile.y[i] * n.y() + tile.z[i] * n.z() > 0)
                 << i;
      if (above == 0) continue;
      rays += std::popcount(above);
      const std::uint64_t visible =
          above & ~scene_.occluded16(origin, tile.x, tile.y, tile.z, above);
      view.above[t / 4] |= std::uint64_t{above} << (t % 4 * 16);
      view.visible[t / 4] |= visible << (t % 4 * 16);
    }
    return static_cast<std::uint16_t>(rays);
  }

 private:
  const RayScene& scene_;
  double offset_;
  DirectionTable table_;
};

// Share of the directions above both horizons in which one sees and the other does not.
float difference(const CoarseView& a, const CoarseView& b) {
  int common = 0, different = 0;
  for (std::size_t i = 0; i < a.above.size(); ++i) {
    const std::uint64_t both = a.above[i] & b.above[i];
    common += std::popcount(both);
    different += std::popcount((a.visible[i] ^ b.visible[i]) & both);
  }
  return common == 0 ? 0 : static_cast<float>(different) / static_cast<float>(common);
}

std::uint64_t sum_of(const std::vector<std::uint16_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

// Calls body(i) for 0 <= i < count, in parallel; tells `monitor`.
template <class Body>
void for_each_in_blocks(std::size_t count, ProgressMonitor& monitor, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, kBlock), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
    monitor.advance(range.size());
  });
}

// Views of the vertices from `first` on that triangles use. Returns rays.
std::uint64_t cast_vertices(const TriangleMesh& mesh, const ViewCaster& caster, std::size_t first,
                            std::string_view stage, const Progress& progress,
                            std::vector<CoarseView>& views) {
  std::vector<char> used(mesh.positions.size(), 0);
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) used[v] = 1;
  views.resize(mesh.positions.size());
  std::vector<std::uint16_t> rays(mesh.positions.size() - first);
  ProgressMonitor monitor(progress, stage, rays.size());
  for_each_in_blocks(rays.size(), monitor, [&](std::size_t i) {
    const std::size_t v = first + i;
    if (used[v]) rays[i] = caster.cast(mesh.positions[v], mesh.normals[v], views[v]);
  });
  return sum_of(rays);
}

void check_density_input(const TriangleMesh& mesh, double threshold, double origin_offset) {
  check_subdivision_input(mesh);
  const std::string subject = mesh.name.empty() ? "receiver" : mesh.name;
  if (!(threshold > 0))
    throw Error(ErrorKind::input, subject,
                fmt::format("the largest difference is {}, expected more than 0", threshold));
  if (!(origin_offset >= 0) || !std::isfinite(origin_offset))
    throw Error(ErrorKind::input, subject,
                fmt::format("the origin offset is {}, expected 0 or more", origin_offset));
}

double triangle_area(const TriangleMesh& mesh, const Triangle& t) {
  const Vector3d a = mesh.positions[t[0]].cast<double>(), b = mesh.positions[t[1]].cast<double>(),
                 c = mesh.positions[t[2]].cast<double>();
  return (b - a).cross(c - a).norm() / 2;
}

bool is_usable(const TriangleMesh& mesh, const std::vector<CoarseView>& views, const Triangle& t) {
  for (const std::uint32_t v : t) {
    const auto& above = views[v].above;
    if (std::all_of(above.begin(), above.end(), [](std::uint64_t word) { return word == 0; }))
      return false;
  }
  return !is_degenerate(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]);
}

// The differences along the edges of a mesh that is being refined, carried from round to round.
class EdgeDifferences {
 public:
  EdgeDifferences(const ViewCaster& caster, const RefinementOptions& options, double min_edge)
      : caster_(caster), options_(options), min_edge_(min_edge) {}

  // Whether a segment may be halved, and how badly it needs to be; by segment. `middles` receives
  // the views of the middles of new edges that differ. Returns rays.
  std::uint64_t look(const TriangleMesh& mesh, const MeshEdges& edges,
                     const std::vector<CoarseView>& views, const Progress& progress,
                     std::vector<std::unique_ptr<CoarseView>>& middles) {
    middles.clear();
    middles.resize(edges.edges.size());
    std::vector<Known> now(edges.edges.size());
    std::vector<std::uint16_t> rays(now.size());
    ProgressMonitor monitor(progress, "refine", now.size());
    for_each_in_blocks(now.size(), monitor, [&](std::size_t i) {
      const MeshEdges::Edge& edge = edges.edges[i];
      const auto before =
          std::lower_bound(known_.begin(), known_.end(), edge.key(),
                           [](const Known& known, std::uint64_t key) { return known.key < key; });
      if (before != known_.end() && before->key == edge.key()) {
        now[i] = *before;
        return;
      }
      now[i] = {edge.key(), difference(views[edge.a], views[edge.b])};
      if (!is_divisible(mesh, edge)) return;
      auto middle = std::make_unique<CoarseView>();
      const Midpoint vertex = midpoint_of(mesh, edge);
      rays[i] = caster_.cast(vertex.position, vertex.normal, *middle);
      now[i].difference = std::max({now[i].difference, difference(views[edge.a], *middle),
                                    difference(*middle, views[edge.b])});
      if (differs(now[i].difference)) middles[i] = std::move(middle);
    });
    known_ = std::move(now);
    return sum_of(rays);
  }

  bool differs(std::size_t edge) const { return differs(known_[edge].difference); }
  float of(std::size_t edge) const { return known_[edge].difference; }
  bool is_divisible(const TriangleMesh& mesh, const MeshEdges::Edge& edge) const {
    return edge_length(mesh, edge) >= 2 * min_edge_ && can_halve(mesh, edge);
  }

 private:
  struct Known {
    std::uint64_t key = 0;
    float difference = 0;
  };
  bool differs(float difference) const { return double(difference) > options_.max_difference; }

  const ViewCaster& caster_;
  const RefinementOptions& options_;
  double min_edge_;
  std::vector<Known> known_;  // by rising key
};

// The longest segment of each triangle.
std::vector<std::uint32_t> longest_segments(const TriangleMesh& mesh, const MeshEdges& edges) {
  std::vector<std::uint32_t> longest(edges.of_triangle.size());
  for (std::size_t t = 0; t < longest.size(); ++t) {
    double length = -1;
    for (const std::uint32_t side : edges.of_triangle[t]) {
      const std::uint32_t segment = edges.edges[side].segment;
      const double own = edge_length(mesh, edges.edges[side]);
      if (!std::isfinite(own)) continue;
      if (!(own > length) && !(own == length && segment < longest[t])) continue;
      length = own;
      longest[t] = segment;
    }
  }
  return longest;
}

// Marks the longest segment of every triangle that has a marked one, until there is none left
// (rivara1984): angles stay above half of what they were, and the refinement ends. Without it, a
// triangle whose longest edge needs no halving could be cut into slivers for ever.
void mark_longest(const MeshEdges& edges, const std::vector<std::uint32_t>& longest,
                  std::vector<char>& marked) {
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t t = 0; t < longest.size(); ++t) {
      if (marked[longest[t]]) continue;
      for (const std::uint32_t side : edges.of_triangle[t])
        if (marked[edges.edges[side].segment]) marked[longest[t]] = changed = true;
    }
  }
}

// The segments to halve. With too few vertices left, those where the difference times the length is
// largest come first, and `out_of_vertices` is set.
std::vector<char> choose_segments(const TriangleMesh& mesh, const MeshEdges& edges,
                                  const EdgeDifferences& differences, std::uint64_t vertices_left,
                                  bool& out_of_vertices) {
  std::vector<double> urgency(edges.segments, 0);
  for (std::size_t i = 0; i < edges.edges.size(); ++i) {
    if (!differences.differs(i) || !differences.is_divisible(mesh, edges.edges[i])) continue;
    double& most = urgency[edges.edges[i].segment];
    most = std::max(most, double(differences.of(i)) * edge_length(mesh, edges.edges[i]));
  }
  std::vector<std::uint32_t> segments;
  for (std::uint32_t s = 0; s < edges.segments; ++s)
    if (urgency[s] > 0) segments.push_back(s);
  std::stable_sort(segments.begin(), segments.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return urgency[a] > urgency[b]; });

  const std::vector<std::uint32_t> longest = longest_segments(mesh, edges);
  std::vector<char> marked;
  const auto fits = [&](std::size_t count) {
    marked.assign(edges.segments, 0);
    for (std::size_t i = 0; i < count; ++i) marked[segments[i]] = 1;
    mark_longest(edges, longest, marked);
    std::uint64_t vertices = 0;
    for (const MeshEdges::Edge& edge : edges.edges) vertices += marked[edge.segment] != 0;
    return vertices <= vertices_left;
  };
  if (fits(segments.size())) return marked;
  out_of_vertices = true;
  std::size_t most = 0, too_many = segments.size();
  while (too_many - most > 1) {
    const std::size_t count = (most + too_many) / 2;
    (fits(count) ? most : too_many) = count;
  }
  fits(most);
  return marked;
}

double largest_extent(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f bounds;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (mesh.positions[v].allFinite()) bounds.extend(mesh.positions[v]);
  return bounds.isEmpty() ? 0 : double(bounds.sizes().maxCoeff());
}

}  // namespace

DensityReport check_density(const TriangleMesh& mesh, const RayScene& scene, double threshold,
                            double origin_offset, std::size_t worst, const Progress& progress) {
  check_density_input(mesh, threshold, origin_offset);
  std::vector<CoarseView> views;
  cast_vertices(mesh, ViewCaster(scene, origin_offset), 0, "density", progress, views);
  DensityReport report;
  report.threshold = threshold;
  double area = 0;
  std::vector<DensityReport::Triangle> exceeding;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    if (!is_usable(mesh, views, triangle)) continue;
    float largest = 0;
    for (std::size_t k = 0; k < 3; ++k)
      largest = std::max(largest, difference(views[triangle[k]], views[triangle[(k + 1) % 3]]));
    const double own = triangle_area(mesh, triangle);
    ++report.triangles;
    area += own;
    report.mean_difference += double(largest) * own;
    if (!(double(largest) > threshold)) continue;
    report.exceeding_area += own;
    exceeding.push_back({t, largest});
  }
  report.exceeding = exceeding.size();
  if (area > 0) {
    report.mean_difference /= area;
    report.exceeding_area /= area;
  }
  const auto count = std::min(worst, exceeding.size());
  std::partial_sort(exceeding.begin(), exceeding.begin() + static_cast<std::ptrdiff_t>(count),
                    exceeding.end(), [](const auto& a, const auto& b) {
                      return a.difference != b.difference ? a.difference > b.difference
                                                          : a.triangle < b.triangle;
                    });
  exceeding.resize(count);
  report.worst = std::move(exceeding);
  return report;
}

RefinementReport refine_by_visibility(TriangleMesh& mesh, const RayScene& scene,
                                      const RefinementOptions& options, const Progress& progress) {
  check_density_input(mesh, options.max_difference, options.origin_offset);
  if (!(options.min_edge >= 0) || !std::isfinite(options.min_edge))
    throw Error(ErrorKind::input, mesh.name.empty() ? "receiver" : mesh.name,
                fmt::format("the shortest edge is {}, expected 0 or more", options.min_edge));
  const double min_edge =
      options.min_edge > 0 ? options.min_edge : largest_extent(mesh) * kDefaultMinEdge;
  const ViewCaster caster(scene, options.origin_offset);
  Subdivider subdivider(mesh);
  EdgeDifferences differences(caster, options, min_edge);
  std::vector<CoarseView> views;
  RefinementReport report;
  report.rays = cast_vertices(mesh, caster, 0, "refine", progress, views);
  while (true) {
    const MeshEdges edges = find_edges(subdivider.mesh());
    std::vector<std::unique_ptr<CoarseView>> middles;
    report.rays += differences.look(subdivider.mesh(), edges, views, progress, middles);
    const std::uint64_t vertices = subdivider.mesh().positions.size();
    // Once they do not suffice, what is left over is left.
    const std::uint64_t vertices_left =
        report.out_of_vertices ? 0
                               : options.max_vertices - std::min(options.max_vertices, vertices);
    const std::vector<char> marked = choose_segments(subdivider.mesh(), edges, differences,
                                                     vertices_left, report.out_of_vertices);
    report.left = 0;
    std::vector<std::size_t> halved;
    for (std::size_t i = 0; i < edges.edges.size(); ++i) {
      if (marked[edges.edges[i].segment])
        halved.push_back(i);
      else
        report.left += differences.differs(i);
    }
    if (halved.empty()) break;
    subdivider.halve(edges, marked);
    ++report.rounds;
    // New vertices are numbered in the order of their edges.
    views.resize(subdivider.mesh().positions.size());
    std::vector<std::uint16_t> rays(halved.size());
    tbb::parallel_for(std::size_t{0}, halved.size(), [&](std::size_t k) {
      const std::size_t v = vertices + k;
      if (middles[halved[k]])
        views[v] = *middles[halved[k]];
      else
        rays[k] =
            caster.cast(subdivider.mesh().positions[v], subdivider.mesh().normals[v], views[v]);
    });
    report.rays += sum_of(rays);
  }
  report.added_vertices = subdivider.mesh().positions.size() - mesh.positions.size();
  report.added_triangles = subdivider.mesh().triangles.size() - mesh.triangles.size();
  mesh = std::move(subdivider).gather_parts();
  return report;
}

}  // namespace burnish
