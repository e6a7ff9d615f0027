#include "shade_subjects.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/fit_light.h"
#include "common/interrupt.h"
#include "harness/parallel_prefilter.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/studio_environment.h"

namespace burnish::tools {
namespace {

Vector3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const Vector3f v(normal(random), normal(random), normal(random));
  return v.normalized();
}

/// Mean squares of the coefficients by basis, [bases][row_size].
std::vector<float> deviations(const Transfer& baked) {
  const auto terms = static_cast<size_t>(baked.terms());
  const auto ladder_terms = static_cast<size_t>(baked.ladder_terms());
  const size_t size = terms + ladder_terms;
  std::vector<double> sums(baked.bases.size() * size, 0.0);
  std::vector<double> count(baked.bases.size(), 0.0);
  for (size_t v = 0; v < baked.vertex_count(); ++v) {
    const size_t basis = baked.basis_id[v];
    ++count[basis];
    for (size_t k = 0; k < size; ++k) {
      const double c = k < terms ? baked.coefficients[v * terms + k]
                                 : baked.ladder_coefficients[v * ladder_terms + k - terms];
      sums[basis * size + k] += c * c;
    }
  }
  std::vector<float> result(sums.size());
  for (size_t i = 0; i < sums.size(); ++i)
    result[i] = static_cast<float>(std::sqrt(sums[i] / std::max(count[i / size], 1.0)));
  return result;
}

}  // namespace

ShadeScene load_shade_scene(const SubjectOptions& options, const std::string& transfer_file,
                            Work& work) {
  ShadeScene scene;
  if (transfer_file.empty()) {
    const ProceduralScene source = load_subject(options.name);
    scene.name = source.name;
    scene.camera = source.camera;
    scene.transfer = bake(source.mesh, {}, options.bake, {.progress = work.progress()});
  } else {
    scene.transfer = read_transfer(transfer_file);
    scene.name = scene.transfer.provenance.mesh_name;
    Eigen::AlignedBox3f box;
    for (const Vector3f& position : scene.transfer.positions) box.extend(position);
    scene.camera = frame_bounds(box.min(), box.max(), 1.5f);
  }
  throw_if_interrupted();
  scene.prepared = prepare_transfer(scene.transfer);
  scene.studio = studio_environment();
  scene.rig = fit_light(scene.studio, {}, work.progress()).rig;
  scene.filtered = prefilter_in_parallel(scene.studio);
  throw_if_interrupted();
  return scene;
}

Material ashikhmin_8_800() {
  Material material;
  material.diffuse = Rgb::Constant(0.3f);
  material.model = SpecularModel::ashikhmin_shirley;
  material.fresnel.normal_reflectance = Rgb::Constant(0.5f);
  material.alpha_x = 0.5f;
  material.alpha_y = 0.05f;
  return material;
}

std::vector<NamedOptions> all_options() {
  return {{"paper", paper_shading_options(VisibilityModel::hemisphere, 1)},
          {"fast", shading_options(Quality::fast)},
          {"balanced", shading_options(Quality::balanced)},
          {"accurate", shading_options(Quality::accurate)}};
}

MovingFrame scene_frame(ShadeScene& scene, const NamedOptions& options, bool from_map) {
  MovingFrame frame;
  frame.name = options.name + (from_map ? ", map" : ", lobes");
  frame.transfer = &scene.prepared;
  frame.rig = scene.rig;
  frame.materials = {ashikhmin_8_800()};
  frame.environment = from_map ? &scene.filtered : nullptr;
  frame.options = options.options;
  frame.camera = scene.camera;
  return frame;
}

PreparedTransfer synthetic_transfer(const Transfer& baked, const PreparedTransfer& prepared,
                                    int vertices) {
  if (baked.bases.empty())
    throw Error(ErrorKind::input, baked.provenance.mesh_name,
                "nothing occludes in it, expected a scene with shadows");
  PreparedTransfer transfer = prepared;
  const TriangleMesh mesh = make_knot(std::max(vertices, 1000)).mesh;
  transfer.positions = mesh.positions;
  transfer.normals = mesh.normals;
  transfer.tangents = mesh.tangents;
  const size_t count = transfer.vertex_count(), size = transfer.row_size();
  const std::vector<float> deviation = deviations(baked);
  transfer.format = RowFormat::float16;
  transfer.rows32 = {};
  transfer.rows16.assign(count * size, 0);
  transfer.basis_id.resize(count);
  constexpr size_t kChunk = 4096;
  tbb::parallel_for(size_t{0}, (count + kChunk - 1) / kChunk, [&](size_t chunk) {
    std::mt19937 random(static_cast<unsigned>(chunk));
    std::normal_distribution<float> normal;
    for (size_t v = chunk * kChunk; v < std::min(count, (chunk + 1) * kChunk); ++v) {
      const std::uint8_t basis = baked.basis_id[v * baked.vertex_count() / count];
      transfer.basis_id[v] = basis;
      for (size_t k = 0; k < size; ++k)
        transfer.rows16[v * size + k] = Eigen::half(deviation[basis * size + k] * normal(random)).x;
    }
  });
  return transfer;
}

LightRig random_rig(int lobes, int spheres, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform;
  LightRig rig;
  for (int i = 0; i < lobes; ++i) {
    EnvironmentLobe light;
    const Vector3f z = random_direction(random);
    light.lobe.frame = frame_from_normal_tangent(z, random_direction(random));
    light.lobe.bandwidth_x = std::pow(100.0f, uniform(random));
    light.lobe.bandwidth_y = std::pow(100.0f, uniform(random));
    light.color = Rgb(uniform(random), uniform(random), uniform(random));
    rig.lobes.push_back(light);
  }
  for (int i = 0; i < spheres; ++i) {
    Vector3f direction = random_direction(random);
    direction.y() = std::abs(direction.y());
    rig.spheres.push_back({4 * direction, 0.2f, Rgb::Constant(50 * uniform(random))});
  }
  return rig;
}

}  // namespace burnish::tools
