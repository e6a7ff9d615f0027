#include "brdf_fit/brdf_error.h"

#include <cmath>
#include <limits>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "brdf_fit/brdf_samples.h"
#include "burnish/formats/error.h"

namespace burnish {

void check_options(const BrdfFitOptions& options) {
  const auto refuse = [&](const std::string& message) {
    throw Error(ErrorKind::input, options.subject, message);
  };
  if (options.lobes < 1 || options.lobes > kMaxFittedLobes)
    refuse(fmt::format("{} lobes, expected 1..{}", options.lobes, kMaxFittedLobes));
  if (options.resolution < 32 || options.resolution > 512)
    refuse(fmt::format("resolution {}, expected 32..512", options.resolution));
  if (!(options.max_angle_rad >= 0.1 && options.max_angle_rad <= kPi<double> / 2))
    refuse(fmt::format("greatest angle {} radians, expected 0.1..pi / 2", options.max_angle_rad));
}

namespace {

// Another table and another part of the sequence than a fit's: other pairs.
BrdfSamples error_samples(const MeasuredBrdf& measured, const BrdfFitOptions& options) {
  check_options(options);
  constexpr double kShift = 0.381966;
  return sample_brdf(measured,
                     {3 * options.resolution / 4, options.max_angle_rad, 1 << 17, kShift});
}

double relative(double error, double truth) {
  if (error == 0) return 0;
  return truth > 0 ? std::sqrt(error / truth) : std::numeric_limits<double>::infinity();
}

struct Squares {
  double error = 0, truth = 0, root_error = 0, root_truth = 0;

  void add(const BrdfPair& pair, const Material& material) {
    const Eigen::Array3d truth_value = pair.value.cast<double>();
    const Eigen::Array3d model = eval_brdf(material, pair.outgoing, pair.incoming).cast<double>();
    const double weight2 = double(pair.weight) * double(pair.weight);
    error += weight2 * (model - truth_value).square().sum();
    truth += weight2 * truth_value.square().sum();
    const double measure = weight2 / std::pow(double(pair.incoming.z()), 2 - 2.0 / 3);
    const Eigen::Array3d root = truth_value.pow(1.0 / 3);
    root_error += measure * (model.pow(1.0 / 3) - root).square().sum();
    root_truth += measure * root.square().sum();
  }
};

}  // namespace

BrdfError measure_brdf_fit(const MeasuredBrdf& measured, const Material& material,
                           const BrdfFitOptions& options) {
  const BrdfSamples samples = error_samples(measured, options);
  constexpr size_t kChunks = 64;  // sums have the same order at any number of threads
  std::vector<Squares> parts(kChunks);
  const size_t count = samples.pairs.size();
  tbb::parallel_for(size_t(0), kChunks, [&](size_t chunk) {
    for (size_t i = chunk * count / kChunks; i < (chunk + 1) * count / kChunks; ++i)
      parts[chunk].add(samples.pairs[i], material);
  });
  Squares sum;
  for (const Squares& part : parts) {
    sum.error += part.error;
    sum.truth += part.truth;
    sum.root_error += part.root_error;
    sum.root_truth += part.root_truth;
  }
  return {relative(sum.error, sum.truth), relative(sum.root_error, sum.root_truth)};
}

// The pairs (o, i) and (i, o) have weights that differ by the squared cosines; the best common
// value is their weighted mean.
double reciprocity_bound(const MeasuredBrdf& measured, const BrdfFitOptions& options) {
  const BrdfSamples samples = error_samples(measured, options);
  if (samples.irregular) return 0;
  double error = 0, truth = 0;
  for (const BrdfPair& pair : samples.pairs) {
    const Rgb exchanged = measured.eval(pair.incoming, pair.outgoing);
    if (!exchanged.isFinite().all()) continue;
    const double weight2 = double(pair.weight) * double(pair.weight);
    const double ratio = double(pair.outgoing.z()) / double(pair.incoming.z());
    const double other = weight2 * ratio * ratio;
    error += weight2 * other / (weight2 + other) *
             (pair.value - exchanged).cast<double>().square().sum();
    truth += weight2 * pair.value.cast<double>().square().sum() +
             other * exchanged.cast<double>().square().sum();
  }
  return relative(error, truth);
}

}  // namespace burnish
