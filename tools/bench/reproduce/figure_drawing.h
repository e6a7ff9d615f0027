#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "burnish/light/environment_map.h"
#include "burnish/sphere/frame.h"

/// Lobes and curves for figures: pictures encoded for a display, 0..1.
namespace burnish::tools {

using SphereFunction = std::function<double(const Vector3d& direction)>;

inline constexpr int kDiscSize = 160;          ///< pixels along the edge of a lobe's panel
inline constexpr double kDifferenceGain = 10;  ///< of the last panel of draw_approximation

/// The hemisphere about the frame's z as a disc of equal areas (Lambert's), the frame's x to the
/// right and y up; values over the disc's peak, as grey. Blue-grey outside. `f` is called from many
/// threads.
Image draw_disc(const SphereFunction& f, const Frame<double>& frame);

/// A row of discs: the operands, each scaled to its own peak, then truth and approximation, scaled
/// to the truth's peak, and kDifferenceGain times their difference.
Image draw_approximation(std::span<const SphereFunction> operands, const SphereFunction& truth,
                         const SphereFunction& approximation, const Frame<double>& frame);

/// Pictures below each other, left-aligned, white between them.
Image stacked(std::span<const Image> pictures);

/// Half as wide and half as high, each pixel the mean of four.
Image halved(const Image& picture);

struct Curve {
  std::vector<std::pair<double, double>> points;  ///< x, y > 0, x rising
  Rgb color;                                      ///< as on the display
};

struct Range {
  double low, high;  ///< > 0
};

/// Colours of curves, told apart by the colour-blind (Okabe and Ito).
/// @{
inline const Rgb kBlack{0.0f, 0.0f, 0.0f};
inline const Rgb kVermilion{0.84f, 0.37f, 0.0f};
inline const Rgb kBlue{0.0f, 0.45f, 0.7f};
inline const Rgb kGreen{0.0f, 0.62f, 0.45f};
/// @}

/// Curves over two logarithmic axes, a grey line at each power of ten; what leaves the ranges is
/// cut. 360 by 240 pixels.
Image draw_curves(std::span<const Curve> curves, const Range& x, const Range& y);

}  // namespace burnish::tools
