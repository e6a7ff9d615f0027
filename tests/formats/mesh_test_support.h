#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "burnish/formats/mesh_file.h"

namespace burnish::test {

inline std::string mesh_data(const std::string& name) {
  return std::string(BURNISH_TEST_DATA) + "/meshes/" + name;
}

/// The data folder that lies beside the sources, or wherever BURNISH_SHARED_DATA says.
inline std::filesystem::path shared_data() {
  if (const char* folder = std::getenv("BURNISH_SHARED_DATA")) return folder;
  return std::filesystem::path(BURNISH_SOURCE_DIR) / ".." / "shared" / "data";
}

inline std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in.good()) << path << ": missing";
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder of its own, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::random_device random;
    path_ = std::filesystem::temp_directory_path() / ("burnish-test-" + std::to_string(random()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const {
    std::ofstream out(path_ / name, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    EXPECT_TRUE(out.good());
    return file(name);
  }

 private:
  std::filesystem::path path_;
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

/// The message of the Error that reading throws; fails when it throws none, or not one line that
/// begins with the file.
inline std::string error_of(const std::string& path, ErrorKind kind = ErrorKind::input) {
  try {
    read_mesh(path);
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(error.kind(), kind) << message;
    EXPECT_TRUE(message.starts_with(path + ": ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const char c : message.substr(path.size())) EXPECT_TRUE(c >= ' ' && c <= '~') << message;
    return message;
  }
  ADD_FAILURE() << path << " was read, expected an Error";
  return {};
}

/// Volume enclosed by a mesh, by the divergence theorem: positive when normals point outward.
inline double signed_volume(const TriangleMesh& mesh) {
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d a = mesh.positions[t[0]].cast<double>();
    const Vector3d b = mesh.positions[t[1]].cast<double>();
    const Vector3d c = mesh.positions[t[2]].cast<double>();
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

inline double surface_area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3d a = mesh.positions[t[0]].cast<double>();
    area += (mesh.positions[t[1]].cast<double>() - a)
                .cross(mesh.positions[t[2]].cast<double>() - a)
                .norm() /
            2;
  }
  return area;
}

}  // namespace burnish::test
