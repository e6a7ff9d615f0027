#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace burnish::detail {

/// The tensor container of RGL's BRDF files: "tensor_file" and a zero byte, version 1.0, then the
/// fields: name, rank, type, offset, shape; all little endian.
inline constexpr std::string_view kTensorMagic{"tensor_file\0", 12};

struct Tensor {
  int type = 0;                      ///< 1..11, see tensor_file.cpp
  std::vector<std::uint64_t> shape;  ///< elements fit the file
  std::string_view bytes;
};

/// The fields of a tensor file, checked to lie within it. Refers to the bytes it was made from.
class TensorFile {
 public:
  TensorFile(std::string_view bytes, const std::string& subject);

  bool has(const std::string& name) const { return fields_.count(name) != 0; }
  /// A field of floating-point numbers of any size, all finite, with the given rank.
  std::vector<float> numbers(const std::string& name, std::size_t rank) const;
  /// A field of single bytes, any rank.
  std::string_view text(const std::string& name) const;
  const std::vector<std::uint64_t>& shape(const std::string& name) const { return at(name).shape; }
  /// Throws the Error of a field.
  [[noreturn]] void fail(const std::string& name, const std::string& message) const;

 private:
  const Tensor& at(const std::string& name) const;

  std::string subject_;
  std::map<std::string, Tensor> fields_;
};

/// "128 x 128", or "no dimensions".
std::string shape_text(const std::vector<std::uint64_t>& shape);

}  // namespace burnish::detail
