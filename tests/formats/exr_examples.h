#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfTiledOutputFile.h>

#include "burnish/light/environment_map.h"

namespace burnish::test {

/// How an example file is stored; written with OpenEXR's own classes.
struct ExrVariant {
  Imf::PixelType type = Imf::HALF;
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  Imf::LineOrder line_order = Imf::INCREASING_Y;
  std::vector<std::string> channels = {"R", "G", "B"};
  bool tiled = false;
  Imf::LevelMode level_mode = Imf::ONE_LEVEL;
  Imath::V2i data_corner = {0, 0};   ///< of the data window, which has the picture's size
  Imath::Box2i display_window = {};  ///< empty: the data window
};

/// One channel's samples as a file stores them.
struct ExrSamples {
  Imf::PixelType type;
  std::vector<std::uint32_t> words;  ///< the sample in the low bytes
  ExrSamples(Imf::PixelType type_, const Image& image, const std::string& channel) : type(type_) {
    const std::string names = "RGB";
    const size_t component = names.find(channel);
    for (const Rgb& pixel : image.pixels) {
      const float value = channel == "Y"                   ? pixel[0]
                          : component == std::string::npos ? 0.25f  // alpha and others
                                                           : pixel[static_cast<int>(component)];
      words.push_back(encode(value));
    }
  }
  std::uint32_t encode(float value) const {
    if (type == Imf::UINT) return static_cast<std::uint32_t>(value);
    if (type == Imf::HALF) return Imath::half(value).bits();
    return std::bit_cast<std::uint32_t>(value);
  }
  Imf::Slice slice(const Imath::Box2i& window) {
    return Imf::Slice::Make(type, words.data(), window, sizeof(std::uint32_t), 0);
  }
};

inline Imf::Header exr_header(const Image& image, const ExrVariant& variant) {
  const Imath::Box2i data(variant.data_corner,
                          variant.data_corner + Imath::V2i(image.width - 1, image.height - 1));
  Imf::Header header(variant.display_window.isEmpty() ? data : variant.display_window, data);
  header.compression() = variant.compression;
  header.lineOrder() = variant.line_order;
  for (const std::string& name : variant.channels)
    header.channels().insert(name, Imf::Channel(variant.type));
  if (variant.tiled) header.setTileDescription({16, 8, variant.level_mode, Imf::ROUND_DOWN});
  return header;
}

/// Writes all levels of a tiled picture; levels above 0 hold zeros.
inline void write_exr_tiles(const Image& image, const ExrVariant& variant,
                            const Imf::Header& header, const std::string& path) {
  Imf::TiledOutputFile file(path.c_str(), header, 0);
  for (int ly = 0; ly < file.numYLevels(); ++ly) {
    for (int lx = 0; lx < file.numXLevels(); ++lx) {
      if (!file.isValidLevel(lx, ly)) continue;
      const Imath::Box2i window = file.dataWindowForLevel(lx, ly);
      const Image level(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1);
      std::vector<ExrSamples> samples;
      samples.reserve(variant.channels.size());
      Imf::FrameBuffer buffer;
      for (const std::string& name : variant.channels) {
        samples.emplace_back(variant.type, lx == 0 && ly == 0 ? image : level, name);
        buffer.insert(name, samples.back().slice(window));
      }
      file.setFrameBuffer(buffer);
      file.writeTiles(0, file.numXTiles(lx) - 1, 0, file.numYTiles(ly) - 1, lx, ly);
    }
  }
}

inline void write_exr_variant(const Image& image, const ExrVariant& variant,
                              const std::string& path, const Imf::Header* other_header = nullptr) {
  const Imf::Header header = other_header ? *other_header : exr_header(image, variant);
  if (variant.tiled) return write_exr_tiles(image, variant, header, path);
  std::vector<ExrSamples> samples;
  samples.reserve(variant.channels.size());
  Imf::FrameBuffer buffer;
  for (const std::string& name : variant.channels) {
    samples.emplace_back(variant.type, image, name);
    buffer.insert(name, samples.back().slice(header.dataWindow()));
  }
  Imf::OutputFile file(path.c_str(), header, 0);
  file.setFrameBuffer(buffer);
  file.writePixels(image.height);
}

/// A deep picture of 4 x 2 pixels without samples.
inline void write_deep_exr(const std::string& path) {
  Imf::Header header(4, 2);
  header.channels().insert("R", Imf::Channel(Imf::HALF));
  header.compression() = Imf::ZIPS_COMPRESSION;
  header.setType(Imf::DEEPSCANLINE);
  Imf::DeepScanLineOutputFile file(path.c_str(), header, 0);
  unsigned counts[8] = {};
  half* samples[8] = {};
  Imf::DeepFrameBuffer buffer;
  buffer.insertSampleCountSlice(Imf::Slice(Imf::UINT, reinterpret_cast<char*>(counts),
                                           sizeof(unsigned), 4 * sizeof(unsigned)));
  buffer.insert("R", Imf::DeepSlice(Imf::HALF, reinterpret_cast<char*>(samples), sizeof(half*),
                                    4 * sizeof(half*), sizeof(half)));
  file.setFrameBuffer(buffer);
  file.writePixels(2);
}

/// Three parts: "depth" with a channel Z, "beauty" with the picture, "other" in black.
inline void write_exr_parts(const Image& picture, const std::string& path) {
  const ExrVariant depth{.channels = {"Z"}}, color{};
  Imf::Header headers[] = {exr_header(picture, depth), exr_header(picture, color),
                           exr_header(picture, color)};
  const char* names[] = {"depth", "beauty", "other"};
  for (size_t i = 0; i < 3; ++i) {
    headers[i].setName(names[i]);
    headers[i].setType(Imf::SCANLINEIMAGE);
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers, 3, false, 0);
  for (int i = 0; i < 3; ++i) {
    std::vector<ExrSamples> samples;
    samples.reserve(3);
    Imf::FrameBuffer buffer;
    const std::vector<std::string>& channels = i == 0 ? depth.channels : color.channels;
    for (const std::string& name : channels) {
      samples.emplace_back(Imf::HALF, i == 1 ? picture : Image(picture.width, picture.height),
                           name);
      buffer.insert(name, samples.back().slice(headers[i].dataWindow()));
    }
    Imf::OutputPart part(file, i);
    part.setFrameBuffer(buffer);
    part.writePixels(picture.height);
  }
}

}  // namespace burnish::test
