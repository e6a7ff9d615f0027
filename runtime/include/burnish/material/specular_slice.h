#pragma once

#include <array>
#include <span>

#include "burnish/material/material.h"
#include "burnish/sphere/batch.h"
#include "burnish/sphere/lobe_comb.h"

/// What a viewer sees of a specular material, as lobes over incoming directions:
///   f(o, i) max(i.z, 0) = sum of weight * lobe(i),
/// each to be multiplied with light and visibility on its own (docs/maths.md, "Specular slice").
namespace burnish {

/// How a lobe over half vectors becomes one over incoming directions.
enum class SpecularForm {
  /// The second derivatives at its peak; M and the cosine there, out of the integral (xu2013asg,
  /// Eq. 23-30), with the paper's lobes for Ward's and Ashikhmin's D. Nothing where the peak is
  /// below the horizon.
  peak,
  /// The mass, mean and covariance of f times the cosine over its part above the horizon, from six
  /// to nine half vectors.
  moments,
};

inline constexpr int kTailLobes = 3;

struct SpecularOptions {
  SpecularForm form = SpecularForm::moments;
  /// Each lobe over half vectors is cut into this many, 1..kMaxTaps: the main dial of specular
  /// accuracy; the cost is proportional. Lobes too narrow to profit stay whole. With
  /// SpecularForm::peak, 1 is the paper's method.
  int taps = 5;
  int lobes = kTailLobes;  ///< for D(h) where its tail needs several (GGX), 1..kTailLobes
};

/// A part of a material's lobe over half vectors.
struct SpecularTooth {
  AnisotropicGaussian<float> lobe;  ///< in the local frame
  float integral = 0;               ///< of it
  float mean_xx = 0, mean_yy = 0;   ///< second moments in its own frame (AsgSecondMoments)
};

inline constexpr int kMaxSpecularTeeth = kMaxFittedLobes * kMaxTaps;

/// A material ready to be seen from any side: prepared once per change of it. No allocation.
struct PreparedMaterial {
  Material material;
  SpecularForm form = SpecularForm::moments;
  HalfVectorLobes lobes;  ///< that the teeth are cut from
  std::array<SpecularTooth, kMaxSpecularTeeth> tooth;
  int count = 0;  ///< 0: not specular
  /// The smooth factor takes up what the lobes lack of D(h). Not where they are too few for its
  /// tail: they have its integral, which a few half vectors would spoil.
  bool corrects_distribution = false;
};

/// Nothing is allocated or thrown. The material is one that domain_error accepts.
PreparedMaterial prepare_material(const Material& material,
                                  const SpecularOptions& options) noexcept;

struct SliceLobe {
  AnisotropicGaussian<float> lobe;  ///< over incoming directions, in the local frame; amplitude 1
  float integral = 0;               ///< of it, exact
  Rgb weight = Rgb::Zero();
};

/// Writes at most prepared.count lobes, without those that weigh nothing, and returns their number.
/// `outgoing` unit, in the local frame; the result is empty for outgoing.z <= 0. With
/// SpecularForm::moments a lobe stands for what is above the horizon, though its Gaussian may reach
/// below: its visible share is the visible fraction over that of the horizon alone.
int specular_slice(const PreparedMaterial& prepared, const Vector3f& outgoing,
                   std::span<SliceLobe, kMaxSpecularTeeth> slice) noexcept;

/// The same of one tooth, 0 <= tooth < prepared.count, from many views: SliceLobe as arrays. Where
/// the weight is 0, the lobe is some valid one. A frame's y is z x x. Spans of one length; results
/// may not be written over the views.
struct SpecularSlices {
  batch::DirectionResults x, z;
  std::span<float> bandwidth_x, bandwidth_y, integral;
  std::array<std::span<float>, 3> weight;
};
void specular_slices(const PreparedMaterial& prepared, int tooth, const batch::Directions& outgoing,
                     const SpecularSlices& results) noexcept;

}  // namespace burnish
