#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "burnish/shading/shade_varying.h"
#include "material/sample_materials.h"
#include "shading/random_transfer.h"
#include "shading/small_transfer.h"

namespace burnish::test {
namespace {

/// Vertices in the open, with frames of all kinds.
Transfer open_vertices(size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  const auto vector = [&] {
    const float x = normal(random), y = normal(random), z = normal(random);
    return Vector3f(x, y, z);
  };
  Transfer transfer;
  for (size_t i = 0; i < count; ++i) {
    const Frame<float> frame = frame_from_normal_tangent<float>(vector().normalized(), vector());
    transfer.positions.push_back(vector());
    transfer.normals.push_back(frame.z);
    transfer.tangents.push_back(frame.x);
  }
  return transfer;
}

PreparedLights two_lights() {
  LightRig rig;
  EnvironmentLobe lobe;
  lobe.lobe.bandwidth_x = 2;
  lobe.lobe.bandwidth_y = 5;
  lobe.color = {1, 2, 3};
  rig.lobes.push_back(lobe);
  rig.directionals.push_back({Vector3f(0.6f, 0, 0.8f), 0.3f, {3, 2, 1}});
  return prepare_lights(rig, kOpen, {});
}

Material glossy() {
  Material material;
  material.model = SpecularModel::ward_balanced;
  material.diffuse = {0.2f, 0.3f, 0.4f};
  material.specular = {0.5f, 0.4f, 0.3f};
  material.alpha_x = 0.3f;
  material.alpha_y = 0.1f;
  return material;
}

constexpr size_t kVertices = 40;
const Vector3f kEye(3, -4, 5);

std::vector<Rgb> shade_uniform(const Transfer& transfer, const PreparedLights& lights,
                               const Material& material) {
  const ShadingOptions options;
  const std::vector<PreparedMaterial> prepared = prepare_materials({&material, 1}, options);
  std::vector<Rgb> radiance(kVertices);
  shade_vertices(prepare_transfer(transfer), {&lights}, prepared, {}, kEye, options, 0, radiance);
  return radiance;
}

std::vector<Rgb> shade_varied(const Transfer& transfer, const PreparedLights& lights,
                              const Material& base, const MaterialVariation& variation) {
  const PreparedTransfer prepared = prepare_transfer(transfer);
  std::vector<Rgb> radiance(kVertices);
  // In two ranges, as threads would.
  const auto part = [&](size_t first, size_t count) {
    shade_vertices(prepared, {&lights}, base, variation, kEye, {}, first,
                   std::span(radiance).subspan(first, count));
  };
  part(0, 11);
  part(11, kVertices - 11);
  return radiance;
}

TEST(VaryingShading, WithoutVariationIsAsOneMaterial) {
  const Transfer transfer = open_vertices(kVertices, 1);
  const PreparedLights lights = two_lights();
  const std::vector<Rgb> plain = shade_uniform(transfer, lights, glossy());
  const std::vector<Rgb> varied = shade_varied(transfer, lights, glossy(), {});
  float most = 0;
  for (size_t v = 0; v < kVertices; ++v) {
    // Frames and views are rounded once in vectors and once one by one.
    EXPECT_LT((varied[v] - plain[v]).abs().maxCoeff(), 1e-5f * (0.1f + plain[v].maxCoeff())) << v;
    most = std::max(most, plain[v].maxCoeff());
  }
  EXPECT_GT(most, 0.1f);  // something is lit
}

/// Each vertex as if all had its material and its frame; and again after everything has changed.
TEST(VaryingShading, EachVertexHasItsOwnMaterial) {
  const Transfer transfer = open_vertices(kVertices, 2);
  const PreparedLights lights = two_lights();
  MaterialArrays arrays;
  for (const unsigned frame : {1u, 2u}) {
    std::mt19937 random(frame);
    std::uniform_real_distribution<float> uniform(0.05f, 0.6f);
    arrays = {};
    for (size_t v = 0; v < kVertices; ++v) {
      const float a = uniform(random), b = uniform(random), c = uniform(random);
      arrays.diffuse.emplace_back(a, b, c);
      arrays.specular.emplace_back(b, c, a);
      arrays.alpha_x.push_back(b);
      arrays.alpha_y.push_back(c);
      arrays.tangent_rotation_rad.push_back(5 * a);
      arrays.normal.push_back(Vector3f(a - 0.3f, b - 0.3f, 1).normalized());
    }
    const std::vector<Rgb> varied = shade_varied(transfer, lights, glossy(), variation_of(arrays));
    for (size_t v = 0; v < kVertices; ++v) {
      Material own = glossy();
      own.diffuse = arrays.diffuse[v];
      own.specular = arrays.specular[v];
      own.alpha_x = arrays.alpha_x[v];
      own.alpha_y = arrays.alpha_y[v];
      Transfer turned = transfer;
      const Frame<float> old = frame_from_normal_tangent(transfer.normals[v], transfer.tangents[v]);
      const float angle = arrays.tangent_rotation_rad[v];
      const Vector3f tangent = std::cos(angle) * old.x + std::sin(angle) * old.y;
      turned.normals[v] = old.to_world(arrays.normal[v]).normalized();
      turned.tangents[v] =
          (tangent - tangent.dot(turned.normals[v]) * turned.normals[v]).normalized();
      const Rgb expected = shade_uniform(turned, lights, own)[v];
      // Rounding of frames.
      EXPECT_LT((varied[v] - expected).abs().maxCoeff(), 1e-3f * (expected.maxCoeff() + 1e-3f))
          << v << ": " << varied[v].transpose() << " / " << expected.transpose();
    }
  }
}

/// Of all models at once, with different numbers of lobes, past occluders and under local lights.
TEST(VaryingShading, APointDoesNotKnowItsNeighboursMaterials) {
  constexpr unsigned kSeed = 77;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::vector<Material> materials = {{.diffuse = Rgb(0.2f, 0.5f, 0.8f)}, {}};
  for (const NamedMaterial& named : all_materials()) materials.push_back(named.material);
  const PreparedTransfer transfer = prepare_transfer(random_transfer(
      {.vertices = materials.size(), .terms = 9, .bases = 3, .ladder_terms = 5, .ladders = 3},
      random));
  const LightRig rig = random_rig(random);
  std::vector<ShadingPoint> points;
  std::vector<Vector3f> outgoing;
  for (size_t i = 0; i < materials.size(); ++i) {
    points.push_back(vertex_shading_point(transfer, i));
    outgoing.push_back(points[i].frame.to_world(Vector3f(0.3f, -0.4f, 0.866f).normalized()));
  }
  for (const Quality quality : {Quality::fast, Quality::balanced, Quality::accurate}) {
    const ShadingOptions options = shading_options(quality);
    const PreparedLights lights = prepare_lights(rig, transfer, options);
    std::vector<Rgb> together(points.size());
    shade_points(transfer, points, outgoing, materials, {&lights}, options, together);
    for (size_t i = 0; i < points.size(); ++i) {
      const Rgb alone =
          shade_point(transfer, points[i], outgoing[i],
                      prepare_material(materials[i], options.specular), {&lights}, options);
      // Two compilations of one code fuse products and sums differently: some roundings.
      EXPECT_LT((together[i] - alone).abs().maxCoeff(), 1e-6f * (alone.maxCoeff() + 0.1f))
          << i << ": " << together[i].transpose() << " / " << alone.transpose();
    }
  }
}

}  // namespace
}  // namespace burnish::test
