#pragma once

#include <string>
#include <vector>

#include "burnish/precompute/progress.h"

/// A small sweep whose errors are written down, so that no change makes pictures worse unseen.
namespace burnish::tools {

struct GuardError {
  std::string scene, settings;
  double relative_l2 = 0;  ///< of vertex radiance, the truth's noise included
};

/// The presets and the papers' method on small scenes. Errors are the same to some 1e-3 of
/// themselves on all machines and at any number of threads. Seconds.
std::vector<GuardError> measure_guard(const Progress& progress = {});

/// What was expected, with a note of where the values come from.
struct GuardFile {
  std::string origin;
  std::vector<GuardError> errors;
};

/// CSV: a line "# origin", then scene,settings,relative_l2. Throws Error with file and line.
GuardFile read_guard(const std::string& path);
void write_guard(const GuardFile& guard, const std::string& path);

/// By which an error may be above what was expected, as a fraction of it: what rounding on other
/// processors, through the bases that a bake finds, can do.
inline constexpr double kGuardMargin = 0.03;

/// A line for each error that is above what was expected, each that is below it by as much (then
/// `update` is due), and each that only one side has.
struct GuardVerdict {
  std::vector<std::string> worse, better, unmatched;
  bool holds() const { return worse.empty() && unmatched.empty(); }
};
GuardVerdict compare_guard(const std::vector<GuardError>& expected,
                           const std::vector<GuardError>& found);

}  // namespace burnish::tools
