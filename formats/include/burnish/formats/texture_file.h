#pragma once

#include <string>

#include "burnish/light/environment_map.h"

namespace burnish {

/// What the values of a texture are.
enum class TextureContent {
  color,  ///< PNG: through the inverse of the sRGB transfer function
  data,   ///< PNG: as they are, 0..1
};

/// Reads a PNG picture (grey, RGB or palette, with alpha or not, of 1..16 bits a channel; alpha is
/// not read) or what read_image reads (which is linear), as RGB, grey in all three. Values that are
/// not finite are refused. Throws Error that names the file.
Image read_texture(const std::string& path, TextureContent content);

/// The inverse of srgb_from_linear, 0..1.
float linear_from_srgb(float srgb);

}  // namespace burnish
