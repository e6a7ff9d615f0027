#pragma once

#include "burnish/shading/transfer.h"
#include "burnish/sphere/anisotropic_gaussian.h"

/// What the ladder tells of single lobes at single points: of local lights, whose lobes are too
/// many for a table.
namespace burnish {

/// How much the ladder, and not the SSDF, tells of a lobe: 1 for wide lobes, 0 for narrow ones, a
/// smooth step over an octave either side of the crossover.
float ladder_weight(float bandwidth, float crossover);

/// The bandwidth of a lobe times a cosine by which it is weighed: its curvature, without the ASG's
/// smooth term, which the ladder's lobes do not have.
float ladder_bandwidth(const AnisotropicGaussian<float>& lit);

/// The fraction of a lobe that the ladder sees; and that is above a normal's horizon. A long lobe
/// is read at three places along its long axis, the nodes of Gauss-Hermite quadrature: by one round
/// lobe it errs by up to twice as much.
/// @{
float seen_by_ladder(const LadderBasis& basis, const float* coefficients,
                     const AnisotropicGaussian<float>& lit);
float above_horizon(const Vector3f& normal, const AnisotropicGaussian<float>& lit);
/// @}

}  // namespace burnish
