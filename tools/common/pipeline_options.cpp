#include "common/pipeline_options.h"

#include "common/options.h"
#include "common/program.h"

namespace burnish::tools {

void add_bake_options(CLI::App& app, BakeOptions& options) {
  add_number(app, "--directions", "N", options.directions, {64, 1024, "", true},
             "visibility is sampled on N x N directions");
  add_choice(app, "--coarsest", options.coarsest,
             {{"16", 16}, {"32", 32}, {"64", 64}, {"128", 128}, {"256", 256}, {"all", 1024}},
             "rays go into N x N directions first, and into finer ones where visibility changes");
  add_number(app, "--origin-offset", "A", options.origin_offset, {0, 1e30, "world units"},
             "rays leave a vertex this far along its normal, 0 for 2^-16 of the scene");
  add_number(app, "--resolution", "N", options.resolution, {16, 1024, "", true},
             "signed distances are stored on N x N texels, at most --directions");
  add_number(app, "--terms", "N", options.terms, {1, 1024},
             "PCA coefficients of a vertex: more are finer and slower");
  add_number(app, "--amplitude", "A", options.amplitude_rad, {0, 100, "radians"},
             "signed distances are compressed as tanh(distance / A), 0 for as they are");
  add_number(app, "--bases", "N", options.bases, {0, 256},
             "PCA bases, each vertex in one of them: more are finer, not slower; 0 to choose by "
             "their error");
  add_number(app, "--target-error", "A", options.target_error, {0, 1},
             "take the fewest terms, up to --terms, for this error of a lobe's visibility at "
             "bandwidth 128; 0 to take them all");
  add_number(app, "--ladder-terms", "N", options.ladder_terms, {0, 1024},
             "coefficients of a vertex for wide lobes, 0 to leave them to the signed distances");
  add_number(app, "--training-vertices", "N", options.training_vertices, {0, 1 << 30},
             "vertices the PCA bases are trained on, 0 for all");
  add_number(app, "--residual-vertices", "N", options.residual_vertices, {1, 4096},
             "vertices that errors are measured on");
}

void add_coefficient_option(CLI::App& app, WriteTransferOptions& options) {
  add_choice(app, "--coefficients", options.coefficient_type,
             {{"float32", CoefficientType::float32},
              {"float16", CoefficientType::float16},
              {"int16", CoefficientType::int16}},
             "how coefficients and eigenimages are stored");
}

void check_bake_options(const BakeOptions& options) {
  if (options.terms > options.resolution * options.resolution)
    throw UsageError(
        fmt::format("--terms: found {}, expected at most the texels of --resolution, {}",
                    options.terms, options.resolution * options.resolution));
  if (options.resolution > options.directions)
    throw UsageError(fmt::format("--resolution: found {}, expected at most --directions, {}",
                                 options.resolution, options.directions));
}

namespace {

/// First of the dials: options are taken in the order of their declaration, so that those given
/// beside it override it.
void add_quality_option(CLI::App& app, ShadingOptions& options) {
  const std::vector<std::pair<std::string, Quality>> qualities = {
      {"fast", Quality::fast}, {"balanced", Quality::balanced}, {"accurate", Quality::accurate}};
  add_parsed(app, "--quality", "fast|balanced|accurate",
             "speed for accuracy: sets the dials of shading that are not given themselves (default "
             "balanced)",
             "one of fast|balanced|accurate", [&options, qualities](const std::string& found) {
               for (const auto& [word, quality] : qualities)
                 if (word == found) {
                   options = shading_options(quality);
                   return true;
                 }
               return false;
             });
}

}  // namespace

void add_shading_options(CLI::App& app, ShadingOptions& options) {
  add_quality_option(app, options);
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
  add_choice(app, "--ladder", options.ladder, {{"on", true}, {"off", false}},
             "whether wide lights see through the visibility ladder, where one was baked");
  add_number(app, "--ladder-reach", "F", options.ladder_reach, {1, 1000},
             "lights up to F times as sharp as the ladder tells best see through it, too");
  add_choice(app, "--specular-form", options.specular.form,
             {{"peak", SpecularForm::peak}, {"moments", SpecularForm::moments}},
             "how a highlight's lobes are found: by the paper's warp, or by their moments");
  add_number(app, "--specular-taps", "N", options.specular.taps, {1, kMaxTaps},
             "parts that a highlight's lobe is cut into: more are finer and slower");
  add_number(app, "--specular-lobes", "N", options.specular.lobes, {1, 3},
             "lobes of a distribution with a long tail (GGX), at most");
  add_number(app, "--split-bandwidth", "A", options.split_bandwidth, {0, 1000},
             "lights wider than this are split into narrower ones, 0 for none");
  add_number(app, "--environment-taps", "N", options.environment_taps, {1, 64},
             "lookups along a highlight's long axis, at most");
  add_choice(app, "--highlight-lobe", options.highlight_lobe,
             {{"whole", HighlightLobe::whole}, {"visible-part", HighlightLobe::visible_part}},
             "what of a highlight's lobe the map is averaged over");
}

}  // namespace burnish::tools
