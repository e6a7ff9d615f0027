#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/light/environment_map.h"

/// Pictures in and out. A file's format is told by its first bytes, never by its name.
///
/// OpenEXR: half, float and uint channels; scanline and tiled (of a mip or rip map, level 0); every
/// compression; RGB, RGBA (alpha is not read: colours are premultiplied, i.e. over black),
/// luminance Y, and luminance-chroma Y RY BY. Of several parts the first with such channels is
/// read. Deep parts, and pictures without such channels, are refused.
/// Radiance (.hdr, .pic): RGBE, flat and both run-length codings, in any orientation; values are
/// divided by the file's EXPOSURE and COLORCORR.
namespace burnish {

/// Dimensions of a picture are 1..kMaxImageEdge. Beyond kFreePixels pixels, a picture may have at
/// most kMaxPixelsPerByte pixels per byte of its file, so that a forged header cannot ask for all
/// memory.
inline constexpr int kMaxImageEdge = 65536;
inline constexpr std::int64_t kFreePixels = std::int64_t{1} << 24;
inline constexpr std::int64_t kMaxPixelsPerByte = 4096;

/// What a picture file contains. Counts and statistics are of the 3 * width * height values of the
/// picture as read, before anything is replaced.
struct ImageReport {
  std::string format;                 ///< "OpenEXR" or "Radiance"
  std::string storage;                ///< "scanline", "tiled", "rgbe"
  std::string compression;            ///< "none", "zip", "dwaa", ..., "rle"
  std::vector<std::string> channels;  ///< as "R half", all channels of the part that was read
  int width = 0;                      ///< of the picture as read
  int height = 0;
  std::uint64_t nan_values = 0;
  std::uint64_t infinite_values = 0;  ///< of either sign
  std::uint64_t negative_values = 0;  ///< < 0, with -infinity
  std::array<float, 3> min = {};      ///< of the finite values of each channel; 0 if there are none
  std::array<float, 3> max = {};
  std::array<double, 3> mean = {};
  std::vector<std::string> notes;  ///< one sentence each, of what a user may want to know
};

/// What read_environment changed.
struct EnvironmentReport {
  ImageReport image;
  float infinity_replacement = 0;  ///< what +infinity became
  std::uint64_t replaced_values = 0;
};

/// Reads a picture as linear RGB (Rec. 709 unless the file's chromaticities say otherwise: then a
/// note says so, and the values are kept). The picture is the OpenEXR display window: pixels of it
/// that the data window lacks are 0, pixels outside it are dropped. When the file is marked as a
/// lat-long environment map, the picture is the data window (ImfEnvmap.h). Throws Error for a file
/// that is missing, truncated, broken, or of another kind.
Image read_image(const std::string& path, ImageReport* report = nullptr);

/// Reads a lat-long environment: read_image, then sanitize_environment. Other layouts are refused
/// by name: a cube map (by the OpenEXR envmap attribute) and, by their proportions, angular maps
/// and mirror balls (1:1), crosses (4:3, 3:4) and strips (6:1, 1:6) of cube faces; not where the
/// envmap attribute says lat-long, nor below 16 pixels' width or height. Any other width that is
/// not twice the height is accepted with a note.
Image read_environment(const std::string& path, EnvironmentReport* report = nullptr);

/// Makes every value finite and >= 0: NaN, negative values and -infinity become 0; +infinity
/// becomes the largest finite value of the picture, or 0 when none is positive. Returns how many
/// values changed; `infinity_replacement`, if given, receives the value that infinity became.
std::uint64_t sanitize_environment(Image& image, float* infinity_replacement = nullptr);

enum class ExrPixelType {
  half_float,   ///< 16 bits; finite values are clamped to +-65504
  single_float  ///< 32 bits, exact
};

/// Writes a scanline OpenEXR file: channels R, G, B, ZIP compression, display window = data window
/// from (0, 0). `latlong_environment` sets the envmap attribute. Throws Error(ErrorKind::output).
void write_exr(const Image& image, const std::string& path,
               ExrPixelType type = ExrPixelType::half_float, bool latlong_environment = false);

/// The picture as 8-bit sRGB, rows from the top, three bytes a pixel: values times
/// 2^exposure_stops, clamped to 0..1 (NaN becomes 0), through the sRGB transfer function.
std::vector<unsigned char> srgb_bytes(const Image& image, float exposure_stops = 0);

/// Writes srgb_bytes as a PNG file. Throws Error(ErrorKind::output).
void write_png(const Image& image, const std::string& path, float exposure_stops = 0);

/// The sRGB transfer function (IEC 61966-2-1), 0..1 to 0..1; what is outside is clamped, NaN is 0.
float srgb_from_linear(float linear);

}  // namespace burnish
