// Environments as lobes: xu2013asg, Figure 7.

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "bench/reproduce/data_files.h"
#include "bench/reproduce/figure.h"
#include "bench/reproduce/figure_drawing.h"
#include "burnish/precompute/fit_light.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "harness/light_picture.h"
#include "harness/tone_map.h"

namespace burnish::tools {
namespace {

constexpr int kShownLobes = 10;  ///< of the pictures, and to be matched by SGs
constexpr int kMostSgs = 24;     ///< that are tried for the match
constexpr std::array kLobeCounts = {5, kShownLobes};

/// SGs are round ASGs here, as in docs/lights.md: true ones give errors within 2 % of theirs.
LightFit fit(const Image& map, int lobes, bool isotropic) {
  throw_if_interrupted();
  LightFitOptions options;
  options.lobes = lobes;
  options.isotropic = isotropic;
  return fit_light(map, options);
}

/// How many SGs err as little as `error`, or "> kMostSgs".
std::string count_to_match(const Image& map, double error) {
  throw_if_interrupted();
  LightFitOptions options;
  options.lobes = kMostSgs;
  options.isotropic = true;
  options.target_error = error;
  const LightFit found = fit_light(map, options);
  return found.met_target ? std::to_string(found.rig.lobes.size()) : fmt::format("> {}", kMostSgs);
}

struct MapFits {
  std::string name;
  LightFitError asg, sg;  ///< of kShownLobes
  std::string match;
};

Image draw_fits(const Image& map, const LightRig& asgs, const LightRig& sgs) {
  const float exposure = picture_exposure_stops(map);
  const std::array rows = {draw_light_fit(map, asgs, exposure), draw_light_fit(map, sgs, exposure)};
  return halved(tone_map(stacked(rows), 1));
}

MapFits add_map(const std::string& path, bool is_shown, const FigureContext& context,
                FigureResult& result) {
  const Image map = load_environment(path, context.work);
  MapFits fits;
  fits.name = std::filesystem::path(path).stem().string();
  LightFit shown_asgs, shown_sgs;
  for (const int lobes : kLobeCounts) {
    const LightFit asgs = fit(map, lobes, false), sgs = fit(map, lobes, true);
    BenchRow row = {{"map", fits.name}, {"lobes", lobes}};
    row["asg_relative_l2"] = asgs.error.relative_l2;
    row["sg_relative_l2"] = sgs.error.relative_l2;
    row["asg_irradiance_relative_l2"] = asgs.error.irradiance_relative_l2;
    row["sg_irradiance_relative_l2"] = sgs.error.irradiance_relative_l2;
    if (lobes == kShownLobes) {
      shown_asgs = asgs;
      shown_sgs = sgs;
      fits.match = count_to_match(map, asgs.error.relative_l2);
      row["as_good_sgs"] = fits.match;
    }
    result.rows.push_back(row);
  }
  fits.asg = shown_asgs.error;
  fits.sg = shown_sgs.error;
  if (is_shown)
    result.pictures.push_back(
        {"lights_" + fits.name,
         fmt::format("{}: the map, {} lobes with their contours of one deviation, and the "
                     "difference. Above ASGs, below SGs.",
                     fits.name, kShownLobes),
         draw_fits(map, shown_asgs.rig, shown_sgs.rig)});
  return fits;
}

std::string describe(const MapFits& fits) {
  return fmt::format("{} {:.1f} against {:.1f} % (SGs as good: {})", fits.name,
                     100 * fits.asg.relative_l2, 100 * fits.sg.relative_l2, fits.match);
}

}  // namespace

FigureResult make_light_fit_figure(const FigureContext& context) {
  FigureResult result;
  std::vector<std::string> maps = {kStudioName};
  for (const std::string& path : data_files(context.data, "env", {".exr", ".hdr"}))
    maps.push_back(path);
  std::vector<std::string> lines;
  bool better_everywhere = true;
  std::pair<double, std::string> least = {1e9, ""}, most = {0, ""};  // SGs' error over ASGs'
  for (const std::string& map : maps) {
    // The maps of others are not ours to publish.
    const bool is_shown = map == kStudioName;
    const MapFits fits = add_map(map, is_shown, context, result);
    lines.push_back(describe(fits));
    better_everywhere = better_everywhere && fits.asg.relative_l2 <= fits.sg.relative_l2;
    const double gain = fits.sg.relative_l2 / fits.asg.relative_l2;
    least = std::min(least, {gain, fits.name});
    most = std::max(most, {gain, fits.name});
  }
  result.found = fmt::format(
      "{}. Relative L2 error of the radiance over the sphere, ten ASGs against ten SGs: {}. SGs "
      "err "
      "{:.2f} ({}) to {:.2f} ({}) times as much; most where a map has long shapes, such as strip "
      "lights or a horizon. The paper prints pictures only, so that no number is compared, and of "
      "its maps we have one. Our fit holds the irradiance as well as the radiance, and solves by "
      "Levenberg-Marquardt over cells of the sphere, not by L-BFGS-B over pixels.{}",
      better_everywhere ? "confirm it: ten ASGs err less than ten SGs on every map"
                        : "confirm it for most maps, not for all",
      fmt::join(lines, "; "), least.first, least.second, most.first, most.second,
      maps.size() > 1 ? "" : " Without --data, only the built-in studio is fitted.");
  return result;
}

}  // namespace burnish::tools
