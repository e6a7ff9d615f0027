#include "burnish/formats/radiance_ply.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/output_file.h"

namespace burnish {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr size_t kBlockBytes = 1 << 20;

template <class T>
void append_value(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

void append_vector(std::string& bytes, float x, float y, float z) {
  for (const float value : {x, y, z}) append_value(bytes, value);
}

std::string header(size_t vertices, size_t triangles) {
  std::string text = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment burnish\nelement vertex {}\n", vertices);
  for (const char* name :
       {"x", "y", "z", "nx", "ny", "nz", "radiance_r", "radiance_g", "radiance_b"})
    text += fmt::format("property float {}\n", name);
  for (const char* name : {"red", "green", "blue"})
    text += fmt::format("property uchar {}\n", name);
  return text + fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                            triangles);
}

std::uint8_t display_byte(float radiance, float scale) {
  return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(radiance * scale)));
}

}  // namespace

void write_radiance_ply(const std::string& path, std::span<const Vector3f> positions,
                        std::span<const Vector3f> normals, std::span<const Rgb> radiance,
                        std::span<const Triangle> triangles, float exposure_stops) {
  if (normals.size() != positions.size() || radiance.size() != positions.size())
    throw std::invalid_argument("write_radiance_ply: positions, normals, radiance differ in size");
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t v : triangle)
      if (v >= positions.size())
        throw std::invalid_argument("write_radiance_ply: a triangle refers to no vertex");

  OutputFile file(path);
  std::string block = header(positions.size(), triangles.size());
  const auto flush = [&](size_t limit) {
    if (block.size() <= limit) return;
    file.write(block);
    block.clear();
  };
  const float scale = std::exp2(exposure_stops);
  for (size_t v = 0; v < positions.size(); ++v) {
    append_vector(block, positions[v].x(), positions[v].y(), positions[v].z());
    append_vector(block, normals[v].x(), normals[v].y(), normals[v].z());
    append_vector(block, radiance[v].x(), radiance[v].y(), radiance[v].z());
    for (int i = 0; i < 3; ++i) append_value(block, display_byte(radiance[v][i], scale));
    flush(kBlockBytes);
  }
  for (const Triangle& triangle : triangles) {
    append_value(block, std::uint8_t{3});
    for (const std::uint32_t v : triangle) append_value(block, static_cast<std::int32_t>(v));
    flush(kBlockBytes);
  }
  flush(0);
  file.commit();
}

}  // namespace burnish
