#pragma once

#include "burnish/shading/shade.h"
#include "harness/rivals/rival.h"

/// Rivals that are settings of our own runtime, and so run on its kernels.
namespace burnish {

/// What the runtime shades with.
struct RuntimeSettings {
  ShadingOptions options = {};
  bool from_map = true;  ///< highlights of the filtered map, else of the lights' lobes
};

/// Our runtime with other options: the paper's own choices (xu2013asg) and ours.
Rival runtime_rival(const RivalScene& scene, const std::string& name,
                    const RuntimeSettings& settings);

/// The same with other distant lobes (in the map's frame) and materials, one prepared by
/// settings.options for each of the scene's.
Rival runtime_rival(const RivalScene& scene, const std::string& name,
                    const RuntimeSettings& settings, LightRig rig,
                    std::vector<PreparedMaterial> materials);

/// Lookups of the map along a lobe by the paper's graphics hardware, which filters so.
inline constexpr int kPaperLookups = 15;

/// xu2013asg: one lobe placed at its peak, the visibility of `model` and the cosine out of the
/// integral (Eq. 29, 30); no ladder. Of Eq. 30, the paper's hemisphere. With one lookup it is as
/// fast as it can be on a processor.
ShadingOptions paper_shading_options(VisibilityModel model = VisibilityModel::hemisphere,
                                     int lookups = kPaperLookups);

/// Bytes that do not grow with the vertices: of the bases, and of the filtered map.
/// @{
size_t shared_bytes(const PreparedTransfer& transfer);
size_t shared_bytes(const PrefilteredEnvironment& environment);
/// @}

}  // namespace burnish
