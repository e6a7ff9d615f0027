#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/direction.h"

namespace burnish {

/// 64-bit FNV-1a of values' bytes as the machine stores them. Spans count with their length, so
/// that values cannot move from one to the next unseen.
class ContentHash {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void add(T value) { add_bytes(&value, sizeof(T)); }
  void add(std::string_view text) {
    add(text.size());
    add_bytes(text.data(), text.size());
  }
  void add(const Rgb& color) { add_bytes(color.data(), 3 * sizeof(float)); }
  void add(const Vector3f& vector) { add_bytes(vector.data(), 3 * sizeof(float)); }

  /// Values without padding.
  template <class T>
  void add(std::span<const T> values) {
    add(values.size());
    add_bytes(values.data(), values.size_bytes());
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::span<const T>(values));
  }

  std::uint64_t value() const { return hash_; }

  /// 16 hex digits.
  std::string hex() const {
    std::string digits(16, '0');
    for (int i = 0; i < 16; ++i)
      digits[static_cast<size_t>(i)] = "0123456789abcdef"[hash_ >> (60 - 4 * i) & 15];
    return digits;
  }

 private:
  void add_bytes(const void* data, size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < size; ++i) {
      hash_ ^= bytes[i];
      hash_ *= 0x100000001b3u;
    }
  }

  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace burnish
