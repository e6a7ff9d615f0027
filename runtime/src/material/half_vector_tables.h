#pragma once

/// D(h) by ASGs about the normal, fitted: least squares of weight h.z with the exact energy, for
/// alphas that divide 0..1 evenly. Written by the test HalfVectorTables.* with BURNISH_UPDATE=1
/// (tests/material/half_vector_fit.h).
namespace burnish::internal {

struct TabulatedLobe {
  float bandwidth_x, bandwidth_y;  ///< times alpha_x^2, alpha_y^2
  float amplitude;
};

inline constexpr int kTableSteps = 10;
/// alpha_x = i / kTableSteps >= alpha_y = j / kTableSteps, at i (i + 1) / 2 + j.
inline constexpr int kTableNodes = (kTableSteps + 1) * (kTableSteps + 2) / 2;

extern const TabulatedLobe kWardLobes[kTableNodes][1];
extern const TabulatedLobe kAshikhminLobes[kTableNodes][1];
extern const TabulatedLobe kBeckmannLobes[kTableNodes][1];
extern const TabulatedLobe kGgxLobes1[kTableNodes][1];
extern const TabulatedLobe kGgxLobes2[kTableNodes][2];
extern const TabulatedLobe kGgxLobes3[kTableNodes][3];
/// Round, by alpha.
extern const TabulatedLobe kBlinnPhongLobes[kTableSteps + 1][1];

}  // namespace burnish::internal
