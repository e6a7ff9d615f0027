#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "burnish/formats/image_file.h"

/// The two picture decoders behind read_image. Each gets the whole file; `path` is for errors. They
/// fill the report but for its counts and statistics.
namespace burnish {

struct DecodedImage {
  Image image;
  ImageReport report;
  bool is_cube_environment = false;     ///< the envmap attribute says so
  bool is_latlong_environment = false;  ///< likewise
};

DecodedImage decode_exr(std::string_view bytes, const std::string& path);
DecodedImage decode_radiance(std::string_view bytes, const std::string& path);

/// Throws when a picture of this size is out of range, or larger than a file of `file_bytes` may
/// claim to hold.
void check_image_size(std::int64_t width, std::int64_t height, std::uint64_t file_bytes,
                      const std::string& path);

/// Throws Error(ErrorKind::output) when a picture has no pixels, too many, or not as many as its
/// size says.
void check_writable_image(const Image& image, const std::string& path);

}  // namespace burnish
