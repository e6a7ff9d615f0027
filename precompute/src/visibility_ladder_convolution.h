#pragma once

#include <array>

#include "burnish/precompute/pca.h"

namespace burnish {

/// Convolution of octahedral maps with a spherical Gaussian, normalised so that a constant map
/// stays as it is.
///
/// The map's mirror images in x and y are permutations of its texels which the convolution commutes
/// with: on the parts of a map that are even or odd in x and y it is four independent matrices of a
/// sixteenth of the size, a quarter of the work in all.
class SphericalConvolution {
 public:
  /// `resolution` even; exp(2 bandwidth (cos - 1)) between texel centres.
  SphericalConvolution(int resolution, double bandwidth);

  /// Convolves each column of `maps`, [resolution^2][columns]. Same bytes at any number of threads.
  RowMatrixf apply(const RowMatrixf& maps) const;

 private:
  int resolution_;
  std::array<RowMatrixf, 4> parity_;  ///< [(resolution / 2)^2] squared: 1 odd in x, 2 odd in y
};

}  // namespace burnish
