#pragma once

#include <span>
#include <string>
#include <string_view>

#include "burnish/material/material.h"

namespace burnish {

/// A named material. Its numbers are published ones as far as `source` says.
struct MaterialPreset {
  std::string name;    ///< lower case, words with blanks
  std::string source;  ///< where the numbers come from, and which are our own
  Material material;
};

/// All presets, by kind.
std::span<const MaterialPreset> material_presets();

/// The preset of a name, in which case does not matter and '-' and '_' stand for a blank; null if
/// there is none.
const MaterialPreset* find_material_preset(std::string_view name);

}  // namespace burnish
