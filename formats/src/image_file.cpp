#include "burnish/formats/image_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <png.h>

#include "burnish/formats/error.h"
#include "burnish/formats/output_file.h"
#include "file_bytes.h"
#include "image_formats.h"

namespace burnish {
namespace {

void measure_values(const Image& image, ImageReport& report) {
  std::array<std::uint64_t, 3> finite = {};
  std::array<double, 3> sum = {};
  for (const Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) {
      const float value = pixel[c];
      if (std::isnan(value)) {
        ++report.nan_values;
        continue;
      }
      if (value < 0) ++report.negative_values;
      if (std::isinf(value)) {
        ++report.infinite_values;
        continue;
      }
      const size_t channel = static_cast<size_t>(c);
      const bool first = finite[channel]++ == 0;
      report.min[channel] = first ? value : std::min(report.min[channel], value);
      report.max[channel] = first ? value : std::max(report.max[channel], value);
      sum[channel] += value;
    }
  }
  for (size_t c = 0; c < 3; ++c)
    report.mean[c] = finite[c] > 0 ? sum[c] / static_cast<double>(finite[c]) : 0;
}

bool starts_with(std::string_view bytes, std::string_view magic) {
  return bytes.substr(0, magic.size()) == magic;
}

/// What a file that is neither OpenEXR nor Radiance looks like, for the error.
std::string foreign_format(std::string_view bytes) {
  if (bytes.empty()) return "an empty file";
  if (starts_with(bytes, "\x89PNG")) return "a PNG picture, which has no high dynamic range";
  if (starts_with(bytes, "\xff\xd8\xff")) return "a JPEG picture, which has no high dynamic range";
  if (starts_with(bytes, "PF\n") || starts_with(bytes, "Pf\n")) return "a PFM picture";
  if (starts_with(bytes, std::string_view("II*\0", 4)) ||
      starts_with(bytes, std::string_view("MM\0*", 4)))
    return "a TIFF picture";
  return "an unknown format";
}

DecodedImage decode_image(const std::string& path) {
  const std::string bytes = read_file_bytes(path);
  DecodedImage decoded;
  if (starts_with(bytes, "\x76\x2f\x31\x01")) {
    decoded = decode_exr(bytes, path);
  } else if (starts_with(bytes, "#?")) {
    decoded = decode_radiance(bytes, path);
  } else {
    throw Error(
        ErrorKind::input, path,
        fmt::format("found {}, expected an OpenEXR or Radiance picture", foreign_format(bytes)));
  }
  decoded.report.width = decoded.image.width;
  decoded.report.height = decoded.image.height;
  measure_values(decoded.image, decoded.report);
  return decoded;
}

/// What a picture of this shape is laid out as, if not as longitude and latitude; "" if it may be.
const char* foreign_layout(int width, int height) {
  constexpr int kLeastEdge = 16;  // of a picture that has a layout to speak of
  if (std::min(width, height) < kLeastEdge) return "";
  if (width == height) return "an angular map, a mirror ball or an octahedral map";
  const auto is_ratio = [&](std::int64_t across, std::int64_t down) {
    return width * down == height * across;
  };
  if (is_ratio(4, 3) || is_ratio(3, 4)) return "a cube map unfolded to a cross";
  if (is_ratio(6, 1) || is_ratio(1, 6)) return "the six faces of a cube map in a strip";
  return "";
}

}  // namespace

void check_image_size(std::int64_t width, std::int64_t height, std::uint64_t file_bytes,
                      const std::string& path) {
  if (width < 1 || height < 1 || width > kMaxImageEdge || height > kMaxImageEdge)
    throw Error(ErrorKind::input, path,
                fmt::format("the picture is {} x {} pixels, expected 1..{} each", width, height,
                            kMaxImageEdge));
  const std::int64_t pixels = width * height;
  const auto bytes = static_cast<std::int64_t>(
      std::min<std::uint64_t>(file_bytes, std::uint64_t{1} << 40));  // no overflow below
  if (pixels > kFreePixels && pixels > bytes * kMaxPixelsPerByte)
    throw Error(ErrorKind::input, path,
                fmt::format("the picture claims {} x {} pixels in a file of {} bytes, expected at "
                            "most {} pixels per byte",
                            width, height, file_bytes, kMaxPixelsPerByte));
}

void check_writable_image(const Image& image, const std::string& path) {
  const bool in_range = image.width >= 1 && image.height >= 1 && image.width <= kMaxImageEdge &&
                        image.height <= kMaxImageEdge;
  if (!in_range)
    throw Error(ErrorKind::output, path,
                fmt::format("a picture of {} x {} pixels, expected 1..{} each", image.width,
                            image.height, kMaxImageEdge));
  if (image.pixels.size() != static_cast<size_t>(image.width) * static_cast<size_t>(image.height))
    throw Error(ErrorKind::output, path,
                fmt::format("a picture of {} x {} pixels has {} values", image.width, image.height,
                            image.pixels.size()));
}

Image read_image(const std::string& path, ImageReport* report) {
  DecodedImage decoded = decode_image(path);
  if (report) *report = std::move(decoded.report);
  return std::move(decoded.image);
}

Image read_environment(const std::string& path, EnvironmentReport* report) {
  DecodedImage decoded = decode_image(path);
  if (decoded.is_cube_environment)
    throw Error(ErrorKind::unsupported, path,
                "is a cube map (envmap attribute), expected a lat-long environment");
  const char* layout = foreign_layout(decoded.image.width, decoded.image.height);
  if (*layout && !decoded.is_latlong_environment)
    throw Error(ErrorKind::unsupported, path,
                fmt::format("{} x {} pixels, as {} has; expected a lat-long environment, twice as "
                            "wide as high (an OpenEXR file that is one says so: envmap = latlong)",
                            decoded.image.width, decoded.image.height, layout));
  EnvironmentReport result;
  result.image = std::move(decoded.report);
  if (decoded.image.width != 2 * decoded.image.height)
    result.image.notes.push_back(
        fmt::format("{} x {} pixels: a lat-long environment is usually twice as wide as high; it "
                    "is stretched over the sphere",
                    decoded.image.width, decoded.image.height));
  result.replaced_values = sanitize_environment(decoded.image, &result.infinity_replacement);
  if (report) *report = std::move(result);
  return std::move(decoded.image);
}

std::uint64_t sanitize_environment(Image& image, float* infinity_replacement) {
  float largest = 0;
  for (const Rgb& pixel : image.pixels)
    for (const float value : {pixel[0], pixel[1], pixel[2]})
      if (std::isfinite(value)) largest = std::max(largest, value);
  std::uint64_t replaced = 0;
  for (Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) {
      if (pixel[c] >= 0 && std::isfinite(pixel[c])) continue;
      pixel[c] = pixel[c] > 0 ? largest : 0;  // NaN compares false
      ++replaced;
    }
  }
  if (infinity_replacement) *infinity_replacement = largest;
  return replaced;
}

float srgb_from_linear(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

std::vector<unsigned char> srgb_bytes(const Image& image, float exposure_stops) {
  const float scale = std::exp2(exposure_stops);
  std::vector<unsigned char> samples;
  samples.reserve(image.pixels.size() * 3);
  for (const Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c)
      samples.push_back(
          static_cast<unsigned char>(std::lround(255 * srgb_from_linear(pixel[c] * scale))));
  return samples;
}

void write_png(const Image& image, const std::string& path, float exposure_stops) {
  check_writable_image(image, path);
  const std::vector<unsigned char> samples = srgb_bytes(image, exposure_stops);

  OutputFile file(path);
  png_image header = {};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;  // 8 bits with the sRGB transfer function
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<unsigned char> bytes(size);
  if (!png_image_write_to_memory(&header, bytes.data(), &size, 0, samples.data(), 0, nullptr)) {
    const std::string reason = header.message;
    png_image_free(&header);
    throw Error(ErrorKind::output, path, "cannot write PNG: " + reason);
  }
  bytes.resize(size);
  file.write(bytes);
  file.commit();
}

}  // namespace burnish
