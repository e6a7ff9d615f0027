// Figures 1 and 8 of xu2013asg: a brushed metal by one ASG, and by rows of SGs.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "bench/reproduce/stage.h"
#include "common/interrupt.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/rivals/sg_rival.h"
#include "harness/tone_map.h"

namespace burnish::tools {
namespace {

/// One lobe, placed by moments, with as many lookups as the paper's; all else as `fast` has it.
ShadingOptions one_lobe_by_moments() {
  ShadingOptions options = shading_options(Quality::fast);
  options.specular = {SpecularForm::moments, 1, 1};
  options.environment_taps = kPaperLookups;
  return options;
}

/// All materials by `lobes` SGs, under the same lights as the ASG: the BRDF alone differs.
MovingFrame sg_frame(Stage& stage, const std::vector<Material>& materials, int lobes,
                     const ShadingOptions& options = sg_shading_options({}),
                     const std::string& suffix = "") {
  MovingFrame frame =
      frame_of(stage, fmt::format("{} SG{}{}", lobes, lobes == 1 ? "" : "s", suffix), options);
  for (const Material& material : materials)
    frame.prepared_materials.push_back(sg_material(material, lobes));
  return frame;
}

std::vector<MovingFrame> all_frames(Stage& stage, const std::vector<Material>& materials,
                                    const std::vector<int>& counts) {
  std::vector<MovingFrame> frames;
  for (const int lobes : counts) frames.push_back(sg_frame(stage, materials, lobes));
  const ShadingOptions one_lookup = paper_shading_options(VisibilityModel::hemisphere, 1);
  frames.push_back(frame_of(stage, "1 ASG, paper", paper_shading_options()));
  frames.push_back(frame_of(stage, "1 ASG, one lookup of the map", one_lookup));
  frames.push_back(frame_of(stage, "1 ASG by moments", one_lobe_by_moments()));
  frames.push_back(frame_of(stage, "1 ASG cut in 5, balanced", shading_options(Quality::balanced)));
  for (MovingFrame& frame : frames) frame.materials = materials;
  return frames;
}

/// A brushed metal of Ashikhmin's model. exponent = 2 / alpha^2.
Material brushed(float exponent_u, float exponent_v) {
  return {.diffuse = Rgb(0.05f, 0.045f, 0.04f),
          .specular = Rgb::Ones(),
          .model = SpecularModel::ashikhmin_shirley,
          .alpha_x = std::sqrt(2 / exponent_u),
          .alpha_y = std::sqrt(2 / exponent_v),
          .fresnel = {.normal_reflectance = Rgb(0.55f, 0.50f, 0.42f)}};
}

const BenchRow& row_of(const std::vector<BenchRow>& rows, const std::string& name) {
  for (const BenchRow& row : rows)
    if (row["row"] == name) return row;
  throw std::logic_error("no row " + name);
}

double number(const BenchRow& row, const char* column) { return row[column].get<double>(); }

/// What Fig. 1 claims, in our numbers.
/// Of rows with a column: that of the first over that of the second.
double ratio(const std::vector<BenchRow>& rows, const std::string& slow, const std::string& quick,
             const char* column) {
  return number(row_of(rows, slow), column) / number(row_of(rows, quick), column);
}

/// The target: an error no worse than that of 13 and 15 SGs, at four times their speed.
std::string verdict_of(const std::vector<BenchRow>& rows, const std::string& asg,
                       const std::string& sg13, const std::string& sg15) {
  const auto percent = [&](const std::string& name) {
    return 100 * number(row_of(rows, name), "relative_l2");
  };
  const double speed13 = ratio(rows, sg13, asg, "frame_ms");
  const double speed15 = ratio(rows, sg15, asg, "frame_ms");
  const bool met = percent(asg) <= std::min(percent(sg13), percent(sg15)) && speed13 >= 4;
  return fmt::format(
      "one ASG errs by {:.1f} % (relative L2), 13 SGs by {:.1f} % and 15 by {:.1f} %, and its "
      "frame is {:.1f} and {:.1f} times as fast, its highlights alone (column highlights_ms) "
      "{:.1f} "
      "and {:.1f} times: the target of no worse an error at 4 times the speed is {}",
      percent(asg), percent(sg13), percent(sg15), speed13, speed15,
      ratio(rows, sg13, asg, "highlights_ms"), ratio(rows, sg15, asg, "highlights_ms"),
      met ? "met" : "missed");
}

std::string found_in_lobe_counts(const std::vector<BenchRow>& rows) {
  const BenchRow& asg = row_of(rows, "1 ASG, paper");
  return fmt::format(
      "measure, with the paper's settings: {}. With ours, where the lobe is placed by its moments "
      "instead of at its peak and lights see through the ladder, SGs too: {}. Cut in five, our "
      "default, the ASG errs by {:.1f} % and is {:.1f} times as fast as 15 SGs. All run on the "
      "same kernels and lights; the SGs differ by the BRDF's lobes alone. A long lobe bends as it "
      "is warped, and a row of SGs bends with it, which one ASG cannot; the paper's dish and map "
      "may show less of that. The paper's 0.10 % is not a relative L2 error: ours of the paper's "
      "ASG is {:.3g} % squared, and {:.3g} % as the mean squared difference of the whole picture "
      "as a display shows it (0..1, sRGB). The latter is the definition that comes to the paper's "
      "order of magnitude for pictures that look as alike as theirs.",
      verdict_of(rows, "1 ASG, paper", "13 SGs", "15 SGs"),
      verdict_of(rows, "1 ASG by moments", "13 SGs, our settings", "15 SGs, our settings"),
      100 * number(row_of(rows, "1 ASG cut in 5, balanced"), "relative_l2"),
      ratio(rows, "15 SGs, our settings", "1 ASG cut in 5, balanced", "frame_ms"),
      number(asg, "squared_percent"), number(asg, "display_mse_percent"));
}

/// Whether lights and highlights are as ours have them, so that a matte dish costs what it costs
/// there.
bool has_our_settings(const std::string& name) {
  return name.ends_with("our settings") || name.ends_with("moments") || name.ends_with("balanced");
}

}  // namespace

FigureResult make_lobe_count_figure(const FigureContext& context) {
  Stage stage(make_scene("dish"), {.local_lights = true}, context.work);
  stage.source.materials[0] = brushed(22, 2222);
  const std::vector<Material>& materials = stage.source.materials;
  const PrimaryHits hits = hits_of(stage, {});
  const PictureTruth truth = truth_of(stage, materials, hits, context);
  const float exposure = exposure_of(truth.picture);
  std::vector<MovingFrame> frames = all_frames(stage, materials, {1, 3, 5, 7, 9, 11, 13, 15});
  for (const int lobes : {13, 15})
    frames.push_back(sg_frame(stage, materials, lobes, one_lobe_by_moments(), ", our settings"));
  const size_t shown_frames = frames.size();
  for (const ShadingOptions& options : {paper_shading_options(), one_lobe_by_moments()}) {
    frames.push_back(frame_of(stage, "matte", options));
    frames.back().materials[0].specular = Rgb::Zero();
  }
  const std::vector<FrameTiming> timings = measure_frames(frames, context.bench);
  const auto matte_s = [&](const std::string& name) {
    return timings[shown_frames + (has_our_settings(name) ? 1 : 0)].frame.median_s;
  };
  constexpr std::array<std::string_view, 7> shown = {"1 SG",
                                                     "5 SGs",
                                                     "15 SGs",
                                                     "1 ASG, one lookup of the map",
                                                     "1 ASG, paper",
                                                     "1 ASG by moments",
                                                     "1 ASG cut in 5, balanced"};
  FigureResult result;
  std::vector<Image> pictures;
  for (size_t i = 0; i < shown_frames; ++i) {
    throw_if_interrupted();
    const Picture picture = draw_by_pixel(stage, frames[i], hits);
    BenchRow row = {{"row", frames[i].name}};
    add_picture_errors(row, stage, picture, truth, hits);
    row["frame_ms"] = timings[i].frame.median_s * 1e3;
    row["highlights_ms"] = (timings[i].frame.median_s - matte_s(frames[i].name)) * 1e3;
    row["fps"] = 1 / timings[i].frame.median_s;
    result.rows.push_back(std::move(row));
    if (std::find(shown.begin(), shown.end(), frames[i].name) != shown.end())
      pictures.push_back(tone_map(picture.radiance, exposure));
  }
  pictures.push_back(tone_map(truth.picture.radiance, exposure));
  result.pictures = {
      {"fig1",
       "Above: 1, 5 and 15 SGs, 1 ASG with one lookup of the map. Below: 1 ASG as the "
       "paper has it, 1 by moments, our defaults, the truth.",
       picture_grid(pictures, 4)}};
  result.found = found_in_lobe_counts(result.rows);
  return result;
}

FigureResult make_ashikhmin_figure(const FigureContext& context) {
  ProceduralScene source = make_scene("sphere");
  source.camera.target = Vector3f(0, 1.1f, 0);
  source.camera.vertical_fov_deg = 26;
  Stage stage(std::move(source), {}, context.work);
  const PrimaryHits hits = hits_of(stage, {132, 132});
  FigureResult result;
  std::vector<Image> pictures;
  std::string ratios;
  const std::pair<float, float> exponents[] = {{8, 800}, {200, 22}, {20000, 200}};
  for (const auto& [u, v] : exponents) {
    const std::vector<Material> materials = {brushed(u, v), stage.source.materials[1]};
    const PictureTruth truth = truth_of(stage, materials, hits, context);
    const float exposure = exposure_of(truth.picture);
    std::vector<BenchRow> rows;
    for (MovingFrame& frame : all_frames(stage, materials, {1, 3, 5, 9, 19})) {
      throw_if_interrupted();
      const Picture picture = draw_by_pixel(stage, frame, hits);
      BenchRow row = {{"what", fmt::format("exponents {:g}, {:g}", u, v)}, {"row", frame.name}};
      add_picture_errors(row, stage, picture, truth, hits);
      rows.push_back(std::move(row));
      if (frame.name != "1 ASG, one lookup of the map")
        pictures.push_back(tone_map(picture.radiance, exposure));
    }
    pictures.push_back(tone_map(truth.picture.radiance, exposure));
    ratios += fmt::format(
        "{}{:g}, {:g}: {:.1f} % for 5 SGs, {:.1f} % for 19, {:.1f} % for one ASG as the paper has "
        "it, {:.1f} % for one placed by its moments and {:.1f} % with our defaults",
        ratios.empty() ? "" : "; ", u, v, 100 * number(row_of(rows, "5 SGs"), "relative_l2"),
        100 * number(row_of(rows, "19 SGs"), "relative_l2"),
        100 * number(row_of(rows, "1 ASG, paper"), "relative_l2"),
        100 * number(row_of(rows, "1 ASG by moments"), "relative_l2"),
        100 * number(row_of(rows, "1 ASG cut in 5, balanced"), "relative_l2"));
    result.rows.insert(result.rows.end(), rows.begin(), rows.end());
  }
  result.pictures = {
      {"fig8",
       "From the left: 1, 3, 5, 9 and 19 SGs, 1 ASG as the paper has it, 1 by "
       "moments, our defaults, the truth. A row each for exponents 8 and 800, 200 and 22, 20000 "
       "and 200.",
       picture_grid(pictures, 9)}};
  result.found =
      "measure on a ball over a floor, relative L2 of the ball's pixels by exponents: " + ratios +
      ". Each number holds the error of the whole method (warp, visibility, cosine, lookups of the "
      "map), not of the fit of D alone, so that it does not go to zero with more SGs.";
  return result;
}

}  // namespace burnish::tools
