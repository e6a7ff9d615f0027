#include "burnish/precompute/clustered_pca_target.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/sphere/octahedral_map.h"
#include "dense_products.h"
#include "lobe_visibility_samples.h"

namespace burnish {
namespace {

using Eigen::Index;

constexpr int kFirstTerms = 48, kMostBases = 16;

int resolution_of(Index texels) {
  return static_cast<int>(std::lround(std::sqrt(static_cast<double>(texels))));
}

void check(std::span<const PcaBasis> bases, const RowMatrixf& held_out,
           const CompressionTarget& target) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::input, "compression error", what);
  };
  if (held_out.rows() < 1) refuse("there is no held-out vertex, expected at least one");
  if (bases.empty()) refuse("there is no basis, expected at least one");
  if (target.strata < 2) refuse(fmt::format("strata is {}, expected at least 2", target.strata));
  if (!(target.bandwidth > 0) || !std::isfinite(target.bandwidth))
    refuse(fmt::format("bandwidth is {}, expected a positive number", target.bandwidth));
  const int resolution = resolution_of(held_out.cols());
  if (Index{resolution} * resolution != held_out.cols())
    refuse(fmt::format("an SSDF has {} texels, expected a square number", held_out.cols()));
  for (const PcaBasis& basis : bases)
    if (basis.components.rows() != held_out.cols() || basis.terms() != bases[0].terms())
      refuse("bases and SSDFs differ in size, expected equal ones");
}

/// One basis at the directions of the measurement, and all held-out vertices in it.
struct MeasuredBasis {
  RowMatrixf coefficients;            // [vertices][terms]
  std::vector<double> squared_norms;  // [vertices] of what the coefficients stand for, and more
  Eigen::VectorXf mean;               // [directions]
  RowMatrixf components;              // [directions][terms]
};

MeasuredBasis measure_basis(const PcaBasis& basis, const RowMatrixf& encoded,
                            const std::vector<Vector3f>& directions) {
  const auto count = static_cast<Index>(directions.size());
  MeasuredBasis result{RowMatrixf(encoded.rows(), basis.terms()),
                       std::vector<double>(static_cast<std::size_t>(encoded.rows())),
                       Eigen::VectorXf::Zero(count), RowMatrixf::Zero(count, basis.terms())};
  multiply_here(encoded, {basis.mean.data(), static_cast<std::size_t>(basis.mean.size())},
                PackedFactor(basis.components), result.coefficients, result.squared_norms);
  for (Index i = 0; i < count; ++i) {
    const Vector2<float> uv = direction_to_octahedral(directions[static_cast<std::size_t>(i)]);
    const auto footprint = octahedral_footprint(uv, resolution_of(encoded.cols()));
    for (int k = 0; k < 4; ++k) {
      result.mean[i] += footprint.weight[k] * basis.mean[footprint.texel[k]];
      result.components.row(i) += footprint.weight[k] * basis.components.row(footprint.texel[k]);
    }
  }
  return result;
}

// The basis that reconstructs a vertex best from its first 1, 2, ... terms.
std::vector<std::size_t> best_bases(std::span<const MeasuredBasis> bases, Index vertex) {
  const auto terms = static_cast<std::size_t>(bases[0].coefficients.cols());
  std::vector<std::size_t> best(terms, 0);
  std::vector<double> least(terms, std::numeric_limits<double>::infinity());
  for (std::size_t b = 0; b < bases.size(); ++b) {
    double residual = bases[b].squared_norms[static_cast<std::size_t>(vertex)];
    for (std::size_t k = 0; k < terms; ++k) {
      const auto c = static_cast<double>(bases[b].coefficients(vertex, static_cast<Index>(k)));
      residual -= c * c;
      if (!(residual < least[k])) continue;
      least[k] = residual;
      best[k] = b;
    }
  }
  return best;
}

// Errors of one vertex with 1, 2, ... terms. A lobe's fraction depends on the gradient only through
// its shape across the boundary: an isotropic one has the same shape all round.
std::vector<SquaredError> measure_vertex(std::span<const MeasuredBasis> bases, Index vertex,
                                         const float* ssdf, int resolution, float amplitude_rad,
                                         const std::vector<Vector3f>& directions, float bandwidth) {
  const std::vector<std::size_t> best = best_bases(bases, vertex);
  std::vector<SquaredError> errors(best.size());
  Eigen::RowVectorXf values(static_cast<Index>(bases.size()));
  for (std::size_t i = static_cast<std::size_t>(vertex) % kEachOf; i < directions.size();
       i += kEachOf) {
    const auto row = static_cast<Index>(i);
    const double exact =
        isotropic_fraction(bandwidth, directions[i], lookup_ssdf(ssdf, resolution, directions[i]));
    for (std::size_t b = 0; b < bases.size(); ++b)
      values[static_cast<Index>(b)] = bases[b].mean[row];
    for (std::size_t k = 0; k < best.size(); ++k) {
      const auto term = static_cast<Index>(k);
      for (std::size_t b = 0; b < bases.size(); ++b)
        values[static_cast<Index>(b)] +=
            bases[b].coefficients(vertex, term) * bases[b].components(row, term);
      const float distance = decode_ssdf(values[static_cast<Index>(best[k])], amplitude_rad);
      errors[k].add(isotropic_fraction(bandwidth, directions[i], {distance, Vector3f::Zero()}),
                    exact);
    }
  }
  return errors;
}

// Appends to `best` what these bases give, if it is better.
void keep_better(std::vector<PcaBasis> bases, std::span<const double> errors, double target,
                 TargetedPca& best) {
  const auto enough =
      std::find_if(errors.begin(), errors.end(), [&](double error) { return error <= target; });
  const auto chosen =
      enough != errors.end() ? enough : std::min_element(errors.begin(), errors.end());
  if (!best.bases.empty() && !(*chosen < best.error)) return;
  const Index terms = chosen - errors.begin() + 1;
  for (PcaBasis& basis : bases) {
    basis.components.conservativeResize(Eigen::NoChange, terms);
    basis.deviations.resize(static_cast<std::size_t>(terms));
  }
  best = {std::move(bases), *chosen, enough != errors.end()};
}

}  // namespace

std::vector<double> compression_errors(std::span<const PcaBasis> bases, float amplitude_rad,
                                       const RowMatrixf& held_out,
                                       const CompressionTarget& target) {
  check(bases, held_out, target);
  const std::vector<Vector3f> directions = stratified_directions(target.strata, target.seed);
  RowMatrixf encoded = held_out;
  encode_ssdf({encoded.data(), static_cast<std::size_t>(encoded.size())}, amplitude_rad);
  std::vector<MeasuredBasis> measured(bases.size());
  tbb::parallel_for(std::size_t{0}, bases.size(), [&](std::size_t i) {
    measured[i] = measure_basis(bases[i], encoded, directions);
  });

  std::vector<std::vector<SquaredError>> each(static_cast<std::size_t>(held_out.rows()));
  tbb::parallel_for(Index{0}, held_out.rows(), [&](Index vertex) {
    each[static_cast<std::size_t>(vertex)] =
        measure_vertex(measured, vertex, held_out.row(vertex).data(),
                       resolution_of(held_out.cols()), amplitude_rad, directions, target.bandwidth);
  });
  std::vector<double> errors;
  for (std::size_t k = 0; k < static_cast<std::size_t>(bases[0].terms()); ++k) {
    SquaredError sum;
    for (const std::vector<SquaredError>& vertex : each) sum += vertex[k];
    errors.push_back(sum.relative_rms());
  }
  return errors;
}

TargetedPca train_to_target(const RowMatrixf& data, const RowMatrixf& held_out, float amplitude_rad,
                            const CompressionTarget& target, const ClusteredPcaOptions& limits,
                            const PcaProgress& progress) {
  TargetedPca best;
  const auto train = [&](const ClusteredPcaOptions& options) {
    std::vector<PcaBasis> bases = train_clustered_pca(data, options, progress);
    const std::vector<double> errors = compression_errors(bases, amplitude_rad, held_out, target);
    const int count = static_cast<int>(bases.size());
    keep_better(std::move(bases), errors, target.error, best);
    return count;
  };
  ClusteredPcaOptions options = limits;
  options.terms = std::min(limits.terms, kFirstTerms);
  int bases = train(options);
  while (!best.met && options.terms < limits.terms) {
    options.terms = std::min(limits.terms, 2 * options.terms);
    bases = train(options);
  }
  if (!best.met && limits.bases == 0 && bases < kMostBases) {
    options.bases = kMostBases;
    train(options);
  }
  return best;
}

}  // namespace burnish
