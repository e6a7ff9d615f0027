#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <unistd.h>

namespace burnish::test {

/// Outcome of a chi-square test of observed against expected counts.
struct ChiSquare {
  double statistic = 0;
  int degrees = 0;
  double p_value = 1;
  std::string table;  ///< CSV of all bins: bin, observed, expected

  /// For a failing test to stream: what was found, and the file that the table was dumped to.
  std::string report(const std::string& name) const {
    const auto path = std::filesystem::temp_directory_path() /
                      ("burnish_chi_square_" + name + "." + std::to_string(::getpid()) + ".csv");
    std::ofstream(path) << table;
    std::ostringstream text;
    text << name << ": statistic " << statistic << " of " << degrees << " degrees, p " << p_value
         << "; the bins are in " << path.string();
    return text.str();
  }
};

/// The level of each test of a family of independent ones, so that the whole family fails by
/// accident with probability alpha: Sidak's 1 - (1 - alpha)^(1 / tests).
inline double sidak_level(double alpha, int tests) {
  return -std::expm1(std::log1p(-alpha) / tests);
}

/// Upper tail of the chi-square distribution: the regularised incomplete gamma function
/// Q(degrees / 2, statistic / 2), by its series below the mean and its continued fraction above.
inline double chi_square_tail(double statistic, int degrees) {
  if (degrees < 1) return statistic > 0 ? 0 : 1;
  if (!(statistic > 0)) return 1;
  const double a = degrees / 2.0, x = statistic / 2;
  const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
  if (x < a + 1) {
    double sum = 1 / a, term = sum;
    for (double n = a + 1; term > 1e-16 * sum; ++n) sum += term *= x / n;
    return std::max(1 - front * sum, 0.0);
  }
  // Lentz's method.
  double b = x + 1 - a, c = 1e300, d = 1 / b, fraction = d;
  for (int i = 1; i < 100000; ++i) {
    const double numerator = -i * (i - a);
    b += 2;
    d = 1 / (numerator * d + b);
    c = b + numerator / c;
    fraction *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return front * fraction;
}

/// Bins that expect fewer than 5 are pooled, as the test's approximation asks; what is left of them
/// joins the last bin, so that no sample goes uncounted. A sample in a bin that expects none at all
/// is proof against the sampler, but for one in 1e5, which rounding may push over a bin's edge.
inline ChiSquare chi_square(const std::vector<double>& observed,
                            const std::vector<double>& expected) {
  struct Bin {
    double observed = 0, expected = 0;
  };
  std::vector<Bin> bins;
  Bin pool;
  double total = 0, impossible = 0;
  std::ostringstream table;
  table << "bin,observed,expected\n";
  for (size_t i = 0; i < observed.size(); ++i) {
    table << i << "," << observed[i] << "," << expected[i] << "\n";
    total += observed[i];
    if (!(expected[i] > 0)) impossible += observed[i];
    pool.observed += observed[i];
    pool.expected += expected[i];
    if (expected[i] >= 5) {
      bins.push_back({observed[i], expected[i]});
      pool.observed -= observed[i];
      pool.expected -= expected[i];
    } else if (pool.expected >= 5) {
      bins.push_back(pool);
      pool = {};
    }
  }
  if (bins.empty()) bins.emplace_back();
  bins.back().observed += pool.observed;
  bins.back().expected += pool.expected;

  ChiSquare result;
  result.degrees = static_cast<int>(bins.size()) - 1;
  for (const Bin& bin : bins) {
    const double difference = bin.observed - bin.expected;
    if (bin.expected > 0) result.statistic += difference * difference / bin.expected;
  }
  result.p_value =
      impossible > 1e-5 * total ? 0 : chi_square_tail(result.statistic, result.degrees);
  result.table = table.str();
  return result;
}

}  // namespace burnish::test
