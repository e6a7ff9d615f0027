#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace burnish::detail {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

constexpr size_t size_bytes(PlyType type) {
  constexpr size_t kSize[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSize[static_cast<int>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;  ///< of the value, or of a list's entries
  bool is_list = false;
  PlyType count_type = PlyType::uint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { ascii, binary_little_endian, binary_big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  size_t body_offset = 0;  ///< of the first byte after end_header and its line end
  std::vector<std::string> notes;
};

/// Reads the header that a PLY file begins with. Throws Error with the line for what is no header.
PlyHeader read_ply_header(const std::string& path, std::string_view bytes);

}  // namespace burnish::detail
