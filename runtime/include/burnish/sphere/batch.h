#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "burnish/sphere/anisotropic_gaussian.h"
#include "burnish/sphere/asg_integral.h"
#include "burnish/sphere/half_space.h"
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

/// Integrals of unit-amplitude ASGs: 2e-6 relative, the exact level; the error of the level
/// otherwise.
void asg_integral(std::span<const float> bandwidths_x, std::span<const float> bandwidths_y,
                  AsgIntegral level, std::span<float> results) noexcept;

/// Visible fractions, absolute error 1e-6; hidden tails above 1e-35 relative 1e-5.
void visible_fraction_directional(std::span<const float> bandwidths_across,
                                  std::span<const float> distances,
                                  std::span<float> results) noexcept;
void visible_fraction_hemisphere(std::span<const float> sharpness, std::span<const float> distances,
                                 std::span<float> results) noexcept;

/// The instruction sets that are compiled in and that this processor has, the best first.
std::vector<std::string_view> instruction_sets();

/// For tests and measurements: from now on, all calls (of the whole process, and of every library
/// in it that uses Highway) run on this set of instruction_sets(); on the best one if empty.
/// False, and no change, for an unknown name.
bool use_instruction_set(std::string_view name);

}  // namespace burnish::batch
