// Figures 11 and 12 of xu2013asg: compressed visibility, and anisotropic balls in a dish.
#include <fmt/format.h>

#include "bench/reproduce/stage.h"
#include "common/interrupt.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/uncompressed_rival.h"
#include "harness/tone_map.h"

namespace burnish::tools {
namespace {

constexpr size_t kVertices = 1500;  ///< on which the errors of Fig. 11 are measured

/// Vertices of a stage as a scene of their own, for rivals. Refers to the stage.
struct Sample {
  Transfer transfer;
  PreparedTransfer prepared;
  std::vector<std::uint8_t> material_id;
  RivalScene scene;

  Sample(const Stage& stage, const std::vector<Material>& materials,
         std::span<const std::uint32_t> vertices)
      : transfer(vertex_subset(stage.transfer, vertices)), prepared(prepare_transfer(transfer)) {
    for (const std::uint32_t vertex : vertices)
      material_id.push_back(stage.source.material_id[vertex]);
    scene.subject = {&transfer, materials, material_id, nullptr, &prepared};
    scene.rays = &stage.rays;
    scene.map = &stage.map;
    scene.rig = stage.rig;
    scene.filtered = std::make_shared<PrefilteredEnvironment>(stage.filtered);
  }
  Sample(const Sample&) = delete;
  Sample& operator=(const Sample&) = delete;
};

ShadingOptions with_terms(ShadingOptions options, int terms) {
  options.terms = terms;
  return options;
}

UncompressedOptions uncompressed(const ShadingOptions& shading) {
  return {.shading = shading,
          .directions = figure_bake().directions,
          .resolution = figure_bake().resolution};
}

/// The paper's models on one basis, ours on eight with the ladder; 16, 32 and 48 terms and none.
std::vector<Rival> visibility_rivals(const RivalScene& one_basis, const RivalScene& ours,
                                     const Progress& progress) {
  std::vector<Rival> rivals;
  const ShadingOptions cap = paper_shading_options(VisibilityModel::cap);
  const ShadingOptions hemisphere = paper_shading_options();
  const ShadingOptions balanced = shading_options(Quality::balanced);
  for (const int terms : {16, 32, 48})
    rivals.push_back(runtime_rival(one_basis, fmt::format("paper, {} terms", terms),
                                   {with_terms(hemisphere, terms)}));
  rivals.push_back(uncompressed_rival(one_basis, uncompressed(hemisphere), progress));
  rivals.back().name = "paper, no compression";
  rivals.push_back(runtime_rival(one_basis, "cap, 48 terms", {cap}));
  rivals.push_back(uncompressed_rival(one_basis, uncompressed(cap), progress));
  rivals.back().name = "cap, no compression";
  for (const int terms : {16, 32, 48})
    rivals.push_back(
        runtime_rival(ours, fmt::format("ours, {} terms", terms), {with_terms(balanced, terms)}));
  rivals.push_back(uncompressed_rival(ours, uncompressed(balanced), progress));
  rivals.back().name = "ours, no compression";
  return rivals;
}

void add_visibility_rows(const Stage& one_basis, const Stage& ours,
                         const std::vector<Material>& materials, const std::string& what,
                         const FigureContext& context, std::vector<BenchRow>& rows) {
  const std::vector<std::uint32_t> vertices =
      draw_vertices(ours.transfer.vertex_count(), kVertices, 1);
  const Sample paper_sample(one_basis, materials, vertices);
  const Sample our_sample(ours, materials, vertices);
  const Vector3f& eye = ours.source.camera.origin;
  const Subject subject = ours.subject(materials);
  const VertexTruth truth =
      vertex_truth(subject, ours.rays, points_seen_from(subject, vertices, eye), ours.lights(),
                   {.noise = 0.01, .most_samples = 4096}, context.cache, context.work.progress());
  for (const Rival& rival :
       visibility_rivals(paper_sample.scene, our_sample.scene, context.work.progress())) {
    throw_if_interrupted();
    rival.prepare_lights(Eigen::Matrix3f::Identity());
    const std::vector<Rgb> radiance = shade_vertices(rival, vertices.size(), eye);
    const RelativeL2 error = relative_l2(radiance, truth.radiance, truth.variance);
    const AbsoluteErrors absolute = absolute_errors(radiance, truth.radiance, truth.variance);
    rows.push_back({{"what", what},
                    {"row", rival.name},
                    {"relative_l2", error.without_noise},
                    {"mean_absolute", absolute.mean},
                    {"percentile_95", absolute.percentile_95},
                    {"truth_noise", error.truth_noise}});
  }
}

double error_of(const std::vector<BenchRow>& rows, const std::string& what,
                const std::string& name) {
  for (const BenchRow& row : rows)
    if (row["what"] == what && row["row"] == name) return 100 * row["relative_l2"].get<double>();
  return 0;
}

std::string found_in_visibility(const std::vector<BenchRow>& rows) {
  std::string found;
  for (const std::string what : {"diffuse floor", "brushed floor"}) {
    const auto error = [&](const char* name) { return error_of(rows, what, name); };
    found += fmt::format(
        "{}: the paper's method errs by {:.1f}, {:.1f} and {:.1f} % with 16, 32 and 48 terms and "
        "by {:.1f} % without compression; a cap in place of the hemisphere, by {:.1f} % without "
        "compression; ours by {:.1f}, {:.1f}, {:.1f} and {:.1f} %. ",
        what, error("paper, 16 terms"), error("paper, 32 terms"), error("paper, 48 terms"),
        error("paper, no compression"), error("cap, no compression"), error("ours, 16 terms"),
        error("ours, 32 terms"), error("ours, 48 terms"), error("ours, no compression"));
  }
  return fmt::format(
      "measure relative L2 over {} vertices of the whole scene (column relative_l2, the truth's "
      "noise taken off). {}What remains without compression is of the fitted lights, the warp, "
      "the visibility model and the cosine. The column without compression has no picture: an SSDF "
      "of its own for each of 54k vertices does not fit in memory.",
      kVertices, found);
}

}  // namespace

FigureResult make_visibility_figure(const FigureContext& context) {
  const Stage ours(make_scene("teapot"), {}, context.work);
  BakeOptions one_basis = figure_bake();
  one_basis.bases = 1;
  one_basis.ladder_terms = 0;
  Stage paper(make_scene("teapot"), {.bake = one_basis}, context.work);
  const PrimaryHits hits = hits_of(paper, {216, 144});
  std::vector<Material> brushed_floor = paper.source.materials;
  brushed_floor.back() = brushed_floor.front();
  FigureResult result;
  std::vector<Image> pictures;
  for (const auto& [what, materials] : {std::pair("diffuse floor", paper.source.materials),
                                        std::pair("brushed floor", brushed_floor)}) {
    const PictureTruth truth = truth_of(paper, materials, hits, context);
    const float exposure = exposure_of(truth.picture);
    for (const int terms : {16, 32, 48, 0}) {
      const bool is_ours = terms == 0;
      MovingFrame frame = frame_of(
          paper, "",
          is_ours ? shading_options(Quality::balanced) : with_terms(paper_shading_options(), terms),
          is_ours ? &ours.prepared : nullptr);
      frame.materials = materials;
      pictures.push_back(tone_map(draw_by_pixel(paper, frame, hits).radiance, exposure));
      throw_if_interrupted();
    }
    pictures.push_back(tone_map(truth.picture.radiance, exposure));
    add_visibility_rows(paper, ours, materials, what, context, result.rows);
  }
  result.pictures = {{"fig11",
                      "From the left: the paper's method with 16, 32 and 48 terms, ours with 48 "
                      "terms, the truth. Above a diffuse floor, below a brushed one.",
                      picture_grid(pictures, 5)}};
  result.found = found_in_visibility(result.rows);
  return result;
}

FigureResult make_dish_balls_figure(const FigureContext& context) {
  Stage stage(make_scene("dish-balls"), {.local_lights = true}, context.work);
  const PrimaryHits hits = hits_of(stage, {288, 192});
  const PictureTruth truth = truth_of(stage, stage.source.materials, hits, context);
  const float exposure = exposure_of(truth.picture);
  FigureResult result;
  std::vector<Image> pictures;
  for (const auto& [name, options] : {std::pair("paper", paper_shading_options()),
                                      std::pair("fast", shading_options(Quality::fast)),
                                      std::pair("balanced", shading_options(Quality::balanced)),
                                      std::pair("accurate", shading_options(Quality::accurate))}) {
    throw_if_interrupted();
    MovingFrame frame = frame_of(stage, name, options);
    const Picture picture = draw_by_pixel(stage, frame, hits);
    BenchRow row = {{"row", name}};
    add_picture_errors(row, stage, picture, truth, hits);
    row["flip"] = flip_error(picture, truth.picture).mean;
    result.rows.push_back(std::move(row));
    if (frame.name == "paper" || frame.name == "balanced")
      pictures.push_back(tone_map(picture.radiance, exposure));
  }
  pictures.push_back(tone_map(truth.picture.radiance, exposure));
  result.pictures = {{"fig12", "One ASG as the paper has it, our defaults, the truth.",
                      picture_grid(pictures, 3)}};
  const auto error = [&](size_t row) {
    return 100 * result.rows[row]["relative_l2"].get<double>();
  };
  result.found = fmt::format(
      "have no numbers of the paper's to compare with. Relative L2 errors over the dish and the "
      "balls: {:.1f} % with the paper's settings, {:.1f} % fast, {:.1f} % balanced and {:.1f} % "
      "accurate. Balls and dish are ours, of three anisotropies from 3 to 10 with an axis each; "
      "neither the paper's meshes nor its map are public.",
      error(0), error(1), error(2), error(3));
  return result;
}

}  // namespace burnish::tools
