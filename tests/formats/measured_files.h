#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace burnish::test {

/// One field of a tensor file; `bytes` are the elements.
struct TensorField {
  std::string name;
  unsigned char type;
  std::vector<std::uint64_t> shape;
  std::string bytes;
};

template <class T>
void append_number(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

/// Written after the format's description, apart from the reader.
inline std::string tensor_file(const std::vector<TensorField>& fields) {
  std::string head("tensor_file\0\1\0", 14);
  append_number(head, static_cast<std::uint32_t>(fields.size()));
  std::size_t size = head.size();
  for (const TensorField& field : fields)
    size += 2 + field.name.size() + 2 + 1 + 8 + 8 * field.shape.size();
  std::string data;
  for (const TensorField& field : fields) {
    append_number(head, static_cast<std::uint16_t>(field.name.size()));
    head += field.name;
    append_number(head, static_cast<std::uint16_t>(field.shape.size()));
    head += static_cast<char>(field.type);
    append_number(head, std::uint64_t{size + data.size()});
    for (const std::uint64_t edge : field.shape) append_number(head, edge);
    data += field.bytes;
  }
  return head + data;
}

inline constexpr unsigned char kTensorUint8 = 1, kTensorFloat16 = 9, kTensorFloat32 = 10,
                               kTensorFloat64 = 11;

/// A float32 field whose elements are `value(index)` in storage order.
template <class Value>
TensorField float_field(const std::string& name, const std::vector<std::uint64_t>& shape,
                        const Value& value) {
  TensorField field{name, kTensorFloat32, shape, ""};
  std::uint64_t count = 1;
  for (const std::uint64_t edge : shape) count *= edge;
  for (std::uint64_t i = 0; i < count; ++i)
    append_number(field.bytes, static_cast<float>(value(i)));
  return field;
}

}  // namespace burnish::test
