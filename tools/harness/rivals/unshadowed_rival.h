#pragma once

#include "harness/rivals/rival.h"

/// Based on: karis2013ue4 (split sum), guy2018filament (anisotropy by a bent reflection): what
/// engines do with an environment. Nothing casts shadows. The diffuse part sees the irradiance of
/// the whole map; a highlight sees the map filtered by a round lobe at the reflected direction,
/// times the material's own directional albedo. Local and directional lights shine unblocked, by
/// our runtime.
namespace burnish {

struct UnshadowedOptions {
  /// Bends the normal that reflects, by Filament's rule for brushed materials. Without, the
  /// geometric mean of the two roughnesses alone tells of anisotropy: less error on the dish.
  bool bent = false;
};

Rival unshadowed_rival(const RivalScene& scene, const UnshadowedOptions& options = {});

}  // namespace burnish
