#pragma once

#include <vector>

#include "burnish/light/environment_map.h"

namespace burnish {

/// How a texture goes on beyond its edges.
enum class TextureWrap {
  repeat,
  mirror,  ///< every other time turned round
  clamp,   ///< with the pixels at the edge
};

/// A picture over UV coordinates, which is square there from (0, 0), its lower left, to (1, 1), its
/// upper right; and ever smaller versions of it, which are its means.
struct Texture {
  std::vector<Image> levels;  ///< each half as wide and high, rounded down, to 1 x 1
  TextureWrap wrap = TextureWrap::repeat;
};

/// Of a picture that has a pixel at least.
Texture make_texture(Image picture, TextureWrap wrap);

/// The mean over a square of about `width` (in UV, >= 0) around a place: bilinear between pixels,
/// linear between levels. With width 0, the picture itself. Finite coordinates.
Rgb eval_texture(const Texture& texture, const Vector2<float>& uv, float width) noexcept;

}  // namespace burnish
