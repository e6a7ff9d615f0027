// Every mesh of the data folder, against counts taken from the files by other, simpler means.

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include "mesh_test_support.h"

namespace burnish::test {
namespace {

namespace fs = std::filesystem;

struct FileCounts {
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
  std::uint64_t short_faces = 0;
  std::uint64_t triangles = 0;  ///< of all faces, corners - 2 each
};

void add_face(FileCounts& counts, std::uint64_t corners) {
  ++counts.faces;
  if (corners < 3)
    ++counts.short_faces;
  else
    counts.triangles += corners - 2;
}

FileCounts count_obj(std::string text) {
  if (text.starts_with("\xFE\xFF")) {  // ASCII as UTF-16: drop the mark and the zero bytes
    text.erase(0, 2);
    std::erase(text, '\0');
  }
  FileCounts counts;
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    for (std::string more; line.ends_with('\\') && std::getline(lines, more);)
      line = line.substr(0, line.size() - 1) + more;
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") ++counts.vertices;
    if (word != "f") continue;
    std::uint64_t corners = 0;
    while (words >> word) ++corners;
    add_face(counts, corners);
  }
  return counts;
}

FileCounts count_off(const std::string& text) {
  std::istringstream words(text);
  std::string keyword;
  std::uint64_t faces = 0, edges = 0;
  FileCounts counts;
  words >> keyword >> counts.vertices >> faces >> edges;
  std::string line;
  std::getline(words, line);
  for (std::uint64_t i = 0; i < counts.vertices; ++i) std::getline(words, line);
  for (std::uint64_t i = 0; i < faces; ++i) {
    std::uint64_t corners = 0;
    words >> corners;
    std::getline(words, line);
    add_face(counts, corners);
  }
  return counts;
}

FileCounts count_stl(const std::string& bytes) {
  std::uint64_t facets = 0;
  if (bytes.starts_with("solid") && bytes.find("facet") != bytes.npos) {
    for (size_t at = 0; (at = bytes.find("endfacet", at)) != bytes.npos; ++at) ++facets;
  } else {
    for (int i = 3; i >= 0; --i)
      facets = facets << 8 | static_cast<unsigned char>(bytes.at(80 + static_cast<size_t>(i)));
  }
  return {3 * facets, facets, 0, facets};
}

/// Of the corners only what the corpus needs: text faces, and one binary strip of 32-bit indices.
FileCounts count_ply(const std::string& bytes) {
  const size_t end = bytes.find("end_header");
  std::istringstream header(bytes.substr(0, end));
  const bool text = bytes.find("format ascii") < end;
  FileCounts counts;
  std::string word, element;
  std::uint64_t strips = 0, faces = 0;
  while (header >> word) {
    if (word != "element") continue;
    header >> element;
    header >> (element == "vertex" ? counts.vertices : element == "face" ? faces : strips);
  }
  const size_t body = bytes.find('\n', end) + 1;
  if (strips > 0) {
    // Three floats a vertex; then the length of the strip, and its indices, -1 to begin anew.
    const auto int_at = [&](size_t at) {
      std::int32_t value = 0;
      std::memcpy(&value, bytes.data() + at, 4);
      return value;
    };
    const size_t list = body + 12 * counts.vertices;
    std::uint64_t run = 0;
    for (std::int32_t i = 0; i < int_at(list); ++i) {
      run = int_at(list + 4 + 4 * static_cast<size_t>(i)) < 0 ? 0 : run + 1;
      if (run >= 3) add_face(counts, 3);
    }
    return counts;
  }
  std::istringstream lines(bytes.substr(body));
  std::string line;
  for (std::uint64_t i = 0; text && i < counts.vertices; ++i) std::getline(lines, line);
  const bool cube = counts.vertices == 8 && faces == 6;
  for (std::uint64_t i = 0; i < faces; ++i) {
    std::uint64_t corners = cube ? 4 : 3;  // the binary files of the corpus
    if (text) {
      lines >> corners;
      std::getline(lines, line);
    }
    add_face(counts, corners);
  }
  return counts;
}

FileCounts count_file(const fs::path& path) {
  const std::string bytes = read_bytes(path);
  const std::string extension = path.extension().string();
  if (extension == ".obj") return count_obj(bytes);
  if (extension == ".off") return count_off(bytes);
  if (extension == ".ply") return count_ply(bytes);
  return count_stl(bytes);
}

bool is_mesh(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".obj" || extension == ".ply" || extension == ".off" || extension == ".stl" ||
         extension == ".STL";
}

std::vector<fs::path> meshes_below(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && is_mesh(entry.path())) paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Files that are refused: they contradict themselves, or have nothing to load.
const std::set<std::string> kRefused = {
    "number_formats.obj",                                  // 3.1+e2 is no number
    "invalid.off",                                         // an index beyond the vertices
    "issue623.ply",                                        // a list announced where there is none
    "OutOfMemory.off",                                     // 353535235358 vertices in 309 bytes
    "crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply",  // no end of the header
    "empty.obj",
    "empty.off",
    "empty.ply",
    "malformed.obj",                       // indices 12 of 8, and 0
    "invalid-relative-texture-index.obj",  // no vertices
    "invalid-relative-vertex-index.obj",
    "issue-356-leading-spaces-newmtl.obj",
    "issue-140-zero-face-idx.obj",  // index 0
    "test-nan.obj"};                // coordinates that are not numbers

void expect_truthful(const fs::path& path) {
  SCOPED_TRACE(path.string());
  if (kRefused.contains(path.filename().string())) {
    refusal_of(path.string());
    return;
  }
  LoadedMesh loaded;
  ASSERT_NO_THROW(loaded = load(path.string()));
  expect_consistent(loaded, path.string());
  const FileCounts counts = count_file(path);
  const MeshReport& report = loaded.report;
  EXPECT_EQ(report.file_vertices, counts.vertices);
  EXPECT_EQ(report.file_faces, counts.faces);
  EXPECT_EQ(report.short_faces, counts.short_faces);
  EXPECT_EQ(report.loaded_faces, counts.faces - counts.short_faces);
  EXPECT_EQ(report.statistics.triangles + report.degenerate_triangles, counts.triangles);
  if (!report.format.starts_with("STL")) {
    EXPECT_EQ(report.loaded_file_vertices, counts.vertices);
  }
}

TEST(MeshCorpus, MessyFilesEndInATruthfulReportOrAnError) {
  const fs::path folder = shared_data() / "messy";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const auto paths = meshes_below(folder);
  EXPECT_GT(paths.size(), 100u);
  std::set<std::string> seen;
  for (const fs::path& path : paths) {
    expect_truthful(path);
    seen.insert(path.filename().string());
  }
  for (const std::string& name : kRefused) EXPECT_TRUE(seen.contains(name)) << name;
}

TEST(MeshCorpus, WholeMeshesLoadWhole) {
  const fs::path folder = shared_data() / "meshes";
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const auto paths = meshes_below(folder);
  EXPECT_GE(paths.size(), 4u);
  for (const fs::path& path : paths) {
    expect_truthful(path);
    EXPECT_EQ(load(path.string()).report.degenerate_triangles, 0u) << path;
  }
}

TEST(MeshCorpus, TheTeapotHasNoSeamsBetweenItsPatches) {
  const fs::path path = shared_data() / "meshes" / "teapot.obj";
  if (!fs::exists(path)) GTEST_SKIP() << path << " is not there";
  const LoadedMesh teapot = load(path.string());
  ASSERT_EQ(teapot.report.statistics.duplicate_vertices, 403u);
  // Vertices at one point have one normal, or lie on a hard edge (the lid's rim, the spout).
  std::map<std::array<float, 3>, Vector3f> normal_at;
  size_t seams = 0;
  for (size_t v = 0; v < teapot.mesh.positions.size(); ++v) {
    const Vector3f& p = teapot.mesh.positions[v];
    const auto [entry, is_new] =
        normal_at.try_emplace({p.x(), p.y(), p.z()}, teapot.mesh.normals[v]);
    const double angle =
        angle_between<double>(entry->second.cast<double>(), teapot.mesh.normals[v].cast<double>());
    if (!is_new && angle > 0 && angle < kPi<double> / 9) ++seams;
  }
  EXPECT_EQ(seams, 0u);
}

}  // namespace
}  // namespace burnish::test
