#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <png.h>

namespace burnish::test {

/// A PNG of any kind. `samples` are rows of packed values as libpng takes them: big endian.
struct PngExample {
  int width = 0, height = 0;
  int bits = 8;
  int color_type = PNG_COLOR_TYPE_RGB;
  bool interlaced = false;
  std::vector<png_color> palette = {};
  std::vector<unsigned char> samples;
};

inline std::string encode_png(const PngExample& example) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  std::string bytes;
  const auto write = [](png_structp to, png_bytep data, size_t size) {
    static_cast<std::string*>(png_get_io_ptr(to))->append(reinterpret_cast<char*>(data), size);
  };
  png_set_write_fn(png, &bytes, write, [](png_structp) {});
  png_set_IHDR(png, info, static_cast<png_uint_32>(example.width),
               static_cast<png_uint_32>(example.height), example.bits, example.color_type,
               example.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (!example.palette.empty())
    png_set_PLTE(png, info, example.palette.data(), static_cast<int>(example.palette.size()));
  png_write_info(png, info);
  const size_t row_bytes = png_get_rowbytes(png, info);
  if (example.samples.size() != row_bytes * static_cast<size_t>(example.height))
    throw std::logic_error("samples of a PNG do not fit its size");
  std::vector<unsigned char> samples = example.samples;
  std::vector<png_bytep> rows;
  for (int y = 0; y < example.height; ++y)
    rows.push_back(samples.data() + static_cast<size_t>(y) * row_bytes);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

}  // namespace burnish::test
