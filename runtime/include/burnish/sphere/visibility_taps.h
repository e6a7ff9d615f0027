#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "burnish/sphere/half_space.h"
#include "burnish/sphere/lobe_comb.h"

/// The visible fraction of a lobe from several readings of the distance to the nearest boundary,
/// spread along the lobe's long axis: one reading at the axis knows nothing of what covers the ends
/// (docs/maths.md, "Visible fraction").
namespace burnish {

/// Equal-probability slabs across the long axis of a lobe: each slab's mean place and deviation, as
/// a table over the bandwidth of the long axis, since the bandwidth of a warped lobe changes from
/// vertex to vertex. Made once for a number of taps.
template <class T>
struct QuantileTapTable {
  static constexpr int kIntervals = 32;
  struct Row {
    std::array<T, kMaxTaps> sine, deviation;  ///< times 1 + sqrt(bandwidth)
  };
  /// Row i is for sqrt(bandwidth) / (1 + sqrt(bandwidth)) = i / kIntervals.
  std::array<Row, kIntervals + 1> row;
  int count = 1;
};

namespace internal {

/// Mean and deviation of y under exp(-root^2 y^2) on [from, to].
inline std::array<double, 2> slab_moments(double root, double from, double to) {
  double mass = 0, mean = 0, square = 0;
  constexpr int kSteps = 512;  // midpoints: 3e-6 of a slab's width
  for (int i = 0; i < kSteps; ++i) {
    const double y = from + (to - from) * (i + 0.5) / kSteps;
    const double density = std::exp(-root * root * y * y);
    mass += density;
    mean += density * y;
    square += density * y * y;
  }
  mean /= mass;
  return {mean, std::sqrt(square / mass - mean * mean)};
}

}  // namespace internal

/// The table for `count` taps, 1..kMaxTaps (others are clamped to that).
template <class T>
QuantileTapTable<T> make_quantile_taps(int count) {
  QuantileTapTable<T> table;
  table.count = std::clamp(count, 1, kMaxTaps);
  constexpr int kLast = QuantileTapTable<T>::kIntervals;
  for (int i = 0; i <= kLast; ++i) {
    // The ends are limits: the table's steps are linear there to 1e-5 and less.
    const double u = std::clamp(double(i) / kLast, 1e-6, 1 - 1e-6);
    const double root = u / (1 - u);
    const double edge = std::min(1.0, 6 / root);  // beyond: 1e-17 of the lobe
    const auto quantile = [&](double p) {
      if (std::abs(p) == 1) return p * edge;
      return inverse_erf(p * std::erf(root)) / root;
    };
    for (int k = 0; k < table.count; ++k) {
      const auto [mean, deviation] = internal::slab_moments(
          root, quantile(2.0 * k / table.count - 1), quantile(2.0 * (k + 1) / table.count - 1));
      table.row[i].sine[k] = T(mean * (1 + root));
      table.row[i].deviation[k] = T(deviation * (1 + root));
    }
  }
  return table;
}

/// The taps of a lobe: the mean place of each slab, as wide along the long axis as the slab is. A
/// single tap is the lobe itself. The table's interpolation errs by .003 of the lobe's deviation,
/// and by .6 % of a tap's.
template <class T>
LobeTaps<T> quantile_taps(const QuantileTapTable<T>& table, const AnisotropicGaussian<T>& lobe) {
  const T bandwidth = std::min(lobe.bandwidth_x, lobe.bandwidth_y);
  LobeTaps<T> taps;
  taps.count = table.count;
  if (taps.count == 1) {
    taps.tap[0] = {T(0), bandwidth, T(1)};
    return taps;
  }
  const T root = std::sqrt(bandwidth), scale = 1 / (1 + root);
  constexpr int kIntervals = QuantileTapTable<T>::kIntervals;
  const T place = (1 - scale) * kIntervals;
  const int index = std::min(static_cast<int>(place), kIntervals - 1);
  const T fraction = place - T(index);
  const auto &low = table.row[index], &high = table.row[index + 1];
  for (int k = 0; k < taps.count; ++k) {
    const T sine = scale * (low.sine[k] + fraction * (high.sine[k] - low.sine[k]));
    const T deviation = low.deviation[k] + fraction * (high.deviation[k] - low.deviation[k]);
    // The deviation of the sine is the cosine times that along the tap's own axis.
    const T own = (1 + root) * std::sqrt((1 - sine) * (1 + sine) / 2) / deviation;
    taps.tap[k] = {sine, std::min(own * own, std::numeric_limits<T>::max()), T(1) / T(taps.count)};
  }
  return taps;
}

/// The visible fraction of a lobe in [0, 1], from one lookup a tap. `lookup(direction)` returns
/// something with the members `distance` (radians, positive: visible) and `gradient` (tangent to
/// the sphere, toward rising distance). 1 where every tap is wholly visible and 0 where every tap
/// is hidden, exactly. Mean absolute error, over five kinds of occluders at anisotropies 1/3/10/30,
/// bandwidths 20..2000: one tap .029/.038/.058/.075, five quantile taps .017/.011/.013/.018 (comb
/// teeth .018/.013/.019/.028), nine .016/.008/.007/.009.
template <class T, class Lookup>
T visible_fraction(VisibilityModel model, const AnisotropicGaussian<T>& lobe,
                   const LobeTaps<T>& taps, const Lookup& lookup) {
  T sum = 0, total = 0;
  for (int k = 0; k < taps.count; ++k) {
    const AnisotropicGaussian<T> part = tap_lobe(lobe, taps.tap[k]);
    const auto boundary = lookup(part.frame.z);
    sum +=
        taps.tap[k].weight * visible_fraction<T>(model, part, boundary.distance, boundary.gradient);
    total += taps.tap[k].weight;
  }
  return sum / total;
}

}  // namespace burnish
