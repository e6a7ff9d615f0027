#pragma once

#include <array>
#include <string>
#include <vector>

#include "burnish/material/material.h"
#include "tradeoff/settings.h"

namespace burnish::tools {

/// Whether any of them has highlights.
bool any_specular(const std::vector<Material>& materials);

/// A point of a grid over the dials.
struct GridPoint {
  std::string name;  ///< the dials that are not as in the middle of the grid, "terms 16, taps 9"
  Settings settings;
  std::array<int, 4> level = {};  ///< in the tuning grid: how dear each of its dials is
};

/// Which dials a grid varies. The rest are as in `base`.
struct GridOptions {
  Settings base;
  /// Also dials of the bake that need another one: bases, resolution and directions; and the
  /// papers' choices with their one basis.
  bool bakes = true;
  bool papers = true;  ///< also the papers' own choices
};

/// Each dial alone, from its cheapest to its best, and the presets with few and many terms and
/// lights: what a curve of error against time is drawn from. Without the dials of highlights where
/// no material has any.
std::vector<GridPoint> tradeoff_grid(const std::vector<Material>& materials,
                                     const GridOptions& options);

/// All combinations of the dials that the error hangs on most, cheap ones first: what tuning
/// chooses from.
std::vector<GridPoint> tuning_grid(const std::vector<Material>& materials,
                                   const GridOptions& options);

}  // namespace burnish::tools
