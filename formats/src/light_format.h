#pragma once

#include "burnish/formats/light_file.h"
#include "json_values.h"

/// What the reader and the writer of light files share.
namespace burnish {

inline constexpr JsonFormat kLightFormat = {"burnish lights", "light", kLightFormatVersion};

}  // namespace burnish
