#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/half_space.h"
#include "burnish/sphere/lobe_moments.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/sphere/sg_clamped_cosine.h"
#include "burnish/sphere/spherical_gaussian.h"
#include "burnish/sphere/spherical_warp.h"

/// The operators of burnish/sphere/ over many lobes or directions at once, in float, by the widest
/// instructions the processor has (chosen at the first call). Each is the scalar form of the same
/// name, to the error stated here against that form in double.
///
/// Every span of a call has the same length, which may be any; none needs to be aligned. A result
/// may be written over an input, but not shifted against it. Nothing is read or written past the
/// spans, allocated or thrown. Where a result would be below 1.2e-38 before its amplitude is
/// applied, it is 0.
namespace burnish::batch {

/// Unit directions, as a structure of arrays.
struct Directions {
  std::span<const float> x, y, z;
};

/// Frames and lobes, as structures of arrays. A frame's y is z x x.
struct Frames {
  Directions x, z;
};
struct SphericalGaussians {
  Directions axis;
  std::span<const float> sharpness, amplitude;
};
struct AnisotropicGaussians {
  Directions x, z;
  std::span<const float> bandwidth_x, bandwidth_y, amplitude;
};

/// Results of several arrays.
struct DirectionResults {
  std::span<float> x, y, z;
};
struct WarpedLobes {
  DirectionResults x, z;
  std::span<float> bandwidth_x, bandwidth_y, amplitude, jacobian;
};
struct ConvolvedLobes {
  std::span<float> bandwidth_x, bandwidth_y, amplitude;
};

/// results[i] = exp(x[i]) for x <= 88: 2e-7 relative.
void exp(std::span<const float> x, std::span<float> results) noexcept;

/// One lobe at many directions: `results[i]` at direction i. Relative error 1e-6 (1 + e), where e
/// is the exponent's magnitude.
void eval(const SphericalGaussian<float>& lobe, const Directions& directions,
          std::span<float> results) noexcept;
void eval(const AnisotropicGaussian<float>& lobe, const Directions& directions,
          std::span<float> results) noexcept;

/// Many lobes at the same directions: `results[l * size + i]` of lobe l at direction i.
void eval(std::span<const SphericalGaussian<float>> lobes, const Directions& directions,
          std::span<float> results) noexcept;
void eval(std::span<const AnisotropicGaussian<float>> lobes, const Directions& directions,
          std::span<float> results) noexcept;

/// Many lobes, each at a direction of its own: `results[i]` of lobe i at direction i.
void eval(const AnisotropicGaussians& lobes, const Directions& directions,
          std::span<float> results) noexcept;

/// Integrals of unit-amplitude SGs: 1e-6 relative.
void sg_integral(std::span<const float> sharpness, std::span<float> results) noexcept;

/// Integrals of unit-amplitude ASGs by the exact level, 1e-6 relative, or, if that is asked for, by
/// the fast one. (The series level is no faster than the exact one and stands for it.)
void asg_integral(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
                  AsgIntegral level, std::span<float> results) noexcept;

/// Integral of the product of one lobe with each of many. Relative error 1e-6 (1 + e), where e is
/// the exponent's magnitude.
void inner_product(const SphericalGaussian<float>& lobe, const SphericalGaussians& others,
                   std::span<float> results) noexcept;

/// inner_product_closed_form of one lobe with each of many. Relative error 1e-5 (1 + e), and that
/// of the dot products: b * 2e-7 in an exponent of bandwidth b, and 4e-7 of the smaller lobe's
/// integral. Between bandwidths that differ by more than 1e30, the magnitude only.
void inner_product(const AnisotropicGaussian<float>& lobe, const AnisotropicGaussians& others,
                   std::span<float> results) noexcept;

/// results[i] = vector . direction i, to 2e-7.
void dot(const Vector3f& vector, const Directions& directions, std::span<float> results) noexcept;

/// Visible fractions, absolute error 1e-6 (of distances below 1e-20 under sharpness above 1e30:
/// 5e-4). Hidden tails above 1e-35: relative 5e-5, but for `directional` under bandwidths below 1.
void visible_fraction_directional(std::span<const float> bandwidths_across,
                                  std::span<const float> distances,
                                  std::span<float> results) noexcept;
void visible_fraction_hemisphere(std::span<const float> sharpness, std::span<const float> distances,
                                 std::span<float> results,
                                 HemisphereLevel level = HemisphereLevel::fast) noexcept;

/// Of one lobe past many boundaries, by the fast level, in two thirds of the time.
void visible_fraction_hemisphere(float sharpness, std::span<const float> distances,
                                 std::span<float> results) noexcept;

/// For gradients in their lobe's frame (the SSDF's gradient's components along x and y): 1e-6
/// relative.
void directional_bandwidth(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
                           std::span<const float> gradients_x, std::span<const float> gradients_y,
                           std::span<float> results) noexcept;

/// Mean of max(n . v, 0) over one lobe, for the normals of many surfaces; `frame` is the lobe's.
/// Absolute error 2e-6.
void mean_clamped_cosine(const LobeMoments<float>& moments, const Frame<float>& frame,
                         const Directions& normals, std::span<float> results) noexcept;

/// The light of one SG onto surfaces of many normals. Absolute error 1e-6 of the value for a normal
/// along its axis.
void clamped_cosine_integral(const PreparedClampedCosine<float>& lobe, const Directions& normals,
                             std::span<float> results) noexcept;

/// ASGs convolved with SGs, for unit amplitudes of both, with one kernel or a kernel each; frames
/// stay as they are. 1e-6 relative.
void convolve(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
              float kernel_sharpness, const ConvolvedLobes& results) noexcept;
void convolve(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
              std::span<const float> kernels_sharpness, const ConvolvedLobes& results) noexcept;

/// Half-vector lobes as lobes over incoming directions, for the unit view outgoing[i] of each: of
/// one material's bandwidths, amplitudes being factors for its lobe's; or a lobe each. Error 4e-7
/// of the axis, 1e-6 of the jacobian, 1e-6 + 8e-7 / c relative of the bandwidths, c the cosine of
/// view and axis, at least .01.
void warp_to_incoming(float bandwidth_x, float bandwidth_y, const Frames& half_frames,
                      const Directions& outgoing, const WarpedLobes& results) noexcept;
void warp_to_incoming(const AnisotropicGaussians& half_lobes, const Directions& outgoing,
                      const WarpedLobes& results) noexcept;

/// The mean form; `shape` is that of the bandwidths. The same errors while the mean of o.h is above
/// 0, with c = jacobian / 4; bandwidths err by 1e-4 where it is 2 deviations below, 6e-4 at 4.
void warp_mean_to_incoming(float bandwidth_x, float bandwidth_y, const LobeShape<float>& shape,
                           const Frames& half_frames, const Directions& outgoing,
                           const WarpedLobes& results) noexcept;

/// Points of the unit square, to 2e-7.
void direction_to_octahedral(const Directions& directions, std::span<float> u,
                             std::span<float> v) noexcept;

/// The instruction sets that are compiled in and that this processor has, the best first.
std::vector<std::string_view> instruction_sets();

/// For tests and measurements: from now on, all calls (of the whole process, and of every library
/// in it that uses Highway) run on this set of instruction_sets(); on the best one if empty.
/// False, and no change, for an unknown name.
bool use_instruction_set(std::string_view name);

}  // namespace burnish::batch
