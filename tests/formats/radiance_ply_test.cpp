#include "burnish/formats/radiance_ply.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "mesh_test_support.h"

namespace burnish::test {
namespace {

const std::vector<Vector3f> kPositions = {{0, 0, 0}, {1.5f, 0, 0}, {0, -2.25f, 1e-3f}};
const std::vector<Vector3f> kNormals = {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
const std::vector<Rgb> kRadiance = {{0, .25f, 1}, {3.5f, -1, std::nanf("")}, {.5f, 1e-3f, 100}};
const std::vector<Triangle> kTriangles = {{0, 1, 2}, {2, 1, 0}};

/// The byte of a linear value, from the definition of sRGB (IEC 61966-2-1).
int srgb_byte(double linear) {
  const double c = linear > 0 ? std::min(linear, 1.0) : 0;
  const double s = c <= .0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - .055;
  return static_cast<int>(std::lround(255 * s));
}

TEST(RadiancePly, HoldsExactlyWhatWasGiven) {
  const InputFolder folder;
  for (const float stops : {0.f, 1.f, -3.f}) {
    write_radiance_ply(folder.file("a.ply"), kPositions, kNormals, kRadiance, kTriangles, stops);
    const std::string bytes = read_bytes(folder.file("a.ply"));
    const std::string end = "end_header\n";
    const size_t body = bytes.find(end) + end.size();
    ASSERT_EQ(bytes.size(), body + 3 * (9 * 4 + 3) + 2 * (1 + 3 * 4));
    for (const char* property : {"float radiance_r", "float radiance_g", "float radiance_b",
                                 "uchar red", "uchar green", "uchar blue"})
      EXPECT_NE(bytes.find("property " + std::string(property) + "\n"), bytes.npos) << property;
    for (size_t v = 0; v < 3; ++v) {
      const char* at = bytes.data() + body + v * 39;
      float values[9];
      std::memcpy(values, at, sizeof values);
      EXPECT_EQ(Vector3f(values[0], values[1], values[2]), kPositions[v]);
      EXPECT_EQ(Vector3f(values[3], values[4], values[5]), kNormals[v]);
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(std::memcmp(&values[6 + c], &kRadiance[v][c], 4), 0);  // NaN too
        EXPECT_EQ(static_cast<unsigned char>(at[36 + c]),
                  srgb_byte(static_cast<double>(kRadiance[v][c]) * std::exp2(stops)))
            << "vertex " << v << ", channel " << c << ", stops " << stops;
      }
    }
  }
}

TEST(RadiancePly, ReadsBackAsAMesh) {
  const InputFolder folder;
  write_radiance_ply(folder.file("a.ply"), kPositions, kNormals, kRadiance, kTriangles);
  const LoadedMesh mesh = load(folder.file("a.ply"));
  expect_consistent(mesh, "a.ply");
  EXPECT_EQ(mesh.mesh.positions, kPositions);
  EXPECT_EQ(mesh.mesh.normals, kNormals);
  EXPECT_EQ(mesh.mesh.triangles, kTriangles);
  EXPECT_TRUE(mesh.report.notes.empty());
}

TEST(RadiancePly, RejectsSizesThatDifferAndIndicesOutOfRange) {
  const InputFolder folder;
  const std::string path = folder.file("a.ply");
  const std::span<const Vector3f> two(kPositions.data(), 2);
  EXPECT_THROW(write_radiance_ply(path, two, kNormals, kRadiance, {}), std::invalid_argument);
  const std::vector<Triangle> beyond = {{0, 1, 3}};
  EXPECT_THROW(write_radiance_ply(path, kPositions, kNormals, kRadiance, beyond),
               std::invalid_argument);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(RadiancePly, FailureLeavesTheOldFileAndNothingElse) {
  expect_output_survives_failure("a.ply", [](const std::string& path) {
    write_radiance_ply(path, kPositions, kNormals, kRadiance, kTriangles);
  });
}

}  // namespace
}  // namespace burnish::test
