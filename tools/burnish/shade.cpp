#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/radiance_ply.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "harness/render.h"
#include "look_options.h"

namespace burnish::tools {
namespace {

struct Options {
  LookOptions look;
  float exposure_stops = 0;
  std::string output;
  CommonOptions common;
};

void run(const Options& options) {
  require_writable(std::vector{options.output, options.common.report});
  Work work(options.common);
  const Look look = load_look(options.look, work);
  const Transfer& transfer = look.transfer;
  const Camera camera = look_camera(options.look, transfer, 1.5f);

  const Stopwatch watch;
  const std::vector<Rgb> radiance =
      shade_all_vertices(look.subject(), look.lighting(), camera.origin, options.look.shading);
  const double shading_ms = watch.seconds() * 1e3;
  throw_if_interrupted();
  write_radiance_ply(options.output, transfer.positions, transfer.normals, radiance,
                     transfer.triangles, options.exposure_stops);

  nlohmann::ordered_json report = look.report;
  report["camera"] = format_camera(camera);
  report["vertices"] = transfer.vertex_count();
  report["shading_ms"] = shading_ms;
  report["machine"] = machine_record(work.threads());
  write_json(options.common.report, report);
  work.print(fmt::format("{}: {} vertices shaded in {:.1f} ms", options.output,
                         transfer.vertex_count(), shading_ms));
}

}  // namespace

std::function<void()> declare_shade(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_look_options(app, options->look);
  add_number(app, "--exposure", "EV", options->exposure_stops, {-40, 40, "stops"},
             "brightens the vertex colours, not the float radiance");
  add_file(app, "-o,--output", "FILE.ply", options->output,
           "binary PLY to write: linear radiance as floats, sRGB vertex colours (required)", ".ply")
      ->required();
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
