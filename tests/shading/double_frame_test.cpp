// The frame's own kernels on lanes of double, which tell what the roundings of float make of it.

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/shading/shade.h"
#include "shading/fill_block.h"
#include "shading/random_transfer.h"
#include "sphere/simd.h"

#define HWY_COMPILE_ONLY_STATIC
#include <hwy/highway.h>

#include "shading/frame-inl.h"
#include "shading/vertex_block-inl.h"

namespace burnish {
namespace {

namespace kernels = HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

constexpr unsigned kSeed = 75;

std::vector<Eigen::Array3d> shade_in_double(const PreparedTransfer& transfer,
                                            const Lighting& lighting,
                                            const PreparedMaterial& material, const Vector3f& eye,
                                            const ShadingOptions& options) {
  std::vector<Eigen::Array3d> radiance;
  ShadingBlock<double> block;
  BlockRgb<double> result;
  const hn::ScalableTag<double> d;
  while (radiance.size() < transfer.vertex_count()) {
    start_block(block);
    for (size_t v = radiance.size(); v < transfer.vertex_count() && has_room(transfer, block); ++v)
      add_vertex(transfer, v, block);
    kernels::pad_block(block);
    kernels::find_vertex_views(d, eye, block);
    kernels::shade_block(d, transfer, kernels::SharedMaterial{material}, lighting, options, block,
                         result);
    for (size_t i = 0; i < block.count; ++i)
      radiance.emplace_back(result[0][i], result[1][i], result[2][i]);
  }
  return radiance;
}

/// Two lobes, a wide and a narrow one, a lamp and a window.
LightRig small_rig() {
  LightRig rig;
  EnvironmentLobe sky;
  sky.lobe.frame = frame_from_axis<float>(Vector3f(0.1f, 0.2f, 1).normalized());
  sky.lobe.bandwidth_x = 1.5f;
  sky.lobe.bandwidth_y = 3;
  sky.color = Rgb(2, 3, 4);
  EnvironmentLobe lamp;
  lamp.lobe.frame = frame_from_axis<float>(Vector3f(1, 0.3f, 0.5f).normalized());
  lamp.lobe.bandwidth_x = 200;
  lamp.lobe.bandwidth_y = 40;
  lamp.color = Rgb(8, 7, 6);
  rig.lobes = {sky, lamp};
  rig.spheres.push_back({Vector3f(0, 3, 2), 0.5f, Rgb::Constant(5)});
  rig.rectangles.push_back(
      {Vector3f(-3, 0, 1), Vector3f(0, 1, 0), Vector3f(0, 0, 1), Rgb::Constant(3), true});
  return rig;
}

Material glossy(SpecularModel model) {
  Material material;
  material.diffuse = Rgb(0.4f, 0.3f, 0.2f);
  material.specular = Rgb::Constant(0.5f);
  material.model = model;
  material.alpha_x = 0.25f;
  material.alpha_y = 0.08f;
  return material;
}

/// The SSDFs are those of a real bake in kind: an horizon, and terms of a tenth of a radian.
Transfer smooth_transfer(std::mt19937& random) {
  Transfer transfer = test::random_transfer(
      {.vertices = 200, .terms = 20, .bases = 2, .ladder_terms = 12, .ladders = 1}, random);
  for (float& c : transfer.coefficients) c *= 0.1f;
  return transfer;
}

TEST(DoubleFrame, FloatRoundsTheFrameByLessThanATenThousandth) {
  std::mt19937 random(kSeed);
  SCOPED_TRACE(kSeed);
  const PreparedTransfer transfer = prepare_transfer(smooth_transfer(random), RowFormat::float32);
  const LightRig rig = small_rig();
  Image map(32, 16);
  for (Rgb& pixel : map.pixels) pixel = Rgb(1, 2, 3) * static_cast<float>(random() % 100) / 100;
  const PrefilteredEnvironment environment = prefilter_environment(map);
  const Vector3f eye(2, 1, 3);
  double worst = 0;
  for (const Quality quality : {Quality::fast, Quality::balanced, Quality::accurate})
    for (const SpecularModel model :
         {SpecularModel::none, SpecularModel::ward, SpecularModel::ashikhmin_shirley,
          SpecularModel::cook_torrance})
      for (const bool with_map : {false, true}) {
        const ShadingOptions options = shading_options(quality);
        const PreparedLights lights = prepare_lights(rig, transfer, options);
        const Lighting lighting = {&lights, with_map ? &environment : nullptr};
        const PreparedMaterial material = prepare_material(glossy(model), options.specular);
        std::vector<Rgb> single(transfer.vertex_count());
        shade_vertices(transfer, lighting, {&material, 1}, {}, eye, options, 0, single);
        const std::vector<Eigen::Array3d> twice =
            shade_in_double(transfer, lighting, material, eye, options);
        double mean = 0, most = 0;
        for (size_t v = 0; v < single.size(); ++v) {
          mean += twice[v].mean() / static_cast<double>(single.size());
          most = std::max(most, (single[v].cast<double>() - twice[v]).abs().maxCoeff());
        }
        ASSERT_GT(mean, 0.05);
        EXPECT_LT(most / mean, 1e-4) << "quality " << static_cast<int>(quality) << ", model "
                                     << static_cast<int>(model) << ", map " << with_map;
        worst = std::max(worst, most / mean);
      }
  std::printf("largest difference over the frame's mean: %.2e\n", worst);
}

}  // namespace
}  // namespace burnish
