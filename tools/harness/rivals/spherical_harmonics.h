#pragma once

#include <Eigen/Core>

#include "burnish/light/environment_map.h"

/// Functions on the sphere as spherical harmonics of `bands` bands, 1..kMaxLadderBands, in the
/// order of visibility_ladder.h: bands^2 coefficients.
namespace burnish {

using Harmonics = Eigen::VectorXf;
/// [bands^2][3]
using RgbHarmonics = Eigen::Matrix<float, Eigen::Dynamic, 3>;
using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Of a lat-long map, in its own frame. Harmonics are taken at the pixels' middles: for 512 x 256
/// pixels 2e-4 of the sixth band are missing.
RgbHarmonics project_environment(const Image& environment, int bands);

/// Turns coefficients of f(d) into those of f(rotation^T d): [bands^2][bands^2].
RowMatrix harmonics_rotation(int bands, const Eigen::Matrix3f& rotation);

/// Hann's window over the bands, 1/2 (1 + cos(pi band / bands)): less ringing, less detail.
void apply_window(int bands, Eigen::Ref<RgbHarmonics> harmonics);

/// Products: for the coefficients v of a function of 2 bands - 1 bands, the matrix M (row-major, as
/// a vector of bands^4) that multiplies functions with it is this times v, M_ij = integral of
/// Y_i v Y_j.
RowMatrix harmonics_product(int bands);

}  // namespace burnish
