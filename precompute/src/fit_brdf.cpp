// Based on: the approximation of measured BRDFs (xu2013asg, section 5.2; wang2009svbrdf). Differs:
// the distribution and the smooth factor are fitted by turns to one error, that of f cos, with the
// lobes in place, instead of lobes to a table once it is found. docs/materials.md has the figures.
#include "burnish/precompute/fit_brdf.h"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <tbb/parallel_for.h>

#include "brdf_fit/brdf_error.h"
#include "brdf_fit/brdf_samples.h"
#include "brdf_fit/distribution_fit.h"
#include "brdf_fit/smooth_factor_fit.h"
#include "burnish/formats/error.h"

namespace burnish {
namespace {

constexpr int kTableRounds = 8, kLobeRounds = 30, kStepsPerRound = 4;
// A round that lowers the squared error by less than a part of it, or than this, is the last.
constexpr double kLeastGain = 1e-3, kLeastSquare = 1e-7;
constexpr double kLeastTailGain = 0.02;
constexpr int kPairsForTable = 4;  // a cell, on average, for the table to mean something

/// Asks `progress` whether to go on. How many rounds there will be is not known: `total` bounds it.
class RoundCounter {
 public:
  RoundCounter(const Progress& progress, int total) : progress_(progress), total_(total) {}
  void next() { ask(done_++); }
  void finish() { ask(total_); }
  int done() const { return done_; }

 private:
  void ask(int done) const {
    if (progress_ && !progress_("fit BRDF", std::uint64_t(done), std::uint64_t(total_)))
      throw Cancelled();
  }

  const Progress& progress_;
  int total_, done_ = 0;
};

std::vector<float> at_pairs(const BrdfSamples& samples, const DistributionLobes& lobes) {
  const std::vector<AnisotropicGaussian<double>> mixture = lobes.mixture();
  const auto sum_at = [&](const Vector3d& half) {
    double sum = 0;
    for (const AnisotropicGaussian<double>& lobe : mixture) sum += eval(lobe, half);
    return static_cast<float>(sum);
  };
  std::vector<float> values(samples.pairs.size());
  tbb::parallel_for(size_t(0), samples.center.size(), [&](size_t cell) {
    const size_t begin = samples.begin[cell], end = samples.begin[cell + 1];
    if (begin == end) return;
    const float at_center = sum_at(samples.center[cell]);
    for (size_t i = begin; i < end; ++i) {
      const BrdfPair& pair = samples.pairs[i];
      values[i] = samples.irregular
                      ? sum_at((pair.outgoing + pair.incoming).cast<double>().normalized())
                      : at_center;
    }
  });
  return values;
}

std::vector<float> at_pairs(const BrdfSamples& samples, const CellTarget& table) {
  std::vector<float> values(samples.pairs.size());
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(table.value[static_cast<size_t>(samples.pairs[i].cell)]);
  return values;
}

/// The smooth factor beside a table of the distribution.
void fit_table(const BrdfRows& rows, RoundCounter& rounds, SmoothFactor& smooth) {
  for (int round = 0; round < kTableRounds; ++round) {
    rounds.next();
    improve_smooth_factor(rows, at_pairs(rows.samples, cell_target(rows, smooth)), smooth);
  }
}

struct Mixture {
  DistributionLobes lobes;
  SmoothFactor smooth;
  double square = 1, root_square = 1;  ///< relative errors, of f cos and of its cube root
};

bool gains_little(double before, double after) {
  return before - after < kLeastGain * after + kLeastSquare;
}

/// Whether a lobe more is worth it: by the error that is fitted to or, where that stays, by the
/// tails, which it hardly sees beside a narrow peak.
bool is_better(const Mixture& more, const Mixture& before) {
  if (!gains_little(before.square, more.square)) return true;
  return more.square <= before.square &&
         more.root_square < (1 - kLeastTailGain) * before.root_square;
}

/// Lobes and smooth factor by turns, until neither gains.
void alternate(const BrdfRows& rows, RoundCounter& rounds, Mixture& mixture) {
  for (int round = 0; round < kLobeRounds; ++round) {
    rounds.next();
    std::vector<float> values = at_pairs(rows.samples, mixture.lobes);
    improve_smooth_factor(rows, values, mixture.smooth);
    const DistributionFit fit(rows.samples, cell_target(rows, mixture.smooth));
    if (fit.empty()) break;
    fit.refine(kStepsPerRound, mixture.lobes);
    values = at_pairs(rows.samples, mixture.lobes);
    const double before = mixture.square;
    mixture.square = relative_square(rows, values, mixture.smooth);
    if (round > 0 && gains_little(before, mixture.square)) break;
  }
  const std::vector<float> values = at_pairs(rows.samples, mixture.lobes);
  improve_smooth_factor(rows, values, mixture.smooth);
  mixture.square = relative_square(rows, values, mixture.smooth);
  mixture.root_square = relative_root_square(rows, values, mixture.smooth);
}

AnisotropicGaussian<float> to_lobe(const LobeShape& shape, double amplitude) {
  const Eigen::Matrix3f axes = shape.rotation.toRotationMatrix().cast<float>();
  AnisotropicGaussian<float> lobe;
  lobe.frame = {axes.col(0), axes.col(1), axes.col(2)};
  lobe.bandwidth_x = static_cast<float>(std::exp(shape.log_bandwidth[0]));
  lobe.bandwidth_y = static_cast<float>(std::exp(shape.log_bandwidth[1]));
  lobe.amplitude = static_cast<float>(amplitude);
  return lobe;
}

Mixture diffuse_only(const BrdfRows& rows, const SmoothFactor& start) {
  const std::vector<float> values(rows.place.size(), 0.0f);
  Mixture mixture;
  mixture.smooth = start;
  improve_smooth_factor(rows, values, mixture.smooth);
  mixture.square = relative_square(rows, values, mixture.smooth);
  mixture.root_square = relative_root_square(rows, values, mixture.smooth);
  return mixture;
}

/// With the lobes' integrals adding up to 1 and S = 1 at the normal; lobes of no amplitude go.
/// `unit` is what the samples' values were divided by.
Material to_material(const Mixture& mixture, double unit) {
  auto fitted = std::make_shared<FittedSpecular>();
  const std::vector<double>& amplitudes = mixture.lobes.amplitudes;
  double total = 0;
  for (size_t k = 0; k < amplitudes.size(); ++k)
    total += amplitudes[k] * double(integral(to_lobe(mixture.lobes.shapes[k], 1)));
  const double lobe_scale = total > 0 ? 1 / total : 1;
  for (size_t k = 0; k < amplitudes.size(); ++k)
    if (amplitudes[k] > 0)
      fitted->lobes.push_back(to_lobe(mixture.lobes.shapes[k], lobe_scale * amplitudes[k]));
  if (fitted->lobes.empty()) fitted->lobes.push_back(to_lobe(LobeShape(), 0));
  const double at_normal = mixture.smooth.masking[0];
  const double masking_scale = at_normal > 0 ? 1 / at_normal : 1;
  for (const double masking : mixture.smooth.masking)
    fitted->masking.push_back(static_cast<float>(masking_scale * masking));
  const double color_scale = unit / (lobe_scale * masking_scale * masking_scale);
  for (Eigen::Index i = 0; i < mixture.smooth.color.rows(); ++i)
    fitted->color_by_difference.push_back(
        (color_scale * mixture.smooth.color.row(i)).transpose().array().cast<float>());
  Material material;
  material.diffuse = (unit * mixture.smooth.diffuse).min(1.0).cast<float>();
  material.model = SpecularModel::fitted;
  material.fitted = std::move(fitted);
  return material;
}

}  // namespace

BrdfFit fit_brdf(const MeasuredBrdf& measured, const BrdfFitOptions& options,
                 const Progress& progress) {
  check_options(options);
  const int pairs = measured.isotropic ? 1 << 17 : 1 << 18;
  BrdfSamples samples =
      sample_brdf(measured, {options.resolution, options.max_angle_rad, pairs, 0});
  const double unit = normalize_values(samples, options);
  const BrdfRows rows(samples);
  RoundCounter rounds(progress, kTableRounds + options.lobes * kLobeRounds);
  SmoothFactor start = initial_smooth_factor();
  start.max_diffuse = 1 / unit;
  Mixture mixture = diffuse_only(rows, start);
  if (samples.pairs.size() >= size_t(kPairsForTable) * size_t(samples.grid.cells()))
    fit_table(rows, rounds, start);
  for (int k = 0; k < options.lobes; ++k) {
    Mixture more = mixture;
    if (k == 0) more.smooth = start;
    const DistributionFit fit(samples, cell_target(rows, more.smooth));
    if (fit.empty()) break;
    fit.add_lobe(more.lobes);
    alternate(rows, rounds, more);
    if (!is_better(more, mixture)) break;
    mixture = more;
  }
  BrdfFit result;
  result.material = to_material(mixture, unit);
  if (const std::string wrong = domain_error(result.material); !wrong.empty())
    throw Error(ErrorKind::input, options.subject, "cannot be a material: " + wrong);
  result.error = measure_brdf_fit(measured, result.material, options);
  result.rounds = rounds.done();
  rounds.finish();
  return result;
}

}  // namespace burnish
