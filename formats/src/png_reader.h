#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace burnish {

inline constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n";

/// A decoded PNG: RGB, of 8 or 16 bits a channel.
struct PngPicture {
  int width = 0;
  int height = 0;
  int bits = 8;
  std::vector<std::uint16_t> values;  ///< [height][width][3], 0..2^bits - 1
};

/// `bytes` is a whole file; `path` is for errors. Palettes and grey become RGB; alpha is dropped.
PngPicture decode_png(std::string_view bytes, const std::string& path);

}  // namespace burnish
