#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "image_formats.h"

/// Based on: the Radiance picture format ("Radiance File Formats", Greg Ward), as Radiance's own
/// color.c reads it, except that mantissas count as m / 256 rather than (m + 1/2) / 256, as in
/// every current tool. A decoder of our own because stb_image takes a truncated file for black
/// pixels and ignores EXPOSURE; the tests compare the two.
namespace burnish {
namespace {

constexpr int kMinRunLengthWidth = 8;  // narrower or wider scanlines are never in the new coding
constexpr int kMaxRunLengthWidth = 32767;
constexpr size_t kMaxHeaderLine = 4096;

struct RadianceReader {
  std::string_view bytes;
  size_t position;
  const std::string& path;

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(ErrorKind::input, path, fmt::format("byte {}: {}", position, message));
  }
  size_t left() const { return bytes.size() - position; }
  unsigned char next() {
    if (left() == 0) fail("the file ends inside its pixels");
    return static_cast<unsigned char>(bytes[position++]);
  }
  std::string_view line() {
    const size_t end = bytes.find('\n', position);
    if (end == std::string_view::npos || end - position > kMaxHeaderLine)
      fail("the header has no end");
    std::string_view text = bytes.substr(position, end - position);
    position = end + 1;
    if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
    return text;
  }
};

std::string_view trim_left(std::string_view text) {
  const size_t first = text.find_first_not_of(" \t");
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

/// The positive number at the start of `text`, which moves past it.
float parse_positive(std::string_view& text, const RadianceReader& reader) {
  text = trim_left(text);
  float value = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc() || !std::isfinite(value) || !(value > 0))
    reader.fail(fmt::format("found '{}', expected a positive number", text));
  text.remove_prefix(static_cast<size_t>(result.ptr - text.data()));
  return value;
}

struct RadianceHeader {
  Rgb scale = Rgb::Ones();  ///< multiplies the stored values
  bool is_scaled = false;
  bool has_format = false;
};

/// Reads the lines up to the empty one.
RadianceHeader read_header(RadianceReader& reader) {
  RadianceHeader header;
  reader.line();  // "#?RADIANCE" or the like
  for (;;) {
    const size_t line_start = reader.position;
    const std::string_view line = reader.line();
    if (line.empty()) {
      if (!header.scale.isFinite().all() || !(header.scale > 0).all())
        reader.fail("EXPOSURE and COLORCORR multiply to more than a float can hold");
      return header;
    }
    const size_t equals = line.find('=');
    if (line.front() == '#' || equals == std::string_view::npos) continue;
    const std::string_view key = line.substr(0, equals);
    std::string_view value = trim_left(line.substr(equals + 1));
    if (key == "FORMAT") {
      if (value != "32-bit_rle_rgbe") {
        reader.position = line_start;
        reader.fail(fmt::format("found the pixel format '{}', expected 32-bit_rle_rgbe", value));
      }
      header.has_format = true;
    } else if (key == "EXPOSURE") {
      header.scale /= parse_positive(value, reader);
      header.is_scaled = true;
    } else if (key == "COLORCORR") {
      for (int c = 0; c < 3; ++c) header.scale[c] /= parse_positive(value, reader);
      header.is_scaled = true;
    }
  }
}

/// The resolution line, as "-Y 512 +X 1024": the first axis is that of the scanlines.
struct RadianceResolution {
  std::int64_t scanlines = 0, length = 0;
  bool columns_first = false;  ///< scanlines are columns
  bool flip_x = false, flip_y = false;

  std::int64_t width() const { return columns_first ? scanlines : length; }
  std::int64_t height() const { return columns_first ? length : scanlines; }
};

RadianceResolution read_resolution(RadianceReader& reader) {
  const size_t line_start = reader.position;
  const std::string_view line = reader.line();
  RadianceResolution resolution;
  std::string_view rest = line;
  bool valid = true;
  char axes[2] = {};
  for (int i = 0; i < 2 && valid; ++i) {
    rest = trim_left(rest);
    valid = rest.size() > 3 && (rest[0] == '-' || rest[0] == '+') &&
            (rest[1] == 'X' || rest[1] == 'Y') && rest[2] == ' ';
    if (!valid) break;
    axes[i] = rest[1];
    if (rest[1] == 'X') resolution.flip_x = rest[0] == '-';  // +X: from left to right
    if (rest[1] == 'Y') resolution.flip_y = rest[0] == '+';  // -Y: from top to bottom
    rest = trim_left(rest.substr(3));
    std::int64_t& count = i == 0 ? resolution.scanlines : resolution.length;
    const auto result = std::from_chars(rest.data(), rest.data() + rest.size(), count);
    valid = result.ec == std::errc();
    rest.remove_prefix(static_cast<size_t>(result.ptr - rest.data()));
  }
  if (!valid || axes[0] == axes[1] || !trim_left(rest).empty()) {
    reader.position = line_start;
    reader.fail(fmt::format("found '{}', expected a resolution as in '-Y 512 +X 1024'",
                            line.substr(0, 40)));
  }
  resolution.columns_first = axes[0] == 'X';
  return resolution;
}

using Rgbe = std::array<unsigned char, 4>;

/// One scanline where each of the four components is run-length coded on its own.
void read_component_runs(RadianceReader& reader, std::vector<Rgbe>& scanline) {
  for (size_t component = 0; component < 4; ++component) {
    size_t x = 0;
    while (x < scanline.size()) {
      const unsigned char code = reader.next();
      const size_t count = code > 128 ? code - 128u : code;
      if (count == 0 || count > scanline.size() - x)
        reader.fail(
            fmt::format("a run of {} pixels where {} are left", count, scanline.size() - x));
      const unsigned char repeated = code > 128 ? reader.next() : 0;
      for (size_t i = 0; i < count; ++i)
        scanline[x++][component] = code > 128 ? repeated : reader.next();
    }
  }
}

/// One scanline of whole pixels, of which (1, 1, 1, n) repeats the last one n times; several in a
/// row are the bytes of one count, lowest first.
void read_pixel_runs(RadianceReader& reader, std::vector<Rgbe>& scanline) {
  int shift = 0;
  size_t x = 0;
  while (x < scanline.size()) {
    Rgbe pixel;
    for (unsigned char& byte : pixel) byte = reader.next();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      scanline[x++] = pixel;
      shift = 0;
      continue;
    }
    const std::uint64_t count = shift < 32 ? std::uint64_t{pixel[3]} << shift : 0;
    if (x == 0 || shift >= 32 || count > scanline.size() - x)
      reader.fail("a run that does not fit its scanline");
    std::fill_n(scanline.begin() + static_cast<std::ptrdiff_t>(x), count, scanline[x - 1]);
    x += count;
    shift += 8;
  }
}

void read_scanline(RadianceReader& reader, std::vector<Rgbe>& scanline) {
  const auto byte = [&](size_t i) {
    return static_cast<unsigned char>(reader.bytes[reader.position + i]);
  };
  const size_t length = scanline.size();
  if (length < kMinRunLengthWidth || length > kMaxRunLengthWidth || reader.left() < 4 ||
      byte(0) != 2 || byte(1) != 2 || byte(2) >= 128)
    return read_pixel_runs(reader, scanline);
  if ((size_t{byte(2)} << 8 | byte(3)) != length)
    reader.fail(fmt::format("a scanline of {} pixels in a picture with scanlines of {}",
                            size_t{byte(2)} << 8 | byte(3), length));
  reader.position += 4;
  read_component_runs(reader, scanline);
}

/// value = mantissa * 2^(exponent - 136); exponent 0 is black.
Rgb rgb_from_rgbe(const Rgbe& pixel) {
  if (pixel[3] == 0) return Rgb::Zero();
  const float scale = std::ldexp(1.0f, pixel[3] - 136);
  return Rgb(pixel[0], pixel[1], pixel[2]) * scale;
}

}  // namespace

DecodedImage decode_radiance(std::string_view bytes, const std::string& path) {
  RadianceReader reader{bytes, 0, path};
  const RadianceHeader header = read_header(reader);
  const RadianceResolution resolution = read_resolution(reader);
  const std::int64_t width = resolution.width(), height = resolution.height();
  check_image_size(width, height, bytes.size(), path);

  DecodedImage decoded;
  decoded.report.format = "Radiance";
  decoded.report.storage = "rgbe";
  decoded.report.compression = "rle";
  decoded.report.channels = {"RGBE 8-bit"};
  if (!header.has_format) decoded.report.notes.push_back("no FORMAT line: taken as RGBE");
  if (header.is_scaled && (header.scale != 1).any())
    decoded.report.notes.push_back(
        fmt::format("values multiplied by {:g} {:g} {:g} to undo EXPOSURE and COLORCORR",
                    header.scale[0], header.scale[1], header.scale[2]));

  Image& image = decoded.image;
  image = Image(static_cast<int>(width), static_cast<int>(height));
  std::vector<Rgbe> scanline(static_cast<size_t>(resolution.length));
  for (int line = 0; line < resolution.scanlines; ++line) {
    read_scanline(reader, scanline);
    for (int i = 0; i < resolution.length; ++i) {
      const int x = resolution.columns_first ? line : i, y = resolution.columns_first ? i : line;
      image.at(resolution.flip_x ? image.width - 1 - x : x,
               resolution.flip_y ? image.height - 1 - y : y) =
          rgb_from_rgbe(scanline[static_cast<size_t>(i)]) * header.scale;
    }
  }
  return decoded;
}

}  // namespace burnish
