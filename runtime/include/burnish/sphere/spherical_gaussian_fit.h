#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "burnish/sphere/mean_resultant.h"
#include "burnish/sphere/spherical_gaussian.h"

/// The spherical Gaussian of a set of directions: the von Mises-Fisher distribution of the same
/// mean (banerjee2005vmf), or of a set of lobes, as when normal maps or virtual lights are filtered
/// (toksvig2005mipmapping). sharpness_from_mean and its cheaper relatives are in mean_resultant.h.
namespace burnish {

/// Weighted mean of directions.
template <class T>
struct MeanDirection {
  Vector3<T> axis = Vector3<T>::UnitZ();  ///< unit; +z where the mean is zero
  MeanResultant<T> resultant;
  T weight = 0;  ///< sum of the weights
};

namespace internal {

/// Two passes: the first finds the axis, the second 1 - r as the mean of
/// complement_i + length_i |v_i - axis|^2 / 2, a sum of small positive terms. An error in the axis
/// enters only squared. Sums are kept in double, whatever T.
template <class T, class Term>
MeanDirection<T> mean_of_terms(std::size_t count, const Term& term) {
  Vector3d sum = Vector3d::Zero();
  double weight = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [direction, resultant, w] = term(i);
    sum += double(w) * double(resultant.length) * direction.template cast<double>();
    weight += double(w);
  }
  const double length = sum.norm();
  MeanDirection<T> mean;
  if (!(weight > 0)) return mean;
  mean.weight = T(weight);
  const Vector3d axis = length > 0 ? Vector3d(sum / length) : Vector3d::UnitZ();
  double complement = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto [direction, resultant, w] = term(i);
    complement += double(w) * (double(resultant.complement) +
                               double(resultant.length) / 2 *
                                   (direction.template cast<double>() - axis).squaredNorm());
  }
  mean.axis = axis.cast<T>();
  mean.resultant = {T(std::min(length / weight, 1.0)), T(std::min(complement / weight, 1.0))};
  return mean;
}

template <class T>
struct MeanTerm {
  Vector3<T> direction;
  MeanResultant<T> resultant;
  T weight;
};

}  // namespace internal

/// Mean of unit directions, with weights >= 0 (as many as directions; none: all 1). 1 - r is
/// accurate to a few epsilons where that of the mean's length has no digits left: float directions
/// of sharpness 1e6 give r / (1 - r) 3 % wrong if 1 - r is formed from a float r.
template <class T>
MeanDirection<T> mean_direction(std::span<const Vector3<T>> directions,
                                std::span<const T> weights = {}) {
  return internal::mean_of_terms<T>(directions.size(), [&](std::size_t i) {
    return internal::MeanTerm<T>{directions[i], {T(1), T(0)}, weights.empty() ? T(1) : weights[i]};
  });
}

/// Mean direction of a sum of lobes of amplitudes >= 0; its weight is their integral.
template <class T>
MeanDirection<T> mean_direction(std::span<const SphericalGaussian<T>> lobes) {
  return internal::mean_of_terms<T>(lobes.size(), [&](std::size_t i) {
    return internal::MeanTerm<T>{lobes[i].axis, mean_resultant(lobes[i].sharpness),
                                 integral(lobes[i])};
  });
}

/// The lobe of that mean direction whose integral is the mean's weight: the maximum-likelihood fit.
template <class T>
SphericalGaussian<T> sg_from_mean(const MeanDirection<T>& mean) {
  const T sharpness = sharpness_from_mean(mean.resultant);
  return {mean.axis, sharpness,
          internal::quotient_within_range(mean.weight, 2 * kPi<T> * internal::sg_mass(sharpness))};
}

}  // namespace burnish
