#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "bench/bench.h"

/// What a figure's text says of its rows.
namespace burnish::tools {

/// Smallest and largest value of a column, over rows that `is_wanted` accepts; (infinity, 0)
/// without any. Values are >= 0, and all accepted rows have the column.
template <class IsWanted>
std::pair<double, double> column_range(const std::vector<BenchRow>& rows, const std::string& column,
                                       const IsWanted& is_wanted) {
  std::pair<double, double> range = {std::numeric_limits<double>::infinity(), 0};
  for (const BenchRow& row : rows) {
    if (!is_wanted(row)) continue;
    const double value = row[column];
    range = {std::min(range.first, value), std::max(range.second, value)};
  }
  return range;
}

/// The same as "2 to 2.9 %".
template <class IsWanted>
std::string percent_range(const std::vector<BenchRow>& rows, const std::string& column,
                          const IsWanted& is_wanted) {
  const auto [low, high] = column_range(rows, column, is_wanted);
  return fmt::format("{:.2g} to {:.2g} %", 100 * low, 100 * high);
}

}  // namespace burnish::tools
