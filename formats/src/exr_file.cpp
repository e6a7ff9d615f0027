#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include <Imath/half.h>
#include <OpenEXR/IexBaseExc.h>
#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaYca.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfTileDescriptionAttribute.h>
#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/output_file.h"
#include "image_formats.h"

namespace burnish {
namespace {

using Imath::Box2i;

/// The bytes of a file as OpenEXR's input.
class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::string_view bytes) : IStream("picture"), bytes_(bytes) {}
  bool read(char target[], int count) override {
    if (count < 0 || position_ > bytes_.size() ||
        static_cast<size_t>(count) > bytes_.size() - position_)
      throw Iex::InputExc("the file ends too early");
    std::memcpy(target, bytes_.data() + position_, static_cast<size_t>(count));
    position_ += static_cast<size_t>(count);
    return position_ < bytes_.size();
  }
  std::uint64_t tellg() override { return position_; }
  void seekg(std::uint64_t position) override { position_ = position; }

 private:
  std::string_view bytes_;
  std::uint64_t position_ = 0;
};

/// OpenEXR's output, kept in memory: its own file streams do not notice when closing fails.
class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("picture") {}
  void write(const char source[], int count) override {
    const size_t end = position_ + static_cast<size_t>(count);
    if (end > bytes_.size()) bytes_.resize(end);
    std::memcpy(bytes_.data() + position_, source, static_cast<size_t>(count));
    position_ = end;
  }
  std::uint64_t tellp() override { return position_; }
  void seekp(std::uint64_t position) override { position_ = position; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::uint64_t position_ = 0;
};

/// What the colours of a part are stored as.
enum class ColorChannels { none, rgb, luminance, luminance_chroma };

bool is_full(const Imf::Channel* channel) {
  return channel && channel->xSampling == 1 && channel->ySampling == 1;
}

ColorChannels color_channels(const Imf::Header& header) {
  const Imf::ChannelList& channels = header.channels();
  if (is_full(channels.findChannel("R")) && is_full(channels.findChannel("G")) &&
      is_full(channels.findChannel("B")))
    return ColorChannels::rgb;
  if (!is_full(channels.findChannel("Y"))) return ColorChannels::none;
  return channels.findChannel("RY") && channels.findChannel("BY") ? ColorChannels::luminance_chroma
                                                                  : ColorChannels::luminance;
}

bool is_deep(const Imf::Header& header) {
  return header.hasType() && Imf::isDeepData(header.type());
}

const char* pixel_type_name(Imf::PixelType type) {
  switch (type) {
    case Imf::UINT:
      return "uint";
    case Imf::HALF:
      return "half";
    case Imf::FLOAT:
      return "float";
    default:
      return "unknown";
  }
}

const char* compression_name(Imf::Compression compression) {
  static constexpr const char* kNames[] = {"none",  "rle", "zips", "zip",  "piz",
                                           "pxr24", "b44", "b44a", "dwaa", "dwab"};
  static_assert(std::size(kNames) == Imf::NUM_COMPRESSION_METHODS);
  return compression < Imf::NUM_COMPRESSION_METHODS ? kNames[compression] : "unknown";
}

std::vector<std::string> channel_names(const Imf::Header& header) {
  std::vector<std::string> names;
  const Imf::ChannelList& channels = header.channels();
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    std::string sampling;
    if (channel.channel().xSampling != 1 || channel.channel().ySampling != 1)
      sampling =
          fmt::format(" 1/{}x1/{}", channel.channel().xSampling, channel.channel().ySampling);
    names.push_back(
        fmt::format("{} {}{}", channel.name(), pixel_type_name(channel.channel().type), sampling));
  }
  return names;
}

/// The first part that has colours we can read.
int find_color_part(const Imf::MultiPartInputFile& file, const std::string& path) {
  bool any_deep = false;
  std::string found;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (is_deep(header)) {
      any_deep = true;
      continue;
    }
    if (color_channels(header) != ColorChannels::none) return part;
    for (const std::string& name : channel_names(header))
      if (found.size() < 200) found += (found.empty() ? "" : ", ") + name;
  }
  if (any_deep && found.empty())
    throw Error(ErrorKind::unsupported, path, "is a deep picture, expected a flat one");
  throw Error(
      ErrorKind::unsupported, path,
      fmt::format("found the channels {}, expected R G B, Y, or Y RY BY{}",
                  found.empty() ? "(none)" : found, any_deep ? " (deep parts are not read)" : ""));
}

std::int64_t box_width(const Box2i& box) { return std::int64_t{box.max.x} - box.min.x + 1; }
std::int64_t box_height(const Box2i& box) { return std::int64_t{box.max.y} - box.min.y + 1; }

/// Refuses headers whose decoding would need far more memory than the file can fill: OpenEXR holds
/// one chunk (a tile, or up to 256 scanlines) of all channels at a time.
void check_chunk_size(const Imf::Header& header, std::uint64_t file_bytes,
                      const std::string& path) {
  constexpr std::int64_t kMaxScanlines = 256;  // DWAB
  constexpr std::int64_t kMaxChannels = 1024;
  std::int64_t channel_count = 0, pixel_bytes = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    ++channel_count;
    pixel_bytes += c.channel().type == Imf::HALF ? 2 : 4;
  }
  if (channel_count > kMaxChannels)
    throw Error(ErrorKind::input, path,
                fmt::format("has {} channels, expected at most {}", channel_count, kMaxChannels));
  std::int64_t pixels =
      box_width(header.dataWindow()) * std::min(box_height(header.dataWindow()), kMaxScanlines);
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tile = header.tileDescription();
    check_image_size(tile.xSize, tile.ySize, file_bytes, path);
    pixels = std::int64_t{tile.xSize} * tile.ySize;
  }
  const auto bytes = static_cast<std::int64_t>(file_bytes);
  const std::int64_t limit = 12 * std::max(kFreePixels, bytes * kMaxPixelsPerByte);
  if (pixels > limit / std::max<std::int64_t>(pixel_bytes, 1))
    throw Error(ErrorKind::input, path,
                fmt::format("a chunk of {} pixels of {} bytes in a file of {} bytes", pixels,
                            pixel_bytes, file_bytes));
}

Imf::Slice pixel_slice(Image& image, const Box2i& window, int component) {
  return Imf::Slice::Make(Imf::FLOAT, image.pixels.data()->data() + component, window, sizeof(Rgb),
                          sizeof(Rgb) * static_cast<size_t>(image.width));
}

/// A subsampled channel: one value for each pixel whose coordinates are multiples of the sampling.
struct ChromaPlane {
  Box2i window;
  int sampling_x = 1, sampling_y = 1;
  int width = 0, height = 0;
  std::vector<float> values;

  ChromaPlane(const Imf::Channel& channel, const Box2i& data_window)
      : window(data_window), sampling_x(channel.xSampling), sampling_y(channel.ySampling) {
    // The data window starts and ends on a multiple of the sampling: OpenEXR's header check.
    width = static_cast<int>((box_width(window) + sampling_x - 1) / sampling_x);
    height = static_cast<int>((box_height(window) + sampling_y - 1) / sampling_y);
    values.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
  }
  Imf::Slice slice() {
    return Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float),
                            sizeof(float) * static_cast<size_t>(width), sampling_x, sampling_y);
  }
  /// Bilinear between samples, x and y from the window's corner.
  float at(int x, int y) const {
    const int x0 = x / sampling_x, y0 = y / sampling_y;
    const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
    const float fx = static_cast<float>(x % sampling_x) / static_cast<float>(sampling_x);
    const float fy = static_cast<float>(y % sampling_y) / static_cast<float>(sampling_y);
    const auto value = [&](int i, int j) {
      return values[static_cast<size_t>(j) * static_cast<size_t>(width) + static_cast<size_t>(i)];
    };
    // Where no interpolation is due, infinity times zero must not make a NaN.
    const float top = fx > 0 ? (1 - fx) * value(x0, y0) + fx * value(x1, y0) : value(x0, y0);
    if (!(fy > 0)) return top;
    const float bottom = fx > 0 ? (1 - fx) * value(x0, y1) + fx * value(x1, y1) : value(x0, y1);
    return (1 - fy) * top + fy * bottom;
  }
};

Imf::Chromaticities chromaticities_of(const Imf::Header& header) {
  return Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities();
}

/// Reads Y, RY = (R - Y) / Y and BY = (B - Y) / Y. Chroma is interpolated bilinearly, in float;
/// OpenEXR's own RgbaInputFile has a 27-tap sinc filter, in half, which rings at bright edges.
void read_luminance_chroma(Imf::InputPart& part, const Box2i& window, Image& image) {
  const Imf::ChannelList& channels = part.header().channels();
  ChromaPlane ry(channels["RY"], window), by(channels["BY"], window);
  Imf::FrameBuffer buffer;
  buffer.insert("Y", pixel_slice(image, window, 1));
  buffer.insert("RY", ry.slice());
  buffer.insert("BY", by.slice());
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  const Imath::V3f weights = Imf::RgbaYca::computeYw(chromaticities_of(part.header()));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const float luminance = image.at(x, y)[1];
      const float r = (ry.at(x, y) + 1) * luminance, b = (by.at(x, y) + 1) * luminance;
      image.at(x, y) = {r, (luminance - r * weights.x - b * weights.z) / weights.y, b};
    }
  }
}

Image read_part(Imf::InputPart& part, ColorChannels colors) {
  const Box2i window = part.header().dataWindow();
  Image image(static_cast<int>(box_width(window)), static_cast<int>(box_height(window)));
  if (colors == ColorChannels::luminance_chroma) {
    read_luminance_chroma(part, window, image);
    return image;
  }
  Imf::FrameBuffer buffer;
  if (colors == ColorChannels::luminance) {
    buffer.insert("Y", pixel_slice(image, window, 0));
  } else {
    buffer.insert("R", pixel_slice(image, window, 0));
    buffer.insert("G", pixel_slice(image, window, 1));
    buffer.insert("B", pixel_slice(image, window, 2));
  }
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  if (colors == ColorChannels::luminance)
    for (Rgb& pixel : image.pixels) pixel = Rgb::Constant(pixel[0]);
  return image;
}

/// The display window's picture: 0 where the data window has no pixels.
Image crop_to_display(const Image& data, const Box2i& data_window, const Box2i& display_window) {
  Image image(static_cast<int>(box_width(display_window)),
              static_cast<int>(box_height(display_window)));
  const int x0 = std::max(data_window.min.x, display_window.min.x);
  const int x1 = std::min(data_window.max.x, display_window.max.x);
  const int y0 = std::max(data_window.min.y, display_window.min.y);
  const int y1 = std::min(data_window.max.y, display_window.max.y);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      image.at(x - display_window.min.x, y - display_window.min.y) =
          data.at(x - data_window.min.x, y - data_window.min.y);
  return image;
}

void note_chromaticities(const Imf::Header& header, ImageReport& report) {
  const Imf::Chromaticities found = chromaticities_of(header), rec709;
  const auto differ = [](const Imath::V2f& a, const Imath::V2f& b) {
    return !((a - b).length() < 1e-3f);  // a finer difference is rounding, not another colour space
  };
  if (differ(found.red, rec709.red) || differ(found.green, rec709.green) ||
      differ(found.blue, rec709.blue) || differ(found.white, rec709.white))
    report.notes.push_back("the primaries are not those of Rec. 709; values are kept as they are");
}

ImageReport describe_part(const Imf::MultiPartInputFile& file, int part) {
  const Imf::Header& header = file.header(part);
  ImageReport report;
  report.format = "OpenEXR";
  report.storage = header.hasTileDescription() ? "tiled" : "scanline";
  report.compression = compression_name(header.compression());
  report.channels = channel_names(header);
  if (file.parts() > 1)
    report.notes.push_back(fmt::format("part {} of {}{}", part + 1, file.parts(),
                                       header.hasName() ? " ('" + header.name() + "')" : ""));
  note_chromaticities(header, report);
  return report;
}

DecodedImage decode(std::string_view bytes, const std::string& path) {
  MemoryInput stream(bytes);
  Imf::MultiPartInputFile file(stream, 0);
  const int part_index = find_color_part(file, path);
  const Imf::Header& header = file.header(part_index);
  const Box2i data_window = header.dataWindow();
  const bool is_environment = Imf::hasEnvmap(header);
  const Box2i picture_window = is_environment ? data_window : header.displayWindow();
  check_image_size(box_width(data_window), box_height(data_window), bytes.size(), path);
  check_image_size(box_width(picture_window), box_height(picture_window), bytes.size(), path);
  check_chunk_size(header, bytes.size(), path);

  DecodedImage decoded;
  decoded.report = describe_part(file, part_index);
  decoded.is_cube_environment = is_environment && Imf::envmap(header) == Imf::ENVMAP_CUBE;
  decoded.is_latlong_environment = is_environment && Imf::envmap(header) == Imf::ENVMAP_LATLONG;
  Imf::InputPart part(file, part_index);
  decoded.image = read_part(part, color_channels(header));
  if (picture_window != data_window) {
    decoded.report.notes.push_back(fmt::format(
        "the data window ({}, {})-({}, {}) is not the display window ({}, {})-({}, {}), which is "
        "the picture",
        data_window.min.x, data_window.min.y, data_window.max.x, data_window.max.y,
        picture_window.min.x, picture_window.min.y, picture_window.max.x, picture_window.max.y));
    decoded.image = crop_to_display(decoded.image, data_window, picture_window);
  }
  return decoded;
}

/// Rounds to half; a finite value stays finite.
Imath::half to_half(float value) {
  constexpr float kLargest = 65504;
  return Imath::half(std::isfinite(value) ? std::clamp(value, -kLargest, kLargest) : value);
}

template <class T, class Convert>
std::vector<T> convert_samples(const Image& image, Convert convert) {
  std::vector<T> samples;
  samples.reserve(image.pixels.size() * 3);
  for (const Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) samples.push_back(convert(pixel[c]));
  return samples;
}

template <class T>
void encode(const Image& image, const std::vector<T>& samples, Imf::PixelType type,
            bool latlong_environment, Imf::OStream& stream) {
  Imf::Header header(image.width, image.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  if (latlong_environment) Imf::addEnvmap(header, Imf::ENVMAP_LATLONG);
  Imf::FrameBuffer buffer;
  const char* const names[] = {"R", "G", "B"};
  for (size_t c = 0; c < 3; ++c) {
    header.channels().insert(names[c], Imf::Channel(type));
    char* base = reinterpret_cast<char*>(const_cast<T*>(samples.data() + c));  // only read
    buffer.insert(names[c], Imf::Slice(type, base, 3 * sizeof(T),
                                       3 * sizeof(T) * static_cast<size_t>(image.width)));
  }
  Imf::OutputFile file(stream, header, 0);
  file.setFrameBuffer(buffer);
  file.writePixels(image.height);
}

}  // namespace

DecodedImage decode_exr(std::string_view bytes, const std::string& path) {
  try {
    return decode(bytes, path);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::input, path, fmt::format("broken OpenEXR file: {}", error.what()));
  }
}

void write_exr(const Image& image, const std::string& path, ExrPixelType type,
               bool latlong_environment) {
  check_writable_image(image, path);
  OutputFile file(path);
  MemoryOutput stream;
  try {
    if (type == ExrPixelType::half_float)
      encode(image, convert_samples<Imath::half>(image, to_half), Imf::HALF, latlong_environment,
             stream);
    else
      encode(image, convert_samples<float>(image, [](float value) { return value; }), Imf::FLOAT,
             latlong_environment, stream);
  } catch (const std::exception& error) {
    throw Error(ErrorKind::output, path, fmt::format("cannot write OpenEXR: {}", error.what()));
  }
  file.write(stream.bytes());
  file.commit();
}

}  // namespace burnish
