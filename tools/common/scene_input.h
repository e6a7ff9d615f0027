#pragma once

#include <string>

#include "harness/procedural_scenes.h"

namespace burnish::tools {

/// A procedural scene by its name, or a mesh file with a camera that frames it and one grey
/// material.
ProceduralScene load_subject(const std::string& name);

}  // namespace burnish::tools
