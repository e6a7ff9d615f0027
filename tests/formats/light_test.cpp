#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "burnish/formats/light_file.h"
#include "burnish/light/local_lights.h"
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

/// `locals` of each kind of light that is not a lobe.
LightFile random_lights(unsigned seed, int lobes, int locals) {
  std::mt19937 random(seed);
  LightFile file;
  file.name = "quotes \" backslash \\ newline \n umlaut \xc3\xbc";
  file.source = "studio.hdr";
  file.fit_relative_l2 = 0.0834567890123;
  file.fit_irradiance_relative_l2 = 0.01234567890123;
  file.scale = 0.3f;
  file.world_from_environment =
      Eigen::AngleAxisf(1.2f, random_vector(random).normalized()).toRotationMatrix();
  for (int i = 0; i < lobes; ++i) {
    EnvironmentLobe light;
    light.lobe.frame =
        frame_from_normal_tangent<float>(random_vector(random).normalized(), random_vector(random));
    light.lobe.bandwidth_x = std::exp(3 * random_vector(random).x());
    light.lobe.bandwidth_y = i == 0 ? 0 : std::exp(3 * random_vector(random).x());
    light.color = random_vector(random).array() * 1e-3f;  // of either sign
    file.rig.lobes.push_back(light);
  }
  for (int i = 0; i < locals; ++i) {
    file.rig.directionals.push_back(
        {random_vector(random).normalized(), 0.1f * float(i), random_vector(random).array().abs()});
    file.rig.spheres.push_back({random_vector(random), std::exp(random_vector(random).x()),
                                random_vector(random).array().abs()});
    const Frame<float> frame = frame_from_axis<float>(random_vector(random).normalized());
    file.rig.rectangles.push_back({random_vector(random), 3 * frame.x, 0.1f * frame.y,
                                   random_vector(random).array().abs(), i % 2 == 0});
  }
  return file;
}

/// Exact equality: floats are written in a form that reads back equal.
void expect_equal(const LightFile& a, const LightFile& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.fit_relative_l2, b.fit_relative_l2);
  EXPECT_EQ(a.fit_irradiance_relative_l2, b.fit_irradiance_relative_l2);
  EXPECT_EQ(a.world_from_environment, b.world_from_environment);
  EXPECT_EQ(a.scale, b.scale);
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
  ASSERT_EQ(a.rig.directionals.size(), b.rig.directionals.size());
  for (size_t i = 0; i < a.rig.directionals.size(); ++i) {
    EXPECT_EQ(a.rig.directionals[i].toward, b.rig.directionals[i].toward);
    EXPECT_EQ(a.rig.directionals[i].angular_radius_rad, b.rig.directionals[i].angular_radius_rad);
    EXPECT_TRUE((a.rig.directionals[i].irradiance == b.rig.directionals[i].irradiance).all());
  }
  ASSERT_EQ(a.rig.rectangles.size(), b.rig.rectangles.size());
  for (size_t i = 0; i < a.rig.rectangles.size(); ++i) {
    EXPECT_EQ(a.rig.rectangles[i].center, b.rig.rectangles[i].center);
    EXPECT_EQ(a.rig.rectangles[i].edge_x, b.rig.rectangles[i].edge_x);
    EXPECT_EQ(a.rig.rectangles[i].edge_y, b.rig.rectangles[i].edge_y);
    EXPECT_EQ(a.rig.rectangles[i].two_sided, b.rig.rectangles[i].two_sided);
    EXPECT_TRUE((a.rig.rectangles[i].radiance == b.rig.rectangles[i].radiance).all());
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
  lights.rig.directionals.push_back({{0, 1, 0}, 0.00465f, {90000, 85000, 80000}});
  lights.rig.spheres.push_back({{0, 1, 2}, 0.5f, {3, 3, 3}});
  lights.rig.rectangles.push_back({{0, 2, 0}, {1, 0, 0}, {0, 0, 0.5f}, {10, 10, 10}, false});
  EXPECT_EQ(format_lights(lights, kName), R"({
  "format": "burnish lights",
  "format_version": 2,
  "name": "one",
  "source": "",
  "world_from_environment": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  "scale": 1,
  "lobes": [
    {"axis": [0, 0, 1], "tangent": [1, 0, 0], "bandwidth_x": 2, "bandwidth_y": 0.1, "color": [1, 0.5, 0.25]}
  ],
  "directionals": [
    {"toward": [0, 1, 0], "angular_radius_rad": 0.00465, "irradiance": [90000, 85000, 80000]}
  ],
  "spheres": [
    {"center": [0, 1, 2], "radius": 0.5, "radiance": [3, 3, 3]}
  ],
  "rectangles": [
    {"center": [0, 2, 0], "edge_x": [1, 0, 0], "edge_y": [0, 0, 0.5], "two_sided": false, "radiance": [10, 10, 10]}
  ]
}
)");
}

/// A file with one field of its only lobe, its only sphere, or itself replaced. Line numbers below
/// refer to it.
std::string example(const std::string& replace = "", const std::string& with = "") {
  std::string json = R"({
  "format": "burnish lights",
  "format_version": 2,
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
                "radiance": [3, 3, 3]} ],
  "directionals": [ {"toward": [0, 0, -1],
                     "angular_radius_rad": 0.25, "irradiance": [4, 5, 6]} ],
  "rectangles": [ {"center": [0, 2, 0], "edge_x": [2, 0, 0],
                   "edge_y": [0, 0.5, 0], "two_sided": true,
                   "power": [7, 8, 9]} ],
  "scale": 2
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
      {"version\": 2", "version\": 0", "line 3, /format_version:", "1 or more"},
      {"version\": 2", "version\": 1.5", "line 3, /format_version:", "integer"},
      {"\"lobes\"", "\"lobs\"", "line 6, /lobs:", "unknown field, expected one of format,"},
      {"\"bandwidth_y\"", "\"bandwidth\"", "line 10, /lobes/0/bandwidth:", "unknown field"},
      {"\"bandwidth_y\": 3,", "", "line 7, /lobes/0:", "has no field 'bandwidth_y'"},
      {"\"bandwidth_x\": 2", "\"bandwidth_x\": -1",
       "line 9, /lobes/0/bandwidth_x:", "-1, expected 0"},
      {"\"bandwidth_x\": 2", "\"bandwidth_x\": \"2\"",
       "line 9, /lobes/0/bandwidth_x:", "is string, expected a number"},
      {"\"bandwidth_x\": 2", "\"bandwidth_x\": 1e39", "line 9, /lobes/0/bandwidth_x:", "1e+39"},
      {"[1, 2, 3]", "[1, 2, -1e39]", "line 10, /lobes/0/color/2:", "-1e+39"},
      {"[1, 2, 3]", "[1, 2]", "line 10, /lobes/0/color:", "has 2 elements, expected 3"},
      {"[1, 2, 3]", "{}", "line 10, /lobes/0/color:", "is object, expected an array"},
      {"\"axis\": [0, 0, 1]", "\"axis\": [0, 0, 1.01]", "line 8, /lobes/0/axis:", "length 1.01"},
      {"\"tangent\": [1, 0, 0]", "\"tangent\": [0, 0, 1]", "line 8, /lobes/0/tangent:", "cosine 1"},
      {"\"radius\": 0.5", "\"radius\": 0", "line 13, /spheres/0/radius:", "0, expected"},
      {"\"radiance\": [3, 3, 3]", "\"radiance\": [3, null, 3]",
       "line 14, /spheres/0/radiance/1:", "is null"},
      {"\"radius\": 0.5,", "\"radius\": 0.5, \"power\": [1, 1, 1],",
       "line 13, /spheres/0:", "expected one of the fields 'radiance' and 'power'"},
      {"\"radius\": 0.5,\n                \"radiance\": [3, 3, 3]",
       "\"radius\": 1e-5,\n                \"power\": [1e35, 3, 3]",
       "line 14, /spheres/0/power:", "beyond the range of a float"},
      {"[0, 0, -1]", "[0, 0, -2]", "line 15, /directionals/0/toward:", "length 2"},
      {"0.25", "2", "line 16, /directionals/0/angular_radius_rad:", "2, expected 0..1.57"},
      {"\"irradiance\"", "\"irradience\"", "line 16, /directionals/0/irradience:", "unknown field"},
      {", \"irradiance\": [4, 5, 6]", "",
       "line 15, /directionals/0:", "expected one of the fields 'radiance' and 'irradiance'"},
      {"0.25, \"irradiance\"", "0, \"radiance\"",
       "line 16, /directionals/0/radiance:", "at an angular radius of 0"},
      {"\"edge_x\": [2, 0, 0]", "\"edge_x\": [0, 0, 0]",
       "line 17, /rectangles/0/edge_x:", "length 0, expected above 0"},
      {"[0, 0.5, 0]", "[0.1, 0.5, 0]", "line 18, /rectangles/0/edge_y:", "with edge_x, expected 0"},
      {"true", "1", "line 18, /rectangles/0/two_sided:", "is number, expected true or false"},
      {"[7, 8, 9]", "[7, 8, -9]", "line 19, /rectangles/0/power/2:", "-9, expected 0"},
      {"\"center\": [0, 2, 0], ", "", "line 17, /rectangles/0:", "has no field 'center'"},
      {"\"scale\": 2", "\"scale\": -2", "line 20, /scale:", "-2, expected 0"},
      {"\"scale\": 2", "\"fit_irradiance_relative_l2\": -2",
       "line 20, /fit_irradiance_relative_l2:", "expected 0 or more"},
      {"[0, 1, 0]", "[0, -1, 0]", "line 4, /world_from_environment:", "not a rotation"},
      {"[0, 0, 1]],", "[0, 0.1, 1]],", "line 4, /world_from_environment:", "not a rotation"},
      {"[0, 0, 1]],", "[0, 0, 7e200]],", "line 5, /world_from_environment/2/2:", "7e+200"},
      {"\"lobes\": [", "\"lobes\": [ 5, ", "line 6, /lobes/0:", "is number, expected an object"},
      {"\"scale\": 2", "\"scale\": 1e30",
       "line 20, /scale:", "1e+30, with which of /lobes/0 the color"},
      {"[1, 2, 3]", "[1e25, 2, -1e30]",
       "line 20, /scale:", "2, with which of /lobes/0 the color times amplitude is 2e+30"},
      {"[4, 5, 6]", "[4, 1e30, 6]",
       "line 20, /scale:", "of /directionals/0 the radiance of the irradiance is 1.0"},
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
  EXPECT_NE(parse_error(example() + "{}").find("line 21"), std::string::npos);
  EXPECT_NE(parse_error(example() + std::string(1, '\0')).find("a zero byte"), std::string::npos);
  EXPECT_NE(parse_error(example("\"lobes\"", "\"format\"")).find("\"format\" occurs twice"),
            std::string::npos);
  EXPECT_NE(parse_error(std::string(100000, '[')), "");
  EXPECT_NE(parse_error(std::string(100, '[') + std::string(100, ']')).find("64 levels"),
            std::string::npos);
  EXPECT_NE(parse_error("[]").find("is array, expected an object"), std::string::npos);
  EXPECT_EQ(parse_error(example("version\": 2", "version\": 3"), ErrorKind::unsupported),
            kName + ": light format version 3, this build reads up to 2");
}

TEST(LightFile, TakesPowersRadiancesAndIrradiances) {
  const LightFile given = parse_lights(example(), kName);
  const RectangleLight& panel = given.rig.rectangles.at(0);
  // 2 x 0.5 on two sides: power / (2 pi) per unit of area; floats.
  EXPECT_LT((panel.radiance - Rgb(7, 8, 9) / (2 * kPi<float>)).abs().maxCoeff(), 1e-6);
  EXPECT_TRUE(panel.two_sided);
  EXPECT_EQ(given.rig.directionals.at(0).irradiance.y(), 5);
  EXPECT_EQ(given.scale, 2);
  const LightFile one_sided =
      parse_lights(example("\"two_sided\": true,\n                   ", ""), kName);
  EXPECT_FALSE(one_sided.rig.rectangles.at(0).two_sided);
  EXPECT_LT((one_sided.rig.rectangles[0].radiance - 2 * panel.radiance).abs().maxCoeff(), 1e-6);
  // pi sin^2 of the angular radius; 4 pi^2 times the square of the radius.
  const LightFile sun = parse_lights(example("\"irradiance\"", "\"radiance\""), kName);
  EXPECT_NEAR(sun.rig.directionals.at(0).irradiance.x(),
              4 * kPi<double> * std::pow(std::sin(0.25), 2), 1e-5);
  const LightFile bulb =
      parse_lights(example("\"radiance\": [3, 3, 3]", "\"power\": [3, 3, 3]"), kName);
  EXPECT_NEAR(bulb.rig.spheres.at(0).radiance.x(), 3 / (kPi<double> * kPi<double>), 1e-6);
}

/// A light that reads is one that shades.
TEST(LightFile, LightsOutOfRangeAreRefused) {
  const auto with_scale = [](const char* value, const std::string& lights) {
    return parse_error(R"({"format": "burnish lights", "format_version": 2, "scale": )" +
                       std::string(value) + ",\n" + lights + "}");
  };
  const auto sphere = [](const std::string& radiance) {
    return R"("spheres": [{"center": [0, 0, 0], "radius": 1, "radiance": [)" + radiance + "]}]";
  };
  EXPECT_EQ(with_scale("1e30", sphere("1, 0, 0.5")), "");
  EXPECT_EQ(with_scale("1e-20", sphere("1e35, 0, 0")), "");
  EXPECT_EQ(with_scale("1e30", sphere("1e20, 0, 0")),
            kName +
                ": line 1, /scale: 1e+30, with which of /spheres/0 the radiance is inf, expected "
                "a finite number >= 0");
  EXPECT_EQ(with_scale("1", sphere("1e35, 0, 0")),
            kName + ": line 2, /spheres/0: radiance is 1e+35, expected at most 1e+30");
  // A disc of radius 0 shades as one of 1e-4.
  EXPECT_EQ(with_scale("1", R"("directionals": [{"toward": [0, 0, 1], "angular_radius_rad": 0,
  "irradiance": [0, 1e32, 0]}])"),
            kName +
                ": line 2, /directionals/0: radiance of the irradiance is inf, expected at most "
                "1e+30");
  EXPECT_EQ(with_scale("1", R"("directionals": [{"toward": [0, 0, 1], "angular_radius_rad": 0,
  "irradiance": [0, 1e22, 0]}])"),
            "");
}

/// Frames, axes and rotations that are off by just what is kept as written make sound lights.
TEST(LightFile, RoundingThatIsKeptAsWrittenIsSound) {
  constexpr unsigned kSeed = 23;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto number = [](double value) { return std::to_string(1e9 * value) + "e-9"; };
  const auto triple = [&](double x, double y, double z) {
    return "[" + number(x) + ", " + number(y) + ", " + number(z) + "]";
  };
  for (int i = 0; i < 300; ++i) {
    const auto off = [&](double value, double error) {
      return value + (uniform(random) < 0 ? -error : error);
    };
    // The rotation is judged by its square.
    const auto turned = [&] { return off(1, 1.9e-6); };
    const auto near = [&](double value) { return off(value, 3.9e-6); };
    LightFile file = parse_lights(
        R"({"format": "burnish lights", "format_version": 2, "world_from_environment": [)" +
            triple(turned(), 0, 0) + "," + triple(0, turned(), 0) + "," + triple(0, 0, turned()) +
            R"(], "lobes": [{"bandwidth_x": 2, "bandwidth_y": 1, "color": [1, 1, 1], "axis": )" +
            triple(near(0), 0, near(1)) + R"(, "tangent": )" + triple(near(1), 0, 0) +
            R"(}], "directionals": [{"angular_radius_rad": 0.1, "irradiance": [1, 1, 1],
             "toward": )" +
            triple(0, 0, near(1)) + "}]}",
        kName);
    // As shading may turn them further.
    const Eigen::Matrix3f turn =
        Eigen::AngleAxisf(float(i), random_vector(random).normalized()).toRotationMatrix();
    file.world_from_environment = turn * file.world_from_environment;
    const LightRig rig = world_lights(file);
    EXPECT_EQ(domain_error(rig.lobes.at(0)), "");
    EXPECT_EQ(domain_error(rig.directionals.at(0)), "");
  }
}

TEST(LightFile, WorldLightsAreTurnedAndScaled) {
  LightFile file = random_lights(3, 2, 2);
  file.scale = 4;
  const LightRig rig = world_lights(file);
  EXPECT_TRUE((rig.lobes[1].color == 4 * file.rig.lobes[1].color).all());
  EXPECT_TRUE((rig.spheres[1].radiance == 4 * file.rig.spheres[1].radiance).all());
  EXPECT_EQ(rig.spheres[1].center, file.rig.spheres[1].center);
  EXPECT_TRUE(rig.directionals[1].toward.isApprox(
      file.world_from_environment * file.rig.directionals[1].toward, 1e-6f));  // float
  EXPECT_TRUE(rig.lobes[1].lobe.frame.z.isApprox(
      file.world_from_environment * file.rig.lobes[1].lobe.frame.z, 1e-6f));
}

/// tests/data/lights/version1.json was written by burnish when version 1 was the newest, from the
/// values that are expected here.
TEST(LightFile, VersionOneStaysReadable) {
  const std::string path = std::string(BURNISH_TEST_DATA) + "/lights/version1.json";
  const LightFile file = read_lights(path);
  EXPECT_EQ(file.name, "studio");
  EXPECT_EQ(file.source, "studio.hdr");
  EXPECT_EQ(file.fit_relative_l2, 0.0834567890123);
  EXPECT_FALSE(file.fit_irradiance_relative_l2.has_value());
  EXPECT_EQ(file.scale, 1);
  EXPECT_EQ(file.world_from_environment.row(0), Eigen::RowVector3f(0, 0, 1));
  ASSERT_EQ(file.rig.lobes.size(), 2u);
  const EnvironmentLobe& lobe = file.rig.lobes[1];
  EXPECT_EQ(lobe.lobe.frame.z, Vector3f(0.6f, 0, 0.8f));
  EXPECT_EQ(lobe.lobe.frame.x, Vector3f(0, 1, 0));
  EXPECT_EQ(lobe.lobe.bandwidth_x, 12.5f);
  EXPECT_EQ(lobe.lobe.bandwidth_y, 0.75f);
  EXPECT_TRUE((lobe.color == Rgb(0.001f, 2, 3e6f)).all());
  ASSERT_EQ(file.rig.spheres.size(), 1u);
  EXPECT_EQ(file.rig.spheres[0].center, Vector3f(-1, 2.5f, 0.125f));
  EXPECT_EQ(file.rig.spheres[0].radius, 0.0625f);
  EXPECT_TRUE((file.rig.spheres[0].radiance == Rgb(10, 20, 30)).all());
  EXPECT_TRUE(file.rig.directionals.empty() && file.rig.rectangles.empty());
  // What is new in version 2 is unknown to version 1.
  EXPECT_NE(parse_error(R"({"format": "burnish lights", "format_version": 1,
  "scale": 2})")
                .find("line 2, /scale: unknown field"),
            std::string::npos);
  EXPECT_NE(parse_error(R"({"format": "burnish lights", "format_version": 1, "spheres":
  [{"center": [0, 0, 0], "radius": 1, "power": [1, 1, 1]}]})")
                .find("power: unknown field"),
            std::string::npos);
  EXPECT_NE(parse_error(R"({"format": "burnish lights", "format_version": 1, "lobes":
  [{"axis": [0, 0, 1], "tangent": [1, 0, 0], "bandwidth_x": 1, "bandwidth_y": 1,
    "color": [1, -1, 1]}]})")
                .find("line 3, /lobes/0/color/1: -1, expected 0"),
            std::string::npos);
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
  const LightFile skewed = parse_lights(example("[0, 0.5, 0]", "[0.0002, 0.5, 0]"), kName);
  const RectangleLight& panel = skewed.rig.rectangles.at(0);
  EXPECT_EQ(domain_error(panel), "");
  EXPECT_NEAR(panel.edge_y.y(), 0.5, 1e-6);
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
  EXPECT_NE(write_error([](LightFile& l) {
              l.rig.spheres[0].radiance[0] = -1;
            }).find("/spheres/0/radiance/0: -1"),
            std::string::npos);
  EXPECT_NE(write_error([](LightFile& l) { l.rig.lobes[1].color[0] = -INFINITY; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.rig.spheres[0].radius = NAN; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.rig.lobes[0].lobe.bandwidth_x = INFINITY; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.world_from_environment *= 2; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.fit_relative_l2 = -0.1; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.scale = NAN; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.rig.directionals[0].toward *= 3; }), "");
  EXPECT_NE(write_error([](LightFile& l) { l.rig.rectangles[0].edge_y.setZero(); }), "");
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
