#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

/// The length of the mean of directions that are distributed as a spherical Gaussian, and the
/// sharpness that belongs to a length. Errors are relative, the worst over 1e-30..1e30 in steps
/// finer than the branches (MeanResultant.* in tests/sphere).
namespace burnish {

/// Length r of the mean direction of a distribution, with 1 - r apart: for a narrow distribution
/// all that is known about its width is in 1 - r, of which a float r keeps few digits.
template <class T>
struct MeanResultant {
  T length = 0;      ///< r, in [0, 1]; 0 for the uniform distribution
  T complement = 1;  ///< 1 - r
};

template <class T>
MeanResultant<T> resultant_from_length(T length) {
  return {length, 1 - length};
}

template <class T>
MeanResultant<T> resultant_from_complement(T complement) {
  return {1 - complement, complement};
}

namespace internal {

/// coth(L) - 1/L for L <= 1.5 by its continued fraction, which has no difference of large terms.
template <class T>
T langevin_of_small(T sharpness) {
  const T square = sharpness * sharpness;
  T tail = 19;
  for (int odd = 17; odd >= 3; odd -= 2) tail = T(odd) + square / tail;
  return sharpness / tail;
}

inline constexpr double kLangevinBranch = 1.5;

template <class T>
T quotient_within_range(T numerator, T denominator) {
  return std::min(numerator / denominator, std::numeric_limits<T>::max());
}

}  // namespace internal

/// Mean of v . axis under a normalised spherical Gaussian, coth(L) - 1/L (the Langevin function):
/// 0 at sharpness 0, rising to 1. Error: 3 epsilons.
template <class T>
T mean_cosine(T sharpness) {
  if (sharpness < T(internal::kLangevinBranch)) return internal::langevin_of_small(sharpness);
  return 1 - (1 / sharpness - 2 / std::expm1(2 * sharpness));
}

/// 1 - mean_cosine(sharpness) without its cancellation: 1/L for large L. Error: 3 epsilons.
template <class T>
T mean_cosine_complement(T sharpness) {
  if (sharpness < T(internal::kLangevinBranch)) return 1 - internal::langevin_of_small(sharpness);
  return 1 / sharpness - 2 / std::expm1(2 * sharpness);
}

template <class T>
MeanResultant<T> mean_resultant(T sharpness) {
  return {mean_cosine(sharpness), mean_cosine_complement(sharpness)};
}

/// Sharpness by Toksvig's rule (toksvig2005mipmapping), r / (1 - r): below the truth by 1/L of it
/// for narrow lobes, by 54 % at sharpness 1, by 67 % for wide ones. The largest finite number for
/// r = 1.
template <class T>
T sharpness_toksvig(const MeanResultant<T>& mean) {
  return internal::quotient_within_range(mean.length, mean.complement);
}

/// Sharpness by the rule of banerjee2005vmf, r (3 - r^2) / (1 - r^2): exact for narrow and for wide
/// lobes, up to 5 % too high between (at sharpness 5). The largest finite number for r = 1.
template <class T>
T sharpness_approximate(const MeanResultant<T>& mean) {
  const T r = mean.length;
  return internal::quotient_within_range(r * (3 - r * r) / (1 + r), mean.complement);
}

/// The sharpness whose mean_cosine is the given length, i.e. the maximum-likelihood fit of the von
/// Mises-Fisher distribution (banerjee2005vmf). The largest finite number for r = 1.
template <class T>
T sharpness_from_mean(const MeanResultant<T>& mean) {
  // coth differs from 1 by less than half an epsilon there.
  constexpr T kNarrow = T(0.04);
  if (mean.complement < kNarrow) return internal::quotient_within_range(T(1), mean.complement);
  T sharpness = sharpness_approximate(mean);
  if (!(sharpness > 0)) return 0;
  for (int step = 0; step < 3; ++step) {
    // Newton's method: for wide lobes on r, which is nearly linear in L, for narrow ones on 1 - r,
    // which is nearly linear in 1/L.
    const T langevin = mean_cosine(sharpness);
    const T slope = 1 - langevin * (langevin + 2 / sharpness);
    if (sharpness < T(internal::kLangevinBranch))
      sharpness -= (langevin - mean.length) / slope;
    else
      sharpness /= 1 - (mean_cosine_complement(sharpness) - mean.complement) / (slope * sharpness);
  }
  return sharpness;
}

}  // namespace burnish
