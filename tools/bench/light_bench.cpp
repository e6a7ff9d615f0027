#include <algorithm>
#include <filesystem>
#include <memory>
#include <random>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "bench.h"
#include "burnish/light/prefiltered_environment.h"
#include "burnish/precompute/fit_light.h"
#include "burnish/shading/shade.h"
#include "common/environment_input.h"
#include "common/interrupt.h"
#include "common/options.h"
#include "harness/environment_truth.h"
#include "harness/parallel_prefilter.h"
#include "stations.h"

namespace burnish::tools {
namespace {

constexpr int kManyLookups = 32;  // as many as lobes of a ratio of 16 can use

struct Options {
  std::vector<std::string> maps;
  std::vector<int> lobes = {5, 10, 14, 20};
  int match_limit = 0;
  int directions = 32;
  std::vector<int> taps = {1, 2, 4, 8, 16, 32, 64};
  BenchOptions bench;
};

std::string name_of(const std::string& map) { return std::filesystem::path(map).stem().string(); }

LightFitOptions fit_options(int lobes, bool isotropic) {
  LightFitOptions options;
  options.lobes = lobes;
  options.isotropic = isotropic;
  return options;
}

BenchRow measure_fit(const std::string& map, const Image& image, int lobes, bool isotropic,
                     const Options& options) {
  LightFit fit;
  const Timing timing =
      measure(options.bench, [&] { fit = fit_light(image, fit_options(lobes, isotropic)); });
  BenchRow row = {{"what", "fit"}, {"map", name_of(map)}, {"kind", isotropic ? "SG" : "ASG"}};
  row["lobes"] = lobes;
  add_timing(row, timing, options.bench);
  row["relative_l2"] = fit.error.relative_l2;
  row["irradiance_relative_l2"] = fit.error.irradiance_relative_l2;
  return row;
}

/// The fewest spherical Gaussians that err as little as some anisotropic ones; 0: more than
/// `limit`.
int matching_spherical(const Image& image, double error, int least, int limit) {
  const auto is_enough = [&](int lobes) {
    throw_if_interrupted();
    return fit_light(image, fit_options(lobes, true)).error.relative_l2 <= error;
  };
  int too_few = least - 1, enough = least;
  while (!is_enough(enough)) {
    too_few = enough;
    if (enough == limit) return 0;
    enough = std::min(limit, enough + std::max(1, enough / 2));
  }
  while (enough - too_few > 1) {
    const int middle = (too_few + enough) / 2;
    (is_enough(middle) ? enough : too_few) = middle;
  }
  return enough;
}

void measure_fits(const std::string& map, const Image& image, const Options& options,
                  std::vector<BenchRow>& rows) {
  for (const int lobes : options.lobes)
    for (const bool isotropic : {false, true}) {
      rows.push_back(measure_fit(map, image, lobes, isotropic, options));
      if (isotropic || lobes > options.match_limit) continue;
      const double error = rows.back()["relative_l2"];
      const int match = matching_spherical(image, error, lobes, options.match_limit);
      rows.back()["as_good_sgs"] = match > 0 ? BenchRow(match) : BenchRow("more");
    }
}

Frame<double> random_frame(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  const Eigen::Matrix3d axes = turn.normalized().toRotationMatrix();
  return {axes.col(0), axes.col(1), axes.col(2)};
}

/// A lobe with a ratio and a geometric mean of its bandwidths, in a random frame.
AnisotropicGaussian<double> random_lobe(double bandwidth, double anisotropy,
                                        std::mt19937_64& random) {
  AnisotropicGaussian<double> lobe;
  lobe.frame = random_frame(random);
  lobe.bandwidth_x = bandwidth / std::sqrt(anisotropy);
  lobe.bandwidth_y = bandwidth * std::sqrt(anisotropy);
  return lobe;
}

AnisotropicGaussian<float> to_float(const AnisotropicGaussian<double>& lobe) {
  AnisotropicGaussian<float> result;
  result.frame = {lobe.frame.x.cast<float>(), lobe.frame.y.cast<float>(),
                  lobe.frame.z.cast<float>()};
  result.bandwidth_x = static_cast<float>(lobe.bandwidth_x);
  result.bandwidth_y = static_cast<float>(lobe.bandwidth_y);
  return result;
}

Eigen::Array3d mean_radiance(const Image& image) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (int y = 0; y < image.height; ++y) {
    const double solid_angle = latlong_pixel_solid_angle(image, y);
    for (int x = 0; x < image.width; ++x) sum += solid_angle * image.at(x, y).cast<double>();
  }
  return sum / (4 * kPi<double>);
}

/// Errors of filtered lookups against integrals, relative to the map's mean radiance: root mean
/// square over directions and channels, and the worst; and relative to the lobes' own root mean
/// square, which says more where a sun outshines the mean.
void measure_filter(const std::string& map, const Image& image,
                    const PrefilteredEnvironment& filtered, const Options& options,
                    std::vector<BenchRow>& rows) {
  constexpr std::uint64_t kSeed = 20131107;
  const Eigen::Array3d mean = mean_radiance(image);
  const auto count = static_cast<std::size_t>(options.directions);
  for (const double bandwidth : {1.0, 4.0, 16.0, 64.0, 256.0, 1024.0, 1e4, 1e5})
    for (const double anisotropy : {1.0, 4.0, 16.0, 100.0}) {
      throw_if_interrupted();
      std::mt19937_64 random(kSeed);
      std::vector<AnisotropicGaussian<double>> lobes(count);
      for (auto& lobe : lobes) lobe = random_lobe(bandwidth, anisotropy, random);
      std::vector<Eigen::Array3d> truth(count);
      tbb::parallel_for(std::size_t{0}, count,
                        [&](std::size_t i) { truth[i] = integrate_environment(image, lobes[i]); });
      BenchRow row = {{"what", "filter"}, {"map", name_of(map)}};
      row["bandwidth"] = bandwidth;
      row["anisotropy"] = anisotropy;
      const auto add = [&](int taps, const std::string& suffix) {
        double squares = 0, worst = 0, own_squares = 0;
        for (std::size_t i = 0; i < count; ++i) {
          const Eigen::Array3d found =
              eval_prefiltered(filtered, to_float(lobes[i]), taps).cast<double>();
          const Eigen::Array3d error = ((found - truth[i]) / mean).abs();
          squares += error.square().mean();
          own_squares += (truth[i] / mean).square().mean();
          worst = std::max(worst, error.maxCoeff());
        }
        row["rms" + suffix] = std::sqrt(squares / static_cast<double>(count));
        if (!suffix.empty()) return;
        row["worst"] = worst;
        row["relative_rms"] = std::sqrt(squares / own_squares);
      };
      add(kManyLookups, "");
      if (anisotropy > 1)
        for (const int taps : options.taps) add(taps, fmt::format("_{}_taps", taps));
      rows.push_back(row);
    }
}

/// Lobes as a structure of arrays.
struct LobeArrays {
  std::vector<float> x[3], z[3], bandwidth_x, bandwidth_y;

  void add(const AnisotropicGaussian<float>& lobe) {
    for (int i = 0; i < 3; ++i) {
      x[i].push_back(lobe.frame.x[i]);
      z[i].push_back(lobe.frame.z[i]);
    }
    bandwidth_x.push_back(lobe.bandwidth_x);
    bandwidth_y.push_back(lobe.bandwidth_y);
  }
  batch::AnisotropicGaussians spans() const {
    return {{x[0], x[1], x[2]}, {z[0], z[1], z[2]}, bandwidth_x, bandwidth_y, {}};
  }
};

/// Time of one of many lookups at once, and one by one, on this thread.
void measure_lookups(const std::string& map, const PrefilteredEnvironment& filtered,
                     const Options& options, std::vector<BenchRow>& rows) {
  constexpr std::uint64_t kSeed = 20131107;
  constexpr std::size_t kLobes = 1024;
  constexpr double kBandwidth = 100;
  for (const double anisotropy : {1.0, 4.0, 100.0}) {
    std::mt19937_64 random(kSeed);
    std::vector<AnisotropicGaussian<float>> lobes(kLobes);
    LobeArrays arrays;
    for (auto& lobe : lobes)
      arrays.add(lobe = to_float(random_lobe(kBandwidth, anisotropy, random)));
    std::vector<float> red(kLobes), green(kLobes), blue(kLobes);
    for (const int taps : options.taps) {
      const Timing batch = measure(options.bench, [&] {
        batch::eval_prefiltered(filtered, arrays.spans(), taps, {red, green, blue});
      });
      const Timing single = measure(options.bench, [&] {
        for (std::size_t i = 0; i < kLobes; ++i)
          red[i] = eval_prefiltered(filtered, lobes[i], taps).x();
      });
      BenchRow row = {{"what", "lookup"}, {"map", name_of(map)}};
      row["bandwidth"] = kBandwidth;
      row["anisotropy"] = anisotropy;
      row["taps"] = taps;
      row["batch_ns"] = batch.median_s * 1e9 / kLobes;
      row["single_ns"] = single.median_s * 1e9 / kLobes;
      rows.push_back(row);
    }
  }
}

BenchRow measure_prefilter(const std::string& map, const Image& image, const Options& options,
                           PrefilteredEnvironment& filtered) {
  const Timing timing = measure(options.bench, [&] { filtered = prefilter_in_parallel(image); });
  BenchRow row = {{"what", "prefilter"}, {"map", name_of(map)}};
  row["width"] = image.width;
  row["height"] = image.height;
  add_timing(row, timing, options.bench);
  return row;
}

void run(const Options& options) {
  require_writable(std::vector{options.bench.json, options.bench.csv});
  Work work(options.bench.common());
  std::vector<BenchRow> rows;
  const std::vector<std::string> maps =
      options.maps.empty() ? std::vector<std::string>{kStudioName} : options.maps;
  for (const std::string& map : maps) {
    const Image image = load_environment(map, work);
    if (!options.lobes.empty()) measure_fits(map, image, options, rows);
    PrefilteredEnvironment filtered;
    rows.push_back(measure_prefilter(map, image, options, filtered));
    measure_lookups(map, filtered, options, rows);
    if (options.directions > 0) measure_filter(map, image, filtered, options, rows);
  }
  report_bench("light", rows, options.bench, work);
}

/// "5,10" as counts; "0" as none.
bool parse_counts(const std::string& found, int most, std::vector<int>& counts) {
  const auto numbers = parse_numbers(found);
  if (!numbers) return false;
  counts.clear();
  for (const double number : *numbers) {
    if (!(number >= 0 && number <= most) || number != std::floor(number)) return false;
    if (number > 0) counts.push_back(static_cast<int>(number));
  }
  return true;
}

}  // namespace

std::function<void()> declare_light_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->bench.repeat = 3;
  app.add_option("MAP", options->maps,
                 "lat-long environment maps, .exr or .hdr, or 'studio' (default) for the built-in "
                 "one")
      ->option_text("MAP...");
  add_parsed(app, "--lobes", "N,N,...", "lobes to fit, 0 for no fits (default 5,10,14,20)",
             "counts in 0..128", [options](const std::string& found) {
               return parse_counts(found, 128, options->lobes);
             });
  add_number(app, "--match", "N", options->match_limit, {0, 128},
             "look for the number of SGs, up to this, that err as little as the ASGs; 0 not to");
  add_number(app, "--directions", "N", options->directions, {0, 1 << 16},
             "lobes of each shape that filtered lookups are compared with integrals for, 0 for "
             "none");
  add_parsed(app, "--taps", "N,N,...", "taps of filtered lookups (default 1,2,4,8,16,32,64)",
             "counts in 0..64", [options](const std::string& found) {
               return parse_counts(found, 64, options->taps);
             });
  add_bench_options(app, options->bench);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
