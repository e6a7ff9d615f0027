#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "mesh_text.h"
#include "mesh_transcript.h"

namespace burnish::detail {
namespace {

// The binary form is little-endian, as are all machines this builds for; OpenMesh assumes no less.
static_assert(std::endian::native == std::endian::little);

constexpr size_t kHeaderBytes = 84;  // 80 free ones and the number of facets
constexpr size_t kFacetBytes = 50;   // normal, three corners, two free bytes

using Facet = std::array<std::array<float, 3>, 3>;

/// Collects facets in the binary form.
class StlDialectWriter {
 public:
  StlDialectWriter() : bytes_(kHeaderBytes, '\0') {}

  void facet(const Facet& corners) {
    ++result_.file_faces;
    // OpenMesh drops them, and they have no area.
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      ++result_.collapsed_facets;
      return;
    }
    char record[kFacetBytes] = {};
    std::memcpy(record + 12, corners.data(), 36);
    bytes_.append(record, sizeof record);
    ++result_.faces;
  }

  MeshTranscript finish(const std::string& path, std::string format) {
    if (result_.file_faces == 0)
      throw Error(ErrorKind::input, path, "has no facets, expected a mesh");
    if (result_.file_faces > kMaxElements / 3)
      throw Error(
          ErrorKind::unsupported, path,
          fmt::format("has {} facets, expected at most {}", result_.file_faces, kMaxElements / 3));
    const auto count = static_cast<std::uint32_t>(result_.faces);
    std::memcpy(bytes_.data() + 80, &count, 4);
    result_.dialect = MeshTranscript::Dialect::stl;
    result_.file_vertices = 3 * result_.file_faces;
    result_.format = std::move(format);
    result_.bytes = std::move(bytes_);
    return std::move(result_);
  }

  MeshTranscript& result() { return result_; }

 private:
  std::string bytes_;
  MeshTranscript result_;
};

MeshTranscript transcribe_binary(const std::string& path, const std::string& bytes,
                                 std::uint32_t facets) {
  StlDialectWriter writer;
  for (size_t i = 0; i < facets; ++i) {
    Facet corners;
    const size_t offset = kHeaderBytes + i * kFacetBytes + 12;
    std::memcpy(corners.data(), bytes.data() + offset, 36);
    for (const auto& corner : corners)
      for (const float value : corner)
        if (!std::isfinite(value))
          throw Error(ErrorKind::input, path,
                      fmt::format("byte {}: facet {} has a coordinate {}, expected a finite number",
                                  offset, i, value));
    writer.facet(corners);
  }
  const size_t rest = bytes.size() - kHeaderBytes - facets * kFacetBytes;
  if (rest > 0)
    writer.result().notes.push_back(
        fmt::format("{} bytes after the last facet are not read", rest));
  return writer.finish(path, "STL binary");
}

/// The text form, a statement a line, in any case.
class StlTextReader {
 public:
  StlTextReader(const std::string& path, std::string_view text) : path_(path), lines_(text) {}

  MeshTranscript run() {
    while (read_line()) {
      if (is("solid")) {
        in_solid_ = true;
      } else if (is("endsolid")) {
        in_solid_ = false;
      } else if (is("facet")) {
        read_facet();
      } else if (is("color")) {
        continue;  // an extension of some writers
      } else {
        fail("solid, facet or endsolid");
      }
    }
    if (in_solid_)
      writer_.result().notes.push_back("the last solid has no endsolid; the file may be cut short");
    return writer_.finish(path_, "STL ascii");
  }

 private:
  /// The next line that is not blank.
  bool read_line() {
    do {
      if (!lines_.next(rest_)) return false;
      keyword_ = next_word(rest_);
    } while (keyword_.empty());
    return true;
  }
  bool is(std::string_view keyword) const { return equals_ignoring_case(keyword_, keyword); }
  [[noreturn]] void fail(std::string_view expected) const {
    throw Error(
        ErrorKind::input, path_,
        fmt::format("line {}: {}, expected {}", lines_.number(), quoted(keyword_), expected));
  }
  void expect(std::string_view keyword) {
    if (!read_line())
      throw Error(ErrorKind::input, path_,
                  fmt::format("line {}: the file ends, expected {}", lines_.number(), keyword));
    if (!is(keyword)) fail(keyword);
  }

  void read_facet() {  // after "facet"; the facet's normal is not used
    expect("outer");
    Facet corners;
    for (auto& corner : corners) {
      expect("vertex");
      for (float& value : corner) {
        keyword_ = next_word(rest_);
        if (!parse_float(keyword_, value)) fail("a coordinate: a finite number");
      }
    }
    expect("endloop");
    expect("endfacet");
    writer_.facet(corners);
  }

  const std::string& path_;
  LineReader lines_;
  std::string_view rest_;
  std::string_view keyword_;
  bool in_solid_ = false;
  StlDialectWriter writer_;
};

}  // namespace

// A text file begins with "solid", but so do some binary ones: their size decides.
MeshTranscript transcribe_stl(const std::string& path, std::string bytes) {
  std::uint32_t facets = 0;
  bool whole = false;
  size_t expected = kHeaderBytes;
  if (bytes.size() >= kHeaderBytes) {
    std::memcpy(&facets, bytes.data() + 80, 4);
    expected += size_t{facets} * kFacetBytes;
    whole = bytes.size() >= expected;
  }
  if (bytes.size() == expected) return transcribe_binary(path, bytes, facets);
  const bool has_zero_byte = bytes.find('\0') != std::string::npos;
  const bool utf16 = bytes.starts_with("\xFE\xFF") || bytes.starts_with("\xFF\xFE");
  std::string text = has_zero_byte && !utf16 ? std::string() : decode_text(bytes);
  std::string_view rest = text;
  if (equals_ignoring_case(next_word(rest), "solid")) return StlTextReader(path, text).run();
  if (!whole)
    throw Error(ErrorKind::input, path,
                bytes.size() < kHeaderBytes
                    ? fmt::format("is no STL: {} bytes, expected 'solid' or a header of {} bytes",
                                  bytes.size(), kHeaderBytes)
                    : fmt::format("is cut short or no STL: {} bytes, expected {} for {} facets",
                                  bytes.size(), expected, facets));
  return transcribe_binary(path, bytes, facets);
}

}  // namespace burnish::detail
