#pragma once

#include <vector>

#include "burnish/formats/measured_brdf.h"
#include "burnish/light/environment_map.h"
#include "burnish/material/material.h"

/// A measured BRDF beside materials that stand in for it (as Fig. 9 of xu2013asg): slices for views
/// at 0, 20, 40, 60 and 75 degrees from the normal, a row a view. Columns: the measurement, each
/// material, and |first material - measurement| by channel.
///
/// A panel shows f cos(incoming) over the incoming directions around the mirror direction, which is
/// its centre; its radius is an angle (equidistant), the same for all panels. Grey is below the
/// horizon, or not measured. A row has one exposure: its measured 99.5 % quantile is 1.
namespace burnish {

inline constexpr int kBrdfPanelSize = 76;  ///< pixels
inline constexpr int kBrdfPanelGap = 4;    ///< white
inline constexpr int kBrdfPanelRows = 5;

/// Angle that a panel shows around the mirror direction: twice that at which the distribution of
/// `material` has fallen to a hundredth, at most pi / 2.
double brdf_panel_radius(const Material& material);

/// The picture, values 0..1 for write_png() without exposure. `view_azimuth_rad` of the views.
Image draw_brdf_fit(const MeasuredBrdf& measured, const std::vector<Material>& materials,
                    double view_azimuth_rad = 0);

}  // namespace burnish
