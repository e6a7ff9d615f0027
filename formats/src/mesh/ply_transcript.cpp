#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "mesh_text.h"
#include "mesh_transcript.h"
#include "ply_header.h"

namespace burnish::detail {
namespace {

static_assert(std::endian::native == std::endian::little);

/// The values behind the header, in any encoding.
class PlyBody {
 public:
  PlyBody(const std::string& path, std::string_view bytes, const PlyHeader& header)
      : path_(path), bytes_(bytes), encoding_(header.encoding), offset_(header.body_offset) {}

  [[noreturn]] void fail(const std::string& message) const {
    const bool ascii = encoding_ == PlyEncoding::ascii;
    const size_t place = ascii ? line_at(bytes_, value_offset_) : value_offset_;
    throw Error(ErrorKind::input, path_,
                fmt::format("{} {}: {}", ascii ? "line" : "byte", place, message));
  }

  /// The next value; every type of PLY is exact as a double. Not finite values are the caller's.
  double value(PlyType type, const PlyElement& element, const PlyProperty& property) {
    value_offset_ = offset_;
    return encoding_ == PlyEncoding::ascii ? ascii_value(element, property)
                                           : binary_value(type, element, property);
  }

  size_t list_count(const PlyElement& element, const PlyProperty& property) {
    const double count = value(property.count_type, element, property);
    if (count < 0 || count != std::floor(count))
      fail(fmt::format("list {} of {} has a count of {}", property.name, element.name, count));
    if (count > static_cast<double>(left() / least_bytes(property.type) + 1))
      fail(fmt::format("list {} of {} has a count of {}, but the file ends {} bytes on",
                       property.name, element.name, count, left()));
    return static_cast<size_t>(count);
  }

  void skip(const PlyElement& element, const PlyProperty& property) {
    const size_t count = property.is_list ? list_count(element, property) : 1;
    for (size_t i = 0; i < count; ++i) value(property.type, element, property);
  }

  /// Refuses an element whose items cannot fit in what is left of the file.
  void check_count(const PlyElement& element) {
    size_t item = 0;
    for (const PlyProperty& property : element.properties)
      item += least_bytes(property.is_list ? property.count_type : property.type);
    value_offset_ = offset_;
    // The last number of a text may lack the space after it: one byte more.
    if (item > 0 && element.count > (left() + 1) / item)
      fail(fmt::format("the header states {} items of {}, but the file ends {} bytes on",
                       element.count, element.name, left()));
  }

  /// Bytes that were not read, not counting blanks behind a text.
  size_t rest() const {
    if (encoding_ != PlyEncoding::ascii) return left();
    std::string_view tail = bytes_.substr(offset_);
    const std::string_view word = next_word(tail);
    return word.empty() ? 0 : word.size() + tail.size();
  }

 private:
  size_t left() const { return bytes_.size() - offset_; }
  size_t least_bytes(PlyType type) const {
    return encoding_ == PlyEncoding::ascii ? 2 : size_bytes(type);
  }
  [[noreturn]] void fail_at_end(const PlyElement& element, const PlyProperty& property) const {
    fail(fmt::format("the file ends, expected {} of {}", property.name, element.name));
  }

  double ascii_value(const PlyElement& element, const PlyProperty& property) {
    std::string_view tail = bytes_.substr(offset_);
    const std::string_view word = next_word(tail);
    value_offset_ = bytes_.size() - tail.size() - word.size();
    offset_ = bytes_.size() - tail.size();
    if (word.empty()) fail_at_end(element, property);
    double number = 0;
    if (parse_double(word, number)) return number;
    fail(fmt::format("{}, expected {} of {}: a number", quoted(word), property.name, element.name));
  }

  double binary_value(PlyType type, const PlyElement& element, const PlyProperty& property) {
    const size_t size = size_bytes(type);
    if (left() < size) fail_at_end(element, property);
    std::array<char, 8> raw = {};
    std::memcpy(raw.data(), bytes_.data() + offset_, size);
    offset_ += size;
    if (encoding_ == PlyEncoding::binary_big_endian)
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, raw.data(), sizeof value);
      return static_cast<double>(value);
    };
    switch (type) {
      case PlyType::int8:
        return as(std::int8_t{});
      case PlyType::uint8:
        return as(std::uint8_t{});
      case PlyType::int16:
        return as(std::int16_t{});
      case PlyType::uint16:
        return as(std::uint16_t{});
      case PlyType::int32:
        return as(std::int32_t{});
      case PlyType::uint32:
        return as(std::uint32_t{});
      case PlyType::float32:
        return as(float{});
      case PlyType::float64:
        return as(double{});
    }
    return 0;
  }

  const std::string& path_;
  std::string_view bytes_;
  PlyEncoding encoding_;
  size_t offset_;
  size_t value_offset_ = 0;
};

/// Where the properties of a vertex go: x y z, nx ny nz, u v.
constexpr int kSlots = 8;
using VertexSlots = std::array<int, kSlots>;  ///< index of the property, or -1

VertexSlots find_slots(const PlyElement& vertex) {
  VertexSlots slots;
  slots.fill(-1);
  const auto find = [&](std::string_view name) {
    for (size_t i = 0; i < vertex.properties.size(); ++i)
      if (vertex.properties[i].name == name && !vertex.properties[i].is_list)
        return static_cast<int>(i);
    return -1;
  };
  constexpr std::string_view kNames[6] = {"x", "y", "z", "nx", "ny", "nz"};
  for (size_t i = 0; i < 6; ++i) slots[i] = find(kNames[i]);
  constexpr std::string_view kUvNames[3][2] = {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}};
  for (const auto& names : kUvNames) {
    if (slots[6] >= 0 && slots[7] >= 0) break;
    slots[6] = find(names[0]);
    slots[7] = find(names[1]);
  }
  return slots;
}

class PlyTranscriber {
 public:
  PlyTranscriber(const std::string& path, std::string_view bytes)
      : path_(path), header_(read_ply_header(path, bytes)), body_(path, bytes, header_) {}

  MeshTranscript run() {
    find_vertices();
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) continue;
      body_.check_count(element);
      if (&element == vertex_)
        read_vertices();
      else if (element.name == "face")
        read_faces(element, false);
      else if (element.name == "tristrips")
        read_faces(element, true);
      else
        skip_element(element);
    }
    return finish();
  }

 private:
  void find_vertices() {
    for (const PlyElement& element : header_.elements) {
      if (element.name != "vertex") continue;
      if (vertex_ != nullptr)
        throw Error(ErrorKind::input, path_, "has two elements 'vertex', expected one");
      vertex_ = &element;
    }
    if (vertex_ == nullptr || vertex_->count == 0)
      throw Error(ErrorKind::input, path_, "has no vertices, expected a mesh");
    if (vertex_->count > kMaxElements)
      throw Error(
          ErrorKind::input, path_,
          fmt::format("states {} vertices, expected at most {}", vertex_->count, kMaxElements));
    slots_ = find_slots(*vertex_);
    for (int i = 0; i < 3; ++i)
      if (slots_[static_cast<size_t>(i)] < 0)
        throw Error(ErrorKind::input, path_,
                    fmt::format("its vertices have no property '{}'", "xyz"[i]));
    result_.has_normals = slots_[3] >= 0 && slots_[4] >= 0 && slots_[5] >= 0;
    result_.has_uvs = slots_[6] >= 0 && slots_[7] >= 0;
  }

  void read_vertices() {
    std::vector<int> slot_of(vertex_->properties.size(), -1);
    for (int slot = 0; slot < kSlots; ++slot)
      if (const int index = slots_[static_cast<size_t>(slot)]; index >= 0)
        slot_of[static_cast<size_t>(index)] = slot;
    std::array<float, kSlots> values = {};
    for (std::uint64_t i = 0; i < vertex_->count; ++i) {
      for (size_t k = 0; k < slot_of.size(); ++k) {
        const PlyProperty& property = vertex_->properties[k];
        if (slot_of[k] < 0) {
          body_.skip(*vertex_, property);
          continue;
        }
        const auto value = static_cast<float>(body_.value(property.type, *vertex_, property));
        if (slot_of[k] < 3 && !std::isfinite(value))
          body_.fail(fmt::format("{} of vertex {} is {}, expected a finite number", property.name,
                                 i, value));
        values[static_cast<size_t>(slot_of[k])] = value;
      }
      writer_.vertex(values.data(), result_.has_normals ? values.data() + 3 : nullptr,
                     result_.has_uvs ? values.data() + 6 : nullptr);
    }
  }

  void read_faces(const PlyElement& element, bool strips) {
    const auto is_indices = [&](const PlyProperty& property) {
      return property.is_list &&
             (property.name == "vertex_indices" || property.name == "vertex_index");
    };
    const auto indices =
        std::find_if(element.properties.begin(), element.properties.end(), is_indices);
    if (indices == element.properties.end()) {
      if (element.count == 0) return;
      throw Error(
          ErrorKind::input, path_,
          fmt::format("element '{}' has no list 'vertex_indices' or 'vertex_index'", element.name));
    }
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) {
        if (&property != &*indices) {
          body_.skip(element, property);
          continue;
        }
        read_indices(element, property, strips);
        if (strips)
          add_strip();
        else
          add_face(corners_);
      }
    for (const PlyProperty& property : element.properties)
      if (property.name == "texcoord" && property.is_list)
        result_.notes.push_back("texture coordinates of the faces' corners are not used");
  }

  void read_indices(const PlyElement& element, const PlyProperty& property, bool strips) {
    const size_t count = body_.list_count(element, property);
    corners_.clear();
    for (size_t k = 0; k < count; ++k) {
      const double index = body_.value(property.type, element, property);
      const bool restart = strips && index == -1;
      const auto vertices = static_cast<double>(vertex_->count);
      if (!restart && !(index >= 0 && index < vertices && index == std::floor(index)))
        body_.fail(fmt::format("{} refers to vertex {}, expected 0 to {}", element.name, index,
                               vertex_->count - 1));
      corners_.push_back(restart ? kRestart : static_cast<std::uint32_t>(index));
    }
  }

  void add_face(const std::vector<std::uint32_t>& corners) {
    ++result_.file_faces;
    if (corners.size() < 3)
      ++result_.short_faces;
    else
      writer_.face(corners.data(), corners.size());
  }

  // Every second triangle of a strip is turned over; after a restart it begins anew. Triangles
  // that only stitch strips together have no area, and are counted as such.
  void add_strip() {
    size_t begin = 0;
    for (size_t i = 0; i < corners_.size(); ++i) {
      if (corners_[i] == kRestart) begin = i + 1;
      if (corners_[i] == kRestart || i < begin + 2) continue;
      const bool odd = (i - begin) % 2 != 0;
      const std::uint32_t triangle[3] = {corners_[odd ? i - 1 : i - 2],
                                         corners_[odd ? i - 2 : i - 1], corners_[i]};
      ++result_.file_faces;
      writer_.face(triangle, 3);
    }
  }

  void skip_element(const PlyElement& element) {
    result_.ignored_elements += element.count;
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) body_.skip(element, property);
  }

  MeshTranscript finish() {
    constexpr std::string_view kEncodings[] = {"ascii", "binary_little_endian",
                                               "binary_big_endian"};
    result_.format = fmt::format("PLY {}", kEncodings[static_cast<int>(header_.encoding)]);
    result_.dialect = MeshTranscript::Dialect::ply;
    result_.vertices = result_.file_vertices = vertex_->count;
    result_.faces = writer_.faces();
    result_.bytes = writer_.finish(result_.has_normals, result_.has_uvs);
    result_.notes.insert(result_.notes.end(), header_.notes.begin(), header_.notes.end());
    if (const size_t rest = body_.rest(); rest > 0)
      result_.notes.push_back(fmt::format("{} bytes after the last element are not read", rest));
    return std::move(result_);
  }

  static constexpr std::uint32_t kRestart = 0xffffffffu;

  const std::string& path_;
  PlyHeader header_;
  PlyBody body_;
  const PlyElement* vertex_ = nullptr;
  VertexSlots slots_ = {};
  PlyDialectWriter writer_;
  std::vector<std::uint32_t> corners_;
  MeshTranscript result_;
};

template <class T>
void append_value(std::string& bytes, T value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof value);
}

}  // namespace

void PlyDialectWriter::vertex(const float position[3], const float* normal, const float* uv) {
  for (int i = 0; i < 3; ++i) append_value(vertex_bytes_, position[i]);
  for (int i = 0; normal != nullptr && i < 3; ++i) append_value(vertex_bytes_, normal[i]);
  for (int i = 0; uv != nullptr && i < 2; ++i) append_value(vertex_bytes_, uv[i]);
  ++vertices_;
}

void PlyDialectWriter::face(const std::uint32_t* corners, size_t count) {
  append_value(face_bytes_, static_cast<std::uint32_t>(count));
  for (size_t i = 0; i < count; ++i) append_value(face_bytes_, corners[i]);
  ++faces_;
}

std::string PlyDialectWriter::finish(bool has_normals, bool has_uvs) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      vertices_);
  if (has_normals) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (has_uvs) bytes += "property float u\nproperty float v\n";
  // "int" for the count: OpenMesh takes no "uint" there.
  bytes +=
      fmt::format("element face {}\nproperty list int uint vertex_indices\nend_header\n", faces_);
  return bytes + vertex_bytes_ + face_bytes_;
}

MeshTranscript transcribe_ply(const std::string& path, std::string bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);
  return PlyTranscriber(path, bytes).run();
}

}  // namespace burnish::detail
