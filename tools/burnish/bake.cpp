#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/mesh_file.h"
#include "burnish/formats/transfer_file.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/reports.h"
#include "common/work.h"

namespace burnish::tools {
namespace {

struct Options {
  std::string mesh;
  std::vector<std::string> occluders;
  std::string output;
  MeshReadOptions reading;
  BakeOptions bake;
  WriteTransferOptions writing;
  CommonOptions common;
};

/// Reads a mesh that is to be baked or to cast shadows; says what a user may want to know of it.
TriangleMesh read_for_bake(const std::string& path, const MeshReadOptions& options, Work& work) {
  MeshReport report;
  TriangleMesh mesh = read_mesh(path, options, &report);
  throw_if_interrupted();
  for (const std::string& note : report.notes) work.print(fmt::format("{}: {}", path, note));
  return mesh;
}

void run(const Options& options) {
  check_bake_options(options.bake);
  require_writable(std::vector{options.output, options.common.report});
  Work work(options.common);
  const TriangleMesh mesh = read_for_bake(options.mesh, options.reading, work);
  std::vector<TriangleMesh> occluders;
  for (const std::string& path : options.occluders)
    occluders.push_back(read_for_bake(path, options.reading, work));

  BakeTimings timings;
  const Transfer transfer = bake(mesh, occluders, options.bake, work.progress(), &timings);
  throw_if_interrupted();
  write_transfer(transfer, options.output, options.writing);

  const std::uint64_t bytes = std::filesystem::file_size(options.output);
  nlohmann::ordered_json report = {{"mesh", options.mesh}, {"output", options.output}};
  report["bake"] = bake_report(transfer, options.bake, timings, bytes);
  report["machine"] = machine_record(work.threads());
  write_json(options.common.report, report);
  work.print(bake_summary(transfer, timings));
  work.print(fmt::format("{}: {}", options.output, bytes_text(static_cast<double>(bytes))));
}

}  // namespace

std::function<void()> declare_bake(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_file(app, "MESH", "MESH", options->mesh, "mesh to bake: .obj, .ply, .off or .stl (required)")
      ->required();
  app.add_option("--occluders", options->occluders,
                 "a further mesh that casts shadows and is not baked; may be given more than once")
      ->option_text("MESH")
      ->allow_extra_args(false);
  add_file(app, "-o,--output", "FILE.h5", options->output, "transfer file to write (required)",
           ".h5")
      ->required();
  add_bake_options(app, options->bake);
  add_choice(app, "--coefficients", options->writing.coefficient_type,
             {{"float32", CoefficientType::float32}, {"float16", CoefficientType::float16}},
             "how coefficients are stored; float16 halves the file");
  add_choice(app, "--up", options->reading.up,
             {{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}},
             "the mesh's upward axis, for the tangents of surfaces without UVs");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
