#pragma once

#include "burnish/formats/material_file.h"
#include "json_values.h"

/// What the reader and the writer of material files share.
namespace burnish {

inline constexpr JsonFormat kMaterialFormat = {"burnish material", "material",
                                               kMaterialFormatVersion};

}  // namespace burnish
