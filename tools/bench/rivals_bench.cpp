#include <algorithm>
#include <map>
#include <memory>

#include "bench.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "harness/error_metrics.h"
#include "harness/reference_integrator.h"
#include "harness/rivals/monte_carlo_rival.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/sg_rival.h"
#include "harness/rivals/sh_rival.h"
#include "harness/rivals/uncompressed_rival.h"
#include "harness/rivals/unshadowed_rival.h"
#include "shade_subjects.h"
#include "stations.h"

namespace burnish::tools {
namespace {

struct Options {
  SubjectOptions subject;
  std::string transfer;
  int vertices = 1000;
  BenchOptions bench;
};

/// A part of a baked scene's vertices of one material.
struct Part {
  std::string name;
  Transfer transfer;
  PreparedTransfer prepared;
  std::vector<Material> materials;
};

using MakeRival = std::function<Rival(const RivalScene&)>;

/// Fits of the map, by the number of lights.
using SgFits = std::map<int, SgLights>;

void add_sg_rivals(bool is_glossy, const SgFits& fits, std::vector<MakeRival>& rivals) {
  const auto add = [&](const SgOptions& options) {
    rivals.push_back([options, &fits](const RivalScene& scene) {
      return sg_rival(scene, options, fits.at(options.light_lobes));
    });
  };
  if (is_glossy)
    for (const int lobes : {1, 3, 5, 7, 9, 13, 15, 19}) add({.lobes = lobes});
  else
    add({});
  for (const auto& [lights, fit] : fits) {
    if (lights != SgOptions{}.light_lobes) add({.light_lobes = lights});
    add({.light_lobes = lights, .cosine = CosineModel::horizon_normalised});
  }
}

void add_uncompressed_rivals(const BakeOptions& bake, Work& work, std::vector<MakeRival>& rivals) {
  for (const bool ladder : {false, true})
    for (const Quality quality : {Quality::balanced, Quality::accurate})
      rivals.push_back([ladder, quality, &bake, &work](const RivalScene& scene) {
        Rival rival = uncompressed_rival(scene,
                                         {.shading = shading_options(quality),
                                          .directions = bake.directions,
                                          .resolution = bake.resolution,
                                          .ladder = ladder},
                                         work.progress());
        rival.name += quality == Quality::accurate ? ", accurate" : ", balanced";
        return rival;
      });
}

std::vector<MakeRival> all_rivals(const BakeOptions& bake, bool is_glossy, const SgFits& fits,
                                  Work& work) {
  std::vector<MakeRival> rivals;
  for (const NamedOptions& named : all_options())
    rivals.push_back([named](const RivalScene& scene) {
      return runtime_rival(scene, named.name, {named.options});
    });
  rivals.push_back([](const RivalScene& scene) {
    return runtime_rival(scene, "paper, cap", {paper_shading_options(VisibilityModel::cap)});
  });
  add_sg_rivals(is_glossy, fits, rivals);
  for (const auto& [order, window] :
       {std::pair(3, false), {4, false}, {5, false}, {6, false}, {5, true}})
    rivals.push_back([order = order, window = window, &work](const RivalScene& scene) {
      return sh_rival(scene, {.order = order, .window = window}, work.progress());
    });
  add_uncompressed_rivals(bake, work, rivals);
  for (const bool bent : {false, true})
    rivals.push_back([bent](const RivalScene& scene) { return unshadowed_rival(scene, {bent}); });
  for (const int samples : {4, 16, 64})
    rivals.push_back([samples](const RivalScene& scene) {
      // Not the truth's own numbers.
      return monte_carlo_rival(scene, samples, 77);
    });
  return rivals;
}

BenchRow measure_rival(const Rival& rival, const RivalScene& scene, const Vector3f& eye,
                       const VertexReference& truth, const BenchOptions& options) {
  const Eigen::Matrix3f world_from_environment = Eigen::Matrix3f::Identity();
  BenchRow row;
  row["row"] = rival.name;
  row["vertices"] = scene.vertex_count();
  row["bake_s"] = rival.bake_s;
  row["bytes_per_vertex"] = rival.bytes_per_vertex;
  row["shared_bytes"] = rival.bytes_shared;
  const Stopwatch preparing;
  rival.prepare_lights(world_from_environment);
  row["prepare_ms"] = preparing.seconds() * 1e3;
  // On one thread: what a vertex costs.
  std::vector<Rgb> radiance(scene.vertex_count());
  const Timing timing = measure(options, [&] { rival.shade(eye, 0, radiance); });
  row["ns_per_vertex"] = timing.min_s * 1e9 / static_cast<double>(scene.vertex_count());
  const RelativeL2 error = relative_l2(radiance, truth.radiance, truth.variance);
  row["relative_l2"] = error.without_noise;
  row["truth_noise"] = error.truth_noise;
  return row;
}

std::vector<BenchRow> measure_part(Part& part, const ShadeScene& whole, const SceneRays& rays,
                                   double bake_s, const SgFits& fits, const Options& options,
                                   Work& work) {
  RivalScene scene;
  scene.subject = {&part.transfer, part.materials, {}, nullptr, &part.prepared};
  scene.rays = &rays;
  scene.map = &whole.studio;
  scene.rig = whole.rig;
  scene.filtered = std::make_shared<PrefilteredEnvironment>(whole.filtered);
  scene.transfer_bake_s = bake_s;
  const Vector3f& eye = whole.camera.origin;
  const VertexReference truth = shade_reference_vertices(
      scene.subject, rays, eye, {{scene.map}},
      {.samples = options.subject.reference_samples, .seed = options.subject.seed},
      work.progress());
  std::vector<BenchRow> rows;
  for (const MakeRival& make :
       all_rivals(options.subject.bake, part.materials[0].has_specular(), fits, work)) {
    throw_if_interrupted();
    BenchRow row = {{"what", whole.name + ", " + part.name}};
    row.update(measure_rival(make(scene), scene, eye, truth, options.bench));
    rows.push_back(std::move(row));
  }
  return rows;
}

void run(const Options& options) {
  check_bake_options(options.subject.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  const Stopwatch baking;
  const ShadeScene whole = load_shade_scene(options.subject, options.transfer, work);
  const double bake_s = options.transfer.empty() ? baking.seconds() : 0;
  const SceneRays rays(whole.transfer);
  const Transfer subset = vertex_subset(
      whole.transfer, draw_vertices(whole.transfer.vertex_count(),
                                    static_cast<size_t>(options.vertices), options.subject.seed));
  Material diffuse;
  diffuse.diffuse = Rgb::Constant(0.5f);
  SgFits fits;
  for (const int lights : {10, 20})
    fits[lights] = fit_sg_lights(whole.studio, lights, work.progress());
  std::vector<BenchRow> rows;
  for (const auto& [name, material] :
       {std::pair("diffuse", diffuse), std::pair("ashikhmin 8:800", ashikhmin_8_800())}) {
    Part part = {name, subset, prepare_transfer(subset), {material}};
    for (BenchRow& row : measure_part(part, whole, rays, bake_s, fits, options, work))
      rows.push_back(std::move(row));
  }
  report_bench("rivals", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_rivals_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->subject.name = "dish";
  options->subject.reference_samples = 1024;
  add_subject_options(app, options->subject);
  add_file(app, "--transfer", "FILE.h5", options->transfer,
           "measure on a baked file instead of baking SCENE", ".h5");
  add_number(app, "--vertices", "N", options->vertices, {1, 100000, ""},
             "that are shaded, drawn by the seed");
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
