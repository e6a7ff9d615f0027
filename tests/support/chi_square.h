#pragma once

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

namespace burnish::test {

/// Outcome of a chi-square test of observed against expected counts.
struct ChiSquare {
  double statistic = 0;
  int degrees = 0;
  double p_value = 1;
  std::string table;  ///< the bins, for a failing test to print
};

/// Upper tail of the chi-square distribution by Wilson and Hilferty's cube-root normal
/// approximation, good to .001 for 10 degrees of freedom and more.
inline double chi_square_tail(double statistic, int degrees) {
  const double variance = 2.0 / (9.0 * degrees);
  const double z = (std::cbrt(statistic / degrees) - (1 - variance)) / std::sqrt(variance);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// Bins that expect fewer than 5 are pooled, as the test's approximation asks.
inline ChiSquare chi_square(const std::vector<double>& observed,
                            const std::vector<double>& expected) {
  ChiSquare result;
  double pooled_observed = 0, pooled_expected = 0;
  std::ostringstream table;
  const auto add = [&](double o, double e) {
    result.statistic += (o - e) * (o - e) / e;
    ++result.degrees;
    table << o << " (" << e << ")\n";
  };
  for (size_t i = 0; i < observed.size(); ++i) {
    if (expected[i] >= 5) {
      add(observed[i], expected[i]);
    } else {
      pooled_observed += observed[i];
      pooled_expected += expected[i];
      if (pooled_expected >= 5) {
        add(pooled_observed, pooled_expected);
        pooled_observed = pooled_expected = 0;
      }
    }
  }
  if (pooled_expected < 1e-3 && pooled_observed > 3)
    result.statistic += 1e9;  // samples where none may be
  result.degrees -= 1;
  result.p_value = chi_square_tail(result.statistic, result.degrees);
  result.table = table.str();
  return result;
}

}  // namespace burnish::test
