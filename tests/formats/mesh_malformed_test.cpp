#include <map>
#include <random>

#include "burnish/formats/polygon_triangulation.h"
#include "mesh_binary_samples.h"
#include "mesh_test_support.h"

namespace burnish::test {
namespace {

struct Refusal {
  std::string words;  ///< in the message, with the place
  ErrorKind kind = ErrorKind::input;
};

/// Every file of data/meshes/malformed.
const std::map<std::string, Refusal> kRefusals = {
    {"binary.off", {"binary OFF", ErrorKind::unsupported}},
    {"count_beyond_file.off", {"line 2: 4000000000, expected the number of vertices"}},
    {"face_count_beyond_file.ply", {"states 4000000000 items of face"}},
    {"faces_without_indices.ply", {"'face' has no list 'vertex_indices'"}},
    {"float_list_count.ply", {"line 4: a list is counted by a float"}},
    {"four_dimensions.off", {"'4OFF'", ErrorKind::unsupported}},
    {"four_indices.obj", {"line 4: face corner '1/1/1/1'"}},
    {"huge_coordinate.obj", {"line 2: vertex coordinate '1e39'"}},
    {"index_before_start.obj", {"line 3: face refers to vertex -3"}},
    {"index_beyond.obj", {"line 5: face refers to vertex 4, expected 1 to 3"}},
    {"index_beyond.off", {"line 6: 3, expected the index of a face's vertex of at most 2"}},
    {"index_beyond.ply", {"line 13: face refers to vertex 3, expected 0 to 2"}},
    {"index_missing.obj", {"line 4: face corner '/1'"}},
    {"index_negative.off", {"line 6: '-1', expected the index of a face's vertex"}},
    {"index_overflow.obj", {"line 4: face corner '99999999999999999999'"}},
    {"index_word.obj", {"line 4: face corner 'three'"}},
    {"index_zero.obj", {"line 4: face refers to vertex 0"}},
    {"infinite_coordinate.stl", {"line 5: 'inf', expected a coordinate"}},
    {"list_count_beyond_file.ply",
     {"line 13: list vertex_indices of face has a count of 4000000000"}},
    {"nan_coordinate.obj", {"line 2: vertex coordinate 'nan'"}},
    {"nan_coordinate.off", {"line 3: 'nan', expected a vertex coordinate"}},
    {"nan_coordinate.ply", {"line 9: y of vertex 1 is"}},
    {"negative_count.off", {"line 2: '-3', expected the number of vertices"}},
    {"negative_list_count.ply", {"line 13: list vertex_indices of face has a count of -3"}},
    {"no_end_header.ply", {"line 5: the header has no end_header"}},
    {"no_facets.stl", {"has no facets"}},
    {"no_format.ply", {"line 6: the header has no format"}},
    {"no_keyword.off", {"line 1: '8', expected OFF"}},
    {"no_magic.ply", {"does not begin with 'ply'"}},
    {"no_vertices.obj", {"has no vertices"}},
    {"no_z.ply", {"no property 'z'"}},
    {"property_first.ply", {"line 3: a property before the first element"}},
    {"prose.obj", {"has no vertices"}},
    {"short_binary.stl", {"is no STL: 43 bytes"}},
    {"too_few_vertices.off", {"line 4: the file ends, expected a vertex coordinate"}},
    {"two_coordinates.obj", {"line 2: vertex has 2 coordinates, expected 3"}},
    {"two_vertex_elements.ply", {"two elements 'vertex'"}},
    {"two_vertices.stl", {"line 6: 'endloop', expected vertex"}},
    {"unknown_format.ply", {"line 2: format 'binary_middle_endian'"}},
    {"unknown_statement.stl", {"line 5: 'vortex', expected vertex"}},
    {"unknown_type.ply", {"line 4: property type 'quad'"}},
    {"vertex_count_beyond_file.ply", {"expected at most"}},
};

TEST(MeshMalformed, EachFileIsRefusedWithPlaceAndReason) {
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(mesh_data("malformed"))) {
    const std::string name = entry.path().filename().string();
    ++files;
    ASSERT_TRUE(kRefusals.contains(name)) << name << " has no expected message";
    const Refusal& refusal = kRefusals.at(name);
    const std::string message = refusal_of(entry.path().string(), refusal.kind);
    EXPECT_NE(message.find(refusal.words), message.npos) << message;
  }
  EXPECT_EQ(files, kRefusals.size());
}

TEST(MeshMalformed, RejectsWhatIsNoReadableFile) {
  const InputFolder folder;
  EXPECT_NE(refusal_of(folder.file("none.obj")).find("No such file"), std::string::npos);
  EXPECT_NE(refusal_of(folder.file("none")).find("no such file"), std::string::npos);
  EXPECT_NE(refusal_of(folder.write("empty.obj", "")).find("empty"), std::string::npos);
  std::filesystem::create_directory(folder.file("folder.obj"));
  EXPECT_NE(refusal_of(folder.file("folder.obj")).find("folder"), std::string::npos);
  const std::string message = refusal_of(folder.write("mesh.fbx", "x"), ErrorKind::unsupported);
  EXPECT_NE(message.find("'.fbx', expected .obj, .ply, .off or .stl"), message.npos);
}

TEST(MeshMalformed, MessagesStayOneShortLine) {
  const InputFolder folder;
  const std::string junk = std::string(5000, 'x') + "\x01\x1b[31m\xff";
  const std::string path = folder.write("a.obj", "v " + junk + " 0 0\n");
  EXPECT_LT(refusal_of(path).size(), path.size() + 200);
}

TEST(MeshMalformed, RejectsPolygonsTooLargeToTriangulate) {
  const InputFolder folder;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf";
  for (size_t i = 0; i <= kMaxPolygonCorners; ++i) text += " 1";
  const std::string message = refusal_of(folder.write("a.obj", text), ErrorKind::unsupported);
  EXPECT_NE(message.find("expected at most"), message.npos);
}

TEST(MeshMalformed, EveryTruncationOfABinaryFileIsRefused) {
  const InputFolder folder;
  for (const auto& [name, bytes] :
       {std::pair<std::string, std::string>{"a.ply", binary_cube_ply(false)},
        {"b.ply", binary_cube_ply(true)},
        {"c.stl", binary_cube_stl()}})
    for (size_t length = 0; length < bytes.size(); ++length) {
      const std::string path = folder.write(name, std::string_view(bytes).substr(0, length));
      EXPECT_NE(refusal_of(path), "") << name << " cut to " << length;
    }
}

// A text may be cut inside its last number, which no reader can know; so cuts are made where words
// end. A prefix that still holds all words is the whole mesh.
TEST(MeshMalformed, EveryTruncationOfACountedTextIsRefused) {
  const InputFolder folder;
  for (const std::string name : {"cube.ply", "cube.off"}) {
    const std::string text = read_bytes(mesh_data(name));
    const size_t words_end = text.find_last_not_of(" \n") + 1;
    for (size_t length = 0; length < words_end; ++length)
      refusal_of(folder.write(name, std::string_view(text).substr(0, length)));
    for (size_t length = words_end; length <= text.size(); ++length) {
      const LoadedMesh whole = load(folder.write(name, std::string_view(text).substr(0, length)));
      EXPECT_EQ(whole.mesh.triangles.size(), 12u);
    }
  }
}

TEST(MeshMalformed, EveryTruncationOfAnStlTextIsRefusedOrNoted) {
  const InputFolder folder;
  const std::string text = read_bytes(mesh_data("cube.stl"));
  const size_t whole = text.rfind("endsolid") + 8;
  size_t noted = 0;
  for (size_t length = 0; length < whole; ++length) {
    const std::string path = folder.write("a.stl", std::string_view(text).substr(0, length));
    try {
      const LoadedMesh mesh = load(path);
      ASSERT_EQ(mesh.report.notes.front(),
                "the last solid has no endsolid; the file may be cut short");
      ++noted;
    } catch (const Error&) {
    }
  }
  EXPECT_EQ(noted, 2u * 12);  // behind each facet, without and with its line end
}

/// `v` and `f` lines, by the most naive means.
std::pair<size_t, size_t> count_obj_lines(const std::string& text) {
  std::pair<size_t, size_t> counts;
  for (size_t at = 0; at != text.npos; at = text.find('\n', at)) {
    if (text[at] == '\n') ++at;
    counts.first += text.compare(at, 2, "v ") == 0;
    counts.second += text.compare(at, 1, "f") == 0;
    if (at >= text.size()) break;
  }
  return counts;
}

TEST(MeshMalformed, EveryTruncationOfAnObjIsRefusedOrCountedAsItIs) {
  const InputFolder folder;
  const std::string text = read_bytes(mesh_data("cube.obj"));
  size_t loaded = 0;
  for (size_t length = 0; length < text.size(); ++length) {
    const std::string prefix = text.substr(0, length);
    const std::string path = folder.write("a.obj", prefix);
    try {
      const LoadedMesh mesh = load(path);
      expect_consistent(mesh, path);
      const auto [vertices, faces] = count_obj_lines(prefix);
      ASSERT_EQ(mesh.report.file_vertices, vertices) << "cut to " << length;
      ASSERT_EQ(mesh.report.file_faces, faces) << "cut to " << length;
      ++loaded;
    } catch (const Error&) {
    }
  }
  EXPECT_GT(loaded, 50u);
}

/// Overwrites, inserts or removes a few bytes; favours those that mean something.
std::string mutate(std::string bytes, std::mt19937& random) {
  constexpr std::string_view kTelling = "0123456789 \n\r-+./\\e#vfn\xff";
  const auto pick = [&](size_t count) {
    return std::uniform_int_distribution<size_t>(0, count - 1)(random);
  };
  for (size_t edits = 1 + pick(4); edits > 0 && !bytes.empty(); --edits) {
    const size_t at = pick(bytes.size());
    const char value =
        pick(2) == 0 ? kTelling[pick(kTelling.size())] : static_cast<char>(pick(256));
    switch (pick(3)) {
      case 0:
        bytes[at] = value;
        break;
      case 1:
        bytes.insert(at, 1 + pick(3), value);
        break;
      default:
        bytes.erase(at, 1 + pick(8));
        break;
    }
  }
  return bytes;
}

TEST(MeshMalformed, MutatedFilesEndInAMeshOrAnError) {
  constexpr unsigned kSeed = 20240611;
  constexpr int kRounds = 500;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  const InputFolder folder;
  std::mt19937 random(kSeed);
  const std::vector<std::pair<std::string, std::string>> samples = {
      {"a.obj", read_bytes(mesh_data("cube_hard_edges.obj"))},
      {"b.ply", read_bytes(mesh_data("cube.ply"))},
      {"c.ply", binary_cube_ply(false)},
      {"d.ply", binary_cube_ply(true)},
      {"e.off", read_bytes(mesh_data("cube.off"))},
      {"f.stl", read_bytes(mesh_data("cube.stl"))},
      {"g.stl", binary_cube_stl()}};
  for (const auto& [name, bytes] : samples) {
    int loaded = 0, refused = 0;
    for (int round = 0; round < kRounds && !testing::Test::HasFatalFailure(); ++round) {
      const std::string path = folder.write(name, mutate(bytes, random));
      try {
        expect_consistent(load(path), name + ", round " + std::to_string(round));
        ++loaded;
      } catch (const Error& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        ++refused;
      }
    }
    // Or the mutations would test nothing but one of the two.
    EXPECT_GT(loaded, kRounds / 100) << name;
    EXPECT_GT(refused, kRounds / 100) << name;
  }
}

}  // namespace
}  // namespace burnish::test
