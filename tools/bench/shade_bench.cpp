#include <memory>
#include <vector>

#include "bench.h"
#include "common/pipeline_options.h"
#include "common/reports.h"
#include "stations.h"
#include "subject.h"

namespace burnish::tools {
namespace {

struct Options {
  SubjectOptions subject;
  ShadingOptions shading;
  BenchOptions bench;
};

struct Look {
  const char* name;
  std::vector<Material> materials;
  std::vector<std::uint8_t> material_id;
};

/// The scene's own materials, and each model alone over the whole mesh.
std::vector<Look> looks_of(const ProceduralScene& scene) {
  Material diffuse;
  Material brushed;
  brushed.diffuse = Rgb::Constant(0.1f);
  brushed.specular = Rgb::Constant(0.5f);
  brushed.alpha_x = 0.3f;
  brushed.alpha_y = 0.03f;
  Material ward = brushed, ashikhmin = brushed;
  ward.model = SpecularModel::ward;
  ashikhmin.model = SpecularModel::ashikhmin_shirley;
  ashikhmin.specular = Rgb::Ones();
  ashikhmin.fresnel.normal_reflectance = brushed.specular;
  return {{"scene", scene.materials, scene.material_id},
          {"diffuse", {diffuse}, {}},
          {"ward 0.3/0.03", {ward}, {}},
          {"ashikhmin 0.3/0.03", {ashikhmin}, {}}};
}

BenchRow bench_look(const Options& options, const ProceduralScene& scene, const Look& look,
                    const Transfer& transfer, const PreparedTransfer& prepared,
                    const StudioLight& studio, Work& work) {
  const Subject subject = {&transfer, look.materials, look.material_id, nullptr, &prepared};
  const Vector3f& eye = scene.camera.origin;
  const Timing timing = measure(
      options.bench, [&] { shade_all_vertices(subject, studio.lighting(), eye, options.shading); });
  const auto vertices = static_cast<double>(transfer.vertex_count());
  BenchRow row = {{"material", look.name}, {"scene", scene.name}};
  row["vertices"] = transfer.vertex_count();
  row["terms"] = transfer.terms();
  row["lobes"] = studio.lights.lobes.size();
  add_timing(row, timing, options.bench);
  row["ns_per_vertex"] = timing.median_s * 1e9 / vertices;
  row["vertices_per_s"] = vertices / timing.median_s;
  row["bytes_per_vertex"] = prepared.bytes_per_vertex();
  if (options.subject.reference_samples > 0)
    row.update(
        error_report(vertex_error(subject, studio, eye, options.shading, options.subject, work)));
  return row;
}

void run(const Options& options) {
  check_bake_options(options.subject.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  const ProceduralScene scene = load_subject(options.subject.name);
  const Transfer transfer =
      bake(scene.mesh, {}, options.subject.bake, {.progress = work.progress()});
  const PreparedTransfer prepared = prepare_transfer(transfer);
  const StudioLight studio = make_studio_light(prepared, options.shading, work);
  std::vector<BenchRow> rows;
  for (const Look& look : looks_of(scene))
    rows.push_back(bench_look(options, scene, look, transfer, prepared, studio, work));
  report_bench("shade", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_shade_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->bench.repeat = 9;
  add_subject_options(app, options->subject);
  add_shading_options(app, options->shading);
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
