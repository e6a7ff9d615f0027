#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include "bench.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/visibility_mask.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/reports.h"
#include "stations.h"
#include "subject.h"

namespace burnish::tools {
namespace {

struct Options {
  SubjectOptions subject;
  std::vector<int> sizes;
  int cast_all = 256;
  WriteTransferOptions writing;
  BenchOptions bench;
};

/// A file name that no other process uses, removed at the end.
class TemporaryFile {
 public:
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_ = std::filesystem::temp_directory_path() /
                                fmt::format("burnish-bench-{}.h5", static_cast<long>(getpid()));
};

/// What the bake is measured against: all rays above the horizon, in coherent packets, and nothing
/// else. Seconds a vertex, from `count` vertices evenly spread.
double cast_all_rays(const TriangleMesh& mesh, const RayScene& scene, int directions, int count) {
  const DirectionTable table(directions);
  const std::size_t vertices = std::min(static_cast<std::size_t>(count), mesh.positions.size());
  const Stopwatch watch;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices, 8), [&](const auto& range) {
    VisibilityMask mask(directions);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      const std::size_t v = (2 * i + 1) * mesh.positions.size() / (2 * vertices);
      sample_visibility(scene, table, mesh.positions[v], mesh.normals[v], mask);
    }
  });
  return watch.seconds() / static_cast<double>(vertices);
}

/// Thread time of a stage, a vertex.
double thread_ms(double seconds, const Transfer& transfer) {
  return 1e3 * seconds / static_cast<double>(transfer.vertex_count());
}

void add_errors(BenchRow& row, const char* name, const std::vector<LobeError>& errors) {
  for (const LobeError& error : errors)
    row[fmt::format("{}_error_{:g}", name, error.bandwidth)] = error.relative_rms;
}

/// One run of the bake and of the rays that it is measured against, side by side.
struct Run {
  double bake_s = 0, write_s = 0, cast_all_s = 0;  ///< cast_all_s: a vertex
  BakeTimings timings;
};

BenchRow measure_bake(const ProceduralScene& scene, const Options& options, Work& work) {
  const RayScene rays = make_ray_scene(scene.mesh, {});
  const TemporaryFile file;
  Transfer transfer;
  std::vector<Run> runs;
  for (int i = -options.bench.warmup; i < options.bench.repeat; ++i) {
    throw_if_interrupted();
    Run run;
    if (options.cast_all > 0)
      run.cast_all_s =
          cast_all_rays(scene.mesh, rays, options.subject.bake.directions, options.cast_all);
    transfer = {};
    const Stopwatch watch;
    transfer = bake(scene.mesh, {}, options.subject.bake,
                    {.progress = work.progress(), .timings = &run.timings});
    const Stopwatch write_watch;
    write_transfer(transfer, file.path(), options.writing);
    run.write_s = write_watch.seconds();
    run.bake_s = watch.seconds();
    if (i >= 0) runs.push_back(run);
  }
  std::sort(runs.begin(), runs.end(),
            [](const Run& a, const Run& b) { return a.bake_s < b.bake_s; });
  const auto ratio = [&](const Run& run) {
    return run.bake_s / (run.cast_all_s * static_cast<double>(transfer.vertex_count()));
  };
  std::vector<double> seconds, ratios;
  for (const Run& run : runs) {
    seconds.push_back(run.bake_s);
    ratios.push_back(ratio(run));
  }
  const Run& median = runs[runs.size() / 2];
  const BakeTimings& spent = median.timings;

  BenchRow row = {{"scene", scene.name}, {"vertices", transfer.vertex_count()}};
  row["triangles"] = transfer.triangles.size();
  row["terms"] = transfer.terms();
  row["bases"] = transfer.bases.size();
  row["ladder_terms"] = transfer.ladder_terms();
  const Timing timing = summarise(seconds);
  add_timing(row, timing, options.bench);
  row["ms_per_vertex"] = timing.median_s * 1e3 / static_cast<double>(transfer.vertex_count());
  if (options.cast_all > 0) {
    row["cast_all_ms_per_vertex"] = 1e3 * median.cast_all_s;
    row["ratio_to_cast_all"] = summarise(ratios).median_s;
  }
  row["rays_per_vertex"] =
      static_cast<double>(transfer.provenance.rays) / static_cast<double>(transfer.vertex_count());
  row["rays_thread_ms"] = thread_ms(spent.rays_s, transfer);
  row["distance_thread_ms"] = thread_ms(spent.distance_s, transfer);
  row["project_thread_ms"] = thread_ms(spent.project_s, transfer);
  row["scene_s"] = spent.scene_s;
  row["basis_s"] = spent.basis_s;
  row["ladder_s"] = spent.ladder_s;
  row["measure_s"] = spent.measure_s;
  row["write_s"] = median.write_s;
  // Of the process: with several sizes the largest so far.
  row["peak_memory_mb"] = static_cast<double>(peak_memory_bytes()) * 1e-6;
  row["bytes"] = std::filesystem::file_size(file.path());
  row["residual_rms_rad"] = transfer.provenance.residual_rms_rad;
  row["wrong_sign_fraction"] = transfer.provenance.wrong_sign_fraction;
  add_errors(row, "ssdf", transfer.provenance.ssdf_errors);
  add_errors(row, "ladder", transfer.provenance.ladder_errors);
  if (options.subject.reference_samples == 0) return row;
  // The truth is of the diffuse part alone: it tells the visibility apart from the highlights.
  std::vector<Material> diffuse(1);
  const PreparedTransfer prepared = prepare_transfer(transfer);
  const Subject subject = {&transfer, diffuse, {}, nullptr, &prepared};
  const StudioLight studio = make_studio_light(prepared, {}, work);
  row.update(
      error_report(vertex_error(subject, studio, scene.camera.origin, {}, options.subject, work)));
  return row;
}

void run(const Options& options) {
  check_bake_options(options.subject.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  std::vector<BenchRow> rows;
  if (options.sizes.empty())
    rows.push_back(measure_bake(load_subject(options.subject.name), options, work));
  for (const int size : options.sizes) rows.push_back(measure_bake(make_knot(size), options, work));
  report_bench("bake", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_bake_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->bench.repeat = 3;
  options->bench.warmup = 0;
  add_subject_options(app, options->subject);
  add_parsed(app, "--sizes", "N,N,...",
             "measure the knot in about as many vertices each, in place of SCENE",
             "vertex counts in 1000..20000000", [options](const std::string& found) {
               const auto sizes = parse_numbers(found);
               if (!sizes) return false;
               options->sizes.clear();
               for (const double size : *sizes) {
                 if (!(size >= 1000 && size <= 2e7)) return false;
                 options->sizes.push_back(static_cast<int>(size));
               }
               return true;
             });
  add_number(app, "--cast-all", "N", options->cast_all, {0, 1 << 20},
             "vertices for which all rays are cast, to compare with; 0 not to");
  add_coefficient_option(app, options->writing);
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
