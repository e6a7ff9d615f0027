#include "png_reader.h"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>

#include <png.h>

#include "burnish/formats/error.h"
#include "image_formats.h"

namespace burnish {
namespace {

/// What libpng's callbacks see. They leave by longjmp, over frames without destructors only.
struct Source {
  std::string_view bytes;
  size_t position = 0;
  std::array<char, 160> message = {};
};

void read_source(png_structp png, png_bytep out, size_t size) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (size > source->bytes.size() - source->position) png_error(png, "truncated");
  std::memcpy(out, source->bytes.data() + source->position, size);
  source->position += size;
}

[[noreturn]] void keep_error(png_structp png, png_const_charp message) {
  auto* source = static_cast<Source*>(png_get_error_ptr(png));
  std::strncpy(source->message.data(), message, source->message.size() - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

class PngDecoder {
 public:
  PngDecoder(std::string_view bytes, const std::string& path) : path_(path), source_{bytes} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, keep_error, ignore_warning);
    if (png_) info_ = png_create_info_struct(png_);
    if (!info_) {
      png_destroy_read_struct(&png_, nullptr, nullptr);
      throw Error(ErrorKind::input, path, "libpng cannot be started");
    }
    png_set_user_limits(png_, kMaxImageEdge, kMaxImageEdge);
    png_set_read_fn(png_, &source_, read_source);
  }
  ~PngDecoder() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngDecoder(const PngDecoder&) = delete;
  PngDecoder& operator=(const PngDecoder&) = delete;

  PngPicture decode() {
    if (!read_header()) fail();
    PngPicture picture;
    picture.width = static_cast<int>(png_get_image_width(png_, info_));
    picture.height = static_cast<int>(png_get_image_height(png_, info_));
    check_image_size(picture.width, picture.height, source_.bytes.size(), path_);
    picture.bits = png_get_bit_depth(png_, info_) == 16 ? 16 : 8;
    const size_t row_bytes = png_get_rowbytes(png_, info_);
    std::vector<unsigned char> samples(row_bytes * static_cast<size_t>(picture.height));
    std::vector<png_bytep> rows(static_cast<size_t>(picture.height));
    for (size_t y = 0; y < rows.size(); ++y) rows[y] = samples.data() + y * row_bytes;
    if (!read_rows(rows.data())) fail();
    unpack(samples, row_bytes, picture);
    return picture;
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(ErrorKind::input, path_,
                std::string("a PNG that cannot be read: ") + source_.message.data());
  }

  /// To RGB of 8 or 16 bits. False after an error.
  bool read_header() {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_read_info(png_, info_);
    png_set_palette_to_rgb(png_);
    png_set_expand_gray_1_2_4_to_8(png_);
    png_set_strip_alpha(png_);
    png_set_gray_to_rgb(png_);
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return true;
  }

  bool read_rows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_))) return false;
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }

  /// Values of 16 bits are big endian.
  static void unpack(const std::vector<unsigned char>& samples, size_t row_bytes,
                     PngPicture& picture) {
    const size_t row_values = 3 * static_cast<size_t>(picture.width);
    picture.values.reserve(row_values * static_cast<size_t>(picture.height));
    for (size_t begin = 0; begin < samples.size(); begin += row_bytes)
      for (size_t i = 0; i < row_values; ++i) {
        const unsigned char* at = samples.data() + begin + (picture.bits == 16 ? 2 * i : i);
        picture.values.push_back(picture.bits == 16 ? static_cast<std::uint16_t>(at[0] << 8 | at[1])
                                                    : std::uint16_t{at[0]});
      }
  }

  const std::string& path_;
  Source source_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

}  // namespace

PngPicture decode_png(std::string_view bytes, const std::string& path) {
  return PngDecoder(bytes, path).decode();
}

}  // namespace burnish
