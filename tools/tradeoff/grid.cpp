#include "tradeoff/grid.h"

#include <algorithm>

#include <fmt/format.h>

#include "harness/rivals/runtime_rival.h"

namespace burnish::tools {
namespace {

/// How finely highlights are cut and lit, from coarse to fine: more parts of a lobe without the
/// lookups to light each, or the reverse, buy little.
struct HighlightCut {
  int taps, map_taps;
};
/// None is coarser in either than those before it, as tuning's grid needs.
constexpr HighlightCut kHighlightCuts[] = {{1, 1}, {1, 3}, {1, 7}, {3, 7},
                                           {5, 7}, {7, 7}, {9, 9}, {9, 15}};
constexpr HighlightCut kMoreCuts[] = {{3, 5}, {5, 5}, {9, 5}, {9, 7}};

void set_cut(Settings& settings, const HighlightCut& cut) {
  settings.shading.specular.taps = cut.taps;
  settings.shading.environment_taps = cut.map_taps;
  if (cut.taps == 1) settings.shading.specular.lobes = 1;
}

/// A dial, and how to set it.
template <class Value, class Set>
void add_dial(std::vector<GridPoint>& grid, const Settings& base, const char* format,
              std::initializer_list<Value> values, const Set& set) {
  for (const Value& value : values) {
    Settings settings = base;
    set(settings, value);
    grid.push_back({fmt::format(fmt::runtime(format), value), settings});
  }
}

void add_bake_dials(std::vector<GridPoint>& grid, const GridOptions& options) {
  const Settings& base = options.base;
  add_dial(grid, base, "terms {}", {4, 8, 16, 24, 32, 48},
           [](Settings& s, int n) { s.bake.terms = n; });
  add_dial(grid, base, "ladder terms {}", {0, 16, 48},
           [](Settings& s, int n) { s.bake.ladder_terms = n; });
  if (!options.bakes) return;
  add_dial(grid, base, "bases {}", {1, 4, 16}, [](Settings& s, int n) { s.bake.bases = n; });
  add_dial(grid, base, "resolution {}", {32, 64},
           [](Settings& s, int n) { s.bake.resolution = n; });
  add_dial(grid, base, "directions {}", {128, 256},
           [](Settings& s, int n) { s.bake.directions = n; });
}

void add_light_dials(std::vector<GridPoint>& grid, const Settings& base) {
  add_dial(grid, base, "lobes {}", {1, 2, 4, 6, 16, 24, 32, 48},
           [](Settings& s, int n) { s.lobes = n; });
  add_dial(grid, base, "reach {}", {1, 2, 1000},
           [](Settings& s, int n) { s.shading.ladder_reach = static_cast<float>(n); });
  add_dial(grid, base, "visibility {}", {"cap", "hemisphere"}, [](Settings& s, const char* name) {
    s.shading.visibility = name[0] == 'c' ? VisibilityModel::cap : VisibilityModel::hemisphere;
  });
  add_dial(grid, base, "cosine {}", {"constant"},
           [](Settings& s, const char*) { s.shading.cosine = CosineModel::constant; });
  add_dial(grid, base, "integral {}", {"fast", "series"}, [](Settings& s, const char* name) {
    s.shading.integral = name[0] == 'f' ? AsgIntegral::fast : AsgIntegral::series;
  });
}

void add_specular_dials(std::vector<GridPoint>& grid, const Settings& base) {
  const auto add_cut = [&](const HighlightCut& cut) {
    Settings settings = base;
    set_cut(settings, cut);
    grid.push_back({fmt::format("taps {}, map taps {}", cut.taps, cut.map_taps), settings});
  };
  std::for_each(std::begin(kHighlightCuts), std::end(kHighlightCuts), add_cut);
  std::for_each(std::begin(kMoreCuts), std::end(kMoreCuts), add_cut);
  add_dial(grid, base, "taps {}", {1, 3, 7, 9},
           [](Settings& s, int n) { s.shading.specular.taps = n; });
  add_dial(grid, base, "peak, taps {}", {1, 5, 9}, [](Settings& s, int n) {
    s.shading.specular.form = SpecularForm::peak;
    s.shading.specular.taps = n;
  });
  add_dial(grid, base, "map taps {}", {1, 3, 5, 9, 15},
           [](Settings& s, int n) { s.shading.environment_taps = n; });
  add_dial(grid, base, "highlight lobe {}", {"whole"},
           [](Settings& s, const char*) { s.shading.highlight_lobe = HighlightLobe::whole; });
  add_dial(grid, base, "highlights from {}", {"lobes"},
           [](Settings& s, const char*) { s.specular_from_map = false; });
}

constexpr Quality kQualities[] = {Quality::fast, Quality::balanced, Quality::accurate};

const char* name_of(Quality quality) {
  switch (quality) {
    case Quality::fast:
      return "fast";
    case Quality::balanced:
      return "balanced";
    case Quality::accurate:
      break;
  }
  return "accurate";
}

}  // namespace

bool any_specular(const std::vector<Material>& materials) {
  return std::any_of(materials.begin(), materials.end(),
                     [](const Material& material) { return material.has_specular(); });
}

std::vector<GridPoint> tradeoff_grid(const std::vector<Material>& materials,
                                     const GridOptions& options) {
  std::vector<GridPoint> grid;
  for (const Quality quality : kQualities)
    for (const int lobes : {6, options.base.lobes, 24})
      for (const int terms : {16, options.base.bake.terms}) {
        Settings settings = options.base;
        settings.shading = shading_options(quality);
        settings.lobes = lobes;
        settings.bake.terms = terms;
        std::string name = name_of(quality);
        if (lobes != options.base.lobes) name += fmt::format(", lobes {}", lobes);
        if (terms != options.base.bake.terms) name += fmt::format(", terms {}", terms);
        grid.push_back({name, settings});
      }
  add_bake_dials(grid, options);
  add_light_dials(grid, options.base);
  if (any_specular(materials)) add_specular_dials(grid, options.base);
  if (options.papers)
    for (const auto& [name, shading] :
         {std::pair{"paper", paper_shading_options()},
          {"paper, one lookup", paper_shading_options(VisibilityModel::hemisphere, 1)},
          {"paper, cap", paper_shading_options(VisibilityModel::cap)}}) {
      Settings settings = options.base;
      settings.shading = shading;
      settings.bake.ladder_terms = 0;
      if (options.bakes) settings.bake.bases = 1;
      grid.push_back({name, settings});
    }
  return grid;
}

std::vector<GridPoint> tuning_grid(const std::vector<Material>& materials,
                                   const GridOptions& options) {
  // Without highlights all cuts are the same.
  const size_t cuts = any_specular(materials) ? std::size(kHighlightCuts) : 1;
  const int terms[] = {8, 16, 32, 48}, lobes[] = {4, 10, 24, 48};
  const float reach[] = {8, 1};
  std::vector<GridPoint> grid;
  for (size_t cut = 0; cut < cuts; ++cut)
    for (int t = 0; t < 4; ++t)
      for (int l = 0; l < 4; ++l)
        for (int r = 0; r < 2; ++r) {
          Settings settings = options.base;
          settings.bake.terms = terms[t];
          settings.lobes = lobes[l];
          settings.shading.ladder_reach = reach[r];
          set_cut(settings, kHighlightCuts[cut]);
          grid.push_back(
              {fmt::format("terms {}, lobes {}, reach {}, taps {}, map taps {}", terms[t], lobes[l],
                           reach[r], kHighlightCuts[cut].taps, kHighlightCuts[cut].map_taps),
               settings,
               {static_cast<int>(cut), t, l, r}});
        }
  return grid;
}

}  // namespace burnish::tools
