#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/half_space.h"
#include "burnish/sphere/lobe_moments.h"
#include "burnish/sphere/octahedral_map.h"
#include "burnish/sphere/spherical_gaussian.h"

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

/// Lobes, as structures of arrays. A frame's y is z x x.
struct SphericalGaussians {
  Directions axis;
  std::span<const float> sharpness, amplitude;
};
struct AnisotropicGaussians {
  Directions x, z;
  std::span<const float> bandwidth_x, bandwidth_y, amplitude;
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
/// of the dot products: b * 2e-7 in an exponent of bandwidth b.
void inner_product(const AnisotropicGaussian<float>& lobe, const AnisotropicGaussians& others,
                   std::span<float> results) noexcept;

/// results[i] = vector . direction i, to 2e-7.
void dot(const Vector3f& vector, const Directions& directions, std::span<float> results) noexcept;

/// Visible fractions, absolute error 1e-6; hidden tails above 1e-35 relative 5e-5.
void visible_fraction_directional(std::span<const float> bandwidths_across,
                                  std::span<const float> distances,
                                  std::span<float> results) noexcept;
void visible_fraction_hemisphere(std::span<const float> sharpness, std::span<const float> distances,
                                 std::span<float> results,
                                 HemisphereLevel level = HemisphereLevel::fast) noexcept;

/// For gradients in their lobe's frame (the SSDF's gradient's components along x and y): 1e-6
/// relative.
void directional_bandwidth(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
                           std::span<const float> gradients_x, std::span<const float> gradients_y,
                           std::span<float> results) noexcept;

/// Mean of max(n . v, 0) over one lobe, for the normals of many surfaces; `frame` is the lobe's.
/// Absolute error 2e-6.
void mean_clamped_cosine(const LobeMoments<float>& moments, const Frame<float>& frame,
                         const Directions& normals, std::span<float> results) noexcept;

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
