#include "burnish/precompute/lobe_visibility_error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/coverage.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/visibility/ssdf.h"
#include "lobe_visibility_samples.h"

namespace burnish {
namespace {

void check(const CompressedSsdfs& vertices, const LobeVisibilityOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::input, "lobe visibility", what);
  };
  const auto count = static_cast<std::size_t>(vertices.ssdfs.rows());
  if (count == 0) refuse("there is no vertex, expected at least one");
  if (vertices.bases.empty()) refuse("there is no basis, expected at least one");
  const SsdfBasis& basis = vertices.bases[0];
  const auto check_size = [&](const char* what, std::size_t size, std::size_t expected) {
    if (size != expected) refuse(fmt::format("there are {} {}, expected {}", size, what, expected));
  };
  check_size(
      "texels of an SSDF", static_cast<std::size_t>(vertices.ssdfs.cols()),
      static_cast<std::size_t>(basis.resolution) * static_cast<std::size_t>(basis.resolution));
  check_size("basis ids", vertices.basis_id.size(), count);
  check_size("coefficients", vertices.coefficients.size(),
             count * static_cast<std::size_t>(basis.terms));
  if (!vertices.masks.empty()) check_size("masks", vertices.masks.size(), count);
  for (const std::uint8_t id : vertices.basis_id)
    if (id >= vertices.bases.size())
      refuse(fmt::format("basis id is {}, expected less than {}", id, vertices.bases.size()));
  if (options.strata < 2) refuse(fmt::format("strata is {}, expected at least 2", options.strata));
  for (const float bandwidth : options.bandwidths)
    if (!(bandwidth > 0) || !std::isfinite(bandwidth))
      refuse(fmt::format("bandwidth is {}, expected a positive number", bandwidth));
}

/// Texels of a map that matter to a lobe, and their shares of it.
struct LobeTexels {
  std::vector<std::uint32_t> texel;
  std::vector<float> share;
};

/// The lobes of one bandwidth around some directions, on the coarsest map whose texels are small
/// against them: a texel's edge is at most .23 of the lobe's standard deviation, and what the
/// midpoint rule makes of a visible share is off by a 24th of that squared.
class LobeBank {
 public:
  LobeBank(float bandwidth, int mask_resolution, std::span<const Vector3f> directions)
      : resolution_(kCoarsest) {
    while (resolution_ < mask_resolution &&
           static_cast<float>(resolution_ * resolution_) < kCoarsest * kCoarsest / 8 * bandwidth)
      resolution_ *= 2;
    resolution_ = std::min(resolution_, mask_resolution);
    std::vector<Vector3f> texels;
    for (int i = 0; i < resolution_ * resolution_; ++i)
      texels.push_back(
          octahedral_texel_direction<double>(i % resolution_, i / resolution_, resolution_)
              .cast<float>());
    lobes_.resize(directions.size());
    tbb::parallel_for(std::size_t{0}, directions.size(), [&](std::size_t i) {
      lobes_[i] = find_texels(bandwidth, directions[i], texels);
    });
  }

  int resolution() const { return resolution_; }

  double visible_fraction(std::size_t direction, std::span<const std::uint8_t> coverage) const {
    const LobeTexels& lobe = lobes_[direction];
    float sum = 0;
    for (std::size_t i = 0; i < lobe.texel.size(); ++i)
      sum += lobe.share[i] * static_cast<float>(coverage[lobe.texel[i]]);
    return static_cast<double>(sum) / kFullCoverage;
  }

 private:
  static constexpr int kCoarsest = 64;

  // What is left out beyond the reach is 1e-5 of the lobe.
  static LobeTexels find_texels(float bandwidth, const Vector3f& direction,
                                const std::vector<Vector3f>& texels) {
    const float reach = std::log(1e5f) / (2 * bandwidth);
    LobeTexels lobe;
    double sum = 0;
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const float rise = (texels[i] - direction).squaredNorm() / 2;  // 1 - cos, exact when small
      if (rise > reach) continue;
      lobe.texel.push_back(static_cast<std::uint32_t>(i));
      lobe.share.push_back(std::exp(-2 * bandwidth * rise));
      sum += static_cast<double>(lobe.share.back());
    }
    for (float& share : lobe.share) share = static_cast<float>(static_cast<double>(share) / sum);
    return lobe;
  }

  int resolution_;
  std::vector<LobeTexels> lobes_;  // [directions]
};

/// Sums over the directions and texels of one vertex, or of all.
struct Sums {
  std::vector<SquaredError> compression, whole;  // [bandwidths]
  double squared_rad = 0;
  std::uint64_t wrong_signs = 0;

  explicit Sums(std::size_t bandwidths) : compression(bandwidths), whole(bandwidths) {}

  void operator+=(const Sums& other) {
    for (std::size_t i = 0; i < compression.size(); ++i) {
      compression[i] += other.compression[i];
      whole[i] += other.whole[i];
    }
    squared_rad += other.squared_rad;
    wrong_signs += other.wrong_signs;
  }
};

// What lobes make of a distance.
double held(float distance) {
  return std::clamp(static_cast<double>(distance), -kPi<double> / 2, kPi<double> / 2);
}

void add_texels(const SsdfBasis& basis, const float* coefficients, const float* ssdf, Sums& sums) {
  const auto texels = static_cast<Eigen::Index>(basis.mean.size());
  const Eigen::Map<const RowMatrixf> eigen(basis.eigen.data(), texels, basis.terms);
  const Eigen::Map<const Eigen::VectorXf> weights(coefficients, basis.terms);
  const Eigen::VectorXf sum =
      eigen * weights + Eigen::Map<const Eigen::VectorXf>(basis.mean.data(), texels);
  for (Eigen::Index i = 0; i < texels; ++i) {
    const double value = held(decode_ssdf(sum[i], basis.amplitude_rad));
    const double exact = held(ssdf[i]);
    sums.squared_rad += (value - exact) * (value - exact);
    sums.wrong_signs += value * exact < 0;
  }
}

Sums measure_vertex(const CompressedSsdfs& vertices, std::size_t vertex,
                    const LobeVisibilityOptions& options, std::span<const Vector3f> directions,
                    std::span<const LobeBank> banks) {
  const SsdfBasis& basis = vertices.bases[vertices.basis_id[vertex]];
  const float* coefficients =
      vertices.coefficients.data() + vertex * static_cast<std::size_t>(basis.terms);
  const float* ssdf = vertices.ssdfs.row(static_cast<Eigen::Index>(vertex)).data();
  Sums sums(options.bandwidths.size());
  add_texels(basis, coefficients, ssdf, sums);
  std::vector<std::vector<std::uint8_t>> coverages;
  for (const LobeBank& bank : banks) {
    auto& coverage = coverages.emplace_back(static_cast<std::size_t>(bank.resolution()) *
                                            static_cast<std::size_t>(bank.resolution()));
    measure_coverage(vertices.masks[vertex], bank.resolution(), coverage);
  }
  for (std::size_t i = vertex % kEachOf; i < directions.size(); i += kEachOf) {
    const SsdfSample exact = lookup_ssdf(ssdf, basis.resolution, directions[i]);
    const SsdfSample sample = lookup_ssdf(basis, coefficients, basis.terms, directions[i]);
    for (std::size_t b = 0; b < options.bandwidths.size(); ++b) {
      const double value = isotropic_fraction(options.bandwidths[b], directions[i], sample);
      sums.compression[b].add(value,
                              isotropic_fraction(options.bandwidths[b], directions[i], exact));
      if (!banks.empty()) sums.whole[b].add(value, banks[b].visible_fraction(i, coverages[b]));
    }
  }
  return sums;
}

}  // namespace

double exact_visible_fraction(const VisibilityMask& mask, const Vector3f& direction,
                              double bandwidth) {
  const Vector3d axis = direction.cast<double>();
  double visible = 0, all = 0;
  for (int y = 0; y < mask.resolution; ++y)
    for (int x = 0; x < mask.resolution; ++x) {
      const Vector3d texel = octahedral_texel_direction<double>(x, y, mask.resolution);
      const double value = std::exp(-bandwidth * (texel - axis).squaredNorm());
      all += value;
      if (mask.visible(x, y)) visible += value;
    }
  return visible / all;
}

LobeVisibilityErrors measure_lobe_visibility(const CompressedSsdfs& vertices,
                                             const LobeVisibilityOptions& options) {
  check(vertices, options);
  const std::vector<Vector3f> directions = stratified_directions(options.strata, options.seed);
  std::vector<LobeBank> banks;
  if (!vertices.masks.empty())
    for (const float bandwidth : options.bandwidths)
      banks.emplace_back(bandwidth, vertices.masks[0].resolution, directions);

  const auto count = static_cast<std::size_t>(vertices.ssdfs.rows());
  std::vector<Sums> each(count, Sums(options.bandwidths.size()));
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t vertex) {
    each[vertex] = measure_vertex(vertices, vertex, options, directions, banks);
  });
  Sums sums(options.bandwidths.size());
  for (const Sums& vertex : each) sums += vertex;

  LobeVisibilityErrors result;
  for (std::size_t b = 0; b < options.bandwidths.size(); ++b) {
    const auto bandwidth = static_cast<double>(options.bandwidths[b]);
    result.compression.push_back({bandwidth, sums.compression[b].relative_rms()});
    if (!banks.empty()) result.whole.push_back({bandwidth, sums.whole[b].relative_rms()});
  }
  const double texels = static_cast<double>(vertices.ssdfs.size());
  result.rms_rad = std::sqrt(sums.squared_rad / texels);
  result.wrong_sign_fraction = static_cast<double>(sums.wrong_signs) / texels;
  return result;
}

}  // namespace burnish
