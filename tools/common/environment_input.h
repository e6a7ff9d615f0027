#pragma once

#include <string>

#include "burnish/light/environment_map.h"
#include "common/work.h"

namespace burnish::tools {

/// The name that stands for the procedural studio environment in place of a file.
inline constexpr const char* kStudioName = "studio";

/// The lat-long map of a file, or the studio; prints what is odd about the file.
Image load_environment(const std::string& name, Work& work);

}  // namespace burnish::tools
