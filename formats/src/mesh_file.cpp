#include "burnish/formats/mesh_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/polygon_triangulation.h"
#include "file_bytes.h"
#include "mesh/mesh_text.h"
#include "mesh/mesh_transcript.h"
#include "mesh/polygon_soup.h"
#include "mesh/weld.h"

namespace burnish {
namespace {

using detail::MeshTranscript;
using detail::PolygonSoup;
using Eigen::Vector2f;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

MeshTranscript transcribe(const std::string& path) {
  using Transcriber = MeshTranscript (*)(const std::string&, std::string);
  struct Format {
    const char* extension;
    Transcriber transcriber;
  };
  static constexpr Format kFormats[] = {{".obj", detail::transcribe_obj},
                                        {".ply", detail::transcribe_ply},
                                        {".off", detail::transcribe_off},
                                        {".stl", detail::transcribe_stl}};
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const Format& format : kFormats)
    if (detail::equals_ignoring_case(extension, format.extension)) {
      std::string bytes = read_file_bytes(path);
      if (bytes.empty()) throw Error(ErrorKind::input, path, "is empty (0 bytes), expected a mesh");
      return format.transcriber(path, std::move(bytes));
    }
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    throw Error(ErrorKind::input, path, "cannot open: no such file");
  throw Error(
      ErrorKind::unsupported, path,
      fmt::format("extension {}, expected .obj, .ply, .off or .stl", detail::quoted(extension)));
}

/// What the file says about the normal of a bake vertex. `unused` vertices are in no face.
enum class NormalOrigin : char { unused, missing, invalid, file };

/// Turns corners into bake vertices: equal corners of a file vertex share one.
class VertexSplitter {
 public:
  VertexSplitter(const PolygonSoup& soup, TriangleMesh& mesh) : soup_(soup), mesh_(mesh) {
    const size_t count = soup.positions.size();
    mesh.positions = soup.positions;
    mesh.file_vertex.resize(count);
    std::iota(mesh.file_vertex.begin(), mesh.file_vertex.end(), 0u);
    mesh.normals.assign(count, Vector3f::Constant(kNan));
    origins_.assign(count, NormalOrigin::unused);
    if (!soup.uvs.empty()) mesh.uvs.assign(count, Vector2f::Constant(kNan));
    for (std::uint32_t v = 0; v < count; ++v) {  // also of vertices that are in no face
      if (soup.per_vertex_normals) set_normal(v, v);
      if (soup.per_vertex_uvs) mesh.uvs[v] = soup.uvs[v];
    }
  }

  std::uint32_t vertex(const PolygonSoup::Corner& corner) {
    const std::uint32_t v = corner.vertex;
    if (origins_[v] == NormalOrigin::unused) {
      assign(v, corner);
      return v;
    }
    // One normal and UV to a vertex: nothing can differ.
    if (soup_.normals.empty() && soup_.uvs.empty()) return v;
    const Key key = key_of(corner);
    if (key == key_of(v)) return v;
    const auto [entry, is_new] =
        splits_.try_emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      mesh_.positions.push_back(soup_.positions[v]);
      mesh_.file_vertex.push_back(v);
      mesh_.normals.push_back(Vector3f::Constant(kNan));
      origins_.push_back(NormalOrigin::unused);
      if (!mesh_.uvs.empty()) mesh_.uvs.push_back(Vector2f::Constant(kNan));
      assign(entry->second, corner);
    }
    return entry->second;
  }

  const std::vector<NormalOrigin>& origins() const { return origins_; }

 private:
  /// File vertex, and the bits of normal and UV; all bits set for none.
  using Key = std::array<std::uint32_t, 6>;
  struct KeyHash {
    size_t operator()(const Key& key) const {
      std::uint64_t hash = 14695981039346656037ull;  // FNV-1a over words
      for (const std::uint32_t word : key) hash = (hash ^ word) * 1099511628211ull;
      return hash ^ hash >> 32;
    }
  };

  static bool is_usable(const Vector3f& n) { return n.allFinite() && n.cast<double>().norm() > 0; }
  static bool is_usable(const Vector2f& uv) { return uv.allFinite(); }

  /// Adding 0 makes -0 and 0 equal.
  template <class V>
  static void put(Key& key, size_t at, const V& value) {
    for (Eigen::Index i = 0; i < value.size(); ++i)
      key[at + static_cast<size_t>(i)] =
          is_usable(value) ? std::bit_cast<std::uint32_t>(value[i] + 0.f) : PolygonSoup::kNone;
  }

  Key key_of(const PolygonSoup::Corner& corner) const {
    Key key;
    key.fill(PolygonSoup::kNone);
    key[0] = corner.vertex;
    // Compared as stored, i.e. as unit vectors.
    if (corner.normal != PolygonSoup::kNone) put(key, 1, unit(soup_.normals[corner.normal]));
    if (corner.uv != PolygonSoup::kNone) put(key, 4, soup_.uvs[corner.uv]);
    return key;
  }

  Key key_of(std::uint32_t v) const {
    Key key;
    key.fill(PolygonSoup::kNone);
    key[0] = mesh_.file_vertex[v];
    put(key, 1, mesh_.normals[v]);
    if (!mesh_.uvs.empty()) put(key, 4, mesh_.uvs[v]);
    return key;
  }

  static Vector3f unit(const Vector3f& normal) {
    if (!is_usable(normal)) return Vector3f::Constant(kNan);
    return normal.cast<double>().normalized().cast<float>();
  }

  void set_normal(std::uint32_t v, std::uint32_t normal) {
    mesh_.normals[v] = unit(soup_.normals[normal]);
    origins_[v] = is_usable(mesh_.normals[v]) ? NormalOrigin::file : NormalOrigin::invalid;
  }

  void assign(std::uint32_t v, const PolygonSoup::Corner& corner) {
    origins_[v] = NormalOrigin::missing;
    if (corner.normal != PolygonSoup::kNone) set_normal(v, corner.normal);
    if (corner.uv != PolygonSoup::kNone) mesh_.uvs[v] = soup_.uvs[corner.uv];
  }

  const PolygonSoup& soup_;
  TriangleMesh& mesh_;
  std::vector<NormalOrigin> origins_;
  std::unordered_map<Key, std::uint32_t, KeyHash> splits_;
};

void add_triangles(const std::string& path, const PolygonSoup& soup, VertexSplitter& splitter,
                   TriangleMesh& mesh, MeshReport& report) {
  std::vector<Vector3f> corners;
  std::vector<std::uint32_t> vertices;
  std::vector<std::array<std::uint32_t, 3>> parts;
  mesh.triangles.reserve(soup.face_count());
  for (size_t f = 0; f < soup.face_count(); ++f) {
    const auto face = soup.face(f);
    if (face.size() > kMaxPolygonCorners)
      throw Error(
          ErrorKind::unsupported, path,
          fmt::format("face {} of three or more corners has {} corners, expected at most {}", f + 1,
                      face.size(), kMaxPolygonCorners));
    corners.clear();
    vertices.clear();
    for (const PolygonSoup::Corner& corner : face) {
      corners.push_back(soup.positions[corner.vertex]);
      vertices.push_back(splitter.vertex(corner));
    }
    triangulate_polygon(corners, parts);
    if (face.size() > 3) ++report.triangulated_faces;
    for (const auto& part : parts) {
      if (is_degenerate(corners[part[0]], corners[part[1]], corners[part[2]]))
        ++report.degenerate_triangles;
      else
        mesh.triangles.push_back({vertices[part[0]], vertices[part[1]], vertices[part[2]]});
    }
  }
}

/// For each vertex its group, to share one computed normal: the vertices of a file vertex, and file
/// vertices at one point whose own normals differ by less than `seam_angle_rad`. Greedy: a vertex
/// joins the first group of its point that fits, measured at the vertex that began it.
std::vector<std::uint32_t> smoothing_groups(const TriangleMesh& mesh,
                                            std::span<const Vector3f> own_normals,
                                            float seam_angle_rad) {
  std::uint32_t points = 0;
  const auto point = detail::weld_positions(mesh.positions, points);
  std::vector<std::vector<std::uint32_t>> representatives(points);
  std::vector<std::uint32_t> group(mesh.positions.size());
  for (std::uint32_t v = 0; v < group.size(); ++v) {
    group[v] = mesh.file_vertex[v];
    if (mesh.file_vertex[v] != v) {  // a split: goes where its file vertex, which came before, went
      group[v] = group[mesh.file_vertex[v]];
      continue;
    }
    auto& begun = representatives[point[v]];
    const auto fits = [&](std::uint32_t other) {
      return angle_between<float>(own_normals[v], own_normals[other]) < seam_angle_rad;
    };
    const auto found = std::find_if(begun.begin(), begun.end(), fits);
    if (found != begun.end())
      group[v] = *found;
    else
      begun.push_back(v);
  }
  return group;
}

void fill_normals(const std::vector<NormalOrigin>& origins, const MeshReadOptions& options,
                  TriangleMesh& mesh, MeshReport& report) {
  bool any_missing = false;
  for (const NormalOrigin origin : origins) {
    if (origin == NormalOrigin::missing) ++report.missing_normals;
    if (origin == NormalOrigin::invalid) ++report.invalid_normals;
    any_missing = any_missing || origin != NormalOrigin::file;
  }
  if (!any_missing) return;
  const Vector3f up = up_direction(options.up);
  const auto own = compute_normals(mesh.positions, mesh.triangles, mesh.file_vertex, up);
  const auto groups = smoothing_groups(mesh, own, options.seam_angle_rad);
  const auto computed = compute_normals(mesh.positions, mesh.triangles, groups, up);
  for (size_t v = 0; v < origins.size(); ++v)
    if (origins[v] != NormalOrigin::file) mesh.normals[v] = computed[v];
}

void fill_tangents(const std::vector<NormalOrigin>& origins, const MeshReadOptions& options,
                   TriangleMesh& mesh, MeshReport& report) {
  std::uint64_t fallbacks = 0;
  mesh.tangents = compute_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.triangles,
                                   options.up, &fallbacks);
  report.uv_tangents = mesh.positions.size() - fallbacks;
  for (size_t v = 0; v < mesh.uvs.size(); ++v) {
    if (mesh.uvs[v].allFinite()) continue;
    mesh.uvs[v].setZero();
    if (origins[v] != NormalOrigin::unused) ++report.missing_uvs;
  }
}

void add_notes(MeshReport& report) {
  const auto note = [&](std::uint64_t count, const std::string& text) {
    if (count > 0) report.notes.push_back(text);
  };
  note(report.loaded_faces == 0, "the file has no faces");
  note(report.short_faces,
       fmt::format("left out, of fewer than three corners: {} faces", report.short_faces));
  note(report.degenerate_triangles,
       fmt::format("left out, without area: {} triangles", report.degenerate_triangles));
  note(report.ignored_elements,
       fmt::format("not read, being lines, points or others that are no faces: {} elements",
                   report.ignored_elements));
  note(report.file_vertices - report.loaded_file_vertices,
       fmt::format("welded, where facets meet: {} corners to {} vertices", report.file_vertices,
                   report.loaded_file_vertices));
}

}  // namespace

TriangleMesh read_mesh(const std::string& path, const MeshReadOptions& options,
                       MeshReport* report) {
  MeshReport local;
  MeshReport& result = report != nullptr ? *report : local;
  result = {};

  MeshTranscript transcript = transcribe(path);
  const PolygonSoup soup = detail::read_soup(path, transcript);
  result.format = transcript.format;
  result.file_vertices = transcript.file_vertices;
  result.file_faces = transcript.file_faces;
  result.loaded_file_vertices = soup.positions.size();
  result.loaded_faces = soup.face_count() + transcript.collapsed_facets;
  result.short_faces = transcript.short_faces;
  result.degenerate_triangles = transcript.collapsed_facets;
  result.has_normals = transcript.has_normals;
  result.has_uvs = transcript.has_uvs;
  result.ignored_elements = transcript.ignored_elements;
  result.notes = std::move(transcript.notes);

  TriangleMesh mesh;
  mesh.name = std::filesystem::path(path).filename().string();
  VertexSplitter splitter(soup, mesh);
  add_triangles(path, soup, splitter, mesh, result);
  fill_normals(splitter.origins(), options, mesh, result);
  fill_tangents(splitter.origins(), options, mesh, result);
  add_notes(result);
  if (report != nullptr) result.statistics = analyse_mesh(mesh);
  return mesh;
}

}  // namespace burnish
