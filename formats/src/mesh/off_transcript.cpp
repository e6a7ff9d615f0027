#include <algorithm>
#include <string_view>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "mesh_text.h"
#include "mesh_transcript.h"

namespace burnish::detail {
namespace {

/// Which of the optional parts the header announces: [ST][C][N][4][n]OFF.
struct OffHeader {
  bool uvs = false;
  bool normals = false;
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

/// Words of an OFF file, comments skipped. An item may be broken over lines; what stands behind it
/// on its last line (colours) is skipped by end_item().
class OffReader {
 public:
  OffReader(const std::string& path, std::string_view text) : path_(path), lines_(text) {}

  [[noreturn]] void fail(const std::string& message) const {
    throw Error(ErrorKind::input, path_, fmt::format("line {}: {}", lines_.number(), message));
  }

  /// The next word of this line, or empty.
  std::string_view word_on_line() {
    std::string_view word = next_word(rest_);
    if (word.starts_with('#')) rest_ = word = {};
    return word;
  }

  std::string_view word(const std::string& expected) {
    std::string_view word = word_on_line();
    while (word.empty()) {
      if (!lines_.next(rest_)) fail("the file ends, expected " + expected);
      word = word_on_line();
    }
    return word;
  }

  float number(const std::string& expected) {
    const std::string_view text = word(expected);
    float value = 0;
    if (!parse_float(text, value))
      fail(fmt::format("{}, expected {}: a finite number", quoted(text), expected));
    return value;
  }

  std::uint64_t count(const std::string& expected, std::uint64_t limit) {
    const std::string_view text = word(expected);
    std::int64_t value = 0;
    if (!parse_integer(text, value) || value < 0)
      fail(fmt::format("{}, expected {}", quoted(text), expected));
    if (static_cast<std::uint64_t>(value) > limit)
      fail(fmt::format("{}, expected {} of at most {}", value, expected, limit));
    return static_cast<std::uint64_t>(value);
  }

  void end_item() { rest_ = {}; }

  /// Whether only blanks and comments are left.
  bool at_end() {
    while (word_on_line().empty())
      if (!lines_.next(rest_)) return true;
    return false;
  }

  void put_back(std::string_view word) { rest_ = {word.data(), word.size() + rest_.size()}; }

 private:
  const std::string& path_;
  LineReader lines_;
  std::string_view rest_;
};

OffHeader read_header(const std::string& path, OffReader& reader, size_t file_size) {
  std::string_view keyword = reader.word("OFF");
  const std::string_view whole = keyword;
  OffHeader header;
  if (keyword.starts_with("ST")) {
    header.uvs = true;
    keyword.remove_prefix(2);
  }
  if (keyword.starts_with('C')) keyword.remove_prefix(1);
  if (keyword.starts_with('N')) {
    header.normals = true;
    keyword.remove_prefix(1);
  }
  if (keyword.starts_with("4") || keyword.starts_with("n"))
    throw Error(ErrorKind::unsupported, path,
                fmt::format("{}: expected OFF with vertices of 3 dimensions", quoted(whole)));
  if (!keyword.starts_with("OFF")) reader.fail(fmt::format("{}, expected OFF", quoted(whole)));
  // Some writers forget the space between OFF and the first count.
  if (keyword.size() > 3) reader.put_back(keyword.substr(3));
  const std::string_view next = reader.word("the number of vertices");
  if (next == "BINARY")
    throw Error(ErrorKind::unsupported, path, "is a binary OFF file, expected a text OFF file");
  reader.put_back(next);
  // Every vertex and face takes two bytes at least: a count beyond the file is a lie.
  const std::uint64_t limit = std::min<std::uint64_t>(file_size, kMaxElements);
  header.vertices = reader.count("the number of vertices", limit);
  header.faces = reader.count("the number of faces", limit);
  reader.end_item();  // the number of edges says nothing
  return header;
}

void read_vertex(OffReader& reader, const OffHeader& header, PlyDialectWriter& writer) {
  float position[3] = {}, normal[3] = {}, uv[2] = {};
  for (float& value : position) value = reader.number("a vertex coordinate");
  if (header.normals) {
    // Kept for the importer to count: a normal may be bad without the vertex being so.
    for (float& value : normal)
      if (!parse_float(reader.word("a normal"), value)) value = 0;
  }
  if (header.uvs) {
    // Behind the colours, if there are any: the last two words of the line.
    std::string_view last[2];
    for (std::string_view word = reader.word("a texture coordinate"); !word.empty();
         word = reader.word_on_line()) {
      last[0] = last[1];
      last[1] = word;
    }
    for (int i = 0; i < 2; ++i)
      if (!parse_float(last[i], uv[i])) reader.fail("expected two texture coordinates");
  }
  reader.end_item();
  writer.vertex(position, header.normals ? normal : nullptr, header.uvs ? uv : nullptr);
}

}  // namespace

MeshTranscript transcribe_off(const std::string& path, std::string bytes) {
  const std::string text = decode_text(std::move(bytes));
  OffReader reader(path, text);
  const OffHeader header = read_header(path, reader, text.size());
  if (header.vertices == 0) throw Error(ErrorKind::input, path, "has no vertices, expected a mesh");

  PlyDialectWriter writer;
  for (std::uint64_t i = 0; i < header.vertices; ++i) read_vertex(reader, header, writer);
  MeshTranscript result;
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < header.faces; ++i) {
    const std::uint64_t count = reader.count("the number of a face's corners", text.size());
    corners.clear();
    for (std::uint64_t k = 0; k < count; ++k)
      corners.push_back(static_cast<std::uint32_t>(
          reader.count("the index of a face's vertex", header.vertices - 1)));
    reader.end_item();
    if (count < 3)
      ++result.short_faces;
    else
      writer.face(corners.data(), corners.size());
  }
  result.dialect = MeshTranscript::Dialect::ply;
  result.vertices = result.file_vertices = header.vertices;
  result.faces = writer.faces();
  result.file_faces = header.faces;
  result.has_normals = header.normals;
  result.has_uvs = header.uvs;
  result.format = "OFF";
  if (!reader.at_end())
    result.notes.push_back("the file goes on after its last face; the rest is not read");
  result.bytes = writer.finish(header.normals, header.uvs);
  return result;
}

}  // namespace burnish::detail
