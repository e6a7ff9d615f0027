#include "subdivision_edges.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;
constexpr std::uint64_t kMaxCount = std::numeric_limits<std::uint32_t>::max();

std::string subject_of(const TriangleMesh& mesh) {
  return mesh.name.empty() ? "receiver" : mesh.name;
}

/// An order of positions in which NaN has a place and -0 is 0.
std::array<std::uint32_t, 3> position_key(const Vector3f& p) {
  return {std::bit_cast<std::uint32_t>(p.x() + 0.f), std::bit_cast<std::uint32_t>(p.y() + 0.f),
          std::bit_cast<std::uint32_t>(p.z() + 0.f)};
}

/// For each vertex the first one, in some fixed order, at its position.
std::vector<std::uint32_t> find_points(const std::vector<Vector3f>& positions) {
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const auto key_a = position_key(positions[a]), key_b = position_key(positions[b]);
    return key_a != key_b ? key_a < key_b : a < b;
  });
  std::vector<std::uint32_t> point(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_new =
        i == 0 || position_key(positions[order[i]]) != position_key(positions[order[i - 1]]);
    point[order[i]] = is_new ? order[i] : point[order[i - 1]];
  }
  return point;
}

/// Numbers the segments of edges that are sorted already.
void find_segments(const std::vector<std::uint32_t>& point, MeshEdges& found) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> segments(found.edges.size());
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    const auto [p, q] = std::minmax(point[found.edges[i].a], point[found.edges[i].b]);
    segments[i] = {std::uint64_t{p} << 32 | q, i};
  }
  std::sort(segments.begin(), segments.end());
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i == 0 || segments[i].first != segments[i - 1].first) ++found.segments;
    found.edges[segments[i].second].segment = found.segments - 1;
  }
}

Vector3d unit_or_zero(const Vector3f& v) {
  const Vector3d wide = v.cast<double>();
  const double length = wide.norm();
  return length > 0 && std::isfinite(length) ? Vector3d(wide / length) : Vector3d::Zero();
}

/// The children of a triangle, `middle[k]` between corners k and k + 1 or kNone, in place of it.
void append_children(const TriangleMesh& mesh, const Triangle& t,
                     const std::array<std::uint32_t, 3>& middle, std::vector<Triangle>& triangles) {
  const auto halved =
      std::count_if(middle.begin(), middle.end(), [](std::uint32_t m) { return m != kNone; });
  if (halved == 0) return triangles.push_back(t);
  if (halved == 3) {
    triangles.insert(triangles.end(), {{t[0], middle[0], middle[2]},
                                       {middle[0], t[1], middle[1]},
                                       {middle[2], middle[1], t[2]},
                                       {middle[0], middle[1], middle[2]}});
    return;
  }
  // Turned so that the edge a-b is halved, and of two halved edges b-c is the other.
  std::size_t k = 0;
  while (middle[k] == kNone || (halved == 2 && middle[(k + 1) % 3] == kNone)) ++k;
  const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
  const std::uint32_t ab = middle[k], bc = middle[(k + 1) % 3];
  if (halved == 1) {
    triangles.insert(triangles.end(), {{a, ab, c}, {ab, b, c}});
    return;
  }
  triangles.push_back({ab, b, bc});
  const auto square_distance = [&](std::uint32_t p, std::uint32_t q) {
    return (mesh.positions[p] - mesh.positions[q]).cast<double>().squaredNorm();
  };
  if (square_distance(a, bc) <= square_distance(ab, c))
    triangles.insert(triangles.end(), {{a, ab, bc}, {a, bc, c}});
  else
    triangles.insert(triangles.end(), {{a, ab, c}, {ab, bc, c}});
}

}  // namespace

void check_subdivision_input(const TriangleMesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  const auto fail = [&](const std::string& message) {
    throw Error(ErrorKind::input, subject_of(mesh), message);
  };
  if (mesh.normals.size() != vertices || mesh.tangents.size() != vertices ||
      mesh.file_vertex.size() != vertices || (!mesh.uvs.empty() && mesh.uvs.size() != vertices))
    fail(
        fmt::format("has {} normals, {} tangents, {} file vertex numbers and {} UVs, expected one "
                    "a vertex ({})",
                    mesh.normals.size(), mesh.tangents.size(), mesh.file_vertex.size(),
                    mesh.uvs.size(), vertices));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const std::uint32_t v : mesh.triangles[i])
      if (v >= vertices)
        fail(fmt::format("triangle {} uses vertex {}, expected below {}", i, v, vertices));
  if (mesh.parts.empty()) return;
  std::uint64_t next_vertex = 0, next_triangle = 0;
  for (const MeshPart& part : mesh.parts) {
    if (part.first_vertex != next_vertex || part.first_triangle != next_triangle)
      fail(fmt::format("part '{}' starts at vertex {} and triangle {}, expected {} and {}",
                       part.name, part.first_vertex, part.first_triangle, next_vertex,
                       next_triangle));
    next_vertex += part.vertices;
    next_triangle += part.triangles;
  }
  if (next_vertex != vertices || next_triangle != mesh.triangles.size())
    fail(fmt::format("its parts have {} vertices and {} triangles, expected {} and {}", next_vertex,
                     next_triangle, vertices, mesh.triangles.size()));
}

MeshEdges find_edges(const TriangleMesh& mesh) {
  struct Side {
    std::uint64_t key = 0, side = 0;  // vertices; 3 * triangle + corner
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      sides.push_back({std::uint64_t{a} << 32 | b, sides.size()});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) { return s.key < t.key; });
  MeshEdges found;
  found.of_triangle.resize(mesh.triangles.size());
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].key != sides[i - 1].key)
      found.edges.push_back({static_cast<std::uint32_t>(sides[i].key >> 32),
                             static_cast<std::uint32_t>(sides[i].key), 0});
    found.of_triangle[sides[i].side / 3][sides[i].side % 3] =
        static_cast<std::uint32_t>(found.edges.size() - 1);
  }
  find_segments(find_points(mesh.positions), found);
  return found;
}

double edge_length(const TriangleMesh& mesh, const MeshEdges::Edge& edge) {
  return (mesh.positions[edge.a].cast<double>() - mesh.positions[edge.b].cast<double>()).norm();
}

Midpoint midpoint_of(const TriangleMesh& mesh, const MeshEdges::Edge& edge) {
  const auto [a, b] = std::pair(edge.a, edge.b);
  Midpoint middle;
  middle.position =
      ((mesh.positions[a].cast<double>() + mesh.positions[b].cast<double>()) / 2).cast<float>();
  const Vector3d normal_a = unit_or_zero(mesh.normals[a]), normal_b = unit_or_zero(mesh.normals[b]);
  Vector3d normal = normal_a + normal_b;
  // 1e-6: what remains of floats' unit vectors that cancel is of the order of 1e-7.
  if (!(normal.norm() > 1e-6)) normal = normal_a.isZero(0) ? normal_b : normal_a;
  normal = unit_or_zero(normal.cast<float>());
  const Vector3d tangent_a = unit_or_zero(mesh.tangents[a]);
  const Vector3d tangent_b = unit_or_zero(mesh.tangents[b]);
  const Vector3d tangent =
      tangent_a.dot(tangent_b) < 0 ? Vector3d(tangent_a - tangent_b) : tangent_a + tangent_b;
  middle.normal = normal.cast<float>();
  middle.tangent = frame_from_normal_tangent<double>(normal, tangent).x.cast<float>();
  middle.uv =
      mesh.uvs.empty() ? Eigen::Vector2f::Zero() : Eigen::Vector2f((mesh.uvs[a] + mesh.uvs[b]) / 2);
  return middle;
}

bool can_halve(const TriangleMesh& mesh, const MeshEdges::Edge& edge) {
  const Vector3f &a = mesh.positions[edge.a], &b = mesh.positions[edge.b];
  if (!a.allFinite() || !b.allFinite()) return false;
  const Vector3f middle = ((a.cast<double>() + b.cast<double>()) / 2).cast<float>();
  return middle != a && middle != b;
}

Subdivider::Subdivider(const TriangleMesh& mesh) : mesh_(mesh) {
  if (mesh.parts.size() < 2) return;
  for (std::uint32_t p = 0; p < mesh.parts.size(); ++p)
    part_of_.insert(part_of_.end(), mesh.parts[p].vertices, p);
}

void Subdivider::halve(const MeshEdges& edges, const std::vector<char>& marked) {
  std::vector<std::uint32_t> middle(edges.edges.size(), kNone);
  std::uint64_t vertices = mesh_.positions.size(), triangles = mesh_.triangles.size();
  for (std::size_t i = 0; i < middle.size(); ++i)
    if (marked[edges.edges[i].segment]) middle[i] = static_cast<std::uint32_t>(vertices++);
  for (const auto& sides : edges.of_triangle)
    for (const std::uint32_t side : sides) triangles += middle[side] != kNone;
  if (vertices > kMaxCount || triangles > kMaxCount)
    throw Error(ErrorKind::input, subject_of(mesh_),
                fmt::format("subdivision makes {} vertices and {} triangles, expected at most {}",
                            vertices, triangles, kMaxCount));

  for (std::size_t i = 0; i < middle.size(); ++i) {
    if (middle[i] == kNone) continue;
    const Midpoint vertex = midpoint_of(mesh_, edges.edges[i]);
    mesh_.positions.push_back(vertex.position);
    mesh_.normals.push_back(vertex.normal);
    mesh_.tangents.push_back(vertex.tangent);
    mesh_.file_vertex.push_back(kNoFileVertex);
    if (!mesh_.uvs.empty()) mesh_.uvs.push_back(vertex.uv);
    if (!part_of_.empty()) part_of_.push_back(part_of_[edges.edges[i].a]);
  }
  std::vector<Triangle> children;
  children.reserve(triangles);
  std::size_t part = 0;
  std::uint32_t part_end = mesh_.parts.empty() ? 0 : mesh_.parts[0].triangles;
  const auto close_parts = [&](std::size_t triangle) {
    while (part < mesh_.parts.size() && triangle == part_end) {
      const auto end = static_cast<std::uint32_t>(children.size());
      mesh_.parts[part].triangles = end - mesh_.parts[part].first_triangle;
      if (++part == mesh_.parts.size()) break;
      mesh_.parts[part].first_triangle = end;
      part_end += mesh_.parts[part].triangles;
    }
  };
  for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
    close_parts(t);
    const auto& sides = edges.of_triangle[t];
    append_children(mesh_, mesh_.triangles[t],
                    {middle[sides[0]], middle[sides[1]], middle[sides[2]]}, children);
  }
  close_parts(mesh_.triangles.size());
  mesh_.triangles = std::move(children);
}

TriangleMesh Subdivider::gather_parts() && {
  if (mesh_.parts.size() == 1)
    mesh_.parts[0].vertices = static_cast<std::uint32_t>(mesh_.positions.size());
  if (part_of_.empty()) return std::move(mesh_);
  for (MeshPart& part : mesh_.parts) part.vertices = 0;
  for (const std::uint32_t part : part_of_) ++mesh_.parts[part].vertices;
  std::vector<std::uint32_t> next(mesh_.parts.size());
  for (std::size_t p = 1; p < next.size(); ++p)
    mesh_.parts[p].first_vertex = next[p] = next[p - 1] + mesh_.parts[p - 1].vertices;
  std::vector<std::uint32_t> place(part_of_.size());
  for (std::size_t v = 0; v < place.size(); ++v) place[v] = next[part_of_[v]]++;
  const auto reorder = [&](auto& values) {
    auto moved = values;
    for (std::size_t v = 0; v < values.size(); ++v) moved[place[v]] = values[v];
    values = std::move(moved);
  };
  reorder(mesh_.positions);
  reorder(mesh_.normals);
  reorder(mesh_.tangents);
  reorder(mesh_.file_vertex);
  if (!mesh_.uvs.empty()) reorder(mesh_.uvs);
  for (Triangle& triangle : mesh_.triangles)
    for (std::uint32_t& v : triangle) v = place[v];
  return std::move(mesh_);
}

}  // namespace burnish
