#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "bench.h"
#include "burnish/formats/transfer_file.h"
#include "common/pipeline_options.h"
#include "common/reports.h"
#include "stations.h"
#include "subject.h"

namespace burnish::tools {
namespace {

struct Options {
  SubjectOptions subject;
  BenchOptions bench;
};

/// Size of the transfer as a file, with the default coefficient type and compression.
std::uint64_t transfer_file_bytes(const Transfer& transfer) {
  const auto path = std::filesystem::temp_directory_path() /
                    fmt::format("burnish-bench-{}.h5", static_cast<long>(getpid()));
  write_transfer(transfer, path.string());
  const std::uint64_t bytes = std::filesystem::file_size(path);
  std::filesystem::remove(path);
  return bytes;
}

void run(const Options& options) {
  check_bake_options(options.subject.bake);
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  const ProceduralScene scene = load_subject(options.subject.name);

  Transfer transfer;
  BakeTimings timings;
  const Timing timing = measure(options.bench, [&] {
    transfer = bake(scene.mesh, {}, options.subject.bake, work.progress(), &timings);
  });
  // The truth is of the diffuse part alone: it tells the visibility apart from the highlights.
  std::vector<Material> diffuse(1);
  const Subject subject = {&transfer, diffuse, {}};
  const StudioLight studio = make_studio_light({}, work);
  const RelativeL2 error =
      vertex_error(subject, studio, scene.camera.origin, {}, options.subject, work);

  BenchRow row = {{"scene", scene.name}, {"vertices", transfer.vertex_count()}};
  row["triangles"] = transfer.triangles.size();
  row["terms"] = transfer.terms();
  add_timing(row, timing, options.bench);
  row["ms_per_vertex"] = timing.median_s * 1e3 / static_cast<double>(transfer.vertex_count());
  row["rays"] = transfer.provenance.rays;
  row["rays_per_s"] = static_cast<double>(transfer.provenance.rays) / timing.median_s;
  row["bytes"] = transfer_file_bytes(transfer);
  row["residual_rms_rad"] = transfer.provenance.residual_rms_rad;
  row["wrong_sign_fraction"] = transfer.provenance.wrong_sign_fraction;
  row.update(error_report(error));
  report_bench("bake", {row}, options.bench, work);
}

}  // namespace

std::function<void()> declare_bake_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->bench.repeat = 3;
  add_subject_options(app, options->subject);
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
