#pragma once

#include <array>
#include <vector>

#include "burnish/light/environment_map.h"
#include "burnish/material/specular_slice.h"

/// A material's specular part as a viewer sees it: the BRDF times the cosine over incoming
/// directions, exact and as the lobes that shading uses (specular_slice.h).
namespace burnish {

inline constexpr std::array kLobeViewsDeg = {0.0f, 30.0f, 60.0f, 80.0f};
inline constexpr float kLobeViewAzimuthDeg = 30;  ///< from the tangent toward the bitangent
inline constexpr int kLobePanel = 192;            ///< pixels along the edge of a panel
inline constexpr int kLobePanelGap = 4;           ///< pixels between and around panels, white

/// How far the lobes are from the exact values, for a view.
struct SliceError {
  float view_deg = 0;       ///< from the normal
  double albedo = 0;        ///< exact: luminance of the integral
  double lobes_albedo = 0;  ///< the same of the lobes, above the horizon
  double relative_l2 = 0;   ///< |lobes - exact| / |exact| over the hemisphere, RGB; 0 without any
};

/// Of each of kLobeViewsDeg, by 2^15 points that are spread as both the BRDF and the hemisphere
/// are. Requires material.has_specular().
std::vector<SliceError> slice_errors(const Material& material, const SpecularOptions& options);

/// A row for each of kLobeViewsDeg; columns exact, lobes, and ten times their difference |a - b|.
/// Each panel is the hemisphere from above, tangent to the right, grey outside; a row is scaled to
/// its exact peak. Linear, for write_png().
Image draw_material_lobes(const Material& material, const SpecularOptions& options);

}  // namespace burnish
