#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>

/// The cube of edge 2 about the origin, in the binary formats, byte by byte.
namespace burnish::test {

inline constexpr std::array<std::array<float, 3>, 8> kCubeVertices = {{{-1, -1, -1},
                                                                       {1, -1, -1},
                                                                       {1, 1, -1},
                                                                       {-1, 1, -1},
                                                                       {-1, -1, 1},
                                                                       {1, -1, 1},
                                                                       {1, 1, 1},
                                                                       {-1, 1, 1}}};
inline constexpr std::array<std::array<std::int32_t, 4>, 6> kCubeFaces = {
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

/// Appends on a little-endian machine, which is all this builds for.
template <class T>
void append_raw(std::string& bytes, T value, bool big_endian = false) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof value);
  bytes.append(raw, sizeof value);
}

inline std::string binary_cube_ply(bool big_endian) {
  std::string bytes = std::string("ply\nformat ") +
                      (big_endian ? "binary_big_endian" : "binary_little_endian") +
                      " 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
                      "property float z\nelement face 6\n"
                      "property list uchar int vertex_indices\nend_header\n";
  for (const auto& vertex : kCubeVertices)
    for (const float value : vertex) append_raw(bytes, value, big_endian);
  for (const auto& face : kCubeFaces) {
    append_raw(bytes, std::uint8_t{4});
    for (const std::int32_t index : face) append_raw(bytes, index, big_endian);
  }
  return bytes;
}

inline std::string binary_cube_stl() {
  std::string bytes(80, ' ');
  append_raw(bytes, std::uint32_t{12});
  for (const auto& face : kCubeFaces)
    for (const auto& part : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
      bytes.append(12, '\0');
      for (const int corner : part)
        for (const float value :
             kCubeVertices[static_cast<size_t>(face[static_cast<size_t>(corner)])])
          append_raw(bytes, value);
      bytes.append(2, '\0');
    }
  return bytes;
}

}  // namespace burnish::test
