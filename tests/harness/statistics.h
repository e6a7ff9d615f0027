#pragma once

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "harness/reference_integrator.h"

namespace burnish {

/// Standard errors by which an estimate may miss the truth. With 63 degrees of freedom (64
/// replicates) Student's t exceeds it once in 6,000; seeds are fixed, so a test that passes keeps
/// passing.
inline constexpr double kSigmas = 4;

/// Expects a channel of an estimate within kSigmas standard errors of the truth, plus `bias` (what
/// the scene itself is off by), and a standard error small enough to mean something.
inline void expect_estimate(const ReferenceEstimate& estimate, double truth, double bias,
                            double largest_standard_error, const std::string& what) {
  const double standard_error = std::sqrt(estimate.variance.x());
  EXPECT_NEAR(estimate.mean.x(), truth, kSigmas * standard_error + bias)
      << what << ": standard error " << standard_error;
  EXPECT_LE(standard_error, largest_standard_error) << what;
}

}  // namespace burnish
