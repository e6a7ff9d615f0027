#pragma once

#include <cstddef>
#include <span>

#include "burnish/sphere/direction.h"

/// Sums of lobes, for any lobe that has the overload used (eval, integral, rotate, inner_product),
/// as in `eval_mixture(std::span<const SphericalGaussian<float>>(lobes), direction)`. An empty sum
/// is 0.
namespace burnish {

/// Scalar of a lobe: float or double.
template <class Lobe>
using LobeScalar = decltype(Lobe::amplitude);

template <class Lobe>
LobeScalar<Lobe> eval_mixture(std::span<const Lobe> lobes,
                              const Vector3<LobeScalar<Lobe>>& direction) {
  LobeScalar<Lobe> sum = 0;
  for (const Lobe& lobe : lobes) sum += eval(lobe, direction);
  return sum;
}

template <class Lobe>
LobeScalar<Lobe> integral_mixture(std::span<const Lobe> lobes) {
  LobeScalar<Lobe> sum = 0;
  for (const Lobe& lobe : lobes) sum += integral(lobe);
  return sum;
}

/// Rotates each lobe in place.
template <class Lobe>
void rotate_mixture(std::span<Lobe> lobes, const Eigen::Matrix<LobeScalar<Lobe>, 3, 3>& rotation) {
  for (Lobe& lobe : lobes) lobe = rotate(lobe, rotation);
}

/// Integral of the product of two mixtures: the sum over all pairs, O(a.size() * b.size()).
template <class LobeA, class LobeB>
LobeScalar<LobeA> inner_product_mixture(std::span<const LobeA> a, std::span<const LobeB> b) {
  LobeScalar<LobeA> sum = 0;
  for (const LobeA& lobe_a : a)
    for (const LobeB& lobe_b : b) sum += inner_product(lobe_a, lobe_b);
  return sum;
}

}  // namespace burnish
