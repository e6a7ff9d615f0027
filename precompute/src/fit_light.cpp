// Based on: light approximation by an ASG mixture (xu2013asg, Sec. 5.1; tsai2006fitting). Differs:
// a greedy start instead of local maxima alone, colours by variable projection, irradiance in the
// error. docs/lights.md has the why and the figures.
#include "burnish/precompute/fit_light.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "burnish/formats/error.h"
#include "light_fit/compact_source.h"
#include "light_fit/environment_cells.h"
#include "light_fit/flux.h"
#include "light_fit/light_fit_error.h"
#include "light_fit/lobe_pursuit.h"
#include "light_fit/reduced_environment.h"

namespace burnish {
namespace {

constexpr int kBaseRows = 24;  // of cells, before they are split where the map varies
constexpr int kNormals = 64;  // of the irradiance: it has few degrees of freedom (order 4 suffices)
// More steps between two new lobes cost time and find no better fit on the maps of docs/lights.md.
constexpr int kStepsPerLobe = 8, kFinalSteps = 60;
constexpr double kPolishGain = 1.1;  // an error this much above a target may fall to it
constexpr size_t kExtraLobes = 3;    // of the second way to a mixture; six took longer for no less
constexpr double kTolerance = 1e-4, kFinalTolerance = 1e-6;
// While lobes are added, irradiance counts less: it would draw them to broad compromises.
constexpr double kStartIrradianceShare = 0.5;

void check(const Image& environment, const LightFitOptions& options) {
  const auto refuse = [](const std::string& message) {
    throw Error(ErrorKind::input, "environment map", message);
  };
  const auto in_range = [](auto value, auto low, auto high) {
    return value >= low && value <= high;
  };
  if (!in_range(options.lobes, 1, 128))
    refuse(fmt::format("{} lobes, expected 1..128", options.lobes));
  if (!in_range(options.cells, 256, 16384))
    refuse(fmt::format("{} cells, expected 256..16384", options.cells));
  if (!in_range(options.target_error, 0.0, 1.0))
    refuse(fmt::format("target error {}, expected 0..1", options.target_error));
  if (!in_range(options.irradiance_weight, 0.0, 1e6))
    refuse(fmt::format("irradiance weight {}, expected 0..1e6", options.irradiance_weight));
  if (!in_range(options.min_bandwidth, 1e-6, 1e8) ||
      !in_range(options.max_bandwidth, options.min_bandwidth, 1e8))
    refuse(fmt::format("bandwidths {}..{}, expected a range within 1e-6..1e8",
                       options.min_bandwidth, options.max_bandwidth));
  if (environment.width < 1 || environment.height < 1 ||
      environment.pixels.size() != size_t(environment.width) * environment.height)
    refuse(fmt::format("{} x {} with {} pixels, expected width * height > 0", environment.width,
                       environment.height, environment.pixels.size()));
  for (size_t i = 0; i < environment.pixels.size(); ++i) {
    const Rgb& pixel = environment.pixels[i];
    if (!pixel.isFinite().all() || !(pixel >= 0).all())
      refuse(fmt::format("pixel ({}, {}) is ({}, {}, {}), expected finite numbers >= 0",
                         i % environment.width, i / environment.width, pixel[0], pixel[1],
                         pixel[2]));
  }
}

// Of a cell, or of its pixel where the cell is a sliver of one; unless the pixel is coarser than
// the cells that the sphere is covered with.
double resolved_solid_angle(const Image& environment, const EnvironmentCell& cell) {
  constexpr double kBaseWidth = kPi<double> / kBaseRows;
  const int row = static_cast<int>((cell.row0 + cell.row1) / 2);
  const double pixel = latlong_pixel_solid_angle(environment, row);
  return std::max(cell.solid_angle, std::min(pixel, kBaseWidth * kBaseWidth));
}

LightFitTarget make_target(const Image& environment, const std::vector<EnvironmentCell>& cells,
                           const LightFitOptions& options) {
  const auto count = static_cast<Eigen::Index>(cells.size());
  LightFitTarget target;
  target.signed_colors = options.signed_colors;
  target.scale.resize(count);
  Eigen::MatrixXd radiance(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    target.direction.push_back(cell_direction(environment, cells[i]));
    target.variance.push_back(cells[i].solid_angle / 12);
    target.resolution.push_back(resolved_solid_angle(environment, cells[i]) / 12);
    target.scale[i] = std::sqrt(cells[i].solid_angle);
    radiance.row(i) = cells[i].radiance.matrix().transpose();
  }
  // The target is exact; that of a lobe is summed over the cells.
  const FluxVectors flux = environment_flux(environment);
  Eigen::MatrixXd cosine(kNormals, count), irradiance(kNormals, 3);
  for (int n = 0; n < kNormals; ++n) {
    const Vector3d normal = fibonacci_direction(n, kNormals);
    for (Eigen::Index i = 0; i < count; ++i)
      cosine(n, i) = cell_irradiance(target.direction[i], cells[i].solid_angle, normal);
    irradiance.row(n) = irradiance_of_flux(flux, normal);
  }
  const double radiance_norm = (target.scale.asDiagonal() * radiance).norm();
  target.scale /= radiance_norm;
  target.irradiance_scale = options.irradiance_weight / irradiance.norm();
  target.irradiance = target.irradiance_scale * cosine * target.scale.cwiseInverse().asDiagonal();
  target.value.resize(count + kNormals, 3);
  target.value.topRows(count) = target.scale.asDiagonal() * radiance;
  target.value.bottomRows(kNormals) = target.irradiance_scale * irradiance;
  return target;
}

// The bandwidth of a lobe whose standard deviation is half the width of a cell, which is
// sqrt(12 variance).
double narrowest_bandwidth(double cell_variance) { return 1 / (6 * cell_variance); }

// A lobe must not hide inside a cell, where nothing is known of its width.
void widen_to_cells(const LightFitTarget& target, std::vector<LobeShape>& shapes) {
  for (LobeShape& shape : shapes) {
    const Vector3d axis = shape.rotation * Vector3d::UnitZ();
    size_t nearest = 0;
    double closest = -2;
    for (size_t i = 0; i < target.direction.size(); ++i)
      if (target.direction[i].dot(axis) > closest) {
        closest = target.direction[i].dot(axis);
        nearest = i;
      }
    shape.log_bandwidth =
        shape.log_bandwidth.cwiseMin(std::log(narrowest_bandwidth(target.resolution[nearest])));
  }
}

Rgb to_color(const Eigen::Array3d& color) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return color.min(kLargest).max(-kLargest).cast<float>();
}

EnvironmentLobe to_light(const LobeShape& shape, const Eigen::Array3d& color) {
  const Eigen::Matrix3f axes = shape.rotation.toRotationMatrix().cast<float>();
  EnvironmentLobe light;
  light.lobe.frame = {axes.col(0), axes.col(1), axes.col(2)};
  light.lobe.bandwidth_x = static_cast<float>(std::exp(shape.log_bandwidth[0]));
  light.lobe.bandwidth_y = static_cast<float>(std::exp(shape.log_bandwidth[1]));
  light.color = to_color(color);
  return light;
}

// The lights of given shapes. The irradiance of each shape is now exact: summed over cells, that of
// a lobe as narrow as they are is a few per cent off.
std::vector<EnvironmentLobe> color_shapes(const LightFitTarget& target,
                                          const std::vector<LobeShape>& shapes) {
  std::vector<EnvironmentLobe> lights;
  Eigen::MatrixXd samples = sample_lobes(target, shapes);
  for (size_t i = 0; i < shapes.size(); ++i) {
    lights.push_back(to_light(shapes[i], Eigen::Array3d::Ones()));
    FluxVectors flux;
    append_lobe_flux(lights[i], flux);
    for (int n = 0; n < kNormals; ++n)
      samples(target.cells() + n, i) =
          target.irradiance_scale * irradiance_of_flux(flux, fibonacci_direction(n, kNormals))[0];
  }
  const LobeColors colors = solve_colors(target, samples);
  for (size_t i = 0; i < shapes.size(); ++i)
    lights[i].color = to_color(colors.color.row(i).transpose().array());
  return lights;
}

// The index of the shape without which the others, with their best colours, fit best.
std::ptrdiff_t least_missed(const LightFitTarget& target, const std::vector<LobeShape>& shapes) {
  const Eigen::MatrixXd samples = sample_lobes(target, shapes);
  std::ptrdiff_t least = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    Eigen::MatrixXd rest(samples.rows(), samples.cols() - 1);
    rest << samples.leftCols(k), samples.rightCols(samples.cols() - 1 - k);
    const double error = (target.value - rest * solve_colors(target, rest).color).squaredNorm();
    if (error < lowest) {
      lowest = error;
      least = k;
    }
  }
  return least;
}

// Fits shapes to a target. `go_on` is asked at every step, with the number of lobes; a step that is
// denied throws Cancelled.
class ShapeFit {
 public:
  ShapeFit(const LightFitTarget& target, const LobeLimits& limits,
           const std::function<bool(size_t)>& go_on)
      : target_(target), start_(target), limits_(limits), go_on_(go_on) {
    start_.irradiance *= kStartIrradianceShare;
    start_.value.bottomRows(kNormals) *= kStartIrradianceShare;
  }

  // Adds lobes one by one where the residual calls for one, improving all of them each time, then
  // polishes, and takes the better of this and of what grow_and_prune() makes of it. Ends early
  // when `good_enough(shapes)`, which is asked after each lobe and, when it says yes, once more
  // after polishing.
  std::vector<LobeShape> run(
      size_t count, const std::function<bool(const std::vector<LobeShape>&, double)>& good_enough) {
    const LobeDictionary dictionary(start_, limits_);
    std::vector<LobeShape> shapes;
    while (shapes.size() < count) {
      shapes.push_back(dictionary.propose(mixture_residual(start_, shapes)));
      refine(start_, kStepsPerLobe, kTolerance, shapes);
      if (shapes.size() == count || !good_enough(shapes, kPolishGain)) continue;
      std::vector<LobeShape> polished = shapes;
      polish(polished);
      if (good_enough(polished, 1)) return polished;
    }
    std::vector<LobeShape> pruned = shapes;
    polish(shapes);
    grow_and_prune(dictionary, pruned);
    return squared_error(pruned) < squared_error(shapes) ? pruned : shapes;
  }

  int iterations() const { return iterations_; }

 private:
  void polish(std::vector<LobeShape>& shapes) {
    refine(target_, kFinalSteps, kFinalTolerance, shapes);
    widen_to_cells(target_, shapes);
  }

  // Another way to as many lobes: a few more are added, then those that are missed least go. It
  // leads to another local minimum.
  void grow_and_prune(const LobeDictionary& dictionary, std::vector<LobeShape>& shapes) {
    const size_t count = shapes.size();
    while (shapes.size() < count + kExtraLobes) {
      shapes.push_back(dictionary.propose(mixture_residual(start_, shapes)));
      refine(start_, kStepsPerLobe, kTolerance, shapes);
    }
    while (shapes.size() > count) {
      shapes.erase(shapes.begin() + least_missed(target_, shapes));
      refine(target_, kStepsPerLobe, kTolerance, shapes);
    }
    polish(shapes);
  }

  // Irradiance counts less here, too: both candidates were polished with all of its weight.
  double squared_error(const std::vector<LobeShape>& shapes) const {
    return mixture_residual(start_, shapes).squaredNorm();
  }

  void refine(const LightFitTarget& goal, int steps, double tolerance,
              std::vector<LobeShape>& shapes) {
    const size_t count = shapes.size();
    const std::function<bool()> keep_going = [&] { return go_on_(count); };
    iterations_ += refine_lobes(goal, limits_, steps, tolerance, keep_going, shapes);
    if (!keep_going()) throw Cancelled();
  }

  const LightFitTarget& target_;
  LightFitTarget start_;
  LobeLimits limits_;
  const std::function<bool(size_t)>& go_on_;
  int iterations_ = 0;
};

// The lobes of a map without compact sources, in its units. `good_enough` is asked of the lights.
std::vector<EnvironmentLobe> fit_mixture(
    const Image& environment, const LightFitOptions& options, size_t count,
    const std::function<bool(const std::vector<EnvironmentLobe>&, double)>& good_enough,
    const std::function<bool(size_t)>& go_on, int& iterations) {
  const std::vector<EnvironmentCell> cells =
      environment_cells(environment, kBaseRows, options.cells);
  const bool black = std::all_of(cells.begin(), cells.end(),
                                 [](const auto& cell) { return cell.radiance.sum() == 0; });
  if (black) return {};
  const LightFitTarget target = make_target(environment, cells, options);
  const double finest = *std::min_element(target.resolution.begin(), target.resolution.end());
  const LobeLimits limits{
      options.min_bandwidth,
      std::clamp(narrowest_bandwidth(finest), options.min_bandwidth, options.max_bandwidth),
      options.isotropic};
  ShapeFit fit(target, limits, go_on);
  const auto shapes = fit.run(count, [&](const std::vector<LobeShape>& found, double slack) {
    return options.target_error > 0 && good_enough(color_shapes(target, found), slack);
  });
  iterations += fit.iterations();
  return color_shapes(target, shapes);
}

// A compact source as a round lobe of the same energy: such a narrow lobe's integral is that of the
// geometric mean of its bandwidths.
void make_round(EnvironmentLobe& light) {
  const float bandwidth = std::sqrt(light.lobe.bandwidth_x) * std::sqrt(light.lobe.bandwidth_y);
  light.lobe.bandwidth_x = light.lobe.bandwidth_y = bandwidth;
}

// In the map's units, those of no colour left out, by falling power.
LightRig make_rig(std::vector<EnvironmentLobe> lobes, float unit) {
  for (EnvironmentLobe& light : lobes) light.color = to_color(light.color.cast<double>() * unit);
  std::erase_if(lobes, [](const EnvironmentLobe& light) { return (light.color == 0).all(); });
  const auto power = [](const EnvironmentLobe& light) {
    return std::abs(luminance(light.color)) * integral(light.lobe);
  };
  std::stable_sort(lobes.begin(), lobes.end(),
                   [&](const auto& a, const auto& b) { return power(a) > power(b); });
  LightRig rig;
  rig.lobes = std::move(lobes);
  return rig;
}

}  // namespace

LightFit fit_light(const Image& environment, const LightFitOptions& options,
                   const Progress& progress) {
  check(environment, options);
  LightFit fit;
  const ReducedEnvironment map = reduce_environment(environment);
  float peak = 0;
  for (const Rgb& pixel : map.image.pixels) peak = std::max(peak, pixel.maxCoeff());
  if (peak == 0) return fit;

  // In units of the peak, so that squares neither overflow nor vanish.
  Image remainder = map.image;
  for (Rgb& pixel : remainder.pixels) pixel /= peak;
  std::vector<EnvironmentLobe> lobes;
  const size_t wanted = options.lobes;
  while (lobes.size() < wanted / 2) {
    auto source = take_compact_source(remainder, options.max_bandwidth);
    if (!source) break;
    if (options.isotropic) make_round(*source);
    lobes.push_back(*source);
  }
  const size_t taken = lobes.size();
  const std::function<bool(size_t)> go_on = [&](size_t placed) {
    return !progress || progress("fit lights", std::min(taken + placed, wanted), wanted);
  };
  if (!go_on(0)) throw Cancelled();
  const auto rig_with = [&](const std::vector<EnvironmentLobe>& mixture) {
    std::vector<EnvironmentLobe> all = lobes;
    all.insert(all.end(), mixture.begin(), mixture.end());
    return make_rig(std::move(all), peak);
  };
  const auto good_enough = [&](const std::vector<EnvironmentLobe>& mixture, double slack) {
    return radiance_error(map, rig_with(mixture)) <= slack * options.target_error;
  };
  std::vector<EnvironmentLobe> mixture;
  if (taken < wanted)
    mixture = fit_mixture(remainder, options, wanted - taken, good_enough, go_on, fit.iterations);
  fit.rig = rig_with(mixture);
  fit.error = measure_light_fit(map, fit.rig);
  fit.met_target = options.target_error == 0 || fit.error.relative_l2 <= options.target_error;
  return fit;
}

}  // namespace burnish
