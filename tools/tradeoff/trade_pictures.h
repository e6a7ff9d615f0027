#pragma once

#include <string>
#include <vector>

#include "tradeoff/trades.h"
#include "tradeoff/trial.h"

namespace burnish::tools {

/// How pictures of chosen rows are made.
struct TradePictureOptions {
  int width = 320;
  int height = 213;
  TruthGoal truth = {.noise = 0.02, .first_samples = 32, .most_samples = 1024};
};

/// Settings to be shown: presets, the papers' choices, ours with one basis as the papers have, and
/// the cheapest and the best of the front against time. Indices of rows, none twice.
std::vector<size_t> rows_to_show(const Sweep& sweep, const Trade& time);

/// A row's picture, the truth and their FLIP map side by side, to be written with write_png
/// (linear, 0..1), and how far it is from the truth.
struct TradePicture {
  Image picture;
  double flip = 0;         ///< mean over the mesh
  double relative_l2 = 0;  ///< over pixels
  double psnr_db = 0;
};
TradePicture trade_picture(Trial& trial, const Settings& settings,
                           const TradePictureOptions& options);

}  // namespace burnish::tools
