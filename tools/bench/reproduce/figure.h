#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/bench.h"
#include "burnish/light/environment_map.h"
#include "harness/truth_cache.h"

/// The papers' figures and tables, made again with ours: numbers, pictures and what they say.
namespace burnish::tools {

/// A picture to be shown: encoded for a display (tone_map.h), 0..1.
struct FigurePicture {
  std::string name;  ///< of its file, without folder and extension
  std::string caption;
  Image picture;
};

struct FigureResult {
  std::vector<BenchRow> rows;
  std::vector<FigurePicture> pictures;
  std::string found;  ///< a paragraph: what we got, with its numbers, and why it differs
};

struct FigureContext {
  Work& work;
  const BenchOptions& bench;
  TruthCache cache;
  std::string data;  ///< folder of measured BRDFs and maps, or empty: what needs them is left out
};

/// One figure or table.
struct Figure {
  std::string name;         ///< as on the command line: "fig1"
  std::string title;        ///< "Xu 2013, Figure 1: ..."
  std::string paper_shows;  ///< a paragraph
  FigureResult (*make)(const FigureContext& context);
};

/// All of them, in the order of the paper.
std::span<const Figure> all_figures();

/// The figures, one source file a group.
/// @{
FigureResult make_lobe_count_figure(const FigureContext& context);   ///< Fig. 1
FigureResult make_integral_figure(const FigureContext& context);     ///< Fig. 3
FigureResult make_product_figure(const FigureContext& context);      ///< Fig. 4, 5
FigureResult make_convolution_figure(const FigureContext& context);  ///< Fig. 6
FigureResult make_light_fit_figure(const FigureContext& context);    ///< Fig. 7
FigureResult make_ashikhmin_figure(const FigureContext& context);    ///< Fig. 8
FigureResult make_measured_figure(const FigureContext& context);     ///< Fig. 9, 13
FigureResult make_warp_figure(const FigureContext& context);         ///< Fig. 10
FigureResult make_visibility_figure(const FigureContext& context);   ///< Fig. 11
FigureResult make_dish_balls_figure(const FigureContext& context);   ///< Fig. 12
FigureResult make_frame_rate_table(const FigureContext& context);    ///< Table 1
/// @}

}  // namespace burnish::tools
