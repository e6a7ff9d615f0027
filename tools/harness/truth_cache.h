#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "burnish/light/rgb.h"

namespace burnish {

/// `$BURNISH_CACHE`, else `$XDG_CACHE_HOME/burnish`, else `~/.cache/burnish`; empty where none of
/// the variables is set. A relative XDG_CACHE_HOME is ignored, as its specification demands.
std::string default_truth_folder();

/// Where truths are kept between runs. Nothing that goes wrong with it is an error: the truth is
/// computed again, and `warn` is told.
struct TruthCache {
  std::string folder = default_truth_folder();  ///< made if missing; empty: nothing is kept
  std::function<void(const std::string&)> warn = {};
};

/// The truth about points or pixels.
struct StoredTruth {
  std::uint32_t samples = 0;      ///< per value
  std::vector<Rgb> radiance;      ///< one a value
  std::vector<Rgb> variance;      ///< as long, of the mean
  std::vector<std::uint8_t> hit;  ///< as long, of a picture; else empty
};

/// The file a key (letters, digits, -) is kept in.
std::string truth_path(const TruthCache& cache, const std::string& key);

/// What store_truth kept under a key, bit for bit; nothing where there is no such file. A file that
/// is cut short, changed, of another key or not of `values` values is warned of, and nothing.
std::optional<StoredTruth> load_truth(const TruthCache& cache, const std::string& key,
                                      size_t values, bool picture);

/// Replaces the file as a whole.
void store_truth(const TruthCache& cache, const std::string& key, const StoredTruth& truth);

}  // namespace burnish
