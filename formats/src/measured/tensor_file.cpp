#include "measured/tensor_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <Eigen/Core>
#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "mesh/mesh_text.h"

namespace burnish::detail {
namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are copied");

struct ElementType {
  const char* name;
  std::size_t bytes;
};
constexpr std::array<ElementType, 12> kTypes = {{{"invalid", 0},
                                                 {"uint8", 1},
                                                 {"int8", 1},
                                                 {"uint16", 2},
                                                 {"int16", 2},
                                                 {"uint32", 4},
                                                 {"int32", 4},
                                                 {"uint64", 8},
                                                 {"int64", 8},
                                                 {"float16", 2},
                                                 {"float32", 4},
                                                 {"float64", 8}}};
constexpr int kUint8 = 1, kInt8 = 2, kFloat16 = 9, kFloat64 = 11;

/// Takes numbers off the front of a file.
class Reader {
 public:
  Reader(std::string_view bytes, const std::string& subject) : bytes_(bytes), subject_(subject) {}

  std::string_view take(std::size_t count, const char* what) {
    if (count > bytes_.size() - position_)
      fail(fmt::format("{} of {} bytes, expected within the file's {} bytes", what, count,
                       bytes_.size()));
    const std::string_view taken = bytes_.substr(position_, count);
    position_ += count;
    return taken;
  }
  template <class T>
  T number(const char* what) {
    T value;
    std::memcpy(&value, take(sizeof(T), what).data(), sizeof(T));
    return value;
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw Error(ErrorKind::input, subject_, fmt::format("byte {}: {}", position_, message));
  }

 private:
  std::string_view bytes_;
  std::size_t position_ = 0;
  const std::string& subject_;
};

template <class T>
void append(std::string_view bytes, std::vector<float>& values) {
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + i, sizeof(T));
    values.push_back(static_cast<float>(value));
  }
}

Tensor read_field(Reader& reader, std::string_view file, const std::string& name) {
  const auto rank = reader.number<std::uint16_t>("a field's rank");
  Tensor tensor;
  tensor.type = reader.number<std::uint8_t>("a field's type");
  if (tensor.type < 1 || tensor.type >= static_cast<int>(kTypes.size()))
    reader.fail(fmt::format("field {} of type {}, expected 1..11", quoted(name), tensor.type));
  const auto offset = reader.number<std::uint64_t>("a field's offset");
  std::uint64_t size = kTypes[static_cast<std::size_t>(tensor.type)].bytes;
  for (int i = 0; i < rank; ++i) {
    tensor.shape.push_back(reader.number<std::uint64_t>("a field's shape"));
    if (tensor.shape.back() == 0 || size > file.size() / tensor.shape.back())
      reader.fail(
          fmt::format("field {} of shape {}.., expected one or more elements that fit the "
                      "file's {} bytes",
                      quoted(name), shape_text(tensor.shape), file.size()));
    size *= tensor.shape.back();
  }
  if (offset > file.size() || size > file.size() - offset)
    reader.fail(fmt::format("field {} of {} bytes at {}, expected within the file's {} bytes",
                            quoted(name), size, offset, file.size()));
  tensor.bytes = file.substr(offset, size);
  return tensor;
}

}  // namespace

std::string shape_text(const std::vector<std::uint64_t>& shape) {
  return shape.empty() ? "no dimensions" : fmt::format("{}", fmt::join(shape, " x "));
}

TensorFile::TensorFile(std::string_view bytes, const std::string& subject) : subject_(subject) {
  Reader reader(bytes, subject);
  if (reader.take(kTensorMagic.size(), "a header") != kTensorMagic)
    reader.fail("found no 'tensor_file', expected a tensor file");
  const auto major = reader.number<std::uint8_t>("a version");
  const auto minor = reader.number<std::uint8_t>("a version");
  if (major != 1 || minor != 0)
    reader.fail(fmt::format("version {}.{} of the tensor format, expected 1.0", major, minor));
  const auto count = reader.number<std::uint32_t>("a number of fields");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto length = reader.number<std::uint16_t>("a name's length");
    const std::string name(reader.take(length, "a name"));
    if (!fields_.emplace(name, read_field(reader, bytes, name)).second)
      reader.fail(fmt::format("field {} for the second time, expected once", quoted(name)));
  }
}

void TensorFile::fail(const std::string& name, const std::string& message) const {
  throw Error(ErrorKind::input, subject_, fmt::format("field {}: {}", quoted(name), message));
}

const Tensor& TensorFile::at(const std::string& name) const {
  const auto found = fields_.find(name);
  if (found == fields_.end()) fail(name, "is missing, expected in a measured BRDF");
  return found->second;
}

std::vector<float> TensorFile::numbers(const std::string& name, std::size_t rank) const {
  const Tensor& tensor = at(name);
  if (tensor.shape.size() != rank)
    fail(name, fmt::format("shape {}, expected {} dimensions", shape_text(tensor.shape), rank));
  const ElementType& type = kTypes[static_cast<std::size_t>(tensor.type)];
  if (tensor.type < kFloat16)
    fail(name, fmt::format("type {}, expected float16, float32 or float64", type.name));
  std::vector<float> values;
  values.reserve(tensor.bytes.size() / type.bytes);
  if (tensor.type == kFloat16)
    append<Eigen::half>(tensor.bytes, values);
  else if (tensor.type == kFloat64)
    append<double>(tensor.bytes, values);
  else
    append<float>(tensor.bytes, values);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      fail(name, fmt::format("element {} is {}, expected a finite number", i, values[i]));
  return values;
}

std::string_view TensorFile::text(const std::string& name) const {
  const Tensor& tensor = at(name);
  if (tensor.type != kUint8 && tensor.type != kInt8)
    fail(name, fmt::format("type {}, expected uint8",
                           kTypes[static_cast<std::size_t>(tensor.type)].name));
  return tensor.bytes;
}

}  // namespace burnish::detail
