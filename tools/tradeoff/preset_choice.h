#pragma once

#include <string>
#include <vector>

#include "burnish/shading/shading_options.h"

/// How the command line's qualities are chosen: by what many settings cost and err on many scenes.
namespace burnish::tools {

/// Settings that a quality could have, and what they measured.
struct PresetCandidate {
  std::string name;  ///< "taps 5, map taps 5, reach 8"
  ShadingOptions shading;
  std::vector<double> frame_ms = {};     ///< [scenes]
  std::vector<double> relative_l2 = {};  ///< [scenes]
};

/// All combinations of the dials of shading that time and error hang on most: the parts of a lobe,
/// lookups of the map, and which lights see through the ladder. Not yet measured.
std::vector<PresetCandidate> preset_candidates();

/// Of a candidate over all scenes, each of which weighs the same.
struct PresetMean {
  double cost = 0;   ///< geometric mean of frame times over those of the cheapest candidate
  double error = 0;  ///< geometric mean
};

/// [candidates]. All have the same scenes, one or more.
std::vector<PresetMean> preset_means(const std::vector<PresetCandidate>& candidates);

/// How many times the cheapest candidate's time each quality may take.
inline constexpr double kFastBudget = 1.3, kBalancedBudget = 4, kAccurateBudget = 8;

/// The most accurate candidate within a budget of cost. Of those within `tolerance` of its error,
/// as a fraction, the cheapest: differences that no one sees are not paid for.
/// means.size() where none fits.
size_t most_accurate_within(const std::vector<PresetMean>& means, double budget,
                            double tolerance = 0.03);

}  // namespace burnish::tools
