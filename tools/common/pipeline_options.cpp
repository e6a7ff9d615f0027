#include "common/pipeline_options.h"

#include "common/options.h"
#include "common/program.h"

namespace burnish::tools {

void add_bake_options(CLI::App& app, BakeOptions& options) {
  add_number(app, "--directions", "N", options.directions, {64, 1024, "", true},
             "visibility is sampled on N x N directions");
  add_number(app, "--resolution", "N", options.resolution, {16, 1024, "", true},
             "signed distances are stored on N x N texels, at most --directions");
  add_number(app, "--terms", "N", options.terms, {1, 1024},
             "PCA coefficients of a vertex: more are finer and slower");
  add_number(app, "--training-vertices", "N", options.training_vertices, {0, 1 << 30},
             "vertices the PCA basis is trained on, 0 for all");
}

void check_bake_options(const BakeOptions& options) {
  if (options.resolution > options.directions)
    throw UsageError(fmt::format("--resolution: found {}, expected at most --directions, {}",
                                 options.resolution, options.directions));
}

void add_shading_options(CLI::App& app, ShadingOptions& options) {
  add_choice(app, "--visibility", options.visibility,
             {{"cap", VisibilityModel::cap},
              {"hemisphere", VisibilityModel::hemisphere},
              {"directional", VisibilityModel::directional}},
             "what is assumed of the visible region around a lobe");
  add_choice(app, "--cosine", options.cosine,
             {{"constant", CosineModel::constant},
              {"horizon-normalised", CosineModel::horizon_normalised}},
             "how the cosine of the diffuse term is taken");
  add_choice(
      app, "--integral", options.integral,
      {{"fast", AsgIntegral::fast}, {"series", AsgIntegral::series}, {"exact", AsgIntegral::exact}},
      "accuracy of a lobe's integral");
  add_number(app, "--environment-taps", "N", options.environment_taps, {1, 64},
             "lookups along a highlight's long axis, at most");
}

}  // namespace burnish::tools
