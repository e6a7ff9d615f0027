#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "burnish/formats/mesh_frames.h"
#include "burnish/formats/mesh_statistics.h"
#include "burnish/formats/triangle_mesh.h"

namespace burnish {

struct MeshReadOptions {
  UpAxis up = UpAxis::y;  ///< for the tangents of surfaces without UVs
  /// Where normals are computed: file vertices at one point share a normal if their own differ by
  /// less than this (a seam of patches or UVs), and keep their own if not (a hard edge). 0: never.
  float seam_angle_rad = kPi<float> / 6;
};

/// What a mesh file contains and what became of it.
///
///     file_faces = loaded_faces + short_faces
///     triangles made of the loaded faces = statistics.triangles + degenerate_triangles
struct MeshReport {
  std::string format;  ///< "OBJ", "PLY ascii", "PLY binary_little_endian", "OFF", "STL binary", ...
  std::uint64_t file_vertices = 0;  ///< as the file states or lists them; STL: 3 times its facets
  std::uint64_t file_faces = 0;     ///< polygons; a PLY triangle strip counts as its triangles
  std::uint64_t loaded_file_vertices = 0;  ///< = file_vertices; STL: after equal ones are welded
  std::uint64_t loaded_faces = 0;
  std::uint64_t short_faces = 0;           ///< with fewer than three corners, left out
  std::uint64_t triangulated_faces = 0;    ///< loaded faces with more than three corners
  std::uint64_t degenerate_triangles = 0;  ///< without area, left out
  bool has_normals = false;                ///< the file has any
  bool has_uvs = false;
  std::uint64_t missing_normals = 0;   ///< vertices without a normal in the file: computed
  std::uint64_t invalid_normals = 0;   ///< vertices whose normal is zero or not finite: computed
  std::uint64_t missing_uvs = 0;       ///< vertices without a finite UV in a file that has UVs
  std::uint64_t uv_tangents = 0;       ///< vertices whose tangent follows the UVs
  std::uint64_t ignored_elements = 0;  ///< lines, points, curves, ... of the file
  MeshStatistics statistics;           ///< of the mesh as returned
  std::vector<std::string> notes;      ///< one sentence each, of what a user may want to know
};

/// Reads a mesh. The format is told by the file's extension: .obj, .ply (ASCII, binary of either
/// byte order; faces or triangle strips), .off (text; N and ST variants, C's colours are not used),
/// .stl (text, binary).
///
/// - Everything the file calls a face is loaded, manifold or not, in the file's order. Polygons are
///   triangulated (triangulate_polygon). Faces of fewer than three corners and triangles without
///   area are left out and counted; nothing else is.
/// - All file vertices are kept, in the file's order, used or not. A file vertex with several
///   normals or UVs becomes several vertices: the first keeps its place, the others follow after
///   the last file vertex. Equality is exact.
/// - OBJ and PLY polygons keep the file's normals; missing, zero and non-finite ones are computed
///   (compute_normals). STL corners at exactly the same position are welded and their normals
///   computed: an STL file has only facet normals. OBJ smoothing groups are not used.
/// - Tangents: compute_tangents. A vertex without UV in a file that has UVs gets (0, 0).
///
/// Throws Error(ErrorKind::input), with line or byte, for a file that is missing, empty, cut short,
/// without vertices, not of its format, with a position that is not finite, or with a face that
/// refers to a vertex the file lacks; Error(ErrorKind::unsupported) for another extension, binary
/// OFF, OFF of other dimensions, and polygons of more than kMaxPolygonCorners corners. A file
/// without faces is not an error: the mesh has no triangles.
///
/// Safe to call from several threads (OpenMesh's readers take turns).
TriangleMesh read_mesh(const std::string& path, const MeshReadOptions& options = {},
                       MeshReport* report = nullptr);

}  // namespace burnish
