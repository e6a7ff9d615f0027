#include "harness/vertex_truth.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "harness/error_metrics.h"
#include "harness/shapes.h"
#include "harness/studio_environment.h"

namespace burnish {
namespace {

/// All a truth depends on: a ball over a floor of 9 x 9 vertices, in the studio.
struct Inputs {
  Transfer transfer;
  std::vector<Material> materials = {{.diffuse = Rgb(0.5f, 0.4f, 0.3f), .specular = Rgb::Zero()},
                                     {.diffuse = Rgb(0.1f, 0.1f, 0.1f),
                                      .specular = Rgb(0.5f, 0.5f, 0.5f),
                                      .model = SpecularModel::ward,
                                      .alpha_x = 0.3f,
                                      .alpha_y = 0.1f}};
  std::vector<std::uint8_t> ids;
  std::shared_ptr<VaryingSubject> varying;
  Image map = studio_environment(64);
  Eigen::Matrix3f world_from_environment = Eigen::Matrix3f::Identity();
  std::vector<SphereLight> spheres = {{Vector3f(1, 2, 0), 0.2f, Rgb(8, 8, 8)}};
  std::vector<DirectionalLight> directionals = {{Vector3f(0, 1, 0), 0.1f, Rgb(1, 1, 1)}};
  std::vector<RectangleLight> rectangles = {
      {Vector3f(-2, 1, 0), Vector3f(0, 0, 1), Vector3f(0, 1, 0), Rgb(2, 2, 2), false}};
  std::vector<TruthPoint> points;
  View view = {{Vector3f(1, 2, 3), Vector3f(0, 0.3f, 0), Vector3f::UnitY(), 40}, 12, 8, 2};
  TruthGoal goal = {.noise = 0.03, .first_samples = 32, .most_samples = 1024, .seed = 7};

  Inputs() {
    TriangleMesh mesh;
    append_floor(mesh, 1.5, 8, 1);
    ids.assign(mesh.positions.size(), 0);
    append_sphere(mesh, Vector3f(0, 0.6f, 0), 0.4, 12, 6);
    ids.resize(mesh.positions.size(), 1);
    transfer.positions = mesh.positions;
    transfer.normals = mesh.normals;
    transfer.tangents = mesh.tangents;
    transfer.triangles = mesh.triangles;
    transfer.texcoords.assign(mesh.positions.size(), Vector2<float>(0.25f, 0.75f));
    transfer.occluder_positions = {Vector3f(5, 5, 5), Vector3f(6, 5, 5), Vector3f(5, 6, 5)};
    transfer.occluder_triangles = {{0, 1, 2}};
    points = points_seen_from(subject(), view.camera.origin);
  }

  Subject subject() const { return {&transfer, materials, ids, varying.get(), nullptr}; }
  ReferenceLights lights() const {
    return {{&map, world_from_environment}, spheres, directionals, rectangles};
  }
  std::string vertex_key() const { return vertex_truth_key(subject(), points, lights(), goal); }
  std::string picture_key() const { return picture_truth_key(subject(), view, lights(), goal); }
  VertexTruth vertices(const TruthCache& cache, const Progress& progress = {}) const {
    return vertex_truth(subject(), SceneRays(transfer), points, lights(), goal, cache, progress);
  }
  PictureTruth picture(const TruthCache& cache, const Progress& progress = {}) const {
    const SceneRays rays(transfer);
    return picture_truth(subject(), rays, trace_primary_rays(rays, view), lights(), goal, cache,
                         progress);
  }
};

/// A material with lobes and tables of its own.
std::shared_ptr<FittedSpecular> small_fit() {
  auto fit = std::make_shared<FittedSpecular>();
  fit->lobes = {{.frame = {}, .bandwidth_x = 4, .bandwidth_y = 9, .amplitude = 1}};
  fit->color_by_difference = {Rgb::Ones(), Rgb::Ones()};
  fit->masking = {1, 1};
  return fit;
}

VaryingSubject small_variation() {
  VaryingSubject varying;
  varying.maps.diffuse = make_texture(Image(2, 2, Rgb::Constant(0.5f)), TextureWrap::repeat);
  return varying;
}

/// A folder that goes with the test, and the warnings.
struct Folder {
  std::string path;
  std::vector<std::string> warnings;
  TruthCache cache;

  Folder() {
    path = testing::TempDir() + "truth-" +
           testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(path);
    cache = {path + "/a/b", [this](const std::string& text) { warnings.push_back(text); }};
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path); }
};

bool same_bits(const std::vector<Rgb>& a, const std::vector<Rgb>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Rgb)) == 0;
}

std::string read_bytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(TruthKey, ChangesWithEveryInputOfBothKinds) {
  const std::vector<std::function<void(Inputs&)>> changes = {
      [](Inputs& i) { i.transfer.positions[3].z() += 1e-3f; },
      [](Inputs& i) { i.transfer.normals[3] = Vector3f(0, 0, 1); },
      [](Inputs& i) { i.transfer.tangents[3] = Vector3f(0, 0, 1); },
      [](Inputs& i) { std::swap(i.transfer.triangles[0][0], i.transfer.triangles[0][1]); },
      [](Inputs& i) { i.transfer.triangles.pop_back(); },
      [](Inputs& i) { i.transfer.occluder_positions[0].x() = 4; },
      [](Inputs& i) {
        i.transfer.occluder_triangles.push_back({0, 2, 1});
      },
      [](Inputs& i) { i.ids[5] = 1; },
      [](Inputs& i) { i.materials.push_back(i.materials[0]); },
      [](Inputs& i) { i.materials[1].diffuse.z() = 0.2f; },
      [](Inputs& i) { i.materials[1].specular.x() = 0.6f; },
      [](Inputs& i) { i.materials[1].model = SpecularModel::ward_balanced; },
      [](Inputs& i) { i.materials[1].alpha_x = 0.4f; },
      [](Inputs& i) { i.materials[1].alpha_y = 0.4f; },
      [](Inputs& i) { i.materials[1].fresnel.model = FresnelModel::conductor; },
      [](Inputs& i) { i.materials[1].fresnel.normal_reflectance.y() = 0.5f; },
      [](Inputs& i) { i.materials[1].fresnel.eta.y() = 2; },
      [](Inputs& i) { i.materials[1].fresnel.k.y() = 2; },
      [](Inputs& i) { i.materials[1].distribution = Distribution::beckmann; },
      [](Inputs& i) { i.materials[1].shadowing = Shadowing::v_cavity; },
      [](Inputs& i) { i.materials[1].fitted = small_fit(); },
      [](Inputs& i) {
        auto fit = small_fit();
        fit->lobes[0].bandwidth_y = 8;
        i.materials[1].fitted = fit;
      },
      [](Inputs& i) {
        auto fit = small_fit();
        fit->lobes[0].frame.x = -fit->lobes[0].frame.x;
        i.materials[1].fitted = fit;
      },
      [](Inputs& i) {
        auto fit = small_fit();
        fit->color_by_difference[1].y() = 2;
        i.materials[1].fitted = fit;
      },
      [](Inputs& i) {
        auto fit = small_fit();
        fit->masking[1] = 2;
        i.materials[1].fitted = fit;
      },
      [](Inputs& i) { i.varying = std::make_shared<VaryingSubject>(small_variation()); },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        i.varying->maps.diffuse->levels[1].pixels[0].x() = 0;
      },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        std::swap(i.varying->maps.diffuse, i.varying->maps.specular);
      },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        i.varying->maps.diffuse->wrap = TextureWrap::clamp;
      },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        i.varying->vertices.tangent_rotation_rad = {1};
      },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        i.varying->vertices.alpha_x = {1};
      },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        i.varying->vertices.normal = {Vector3f::UnitZ()};
      },
      [](Inputs& i) {
        i.varying = std::make_shared<VaryingSubject>(small_variation());
        i.transfer.texcoords[1].x() = 0.5f;
      },
      [](Inputs& i) { i.map.pixels[77].y() *= 2; },
      [](Inputs& i) { std::swap(i.map.width, i.map.height); },
      [](Inputs& i) { i.world_from_environment = world_from_environment(Vector3f::UnitY(), 30); },
      [](Inputs& i) { i.spheres[0].center.x() = 0; },
      [](Inputs& i) { i.spheres[0].radius = 0.3f; },
      [](Inputs& i) { i.spheres[0].radiance.z() = 1; },
      [](Inputs& i) { i.spheres.clear(); },
      [](Inputs& i) { i.directionals[0].toward = Vector3f::UnitX(); },
      [](Inputs& i) { i.directionals[0].angular_radius_rad = 0.2f; },
      [](Inputs& i) { i.directionals[0].irradiance.x() = 2; },
      [](Inputs& i) { i.rectangles[0].center.x() = -3; },
      [](Inputs& i) { i.rectangles[0].edge_x.z() = 2; },
      [](Inputs& i) { i.rectangles[0].edge_y.y() = 2; },
      [](Inputs& i) { i.rectangles[0].radiance.x() = 3; },
      [](Inputs& i) { i.rectangles[0].two_sided = true; },
      [](Inputs& i) { i.goal.noise = 0.02; },
      [](Inputs& i) { i.goal.first_samples = 64; },
      [](Inputs& i) { i.goal.most_samples = 512; },
      [](Inputs& i) { i.goal.seed = 8; },
  };
  std::set<std::string> vertex_keys = {Inputs().vertex_key()};
  std::set<std::string> picture_keys = {Inputs().picture_key()};
  EXPECT_TRUE(vertex_keys.contains(Inputs().vertex_key())) << "equal inputs, equal keys";
  EXPECT_TRUE(picture_keys.contains(Inputs().picture_key()));
  for (size_t c = 0; c < changes.size(); ++c) {
    Inputs inputs;
    changes[c](inputs);
    EXPECT_TRUE(vertex_keys.insert(inputs.vertex_key()).second) << "change " << c;
    EXPECT_TRUE(picture_keys.insert(inputs.picture_key()).second) << "change " << c;
  }
}

TEST(TruthKey, ChangesWithThePointsOrTheView) {
  std::set<std::string> keys = {Inputs().vertex_key()};
  const std::vector<std::function<void(Inputs&)>> points = {
      [](Inputs& i) { i.points[0].vertex = 4; },
      [](Inputs& i) { i.points[0].outgoing = Vector3f::UnitX(); },
      [](Inputs& i) { i.points.pop_back(); },
      [](Inputs& i) { std::swap(i.points[0], i.points[1]); }};
  for (const auto& change : points) {
    Inputs inputs;
    change(inputs);
    EXPECT_TRUE(keys.insert(inputs.vertex_key()).second);
  }
  keys = {Inputs().picture_key()};
  const std::vector<std::function<void(Inputs&)>> views = {
      [](Inputs& i) { i.view.camera.origin.x() = 2; },
      [](Inputs& i) { i.view.camera.target.x() = 2; },
      [](Inputs& i) { i.view.camera.up = Vector3f::UnitX(); },
      [](Inputs& i) { i.view.camera.vertical_fov_deg = 41; },
      [](Inputs& i) { i.view.width = 13; },
      [](Inputs& i) { i.view.height = 13; },
      [](Inputs& i) { i.view.samples_per_axis = 1; }};
  for (const auto& change : views) {
    Inputs inputs;
    change(inputs);
    EXPECT_TRUE(keys.insert(inputs.picture_key()).second);
  }
}

TEST(TruthCache, GivesBackVerticesBitForBitWithoutTracingThemAgain) {
  Folder folder;
  const Inputs inputs;
  const VertexTruth first = inputs.vertices(folder.cache);
  int reports = 0;
  const VertexTruth second = inputs.vertices(folder.cache, [&](auto...) { return ++reports > 0; });
  EXPECT_EQ(reports, 0);
  EXPECT_TRUE(same_bits(first.radiance, second.radiance));
  EXPECT_TRUE(same_bits(first.variance, second.variance));
  EXPECT_EQ(first.quality.samples, second.quality.samples);
  EXPECT_EQ(first.quality.noise, second.quality.noise);
  EXPECT_EQ(first.quality.reached, second.quality.reached);
  EXPECT_TRUE(folder.warnings.empty());
  const VertexTruth again = inputs.vertices({.folder = ""});
  EXPECT_TRUE(same_bits(first.radiance, again.radiance)) << "and so it is without a cache";
}

TEST(TruthCache, GivesBackPicturesBitForBitWithoutTracingThemAgain) {
  Folder folder;
  const Inputs inputs;
  const PictureTruth first = inputs.picture(folder.cache);
  int reports = 0;
  const PictureTruth second = inputs.picture(folder.cache, [&](auto...) { return ++reports > 0; });
  EXPECT_EQ(reports, 0);
  EXPECT_TRUE(same_bits(first.picture.radiance.pixels, second.picture.radiance.pixels));
  EXPECT_TRUE(same_bits(first.picture.variance.pixels, second.picture.variance.pixels));
  EXPECT_EQ(first.picture.hit, second.picture.hit);
  EXPECT_EQ(second.picture.radiance.width, 12);
  EXPECT_EQ(second.picture.radiance.height, 8);
  EXPECT_EQ(first.quality.noise, second.quality.noise);
  EXPECT_EQ(first.quality.samples, second.quality.samples);
  EXPECT_TRUE(folder.warnings.empty());
}

TEST(TruthCache, ADamagedOrForeignFileIsComputedAgainWithAWarning) {
  Folder folder;
  const Inputs inputs;
  const VertexTruth truth = inputs.vertices(folder.cache);
  const std::string path = truth_path(folder.cache, inputs.vertex_key());
  const std::string whole = read_bytes(path);
  ASSERT_FALSE(whole.empty());
  std::vector<std::string> damaged = {"", whole + '\0', whole.substr(0, whole.size() - 1)};
  for (const size_t at : {size_t{3}, size_t{18}, size_t{25}, size_t{40}, whole.size() / 3,
                          whole.size() - 20, whole.size() - 1}) {
    damaged.push_back(whole);
    damaged.back()[at] = static_cast<char>(damaged.back()[at] ^ 1);
  }
  // A sound file of other inputs and as many points.
  Inputs other;
  other.goal.seed = 8;
  other.vertices(folder.cache);
  damaged.push_back(read_bytes(truth_path(folder.cache, other.vertex_key())));
  ASSERT_EQ(damaged.back().size(), whole.size());

  for (size_t d = 0; d < damaged.size(); ++d) {
    folder.warnings.clear();
    write_bytes(path, damaged[d]);
    const VertexTruth again = inputs.vertices(folder.cache);
    EXPECT_TRUE(same_bits(truth.radiance, again.radiance)) << "damage " << d;
    ASSERT_EQ(folder.warnings.size(), 1u) << "damage " << d;
    EXPECT_NE(folder.warnings[0].find(path), std::string::npos) << folder.warnings[0];
    EXPECT_EQ(read_bytes(path), whole) << "damage " << d << " is repaired";
  }
}

TEST(TruthCache, AFolderThatCannotBeWrittenIsAWarning) {
  Folder folder;
  std::filesystem::create_directories(folder.path);
  write_bytes(folder.path + "/a", "a file where a folder should be");
  const Inputs inputs;
  EXPECT_EQ(inputs.vertices(folder.cache).radiance.size(), inputs.points.size());
  EXPECT_EQ(folder.warnings.size(), 1u);
}

TEST(TruthCache, IsWhereTheEnvironmentSays) {
  const auto keep = [](const char* name) {
    const char* value = std::getenv(name);
    return std::make_pair(name, value ? std::optional<std::string>(value) : std::nullopt);
  };
  const std::vector before = {keep("BURNISH_CACHE"), keep("XDG_CACHE_HOME"), keep("HOME")};
  setenv("BURNISH_CACHE", "mine", 1);
  setenv("XDG_CACHE_HOME", "/xdg", 1);
  setenv("HOME", "/home/me", 1);
  EXPECT_EQ(default_truth_folder(), "mine");
  unsetenv("BURNISH_CACHE");
  EXPECT_EQ(default_truth_folder(), "/xdg/burnish");
  setenv("XDG_CACHE_HOME", "relative", 1);
  EXPECT_EQ(default_truth_folder(), "/home/me/.cache/burnish");
  unsetenv("HOME");
  EXPECT_EQ(default_truth_folder(), "");
  for (const auto& [name, value] : before) value ? setenv(name, value->c_str(), 1) : unsetenv(name);
}

TEST(VertexTruth, DoublesItsSamplesUntilTheStatedNoiseIsReached) {
  Inputs inputs;
  inputs.goal = {.noise = 0.02, .first_samples = 16, .most_samples = 1 << 14, .seed = 3};
  const VertexTruth truth = inputs.vertices({.folder = ""});
  EXPECT_TRUE(truth.quality.reached);
  EXPECT_LE(truth.quality.noise, 0.02);
  EXPECT_DOUBLE_EQ(truth.quality.noise,
                   relative_l2(truth.radiance, truth.radiance, truth.variance).truth_noise);
  ASSERT_GT(truth.quality.samples, 32);
  EXPECT_EQ(truth.quality.samples & (truth.quality.samples - 1), 0);

  Inputs half = inputs;
  half.goal.most_samples = truth.quality.samples / 2;
  const VertexTruth less = half.vertices({.folder = ""});
  EXPECT_EQ(less.quality.samples, truth.quality.samples / 2);
  EXPECT_FALSE(less.quality.reached);
  EXPECT_GT(less.quality.noise, 0.02);
}

TEST(VertexTruth, ItsNoiseIsItsDistanceFromABetterTruth) {
  Inputs inputs;
  inputs.goal = {.noise = 0.02, .first_samples = 16, .most_samples = 1 << 14, .seed = 3};
  Inputs better = inputs;
  better.goal.noise = 0.006;
  better.goal.seed = 4;
  const VertexTruth truth = inputs.vertices({.folder = ""});
  const VertexTruth best = better.vertices({.folder = ""});
  ASSERT_TRUE(best.quality.reached) << best.quality.noise;
  const double distance = relative_l2(truth.radiance, best.radiance).value;
  // Some 170 points with noise of very different sizes: the sum of squares is known to some 20 %,
  // its root to 10 %.
  EXPECT_NEAR(distance / truth.quality.noise, 1, 0.3);
  EXPECT_FALSE(above_noise(relative_l2(best.radiance, truth.radiance, truth.variance)));
  std::vector<Rgb> off = best.radiance;
  for (Rgb& value : off) value *= 1.06f;
  EXPECT_TRUE(above_noise(relative_l2(off, truth.radiance, truth.variance)));
}

TEST(VertexTruth, OfADiffuseFloorUnderAnEvenSkyIsItsAlbedo) {
  Inputs inputs;
  inputs.map = Image(64, 32, Rgb::Constant(2));
  inputs.spheres.clear();
  inputs.directionals.clear();
  inputs.rectangles.clear();
  inputs.transfer.triangles.resize(8 * 8 * 2);  // without the ball
  inputs.points.resize(81);
  inputs.goal = {.noise = 0.002, .first_samples = 16, .most_samples = 1 << 14, .seed = 5};
  const VertexTruth truth = inputs.vertices({.folder = ""});
  const std::vector<Rgb> exact(81, Rgb(1.0f, 0.8f, 0.6f));
  // The noise is a root of a mean square over 81 points, known to 10 % by itself.
  EXPECT_LE(relative_l2(truth.radiance, exact).value, 1.3 * 0.002);
  EXPECT_TRUE(truth.quality.reached);
}

TEST(PictureTruth, ReachesTheStatedNoiseOverItsMesh) {
  Inputs inputs;
  inputs.goal = {.noise = 0.02, .first_samples = 32, .most_samples = 1 << 13, .seed = 3};
  const PictureTruth truth = inputs.picture({.folder = ""});
  EXPECT_TRUE(truth.quality.reached);
  EXPECT_LE(relative_l2(truth.picture, truth.picture).truth_noise, 0.02);
  inputs.goal.noise = 0.005;
  inputs.goal.seed = 4;
  const PictureTruth best = inputs.picture({.folder = ""});
  // Some 40 pixels; their sum of squares is known to a third.
  EXPECT_NEAR(relative_l2(best.picture, truth.picture).value / truth.quality.noise, 1, 0.4);
}

}  // namespace
}  // namespace burnish
