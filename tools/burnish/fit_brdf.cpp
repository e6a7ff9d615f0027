#include "burnish/precompute/fit_brdf.h"

#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/material_file.h"
#include "burnish/formats/measured_brdf.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/work.h"
#include "harness/brdf_picture.h"

namespace burnish::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string measured;
  std::string output;
  std::string preview;
  double max_angle_degrees = 80;
  double view_azimuth_degrees = 0;  ///< of the preview
  BrdfFitOptions fit;
  CommonOptions common;
};

/// A model to compare with, at its best.
struct Parametric {
  std::string name;
  Material material;
  BrdfError error;
};

std::vector<Parametric> fit_parametric(const MeasuredBrdf& measured,
                                       const BrdfFitOptions& options) {
  std::vector<Parametric> list = {{"Ward", {}, {}}, {"Ashikhmin-Shirley", {}, {}}};
  for (Parametric& entry : list) {
    throw_if_interrupted();
    const auto model =
        entry.name == "Ward" ? SpecularModel::ward : SpecularModel::ashikhmin_shirley;
    entry.material = fit_parametric_brdf(measured, model, options);
    entry.error = measure_brdf_fit(measured, entry.material, options);
  }
  return list;
}

std::string error_line(const std::string& name, const BrdfError& error) {
  return fmt::format("{:<18} relative L2 error {:5.1f} %, of the cube root {:5.1f} %", name,
                     100 * error.relative_l2, 100 * error.cube_root);
}

Json error_json(const BrdfError& error) {
  return {{"relative_l2", error.relative_l2}, {"cube_root", error.cube_root}};
}

Json report(const Options& options, const MeasuredBrdf& measured, const BrdfFit& fit,
            const std::vector<Parametric>& others, double bound, double seconds, int threads) {
  Json document = {{"measured", options.measured},
                   {"output", options.output},
                   {"format", measured.format},
                   {"description", measured.description},
                   {"isotropic", measured.isotropic},
                   {"samples", measured.samples.size()},
                   {"max_angle_degrees", options.max_angle_degrees},
                   {"lobes", fit.material.fitted->lobes.size()},
                   {"fitted", error_json(fit.error)}};
  for (const Parametric& other : others) {
    Json& entry = document[other.name == "Ward" ? "ward" : "ashikhmin_shirley"];
    entry = error_json(other.error);
    entry["alpha_x"] = other.material.alpha_x;
    entry["alpha_y"] = other.material.alpha_y;
  }
  document["reciprocity_bound"] = bound;
  document["rounds"] = fit.rounds;
  document["seconds"] = seconds;
  document["machine"] = machine_record(threads);
  return document;
}

void write_material(const Options& options, const MeasuredBrdf& measured, const BrdfFit& fit) {
  MaterialFile file;
  file.name = measured.description;
  file.source = std::filesystem::path(options.measured).filename().string();
  file.fit_relative_l2 = fit.error.relative_l2;
  file.material = fit.material;
  write_material_file(file, options.output);
}

void run(Options options) {
  require_writable(std::vector{options.output, options.preview, options.common.report});
  Work work(options.common);
  options.fit.subject = options.measured;
  options.fit.max_angle_rad = options.max_angle_degrees * kPi<double> / 180;
  const MeasuredBrdf measured = read_measured_brdf(options.measured);
  const Stopwatch watch;
  const BrdfFit fit = fit_brdf(measured, options.fit, work.progress());
  const double seconds = watch.seconds();
  const std::vector<Parametric> others = fit_parametric(measured, options.fit);
  const double bound = reciprocity_bound(measured, options.fit);
  throw_if_interrupted();

  write_material(options, measured, fit);
  if (!options.preview.empty())
    write_png(draw_brdf_fit(measured, {fit.material, others[0].material, others[1].material},
                            options.view_azimuth_degrees * kPi<double> / 180),
              options.preview);
  write_json(options.common.report,
             report(options, measured, fit, others, bound, seconds, work.threads()));
  work.print(fmt::format("{}: {}{}{}, lobes: {}, {:.1f} s", measured.format, measured.description,
                         measured.description.empty() ? "" : ", ",
                         measured.isotropic ? "isotropic" : "anisotropic",
                         fit.material.fitted->lobes.size(), seconds));
  work.print(error_line("fitted", fit.error));
  for (const Parametric& other : others) work.print(error_line(other.name, other.error));
  for (const Parametric& other : others)
    if (fit.error.relative_l2 > other.error.relative_l2)
      work.print(
          fmt::format("warning: the best {} material is closer than the fitted one", other.name));
  if (bound > 0)
    work.print(fmt::format("{:<18} relative L2 error {:5.1f} %: the data are not reciprocal",
                           "any material", 100 * bound));
}

}  // namespace

std::function<void()> declare_fit_brdf(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_file(app, "FILE", "FILE", options->measured,
           "measured BRDF: RGL tensor file (.bsdf), MERL (.binary) or CSV (required)")
      ->required();
  add_file(app, "-o,--output", "FILE.json", options->output, "material file to write (required)",
           ".json")
      ->required();
  BrdfFitOptions& fit = options->fit;
  add_number(app, "--lobes", "N", fit.lobes, {1, kMaxFittedLobes},
             "lobes of the distribution, at most");
  add_number(app, "--resolution", "N", fit.resolution, {32, 512},
             "edge of the table of half vectors that lobes are fitted to");
  add_number(app, "--max-angle", "A", options->max_angle_degrees, {6, 90, "degrees"},
             "directions further from the normal do not count");
  add_file(app, "--preview", "FILE.png", options->preview,
           "draws slices: measured, fitted, best Ward, best Ashikhmin-Shirley, and the difference "
           "of the first two; a row a view, 0, 20, 40, 60 and 75 degrees",
           ".png");
  add_number(app, "--view-azimuth", "A", options->view_azimuth_degrees, {-360, 360, "degrees"},
             "of the preview's views");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
