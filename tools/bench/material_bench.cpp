#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "bench/bench.h"
#include "bench/slice_light_error.h"
#include "burnish/material/specular_slice.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "distribution_bench.h"
#include "material_times.h"
#include "stations.h"

namespace burnish::tools {
namespace {

enum class Part { all, slice, distribution, time };

struct Options {
  BenchOptions bench;
  Part only = Part::all;
};

struct NamedModel {
  const char* name;
  Material material;  ///< without its alphas
};

std::vector<NamedModel> models() {
  Material ward;
  ward.diffuse = Rgb::Zero();
  ward.model = SpecularModel::ward;
  Material balanced = ward, ashikhmin = ward, beckmann = ward;
  balanced.model = SpecularModel::ward_balanced;
  ashikhmin.model = SpecularModel::ashikhmin_shirley;
  ashikhmin.fresnel.normal_reflectance = Rgb::Constant(0.5f);
  beckmann.model = SpecularModel::cook_torrance;
  beckmann.distribution = Distribution::beckmann;
  beckmann.fresnel = ashikhmin.fresnel;
  Material ggx = beckmann;
  ggx.distribution = Distribution::ggx;
  return {{"ward", ward},
          {"ward-balanced", balanced},
          {"ashikhmin", ashikhmin},
          {"beckmann", beckmann},
          {"ggx", ggx}};
}

struct NamedForm {
  const char* name;
  SpecularOptions options;
};

constexpr std::array<NamedForm, 6> kForms = {{{"paper", {SpecularForm::peak, 1, 1}},
                                              {"peak, 9", {SpecularForm::peak, 9, 3}},
                                              {"1", {SpecularForm::moments, 1, 3}},
                                              {"3", {SpecularForm::moments, 3, 3}},
                                              {"5", {SpecularForm::moments, 5, 3}},
                                              {"9", {SpecularForm::moments, 9, 3}}}};
constexpr std::array kViews_deg = {0.0, 30.0, 60.0, 75.0, 80.0, 85.0};

/// Rows of the slice's error and of its energy, a column an angle of view.
void measure_slices(const NamedModel& model, std::vector<BenchRow>& rows,
                    std::vector<BenchRow>& energies) {
  std::array<SpecularOptions, kForms.size()> forms;
  for (size_t f = 0; f < kForms.size(); ++f) forms[f] = kForms[f].options;
  for (const double alpha : {0.05, 0.1, 0.2, 0.3, 0.5}) {
    for (const double anisotropy : {1.0, 3.0, 10.0}) {
      throw_if_interrupted();
      Material material = model.material;
      material.alpha_x = static_cast<float>(alpha * std::sqrt(anisotropy));
      material.alpha_y = static_cast<float>(alpha / std::sqrt(anisotropy));
      if (material.alpha_x > kMaxAlpha) continue;
      std::array<std::vector<SliceLightError>, kViews_deg.size()> errors;
      tbb::parallel_for(size_t{0}, kViews_deg.size(), [&](size_t v) {
        errors[v] = slice_light_errors(material, kViews_deg[v], forms);
      });
      for (size_t f = 0; f < kForms.size(); ++f) {
        BenchRow row = {{"what", "slice"}, {"model", model.name}};
        row["alpha"] = alpha;
        row["anisotropy"] = anisotropy;
        row["lobes"] = kForms[f].name;
        BenchRow energy = row;
        energy["what"] = "energy";
        for (size_t v = 0; v < kViews_deg.size(); ++v) {
          const std::string column = fmt::format("{}_deg", kViews_deg[v]);
          row[column] = errors[v][f].relative_rms;
          energy[column] = errors[v][f].energy;
        }
        rows.push_back(row);
        energies.push_back(energy);
      }
    }
  }
}

void run(const Options& options) {
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  const auto is_wanted = [&](Part part) {
    return options.only == Part::all || options.only == part;
  };
  std::vector<BenchRow> rows;
  const auto add = [&rows](const std::vector<BenchRow>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  if (is_wanted(Part::slice)) {
    std::vector<BenchRow> energies;
    for (const NamedModel& model : models()) measure_slices(model, rows, energies);
    add(energies);
  }
  if (is_wanted(Part::distribution)) add(measure_distributions());
  if (is_wanted(Part::time)) add(measure_material_times(options.bench.repeat));
  report_bench("material", rows, options.bench, work);
}

}  // namespace

std::function<void()> declare_material_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_bench_options(app, options->bench);
  add_choice(app, "--only", options->only,
             {{"all", Part::all},
              {"slice", Part::slice},
              {"distribution", Part::distribution},
              {"time", Part::time}},
             "what to measure: errors of slices and their energy, of D as round lobes, times");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
