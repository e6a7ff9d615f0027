#pragma once

#include <cstdint>
#include <string>
#include <vector>

/// How mesh files reach OpenMesh.
///
/// OpenMesh 9 reads well-formed files well. Others it misreads, mostly in silence: a face on a
/// non-manifold edge is dropped by its half-edge mesh; in OBJ, a number it cannot read shifts all
/// later indices, continued lines end a face, repeated corners vanish, a corner without a vertex
/// index reads before an array, and materials open other files; in PLY, an unfinished header is an
/// endless loop, a list in an ASCII element, or a face property before the indices, shifts all that
/// follows, and counts are trusted before they are compared with the file; OFF knows no comments
/// and keeps its header from file to file; STL drops triangles, and takes a name with "outer" in
/// it for a loop.
///
/// So each file is first transcribed, token by token, into the plain dialect of its format that
/// OpenMesh reads exactly, and refused with line or byte when it cannot be. The transcript's counts
/// are the file's own, and what OpenMesh delivers is held against them.
namespace burnish::detail {

/// Handles of OpenMesh are ints.
inline constexpr std::uint64_t kMaxElements = (std::uint64_t{1} << 31) - 1;

struct MeshTranscript {
  enum class Dialect { obj, ply, stl };

  Dialect dialect = Dialect::obj;  ///< PLY: binary little-endian. STL: binary
  std::string bytes;
  std::uint64_t vertices = 0;  ///< in `bytes`; STL: unknown, 0
  std::uint64_t faces = 0;     ///< in `bytes`

  /// OBJ: vertex file_vertices + i of the transcript is one more copy of vertex alias_of[i], for a
  /// face that uses it twice.
  std::vector<std::uint32_t> alias_of;

  std::string format;
  std::uint64_t file_vertices = 0;
  std::uint64_t file_faces = 0;
  std::uint64_t short_faces = 0;       ///< in the file, of fewer than three corners
  std::uint64_t collapsed_facets = 0;  ///< STL: in the file, with two corners at one point
  std::uint64_t ignored_elements = 0;
  bool has_normals = false;
  bool has_uvs = false;
  std::vector<std::string> notes;
};

/// `path` is for errors, `bytes` is the file's contents. Throw Error.
MeshTranscript transcribe_obj(const std::string& path, std::string bytes);
MeshTranscript transcribe_ply(const std::string& path, std::string bytes);
MeshTranscript transcribe_off(const std::string& path, std::string bytes);
MeshTranscript transcribe_stl(const std::string& path, std::string bytes);

/// Collects vertices and faces, and writes them in the PLY dialect.
class PlyDialectWriter {
 public:
  /// `normal` and `uv` are written when the file has them: the same for every vertex.
  void vertex(const float position[3], const float* normal, const float* uv);
  void face(const std::uint32_t* corners, size_t count);

  std::uint64_t faces() const { return faces_; }

  /// The finished file; call once.
  std::string finish(bool has_normals, bool has_uvs);

 private:
  std::string vertex_bytes_;
  std::string face_bytes_;
  std::uint64_t vertices_ = 0;
  std::uint64_t faces_ = 0;
};

}  // namespace burnish::detail
