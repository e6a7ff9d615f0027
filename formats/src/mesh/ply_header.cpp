#include "ply_header.h"

#include <optional>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "mesh_text.h"

namespace burnish::detail {
namespace {

std::optional<PlyType> parse_type(std::string_view word) {
  struct Name {
    std::string_view name;
    PlyType type;
  };
  static constexpr Name kNames[] = {
      {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
      {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
      {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
      {"float64", PlyType::float64}};
  for (const Name& name : kNames)
    if (name.name == word) return name.type;
  return std::nullopt;
}

/// Lines that end in '\n', '\r' or both, and in the same way throughout: told by the first one,
/// because the byte after a '\r' may already be data.
class HeaderLines {
 public:
  HeaderLines(const std::string& path, std::string_view bytes) : path_(path), bytes_(bytes) {
    const size_t first = bytes.find_first_of("\r\n");
    if (first != bytes.npos && bytes[first] == '\r')
      line_end_ = bytes.substr(first, 2) == "\r\n" ? "\r\n" : "\r";
  }

  std::string_view next() {
    const size_t end = bytes_.find(line_end_, offset_);
    if (end == bytes_.npos)
      throw Error(ErrorKind::input, path_,
                  fmt::format("line {}: the header has no end_header", number_ + 1));
    const std::string_view line = bytes_.substr(offset_, end - offset_);
    offset_ = end + line_end_.size();
    ++number_;
    return line;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(ErrorKind::input, path_, fmt::format("line {}: {}", number_, message));
  }

  size_t number() const { return number_; }
  size_t offset() const { return offset_; }

 private:
  const std::string& path_;
  std::string_view bytes_;
  std::string_view line_end_ = "\n";
  size_t offset_ = 0;
  size_t number_ = 0;
};

PlyEncoding read_format(HeaderLines& lines, std::string_view rest) {
  const std::string_view name = next_word(rest);
  if (name == "ascii") return PlyEncoding::ascii;
  if (name == "binary_little_endian") return PlyEncoding::binary_little_endian;
  if (name == "binary_big_endian") return PlyEncoding::binary_big_endian;
  lines.fail(fmt::format("format {}, expected ascii, binary_little_endian or binary_big_endian",
                         quoted(name)));
}

PlyElement read_element(HeaderLines& lines, std::string_view rest) {
  PlyElement element;
  element.name = next_word(rest);
  const std::string_view count = next_word(rest);
  std::int64_t value = 0;
  if (element.name.empty() || !parse_integer(count, value) || value < 0)
    lines.fail(fmt::format("element {} of count {}, expected a name and a count",
                           quoted(element.name), quoted(count)));
  element.count = static_cast<std::uint64_t>(value);
  return element;
}

PlyType read_type(HeaderLines& lines, std::string_view word) {
  const std::optional<PlyType> type = parse_type(word);
  if (!type)
    lines.fail(
        fmt::format("property type {}, expected char, uchar, short, ushort, int, uint, "
                    "float, double or their names with sizes",
                    quoted(word)));
  return *type;
}

PlyProperty read_property(HeaderLines& lines, std::string_view rest) {
  PlyProperty property;
  std::string_view type = next_word(rest);
  if (type == "list") {
    property.is_list = true;
    property.count_type = read_type(lines, next_word(rest));
    if (property.count_type >= PlyType::float32)
      lines.fail("a list is counted by a float, expected an integer type");
    type = next_word(rest);
  }
  property.name = next_word(rest);
  // Some files have name and type the other way round.
  if (!property.is_list && !parse_type(type) && parse_type(property.name)) {
    property.type = *parse_type(property.name);
    property.name = type;
  } else {
    property.type = read_type(lines, type);
  }
  if (property.name.empty()) lines.fail("a property without a name");
  return property;
}

}  // namespace

PlyHeader read_ply_header(const std::string& path, std::string_view bytes) {
  std::string_view first = bytes.substr(0, 5);
  if (!equals_ignoring_case(next_word(first), "ply"))
    throw Error(ErrorKind::input, path, "does not begin with 'ply'");
  HeaderLines lines(path, bytes);
  lines.next();
  PlyHeader header;
  bool has_format = false;
  for (std::string_view rest = lines.next();; rest = lines.next()) {
    const std::string_view keyword = next_word(rest);
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.encoding = read_format(lines, rest);
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(lines, rest));
    } else if (keyword == "property") {
      if (header.elements.empty()) lines.fail("a property before the first element");
      header.elements.back().properties.push_back(read_property(lines, rest));
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      header.notes.push_back(
          fmt::format("line {}: header keyword {} is not known", lines.number(), quoted(keyword)));
    }
  }
  if (!has_format) lines.fail("the header has no format");
  header.body_offset = lines.offset();
  return header;
}

}  // namespace burnish::detail
