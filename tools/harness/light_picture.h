#pragma once

#include "burnish/light/environment_map.h"
#include "burnish/light/light_rig.h"

/// A fit of lights as a picture: the environment, the lobes that stand in for it and the difference
/// of both, |a - b| by channel, side by side as lat-long maps at one exposure. Over the lobes'
/// panel lies an ellipse a lobe, as far from its axis as the lobe falls to exp(-1/2) of its peak
/// (one standard deviation), and a cross at the axis. An ellipse goes on across the seam and around
/// the poles.
namespace burnish {

inline constexpr int kPanelWidth = 768;
inline constexpr int kPanelHeight = kPanelWidth / 2;
inline constexpr int kPanelGap = 8;  ///< pixels between panels, white

/// Stops after which an environment's log-mean luminance is a middle grey, 0.18; black parts, below
/// a millionth of the mean, are left out. 0 for a black environment.
float picture_exposure_stops(const Image& environment);

/// The direction from a lobe's axis, turned by `angle_rad` from its x toward its y, in which the
/// lobe has fallen to exp(-1/2) of its peak.
Vector3d lobe_contour(const AnisotropicGaussian<float>& lobe, double angle_rad);

/// The three panels for write_png() without exposure: values are multiplied by 2^exposure_stops
/// already. The environment's pixels are averaged over those of a panel.
Image draw_light_fit(const Image& environment, const LightRig& rig, float exposure_stops);

}  // namespace burnish
