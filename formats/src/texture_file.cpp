#include "burnish/formats/texture_file.h"

#include <cmath>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/image_file.h"
#include "file_bytes.h"
#include "png_reader.h"

namespace burnish {
namespace {

Image image_of(const PngPicture& picture, TextureContent content) {
  std::vector<float> decoded(size_t{1} << picture.bits);
  for (size_t i = 0; i < decoded.size(); ++i) {
    const float value = static_cast<float>(i) / static_cast<float>(decoded.size() - 1);
    decoded[i] = content == TextureContent::color ? linear_from_srgb(value) : value;
  }
  Image image(picture.width, picture.height);
  for (size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {decoded[picture.values[3 * i]], decoded[picture.values[3 * i + 1]],
                       decoded[picture.values[3 * i + 2]]};
  return image;
}

}  // namespace

Image read_texture(const std::string& path, TextureContent content) {
  if (read_file_start(path, kPngSignature.size()) == kPngSignature)
    return image_of(decode_png(read_file_bytes(path), path), content);
  ImageReport report;
  Image image = read_image(path, &report);
  if (const std::uint64_t bad = report.nan_values + report.infinite_values; bad > 0)
    throw Error(ErrorKind::input, path,
                fmt::format("{} values are not finite, expected none in a texture", bad));
  return image;
}

float linear_from_srgb(float srgb) {
  if (!(srgb > 0)) return 0;
  if (srgb >= 1) return 1;
  return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}

}  // namespace burnish
