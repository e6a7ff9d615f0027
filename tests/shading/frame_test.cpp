// What holds for the frame however it is cut up, and on any instructions.

#include <algorithm>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "burnish/shading/shade.h"
#include "burnish/sphere/batch.h"
#include "material/sample_materials.h"
#include "shading/random_transfer.h"
#include "shading/small_transfer.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 73;
constexpr size_t kVertices = 600;  // more than are grouped by material at a time

/// Vertices of several materials under lights of all kinds, with a map and without.
struct Scene {
  std::mt19937 random{kSeed};
  PreparedTransfer transfer = prepare_transfer(random_transfer({.vertices = kVertices,
                                                                .terms = 19,
                                                                .bases = 3,
                                                                .ladder_terms = 7,
                                                                .ladders = 3,
                                                                .amplitude_rad = 0.7f},
                                                               random));
  LightRig rig = random_rig(random);
  std::vector<Material> materials;
  std::vector<std::uint8_t> ids;
  PrefilteredEnvironment environment;
  Vector3f eye = {0.3f, 2, -1.5f};

  Scene() {
    materials.push_back({.diffuse = Rgb(0.2f, 0.5f, 0.8f)});
    for (const NamedMaterial& named : all_materials()) {
      materials.push_back(named.material);
      materials.back().diffuse = Rgb::Constant(0.3f);
    }
    for (size_t i = 0; i < kVertices; ++i)
      ids.push_back(static_cast<std::uint8_t>(random() % materials.size()));
    Image map(32, 16);
    for (Rgb& pixel : map.pixels) pixel = Rgb(1, 2, 3) * static_cast<float>(random() % 100) / 100;
    environment = prefilter_environment(map);
  }

  /// Everything is prepared anew, so that preparing takes part.
  std::vector<Rgb> shade(bool with_map, const ShadingOptions& options = {}) const {
    const PreparedLights lights = prepare_lights(rig, transfer, options);
    const std::vector<PreparedMaterial> prepared = prepare_materials(materials, options);
    std::vector<Rgb> radiance(kVertices);
    shade_vertices(transfer, {&lights, with_map ? &environment : nullptr}, prepared, ids, eye,
                   options, 0, radiance);
    return radiance;
  }
};

double mean_of(const std::vector<Rgb>& radiance) {
  double sum = 0;
  for (const Rgb& rgb : radiance) sum += double(rgb.sum()) / 3;
  return sum / double(radiance.size());
}

TEST(Frame, AllInstructionSetsAgree) {
  SCOPED_TRACE(kSeed);
  const Scene scene;
  ShadingOptions paper;
  paper.visibility = VisibilityModel::hemisphere;
  paper.cosine = CosineModel::constant;
  paper.specular = {SpecularForm::peak, 1, 1};
  for (const ShadingOptions& options : {ShadingOptions(), paper})
    for (const bool with_map : {false, true}) {
      std::vector<Rgb> first;
      for (const std::string_view name : batch::instruction_sets()) {
        ASSERT_TRUE(batch::use_instruction_set(name));
        const std::vector<Rgb> radiance = scene.shade(with_map, options);
        if (first.empty()) first = radiance;
        const float mean = static_cast<float>(mean_of(first));
        float most = 0;
        for (size_t i = 0; i < kVertices; ++i)
          most = std::max(most, ((radiance[i] - first[i]) / (first[i] + mean)).abs().maxCoeff());
        // An axis is good to 2e-7, and so the exponent of a lobe of bandwidth 300 at two deviations
        // to 1e-5: AVX-512's estimates of reciprocals have 14 bits, all others' the same 12. Random
        // coefficients, whose slopes are ten times those of real ones, double it.
        EXPECT_LT(most, 2.5e-5) << name << ", map " << with_map;
      }
      EXPECT_GT(mean_of(first), 0.05);
    }
  batch::use_instruction_set("");
}

TEST(Frame, AnyRangesGiveTheSameBits) {
  SCOPED_TRACE(kSeed);
  Scene scene;
  const PreparedLights lights = prepare_lights(scene.rig, scene.transfer, {});
  const std::vector<PreparedMaterial> materials = prepare_materials(scene.materials, {});
  for (const PrefilteredEnvironment* map : {&scene.environment, (PrefilteredEnvironment*)nullptr}) {
    const std::vector<Rgb> whole = scene.shade(map != nullptr);
    for (const size_t longest : {1, 3, 40, 500}) {
      std::vector<Rgb> parts(kVertices);
      for (size_t first = 0; first < kVertices;) {
        const size_t count =
            std::min(kVertices - first, 1 + scene.random() % static_cast<unsigned>(longest));
        shade_vertices(scene.transfer, {&lights, map}, materials, scene.ids, scene.eye, {}, first,
                       std::span(parts).subspan(first, count));
        first += count;
      }
      for (size_t i = 0; i < kVertices; ++i)
        ASSERT_TRUE((whole[i] == parts[i]).all())
            << "vertex " << i << " of material " << int(scene.ids[i]) << ", ranges to " << longest
            << ": " << whole[i].transpose() << " / " << parts[i].transpose();
    }
  }
}

TEST(Frame, AVertexDoesNotKnowItsNeighboursMaterials) {
  SCOPED_TRACE(kSeed);
  Scene scene;
  const PreparedLights lights = prepare_lights(scene.rig, scene.transfer, {});
  const std::vector<PreparedMaterial> materials = prepare_materials(scene.materials, {});
  const std::vector<Rgb> mixed = scene.shade(true);
  for (size_t id = 0; id < materials.size(); ++id) {
    std::vector<Rgb> alone(kVertices);
    shade_vertices(scene.transfer, {&lights, &scene.environment}, {&materials[id], 1}, {},
                   scene.eye, {}, 0, alone);
    for (size_t i = 0; i < kVertices; ++i)
      if (scene.ids[i] == id) {
        ASSERT_TRUE((mixed[i] == alone[i]).all())
            << "vertex " << i << ", material " << id << ": " << mixed[i].transpose() << " / "
            << alone[i].transpose();
      }
  }
}

TEST(Frame, PointsAreShadedAsVerticesAre) {
  SCOPED_TRACE(kSeed);
  Scene scene;
  const PreparedLights lights = prepare_lights(scene.rig, scene.transfer, {});
  const Lighting lighting = {&lights, &scene.environment};
  const PreparedMaterial material = prepare_material(scene.materials[3], {});
  std::vector<Rgb> by_vertex(kVertices), by_point(kVertices);
  shade_vertices(scene.transfer, lighting, {&material, 1}, {}, scene.eye, {}, 0, by_vertex);
  std::vector<ShadingPoint> points;
  std::vector<Vector3f> outgoing;
  for (size_t i = 0; i < kVertices; ++i) {
    points.push_back(vertex_shading_point(scene.transfer, i));
    outgoing.push_back(
        lift_above_horizon((scene.eye - points[i].position).normalized(), points[i].frame.z));
  }
  shade_points(scene.transfer, points, outgoing, material, lighting, {}, by_point);
  for (size_t i = 0; i < kVertices; ++i) {
    // The rounding of the view.
    EXPECT_LT((by_vertex[i] - by_point[i]).abs().maxCoeff(),
              1e-4f * (by_vertex[i].maxCoeff() + 1e-2f))
        << i;
    if (i % 20 == 0) {
      EXPECT_TRUE((shade_point(scene.transfer, points[i], outgoing[i], material, lighting, {}) ==
                   by_point[i])
                      .all())
          << i;
    }
  }
}

}  // namespace
}  // namespace burnish::test
