#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string>

namespace burnish {

/// 64-bit FNV-1a of the values' bytes as little-endian machines store them.
class Fnv1a {
 public:
  template <class T>
  void add(std::span<const T> values) {
    static_assert(sizeof(T) % 4 == 0);
    for (const T& value : values) {
      std::uint32_t words[sizeof(T) / 4];
      std::memcpy(words, &value, sizeof(T));
      for (const std::uint32_t word : words)
        for (int shift = 0; shift < 32; shift += 8) {
          hash_ ^= word >> shift & 0xff;
          hash_ *= 0x100000001b3u;
        }
    }
  }

  std::uint64_t value() const { return hash_; }

  /// 16 hex digits.
  std::string hex() const {
    std::string digits(16, '0');
    for (int i = 0; i < 16; ++i)
      digits[static_cast<std::size_t>(i)] = "0123456789abcdef"[hash_ >> (60 - 4 * i) & 15];
    return digits;
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace burnish
