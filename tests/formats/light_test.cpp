#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "burnish/formats/light_file.h"
#include "files.h"
#include "json_damage.h"

namespace burnish::test {
namespace {

const std::string kName = "studio.json";

std::string parse_error(const std::string& json, ErrorKind kind = ErrorKind::input) {
  return error_of(
      kName, [&] { parse_lights(json, kName); }, kind);
}

Vector3f random_vector(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const float x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

LightFile random_lights(unsigned seed, int lobes, int spheres) {
  std::mt19937 random(seed);
  LightFile file;
  file.name = "quotes \" backslash \\ newline \n umlaut \xc3\xbc";
  file.source = "studio.hdr";
  file.fit_relative_l2 = 0.0834567890123;
  file.world_from_environment =
      Eigen::AngleAxisf(1.2f, random_vector(random).normalized()).toRotationMatrix();
  for (int i = 0; i < lobes; ++i) {
    EnvironmentLobe light;
    light.lobe.frame =
        frame_from_normal_tangent<float>(random_vector(random).normalized(), random_vector(random));
    light.lobe.bandwidth_x = std::exp(3 * random_vector(random).x());
    light.lobe.bandwidth_y = i == 0 ? 0 : std::exp(3 * random_vector(random).x());
    light.color = random_vector(random).array().abs() * 1e-3f;
    file.rig.lobes.push_back(light);
  }
  for (int i = 0; i < spheres; ++i)
    file.rig.spheres.push_back({random_vector(random), std::exp(random_vector(random).x()),
                                random_vector(random).array().abs()});
  return file;
}

/// Exact equality: floats are written in a form that reads back equal.
void expect_equal(const LightFile& a, const LightFile& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.fit_relative_l2, b.fit_relative_l2);
  EXPECT_EQ(a.world_from_environment, b.world_from_environment);
  ASSERT_EQ(a.rig.lobes.size(), b.rig.lobes.size());
  for (size_t i = 0; i < a.rig.lobes.size(); ++i) {
    const EnvironmentLobe &l = a.rig.lobes[i], &m = b.rig.lobes[i];
    EXPECT_EQ(l.lobe.frame.z, m.lobe.frame.z);
    EXPECT_EQ(l.lobe.frame.x, m.lobe.frame.x);
    EXPECT_TRUE(l.lobe.frame.y.isApprox(m.lobe.frame.y, 1e-5f));  // computed: rounding
    EXPECT_EQ(l.lobe.bandwidth_x, m.lobe.bandwidth_x);
    EXPECT_EQ(l.lobe.bandwidth_y, m.lobe.bandwidth_y);
    EXPECT_EQ(l.lobe.amplitude, m.lobe.amplitude);
    EXPECT_TRUE((l.color == m.color).all());
  }
  ASSERT_EQ(a.rig.spheres.size(), b.rig.spheres.size());
  for (size_t i = 0; i < a.rig.spheres.size(); ++i) {
    EXPECT_EQ(a.rig.spheres[i].center, b.rig.spheres[i].center);
    EXPECT_EQ(a.rig.spheres[i].radius, b.rig.spheres[i].radius);
    EXPECT_TRUE((a.rig.spheres[i].radiance == b.rig.spheres[i].radiance).all());
  }
}

TEST(LightFile, ReadsBackWhatWasWritten) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.json");
  for (const auto& [lobes, spheres] : {std::pair{0, 0}, {1, 0}, {0, 1}, {20, 5}}) {
    const LightFile lights = random_lights(unsigned(31 + lobes), lobes, spheres);
    write_lights(lights, path);
    expect_equal(read_lights(path), lights);
    // A second round changes nothing.
    EXPECT_EQ(format_lights(read_lights(path), path), read_bytes(path));
  }
  LightFile plain;
  write_lights(plain, path);
  expect_equal(read_lights(path), plain);
}

TEST(LightFile, AmplitudeGoesIntoTheColor) {
  LightFile lights = random_lights(2, 1, 0);
  lights.rig.lobes[0].lobe.amplitude = 4;
  const LightFile found = parse_lights(format_lights(lights, kName), kName);
  EXPECT_EQ(found.rig.lobes[0].lobe.amplitude, 1);
  EXPECT_TRUE((found.rig.lobes[0].color == 4 * lights.rig.lobes[0].color).all());
}

TEST(LightFile, IsReadableByPeople) {
  LightFile lights;
  lights.name = "one";
  lights.rig.lobes.push_back({{{}, 2, 0.1f, 1}, {1, 0.5f, 0.25f}});
  lights.rig.spheres.push_back({{0, 1, 2}, 0.5f, {3, 3, 3}});
  EXPECT_EQ(format_lights(lights, kName), R"({
  "format": "burnish lights",
  "format_version": 1,
  "name": "one",
  "source": "",
  "world_from_environment": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  "lobes": [
    {"axis": [0, 0, 1], "tangent": [1, 0, 0], "bandwidth_x": 2, "bandwidth_y": 0.1, "color": [1, 0.5, 0.25]}
  ],
  "spheres": [
    {"center": [0, 1, 2], "radius": 0.5, "radiance": [3, 3, 3]}
  ]
}
)");
}

/// A file with one field of its only lobe, its only sphere, or itself replaced. Line numbers below
/// refer to it.
std::string example(const std::string& replace = "", const std::string& with = "") {
  std::string json = R"({
  "format": "burnish lights",
  "format_version": 1,
  "world_from_environment": [[1, 0, 0], [0, 1, 0],
                             [0, 0, 1]],
  "lobes": [
    {
      "axis": [0, 0, 1], "tangent": [1, 0, 0],
      "bandwidth_x": 2,
      "bandwidth_y": 3, "color": [1, 2, 3]
    }
  ],
  "spheres": [ {"center": [0, 1, 2], "radius": 0.5,
                "radiance": [3, 3, 3]} ]
})";
  if (!replace.empty()) {
    const size_t place = json.find(replace);
    EXPECT_NE(place, std::string::npos) << replace;
    json.replace(place, replace.size(), with);
  }
  return json;
}

TEST(LightFile, RejectsBadValuesByPathAndLine) {
  ASSERT_EQ(parse_error(example()), "");
  const struct {
    const char *replace, *with, *place, *cause;
  } cases[] = {
      {"burnish lights", "other", "line 2, /format:", "expected 'burnish lights'"},
      {"\"format\"", "\"fmt\"", "line 1, /:", "has no field 'format'"},
      {"version\": 1", "version\": 0", "line 3, /format_version:", "1 or more"},
      {"version\": 1", "version\": 1.5", "line 3, /format_version:", "integer"},
      {"\"lobes\"", "\"lobs\"", "line 6, /lobs:", "unknown field, expected one of format,"},
      {"\"bandwidth_y\"", "\"bandwidth\"", "line 10, /lobes/0/bandwidth:", "unknown field"},
      {"\"bandwidth_y\": 3,", "", "line 7, /lobes/0:", "has no field 'bandwidth_y'"},
      {"\"bandwidth_x\": 2", "\"bandwidth_x\": -1",
       "line 9, /lobes/0/bandwidth_x:", "-1, expected 0"},
      {"\"bandwidth_x\": 2", "\"bandwidth_x\": \"2\"",
       "line 9, /lobes/0/bandwidth_x:", "is string, expected a number"},
      {"\"bandwidth_x\": 2", "\"bandwidth_x\": 1e39", "line 9, /lobes/0/bandwidth_x:", "1e+39"},
      {"[1, 2, 3]", "[1, 2, -3]", "line 10, /lobes/0/color/2:", "-3, expected 0"},
      {"[1, 2, 3]", "[1, 2]", "line 10, /lobes/0/color:", "has 2 elements, expected 3"},
      {"[1, 2, 3]", "{}", "line 10, /lobes/0/color:", "is object, expected an array"},
      {"\"axis\": [0, 0, 1]", "\"axis\": [0, 0, 1.01]", "line 8, /lobes/0/axis:", "length 1.01"},
      {"\"tangent\": [1, 0, 0]", "\"tangent\": [0, 0, 1]", "line 8, /lobes/0/tangent:", "cosine 1"},
      {"\"radius\": 0.5", "\"radius\": 0", "line 13, /spheres/0/radius:", "0, expected"},
      {"\"radiance\": [3, 3, 3]", "\"radiance\": [3, null, 3]",
       "line 14, /spheres/0/radiance/1:", "is null"},
      {"[0, 1, 0]", "[0, -1, 0]", "line 4, /world_from_environment:", "not a rotation"},
      {"[0, 0, 1]],", "[0, 0.1, 1]],", "line 4, /world_from_environment:", "not a rotation"},
      {"[0, 0, 1]],", "[0, 0, 7e200]],", "line 5, /world_from_environment/2/2:", "7e+200"},
      {"\"lobes\": [", "\"lobes\": [ 5, ", "line 6, /lobes/0:", "is number, expected an object"},
      {"\"spheres\": [ {", "\"spheres\": [ {\"a/b~\\n\": 1, ",
       "line 13, /spheres/0/a~1b~0?:", "unknown field"},
  };
  for (const auto& bad : cases) {
    const std::string error = parse_error(example(bad.replace, bad.with));
    EXPECT_NE(error.find(bad.place), std::string::npos) << bad.place << " / " << error;
    EXPECT_NE(error.find(bad.cause), std::string::npos) << bad.cause << " / " << error;
  }
}

TEST(LightFile, RejectsBadSyntaxByLineAndColumn) {
  EXPECT_NE(parse_error("").find("line 1, column 1"), std::string::npos);
  EXPECT_NE(
      parse_error(example("\"bandwidth_x\": 2", "\"bandwidth_x\": 2x")).find("line 9, column 23"),
      std::string::npos);
  EXPECT_NE(parse_error(example("\"bandwidth_x\": 2", "\"bandwidth_x\": 1e999")).find("line 9"),
            std::string::npos);
  EXPECT_NE(parse_error(example() + "{}").find("line 15"), std::string::npos);
  EXPECT_NE(parse_error(example() + std::string(1, '\0')).find("a zero byte"), std::string::npos);
  EXPECT_NE(parse_error(example("\"lobes\"", "\"format\"")).find("\"format\" occurs twice"),
            std::string::npos);
  EXPECT_NE(parse_error(std::string(100000, '[')), "");
  EXPECT_NE(parse_error(std::string(100, '[') + std::string(100, ']')).find("64 levels"),
            std::string::npos);
  EXPECT_NE(parse_error("[]").find("is array, expected an object"), std::string::npos);
  EXPECT_EQ(parse_error(example("version\": 1", "version\": 2"), ErrorKind::unsupported),
            kName + ": light format version 2, this build reads up to 1");
}

TEST(LightFile, FramesAreMadeOrthonormal) {
  const LightFile lights =
      parse_lights(example("\"axis\": [0, 0, 1], \"tangent\": [1, 0, 0]",
                           "\"axis\": [0, 0.0005, 1.0003], \"tangent\": [0.9996, 0, 0.0007]"),
                   kName);
  const Frame<float>& frame = lights.rig.lobes.at(0).lobe.frame;
  Eigen::Matrix3f matrix;
  matrix << frame.x, frame.y, frame.z;
  EXPECT_TRUE((matrix.transpose() * matrix).isIdentity(1e-6f));  // a few roundings of float
  EXPECT_NEAR(matrix.determinant(), 1, 1e-6f);
  const LightFile turned = parse_lights(example("[[1, 0, 0]", "[[1.0004, 0, 0]"), kName);
  EXPECT_TRUE((turned.world_from_environment.transpose() * turned.world_from_environment)
                  .isIdentity(1e-6f));
}

TEST(LightFile, WriterRejectsWhatCannotBeReadBack) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.json");
  const auto write_error = [&](auto spoil) {
    LightFile lights = random_lights(4, 2, 1);
    spoil(lights);
    return error_of(
        path, [&] { write_lights(lights, path); }, ErrorKind::output);
  };
  EXPECT_NE(
      write_error([](LightFile& l) { l.rig.lobes[1].color[0] = -1; }).find("/lobes/1/color/0: -1"),
      std::string::npos);
  EXPECT_NE(write_error([](LightFile& l) { l.rig.spheres[0].radius = NAN; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.rig.lobes[0].lobe.bandwidth_x = INFINITY; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.world_from_environment *= 2; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.fit_relative_l2 = -0.1; }), "");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(LightFile, FailedWriteLeavesTheOldFile) {
  expect_output_survives_failure(
      "a.json", [](const std::string& path) { write_lights(random_lights(1, 2, 1), path); });
}

TEST(LightFile, EveryTruncationAndChangeIsRejectedOrRead) {
  expect_damage_is_refused_or_read(format_lights(random_lights(9, 2, 1), kName), 12,
                                   [](const std::string& json) { parse_lights(json, kName); });
}

}  // namespace
}  // namespace burnish::test
