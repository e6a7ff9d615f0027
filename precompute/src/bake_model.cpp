#include "bake_model.h"

#include <array>
#include <chrono>
#include <cmath>

#include <tbb/parallel_for.h>

#include "burnish/precompute/clustered_pca_target.h"
#include "burnish/precompute/coverage.h"
#include "burnish/precompute/lobe_visibility_error.h"
#include "burnish/visibility/ssdf.h"
#include "fnv1a.h"

namespace burnish {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// At which the ladder's error is measured, and compared with the SSDF's.
constexpr std::array<float, 6> kLadderBandwidths = {1, 2, 4, 8, 16, 32};

SsdfBasis to_ssdf_basis(const PcaBasis& basis, const BakeOptions& options) {
  SsdfBasis result;
  result.resolution = options.resolution;
  result.terms = static_cast<int>(basis.terms());
  result.amplitude_rad = static_cast<float>(options.amplitude_rad);
  result.mean.assign(basis.mean.data(), basis.mean.data() + basis.mean.size());
  result.eigen.assign(basis.components.data(), basis.components.data() + basis.components.size());
  return result;
}

}  // namespace

void VisibilityRows::resize(std::size_t vertices, const BakeOptions& options) {
  ssdfs_.resize(static_cast<Eigen::Index>(vertices),
                Eigen::Index{options.resolution} * options.resolution);
  with_coverage_ = options.ladder_terms > 0;
  coverage_.resize(with_coverage_ ? vertices * kLadderTexels : 0);
}

std::span<float> VisibilityRows::ssdf(std::size_t row) {
  return {ssdfs_.row(static_cast<Eigen::Index>(row)).data(),
          static_cast<std::size_t>(ssdfs_.cols())};
}

void VisibilityRows::count_coverage(const VisibilityMask& mask, std::size_t row) {
  if (with_coverage_)
    measure_coverage(mask, kLadderCoverageResolution,
                     std::span(coverage_).subspan(row * kLadderTexels, kLadderTexels));
}

std::span<const std::uint8_t> VisibilityRows::coverage(std::size_t first, std::size_t count) const {
  return std::span(coverage_).subspan(first * kLadderTexels, count * kLadderTexels);
}

BlockCoefficients::BlockCoefficients(std::size_t vertices, const BakeModel& model)
    : ssdf(vertices * model.terms()), ladder(vertices * model.ladder_terms()), basis_id(vertices) {}

void BlockCoefficients::write(ByteWriter& to) const {
  to.put(std::span<const float>(ssdf));
  to.put(std::span<const float>(ladder));
  to.put(std::span<const std::uint8_t>(basis_id));
}

void BlockCoefficients::read(ByteReader& from) {
  from.get(std::span(ssdf));
  from.get(std::span(ladder));
  from.get(std::span(basis_id));
}

BakeModel::BakeModel(const VisibilityRows& training, const VisibilityRows& measured,
                     const BakeOptions& options,
                     const std::function<void(std::uint64_t, std::uint64_t)>& step,
                     BakeTimings& timings)
    : options_(options) {
  const Clock::time_point start = Clock::now();
  const ClusteredPcaOptions limits{.terms = options.terms, .bases = options.bases};
  const PcaProgress progress = [&](int done, int total) {
    step(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(total));
  };
  const std::vector<PcaBasis> bases =
      options.target_error > 0 ? train_to_target(training.ssdfs(), measured.ssdfs(),
                                                 static_cast<float>(options.amplitude_rad),
                                                 {.error = options.target_error}, limits, progress)
                                     .bases
                               : train_clustered_pca(training.ssdfs(), limits, progress);
  projector_.emplace(bases);
  for (const PcaBasis& basis : bases) bases_.push_back(to_ssdf_basis(basis, options));
  timings.basis_s = seconds_since(start);
  if (options.ladder_terms > 0) {
    const Clock::time_point ladder_start = Clock::now();
    LadderOptions ladder;
    ladder.terms = options.ladder_terms;
    ladders_ = train_ladders(training.coverage(0, training.size()), ladder);
    timings.ladder_s = seconds_since(ladder_start);
  }
  Fnv1a hash;
  const auto add = [&](const auto& basis) {
    hash.add(std::span<const float>(basis.mean));
    hash.add(std::span<const float>(basis.eigen));
  };
  for (const SsdfBasis& basis : bases_) add(basis);
  for (const VisibilityLadder& ladder : ladders_) add(ladder.basis);
  fingerprint_ = hash.value();
}

void BakeModel::project(const VisibilityRows& rows, std::size_t first, BlockCoefficients& result,
                        Scratch& scratch) const {
  const std::size_t count = result.basis_id.size();
  scratch.squared_residuals.resize(count);
  projector_->project(
      rows.ssdfs().middleRows(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count)),
      result.ssdf, result.basis_id, scratch.squared_residuals, scratch.ssdf);
  if (!ladders_.empty()) project_ladder(ladders_[0], rows.coverage(first, count), result.ladder);
}

void BakeModel::measure(const VisibilityRows& rows, std::span<const VisibilityMask> masks,
                        Provenance& provenance) {
  BlockCoefficients result(rows.size(), *this);
  Scratch scratch;
  VisibilityRows encoded = rows;
  for (std::size_t i = 0; i < rows.size(); ++i)
    encode_ssdf(encoded.ssdf(i), static_cast<float>(options_.amplitude_rad));
  project(encoded, 0, result, scratch);
  const LobeVisibilityErrors found =
      measure_lobe_visibility({bases_, result.basis_id, result.ssdf, rows.ssdfs(), {}});
  provenance.residual_rms_rad = found.rms_rad;
  provenance.wrong_sign_fraction = found.wrong_sign_fraction;
  provenance.ssdf_errors = found.compression;
  if (ladders_.empty()) return;
  const LadderBasis* const ladder = &ladders_[0].basis;
  provenance.ladder_errors =
      measure_ladder({std::span(ladder, 1), {}, result.ladder, masks}, kLadderBandwidths);
  LobeVisibilityOptions wide;
  wide.bandwidths.assign(kLadderBandwidths.begin(), kLadderBandwidths.end());
  const LobeVisibilityErrors ssdf =
      measure_lobe_visibility({bases_, result.basis_id, result.ssdf, rows.ssdfs(), masks}, wide);
  ladder_crossover_ = find_ladder_crossover(ssdf.whole, provenance.ladder_errors);
}

void BakeModel::write_bases(Transfer& transfer) const {
  transfer.bases = bases_;
  for (const VisibilityLadder& ladder : ladders_) transfer.ladder_bases.push_back(ladder.basis);
  transfer.ladder_crossover = ladder_crossover_;
}

}  // namespace burnish
