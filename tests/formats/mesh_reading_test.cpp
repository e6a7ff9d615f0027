#include <algorithm>
#include <locale>
#include <set>
#include <thread>
#include <vector>

#include "mesh_binary_samples.h"
#include "mesh_test_support.h"

namespace burnish::test {
namespace {

using Eigen::Vector2f;

std::vector<std::string> sorted_notes(const MeshReport& report) {
  std::vector<std::string> notes = report.notes;
  std::sort(notes.begin(), notes.end());
  return notes;
}

bool any_note_contains(const MeshReport& report, const std::string& text) {
  return std::any_of(report.notes.begin(), report.notes.end(),
                     [&](const std::string& note) { return note.find(text) != note.npos; });
}

/// The cube of edge 2 that all samples hold.
void expect_cube(const LoadedMesh& cube, const std::string& name, std::uint64_t faces = 6) {
  SCOPED_TRACE(name);
  expect_consistent(cube, name);
  EXPECT_EQ(cube.report.loaded_file_vertices, 8u);
  EXPECT_EQ(cube.report.file_faces, faces);
  EXPECT_EQ(cube.report.loaded_faces, faces);
  EXPECT_EQ(cube.mesh.triangles.size(), 12u);
  EXPECT_EQ(signed_volume(cube.mesh), 8);  // exact: all coordinates are -1 or 1
  EXPECT_EQ(surface_area(cube.mesh), 24);
  const MeshStatistics& statistics = cube.report.statistics;
  EXPECT_EQ(statistics.points, 8u);
  EXPECT_EQ(statistics.components, 1u);
  EXPECT_EQ(statistics.boundary_edges, 0u);
  EXPECT_EQ(statistics.non_manifold_edges, 0u);
  EXPECT_EQ(statistics.inconsistent_edges, 0u);
  EXPECT_EQ(statistics.bounds.min(), Vector3f(-1, -1, -1));
  EXPECT_EQ(statistics.bounds.max(), Vector3f(1, 1, 1));
}

TEST(MeshReading, CubeInEveryTextFormat) {
  for (const std::string name : {"cube.obj", "cube.ply", "cube.off"})
    expect_cube(load(mesh_data(name)), name);
  const LoadedMesh stl = load(mesh_data("cube.stl"));
  expect_cube(stl, "cube.stl", 12);
  EXPECT_EQ(stl.report.file_vertices, 36u);
}

TEST(MeshReading, CubeInEveryBinaryFormat) {
  const InputFolder folder;
  expect_cube(load(folder.write("little.ply", binary_cube_ply(false))), "little-endian PLY");
  expect_cube(load(folder.write("big.ply", binary_cube_ply(true))), "big-endian PLY");
  expect_cube(load(folder.write("cube.STL", binary_cube_stl())), "binary STL", 12);
}

TEST(MeshReading, FormatIsNamed) {
  const InputFolder folder;
  EXPECT_EQ(load(mesh_data("cube.obj")).report.format, "OBJ");
  EXPECT_EQ(load(mesh_data("cube.ply")).report.format, "PLY ascii");
  EXPECT_EQ(load(folder.write("a.ply", binary_cube_ply(true))).report.format,
            "PLY binary_big_endian");
  EXPECT_EQ(load(mesh_data("cube.off")).report.format, "OFF");
  EXPECT_EQ(load(mesh_data("cube.stl")).report.format, "STL ascii");
  EXPECT_EQ(load(folder.write("a.stl", binary_cube_stl())).report.format, "STL binary");
  EXPECT_EQ(load(mesh_data("cube.obj")).mesh.name, "cube.obj");
}

TEST(MeshReading, NormalsOfASmoothCubePointAlongItsDiagonals) {
  // By symmetry, and only if the two triangles of a quad count as one: their angles add up.
  const LoadedMesh cube = load(mesh_data("cube.obj"));
  EXPECT_EQ(cube.report.missing_normals, 8u);
  for (size_t v = 0; v < 8; ++v)
    EXPECT_LT((cube.mesh.normals[v] - cube.mesh.positions[v].normalized()).norm(), 1e-6);
}

TEST(MeshReading, HardEdgesAndSeamsSplitFileVertices) {
  const LoadedMesh cube = load(mesh_data("cube_hard_edges.obj"));
  expect_consistent(cube, "cube_hard_edges.obj");
  EXPECT_EQ(cube.mesh.positions.size(), 24u);  // 6 faces of 4 corners, none alike
  EXPECT_EQ(cube.report.statistics.split_vertices, 16u);
  EXPECT_EQ(cube.report.statistics.boundary_edges, 0u);  // splits are no boundary
  EXPECT_EQ(cube.report.missing_normals, 0u);
  EXPECT_EQ(cube.report.uv_tangents, 24u);
  for (const Triangle& triangle : cube.mesh.triangles) {
    const Vector3f a = cube.mesh.positions[triangle[0]];
    const Vector3f flat = (cube.mesh.positions[triangle[1]] - a)
                              .cross(cube.mesh.positions[triangle[2]] - a)
                              .normalized();
    for (const std::uint32_t v : triangle) EXPECT_EQ(cube.mesh.normals[v], flat);
  }
  std::set<std::pair<float, float>> uvs;
  for (const Vector2f& uv : cube.mesh.uvs) uvs.insert({uv.x(), uv.y()});
  EXPECT_EQ(uvs.size(), 4u);
}

TEST(MeshReading, EachCornerGetsItsOwnNormalAndUv) {
  // A square of two triangles: at one end of the diagonal normals differ, at the other UVs.
  const InputFolder folder;
  const LoadedMesh square = load(folder.write("a.obj",
                                              "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                              "vn 0 0 1\nvn 0 0.6 0.8\nvt 0 0\nvt .25 .5\n"
                                              "f 1/1/1 2/1/1 3/1/1\nf 1/1/2 3/2/1 4/1/1\n"));
  const TriangleMesh& mesh = square.mesh;
  ASSERT_EQ(mesh.positions.size(), 6u);
  EXPECT_EQ(mesh.file_vertex, (std::vector<std::uint32_t>{0, 1, 2, 3, 0, 2}));
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{4, 5, 3}));
  EXPECT_EQ(mesh.normals[0], Vector3f(0, 0, 1));
  EXPECT_LT((mesh.normals[4] - Vector3f(0, 0.6f, 0.8f)).norm(), 1e-6);
  EXPECT_EQ(mesh.normals[5], Vector3f(0, 0, 1));
  EXPECT_EQ(mesh.uvs[2], Vector2f(0, 0));
  EXPECT_EQ(mesh.uvs[5], Vector2f(.25f, .5f));
}

TEST(MeshReading, CornersWithoutNormalOrUvAreComputedAndCounted) {
  const InputFolder folder;
  const LoadedMesh mixed = load(folder.write("a.obj",
                                             "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                                             "vn 0 0 5\nvn 0 0 0\nvn nan 0 1\nvn 1 2\nvt 0 0\n"
                                             "vt 1\nvt nan 1\n"
                                             "f 1/1/1 2//2 3/2/3\nf 1/1/1 3/3/4 4/9/9\n"));
  expect_consistent(mixed, "mixed");
  EXPECT_EQ(mixed.mesh.positions.size(), 5u);   // vertex 3 has a UV in one face only
  EXPECT_EQ(mixed.report.invalid_normals, 3u);  // vertex 2, both of vertex 3
  EXPECT_EQ(mixed.report.missing_normals, 1u);  // vertex 4
  EXPECT_EQ(mixed.report.missing_uvs, 3u);
  for (const Vector3f& normal : mixed.mesh.normals) EXPECT_EQ(normal, Vector3f(0, 0, 1));
  EXPECT_TRUE(any_note_contains(mixed.report, "texture coordinate the file lacks: 1"));
  EXPECT_TRUE(any_note_contains(mixed.report, "normal the file lacks: 1"));
}

TEST(MeshReading, NonManifoldFacesAreAllKept) {
  const LoadedMesh fan = load(mesh_data("non_manifold.obj"));
  expect_consistent(fan, "non_manifold.obj");
  EXPECT_EQ(fan.mesh.triangles.size(), 5u);
  EXPECT_EQ(fan.report.statistics.non_manifold_edges, 3u);
}

TEST(MeshReading, FacesKeepTheirOrderAndCorners) {
  const LoadedMesh fan = load(mesh_data("non_manifold.obj"));
  EXPECT_EQ(fan.mesh.triangles,
            (std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {2, 1, 0}, {0, 1, 2}}));
}

TEST(MeshReading, RepeatedCornersStayAndShortFacesAreCounted) {
  const InputFolder folder;
  // A square annulus as one polygon with a bridge; a face that folds onto itself; short faces.
  const LoadedMesh mesh =
      load(folder.write("a.obj",
                        "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\n"
                        "f 1 2 3 4 1 5 6 7 8 5\nf 1 1 2\nf 1 2\nf\n"));
  expect_consistent(mesh, "annulus");
  EXPECT_EQ(mesh.report.file_faces, 4u);
  EXPECT_EQ(mesh.report.short_faces, 2u);
  EXPECT_EQ(mesh.report.degenerate_triangles, 1u);
  EXPECT_EQ(mesh.mesh.positions.size(), 8u);
  EXPECT_EQ(mesh.mesh.triangles.size(), 8u);
  EXPECT_NEAR(surface_area(mesh.mesh), 8, 1e-12);
  EXPECT_EQ(mesh.report.statistics.boundary_edges, 8u);  // the bridge is inside
}

TEST(MeshReading, ObjDialectsMeanTheSameCube) {
  const std::string cube = read_bytes(mesh_data("cube.obj"));
  const InputFolder folder;
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    for (size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  };
  const size_t faces = cube.find("\nf ") + 1;
  std::string utf16("\xFE\xFF", 2);
  for (const char c : cube) utf16.append(1, '\0').append(1, c);
  const std::vector<std::pair<std::string, std::string>> dialects = {
      {"CRLF", replaced(cube, "\n", "\r\n")},
      {"CR", replaced(cube, "\n", "\r")},
      {"UTF-8 mark", "\xEF\xBB\xBF" + cube},
      {"UTF-16", utf16},
      {"no end of line", cube.substr(0, cube.size() - 1)},
      {"continued lines", replaced(cube, " ", " \\\n ")},
      {"tabs and spaces", replaced(cube, " ", "\t  ")},
      {"plus signs", replaced(cube, " 1 ", " +1 ")},
      {"exponents", replaced(cube, "v -1", "v -1.0E+00")},
      {"colours", replaced(replaced(cube, "1\nv", "1 .5 .5 .5\nv"), "1\nf", "1 1.0 0 0\nf")},
      {"statements", "mtllib /etc/passwd\no a\ng b\ns 1\nusemtl c\n" + cube},
      {"trailing comment", replaced(cube, "f 1 4 3 2", "f 1 4 3 2 # bottom")},
      {"faces first", cube.substr(faces) + cube.substr(0, faces)},
      {"from the end", replaced(cube, "f 1 4 3 2", "f -8 -5 -6 -7")},
      {"bare slashes", replaced(cube, "f 1 4 3 2", "f 1/ 4// 3 2/")}};
  for (const auto& [name, text] : dialects) {
    ASSERT_TRUE(name == "UTF-8 mark" || text != cube) << name;
    expect_cube(load(folder.write("a.obj", text)), name);
  }
}

TEST(MeshReading, ObjElementsThatAreNoFacesAreCounted) {
  const InputFolder folder;
  const LoadedMesh mesh = load(folder.write(
      "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1\nl 1 2\nf 1 2 3\nnonsense here\ncurv 0 1 1 2\n"));
  EXPECT_EQ(mesh.report.ignored_elements, 3u);
  EXPECT_EQ(mesh.report.loaded_faces, 1u);
  EXPECT_TRUE(any_note_contains(mesh.report, "line 7: 'nonsense'"));
}

TEST(MeshReading, PlyWithPropertiesThatOpenMeshMisreads) {
  // A list in the vertices, properties before the indices, counts of other types, an element in
  // between, an unused list behind, and texture_u, texture_v.
  const InputFolder folder;
  const LoadedMesh mesh = load(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nobj_info element face 7\ncomment end_header\nelement vertex 3\n"
      "property list uchar int weights\nproperty double x\nproperty uchar red\nproperty float y\n"
      "property float z\nproperty float texture_u\nproperty float texture_v\n"
      "element edge 1\nproperty list uchar int ends\nelement face 1\nproperty uchar material\n"
      "property list ushort short vertex_index\nproperty list uchar float texcoord\nend_header\n"
      "2 7 7 0 255 0 0 .5 1\n0 1 255 0 0 1 0\n1 7 0 255 1 0 0 0\n2 0 1\n9 3 0 1 2 2 .5 .5\n"));
  expect_consistent(mesh, "odd PLY");
  EXPECT_EQ(mesh.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(mesh.mesh.positions[1], Vector3f(1, 0, 0));
  EXPECT_EQ(mesh.mesh.positions[2], Vector3f(0, 1, 0));
  EXPECT_EQ(mesh.mesh.uvs[0], Vector2f(.5f, 1));
  EXPECT_EQ(mesh.report.ignored_elements, 1u);
}

TEST(MeshReading, PlyTriangleStripsAlternateTheirOrientation) {
  // A strip of four triangles in the plane z = 0, a restart, and a single triangle: all face up.
  const InputFolder folder;
  const LoadedMesh mesh = load(folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n10 1 0 3 2 5 4 -1 0 2 1\n"));
  expect_consistent(mesh, "strips");
  EXPECT_EQ(mesh.report.file_faces, 5u);
  EXPECT_EQ(mesh.mesh.triangles.size(), 5u);
  for (const Vector3f& normal : mesh.mesh.normals) EXPECT_EQ(normal, Vector3f(0, 0, 1));
}

TEST(MeshReading, PlyNormalsThatAreNotUsableAreComputed) {
  const InputFolder folder;
  const LoadedMesh mesh = load(
      folder.write("a.ply",
                   "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                   "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                   "0 0 0 0 3 4\n1 0 0 0 0 0\n0 1 0 -nan inf 1.#IND\n3 0 1 2\n"));
  expect_consistent(mesh, "normals");
  EXPECT_EQ(mesh.report.invalid_normals, 2u);
  EXPECT_LT((mesh.mesh.normals[0] - Vector3f(0, .6f, .8f)).norm(), 1e-6);
  EXPECT_EQ(mesh.mesh.normals[1], Vector3f(0, 0, 1));
  EXPECT_EQ(mesh.mesh.normals[2], Vector3f(0, 0, 1));
}

TEST(MeshReading, OffVariants) {
  const InputFolder folder;
  const std::string cube = read_bytes(mesh_data("cube.off"));
  const std::string glued = "OFF8 6 12" + cube.substr(cube.find("12\n") + 2);
  expect_cube(load(folder.write("a.off", glued)), "counts glued to the keyword");
  expect_cube(load(folder.write("b.off", "OFF 8 6" + cube.substr(cube.find("12\n") + 2))),
              "counts on the line of the keyword, no edges");

  const LoadedMesh rich = load(folder.write("c.off",
                                            "STCNOFF # all there is\n\n3 1 0 # counts\n"
                                            "0 0 0 0 0 2 255 0 0 255 .5 1\n1 0 0\n0 0 2 0 1\n"
                                            "0 1 0 0 0 2 .1 .2 .3 1 0\n3 0 1 2 255 0 0\n"));
  expect_consistent(rich, "STCNOFF");
  EXPECT_EQ(rich.report.invalid_normals + rich.report.missing_normals, 0u);
  EXPECT_EQ(rich.mesh.uvs[0], Vector2f(.5f, 1));
  EXPECT_EQ(rich.mesh.uvs[1], Vector2f(0, 1));
  EXPECT_EQ(rich.mesh.uvs[2], Vector2f(1, 0));
  EXPECT_EQ(rich.mesh.normals[0], Vector3f(0, 0, 1));
  // The reader of OpenMesh remembers the last header: not so here.
  expect_cube(load(mesh_data("cube.off")), "after a file with normals");
}

TEST(MeshReading, StlOddities) {
  const InputFolder folder;
  const std::string cube = read_bytes(mesh_data("cube.stl"));
  expect_cube(load(folder.write("a.stl", "solid outer shell\n" + cube.substr(cube.find('\n') + 1))),
              "a name with 'outer'", 12);
  std::string upper = cube;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  expect_cube(load(folder.write("b.stl", upper)), "upper case", 12);
  std::string named = binary_cube_stl();
  named.replace(0, 10, "solid cube");
  expect_cube(load(folder.write("c.stl", named)), "binary that begins with solid", 12);
  const LoadedMesh longer = load(folder.write("d.stl", binary_cube_stl() + "more"));
  expect_cube(longer, "binary with a tail", 12);
  EXPECT_TRUE(any_note_contains(longer.report, "4 bytes after the last facet"));

  const std::string facet =
      "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 1 0 0\nendloop\n"
      "endfacet\n";
  const LoadedMesh collapsed = load(folder.write("e.stl", "solid a\n" + facet + facet));
  EXPECT_EQ(collapsed.report.file_faces, 2u);
  EXPECT_EQ(collapsed.report.degenerate_triangles, 2u);
  EXPECT_TRUE(any_note_contains(collapsed.report, "no endsolid"));
}

TEST(MeshReading, DegenerateTrianglesAreLeftOutAndCounted) {
  const InputFolder folder;
  const LoadedMesh mesh = load(folder.write(
      "a.obj",
      "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 0\nf 1 2 3\nf 1 5 4\nf 1 2 4\nf 2 3 4\n"));
  expect_consistent(mesh, "degenerate");
  EXPECT_EQ(mesh.report.loaded_faces, 4u);
  EXPECT_EQ(mesh.report.degenerate_triangles, 2u);
  EXPECT_EQ(mesh.mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.report.statistics.duplicate_vertices, 1u);
  EXPECT_EQ(mesh.mesh.normals[4], Vector3f(0, 1, 0));  // in no triangle: the up axis
  EXPECT_EQ(sorted_notes(mesh.report),
            (std::vector<std::string>{"left out, without area: 2 triangles"}));
}

TEST(MeshReading, ComputedNormalsAreSharedAcrossSeamsAndNotAcrossEdges) {
  // Two squares with file vertices of their own along the fold x = 1.
  const InputFolder folder;
  const std::string faces = "f 1 2 3 4\nf 5 6 7 8\n";
  // Far edge at (1.9, y, 0.2): a fold of 12.5 degrees. At (1, y, 1): one of 90 degrees.
  const std::string gentle =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 1.9 0 .2\nv 1.9 1 .2\nv 1 1 0\n" + faces;
  const std::string sharp =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 0\nv 1 0 1\nv 1 1 1\nv 1 1 0\n" + faces;
  const LoadedMesh seam = load(folder.write("seam.obj", gentle));
  EXPECT_EQ(seam.mesh.normals[1], seam.mesh.normals[4]);
  EXPECT_NE(seam.mesh.normals[1], seam.mesh.normals[0]);
  MeshReadOptions never;
  never.seam_angle_rad = 0;
  EXPECT_NE(load(folder.file("seam.obj"), never).mesh.normals[1], seam.mesh.normals[4]);
  const LoadedMesh edge = load(folder.write("edge.obj", sharp));
  EXPECT_EQ(edge.mesh.normals[1], Vector3f(0, 0, 1));
  EXPECT_EQ(edge.mesh.normals[4], Vector3f(-1, 0, 0));
}

/// Writes one half as 0,5.
struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(MeshReading, DoesNotDependOnTheLocaleOfTheProgram) {
  const InputFolder folder;
  const std::string path = folder.write("a.obj", "v 0 0 0\nv 1.5 0 0\nv 0 2.25 0\nf 1 2 3\n");
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  const LoadedMesh mesh = load(path);
  const char point = std::use_facet<std::numpunct<char>>(std::locale()).decimal_point();
  std::locale::global(before);
  EXPECT_EQ(mesh.mesh.positions[1], Vector3f(1.5f, 0, 0));
  EXPECT_EQ(mesh.mesh.positions[2], Vector3f(0, 2.25f, 0));
  EXPECT_EQ(point, ',') << "the program's locale was not put back";
}

TEST(MeshReading, SeveralThreadsAtOnce) {
  const InputFolder folder;
  const std::vector<std::string> paths = {mesh_data("cube.obj"), mesh_data("cube.off"),
                                          mesh_data("cube.stl"),
                                          folder.write("a.ply", binary_cube_ply(false))};
  std::vector<std::string> failures(4);
  std::vector<std::thread> threads;
  for (size_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (size_t i = 0; i < 50; ++i) {
        const TriangleMesh mesh = read_mesh(paths[(t + i) % 4]);
        if (mesh.positions.size() != 8 || signed_volume(mesh) != 8)
          failures[t] = paths[(t + i) % 4];
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::string& failure : failures) EXPECT_EQ(failure, "");
}

TEST(MeshReading, PrintsNothing) {
  const InputFolder folder;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  read_mesh(folder.write("a.obj",
                         "mtllib missing.mtl\nusemtl none\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n"
                         "f 1/9/9 2 3\n"));
  read_mesh(folder.write("a.ply", binary_cube_ply(true)));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace burnish::test
