#include "harness/rivals/sg_rival.h"

#include <chrono>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/precompute/fit_light.h"
#include "burnish/sphere/lobe_moments.h"
#include "harness/round_lobe_fit.h"

namespace burnish {
namespace {

/// An SG as the ASG of its curvature.
SpecularTooth tooth_of(const SphericalGaussian<float>& sg) {
  SpecularTooth tooth;
  tooth.lobe.frame = frame_from_axis(sg.axis);
  tooth.lobe.bandwidth_x = tooth.lobe.bandwidth_y = sg.sharpness / 2;
  tooth.lobe.amplitude = sg.amplitude;
  const auto moments = asg_second_moments(tooth.lobe.bandwidth_x, tooth.lobe.bandwidth_y);
  tooth.integral = sg.amplitude * moments.integral;
  tooth.mean_xx = moments.mean_xx;
  tooth.mean_yy = moments.mean_yy;
  return tooth;
}

}  // namespace

PreparedMaterial sg_material(const Material& material, int lobes) {
  PreparedMaterial prepared;
  prepared.material = material;
  prepared.form = SpecularForm::peak;
  if (!material.has_specular()) return prepared;
  for (const SphericalGaussian<float>& sg : fit_round_lobes(distribution_of(material), lobes).lobes)
    prepared.tooth[static_cast<size_t>(prepared.count++)] = tooth_of(sg);
  return prepared;
}

ShadingOptions sg_shading_options(const SgOptions& options) {
  ShadingOptions shading = paper_shading_options(VisibilityModel::hemisphere, 1);
  shading.cosine = options.cosine;
  return shading;
}

SgLights fit_sg_lights(const Image& map, int lobes, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  SgLights lights;
  lights.lobes = fit_light(map, {.lobes = lobes, .isotropic = true}, progress).rig.lobes;
  lights.fit_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return lights;
}

Rival sg_rival(const RivalScene& scene, const SgOptions& options, const SgLights& lights) {
  require_complete(scene);
  const auto start = std::chrono::steady_clock::now();
  std::vector<PreparedMaterial> materials(scene.subject.materials.size());
  tbb::parallel_for(size_t{0}, materials.size(), [&](size_t i) {
    materials[i] = sg_material(scene.subject.materials[i], options.lobes);
  });
  const std::chrono::duration<double> fitting = std::chrono::steady_clock::now() - start;
  LightRig rig = scene.rig;
  rig.lobes = lights.lobes;
  const std::string cosine = options.cosine == CosineModel::constant ? "" : ", horizon-normalised";
  Rival rival = runtime_rival(
      scene,
      fmt::format("SG, {} a BRDF lobe, {} lights{}", options.lobes, lights.lobes.size(), cosine),
      {sg_shading_options(options)}, std::move(rig), std::move(materials));
  rival.bake_s += lights.fit_s + fitting.count();
  return rival;
}

Rival sg_rival(const RivalScene& scene, const SgOptions& options, const Progress& progress) {
  require_complete(scene);
  return sg_rival(scene, options, fit_sg_lights(*scene.map, options.light_lobes, progress));
}

}  // namespace burnish
