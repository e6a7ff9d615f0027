#pragma once

#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "burnish/formats/mesh_file.h"
#include "files.h"
#include "mesh_measures.h"

namespace burnish::test {

inline std::string mesh_data(const std::string& name) {
  return std::string(BURNISH_TEST_DATA) + "/meshes/" + name;
}

/// A folder for files that are to be read.
class InputFolder : public TemporaryFolder {
 public:
  std::string write(const std::string& name, std::string_view bytes) const {
    write_bytes(file(name), std::string(bytes));
    return file(name);
  }
};

struct LoadedMesh {
  TriangleMesh mesh;
  MeshReport report;
};

inline LoadedMesh load(const std::string& path, const MeshReadOptions& options = {}) {
  LoadedMesh loaded;
  loaded.mesh = read_mesh(path, options, &loaded.report);
  return loaded;
}

/// What every mesh that read_mesh returns must hold, whatever the file.
inline void expect_consistent(const LoadedMesh& loaded, const std::string& name) {
  SCOPED_TRACE(name);
  const TriangleMesh& mesh = loaded.mesh;
  const MeshReport& report = loaded.report;
  const size_t count = mesh.positions.size();
  ASSERT_EQ(mesh.normals.size(), count);
  ASSERT_EQ(mesh.tangents.size(), count);
  ASSERT_EQ(mesh.file_vertex.size(), count);
  ASSERT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == count);
  ASSERT_EQ(report.file_faces, report.loaded_faces + report.short_faces);
  ASSERT_EQ(report.statistics.triangles, mesh.triangles.size());
  ASSERT_EQ(report.statistics.degenerate_triangles, 0u);
  ASSERT_GE(count, report.loaded_file_vertices);
  for (size_t v = 0; v < count; ++v) {
    ASSERT_TRUE(mesh.positions[v].allFinite()) << "vertex " << v;
    // 1e-6: a unit vector rounded to float.
    ASSERT_NEAR(mesh.normals[v].norm(), 1, 1e-6) << "vertex " << v;
    ASSERT_NEAR(mesh.tangents[v].norm(), 1, 1e-6) << "vertex " << v;
    ASSERT_NEAR(mesh.tangents[v].dot(mesh.normals[v]), 0, 1e-6) << "vertex " << v;
    const std::uint32_t original = mesh.file_vertex[v];
    ASSERT_LT(original, report.loaded_file_vertices) << "vertex " << v;
    if (v < report.loaded_file_vertices) {
      ASSERT_EQ(original, v);
    }
    ASSERT_EQ(mesh.positions[v], mesh.positions[original]) << "vertex " << v;
  }
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) ASSERT_LT(v, count);
}

/// The message with which reading is refused; a failure when it is not, or not in one line of
/// printable characters.
inline std::string refusal_of(const std::string& path, ErrorKind kind = ErrorKind::input) {
  const std::string message = error_of(
      path, [&] { read_mesh(path); }, kind);
  EXPECT_NE(message, "") << path << " was read, expected an Error";
  for (const char c : message) EXPECT_TRUE(c >= ' ' && c <= '~') << message;
  return message;
}

}  // namespace burnish::test
