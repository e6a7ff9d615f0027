#include "tradeoff/preset_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace burnish::tools {
namespace {

double geometric_mean(const std::vector<double>& values, const std::vector<double>* units) {
  double sum = 0;
  for (size_t i = 0; i < values.size(); ++i)
    sum += std::log(units ? values[i] / (*units)[i] : values[i]);
  return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace

std::vector<PresetCandidate> preset_candidates() {
  std::vector<PresetCandidate> candidates;
  for (const int taps : {1, 3, 5, 7, 9})
    for (const int lookups : {1, 3, 5, 7, 9, 15})
      for (const int reach : {2, 8}) {
        PresetCandidate candidate;
        candidate.name = fmt::format("taps {}, map taps {}, reach {}", taps, lookups, reach);
        ShadingOptions& shading = candidate.shading;
        shading.specular.taps = taps;
        // A tail apart costs as much as a lobe's parts, and shows only beside them.
        shading.specular.lobes = taps == 1 ? 1 : kTailLobes;
        shading.environment_taps = lookups;
        shading.ladder_reach = static_cast<float>(reach);
        candidates.push_back(candidate);
      }
  return candidates;
}

std::vector<PresetMean> preset_means(const std::vector<PresetCandidate>& candidates) {
  if (candidates.empty()) return {};
  std::vector<double> cheapest = candidates.front().frame_ms;
  for (const PresetCandidate& candidate : candidates)
    for (size_t i = 0; i < cheapest.size(); ++i)
      cheapest[i] = std::min(cheapest[i], candidate.frame_ms[i]);
  std::vector<PresetMean> means;
  for (const PresetCandidate& candidate : candidates)
    means.push_back({geometric_mean(candidate.frame_ms, &cheapest),
                     geometric_mean(candidate.relative_l2, nullptr)});
  return means;
}

size_t most_accurate_within(const std::vector<PresetMean>& means, double budget, double tolerance) {
  double least = std::numeric_limits<double>::infinity();
  for (const PresetMean& mean : means)
    if (mean.cost <= budget) least = std::min(least, mean.error);
  size_t best = means.size();
  for (size_t i = 0; i < means.size(); ++i) {
    if (means[i].cost > budget || means[i].error > (1 + tolerance) * least) continue;
    if (best == means.size() || means[i].cost < means[best].cost) best = i;
  }
  return best;
}

}  // namespace burnish::tools
