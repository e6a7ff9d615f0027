#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "mesh_text.h"
#include "mesh_transcript.h"

namespace burnish::detail {
namespace {

/// Statements that say nothing about the surface (materials, groups, display), or are part of a
/// statement of kElements.
constexpr std::string_view kSilentKeywords[] = {
    "g",   "s",    "o",    "mg",        "usemtl",   "mtllib",   "usemap", "maplib",
    "deg", "bmat", "step", "cstype",    "parm",     "trim",     "hole",   "scrv",
    "sp",  "end",  "con",  "bevel",     "c_interp", "d_interp", "lod",    "shadow_obj",
    "vp",  "vc",   "call", "trace_obj", "ctech",    "stech",    "csh"};
/// Elements that are not faces.
constexpr std::string_view kElements[] = {"p", "l", "curv", "curv2", "surf", "fo", "bzp", "bsp"};

template <size_t N>
bool contains(const std::string_view (&words)[N], std::string_view word) {
  return std::find(std::begin(words), std::end(words), word) != std::end(words);
}

/// One corner of a face: OBJ's own 1-based indices, 0 for none.
struct ObjCorner {
  std::int64_t vertex = 0;
  std::int64_t uv = 0;
  std::int64_t normal = 0;
};

/// How many vertices, UVs and normals came before the current line: negative indices count back
/// from here.
struct ObjCounts {
  std::int64_t vertices = 0;
  std::int64_t uvs = 0;
  std::int64_t normals = 0;
};

class ObjTranscriber {
 public:
  ObjTranscriber(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  MeshTranscript run() {
    read_attributes();
    if (result_.file_vertices == 0)
      throw Error(ErrorKind::input, path_, "has no vertices ('v' lines), expected a mesh");
    read_faces();
    finish();
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(size_t line, const std::string& message) const {
    throw Error(ErrorKind::input, path_, fmt::format("line {}: {}", line, message));
  }

  void read_attributes();
  void read_vertex(std::string_view rest, size_t line);
  void read_uv(std::string_view rest);
  void read_normal(std::string_view rest);
  void read_faces();
  ObjCorner read_corner(std::string_view word, const ObjCounts& before, size_t line);
  void write_face(std::string& out);
  void finish();

  const std::string& path_;
  std::string_view text_;
  MeshTranscript result_;
  std::vector<size_t> vertex_line_;  ///< where in result_.bytes each vertex is
  std::vector<bool> uv_valid_;
  std::uint64_t normals_ = 0;
  std::uint64_t bad_uvs_ = 0;
  std::uint64_t missing_uv_references_ = 0;
  std::uint64_t missing_normal_references_ = 0;
  std::uint64_t unknown_lines_ = 0;
  std::string first_unknown_;
  std::vector<ObjCorner> face_;
  std::vector<std::uint64_t> last_face_;  ///< of each vertex: the last face that used it
};

// Pass 1: everything that faces refer to, so that pass 2 knows what there is.
void ObjTranscriber::read_attributes() {
  result_.bytes.reserve(text_.size());
  LineReader lines(text_, true);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") {
      read_vertex(line, lines.number());
    } else if (keyword == "vt") {
      read_uv(line);
    } else if (keyword == "vn") {
      read_normal(line);
    } else if (keyword == "f") {
      ++result_.file_faces;
    } else if (contains(kElements, keyword)) {
      ++result_.ignored_elements;
    } else if (!keyword.empty() && keyword[0] != '#' && !contains(kSilentKeywords, keyword)) {
      if (unknown_lines_++ == 0)
        first_unknown_ = fmt::format("line {}: {}", lines.number(), quoted(keyword));
    }
  }
  result_.file_vertices = vertex_line_.size();
}

void ObjTranscriber::read_vertex(std::string_view rest, size_t line) {
  vertex_line_.push_back(result_.bytes.size());
  result_.bytes += 'v';
  for (int i = 0; i < 3; ++i) {
    const std::string_view word = next_word(rest);
    float value = 0;
    if (word.empty()) fail(line, fmt::format("vertex has {} coordinates, expected 3", i));
    if (!parse_float(word, value))
      fail(line, fmt::format("vertex coordinate {}, expected a finite number", quoted(word)));
    result_.bytes.append(1, ' ').append(word);
  }
  result_.bytes += '\n';
}

// OpenMesh gives up at a UV it cannot read; v is optional.
void ObjTranscriber::read_uv(std::string_view rest) {
  const std::string_view u = next_word(rest);
  const std::string_view v = next_word(rest);
  float value = 0;
  const bool valid = parse_float(u, value) && (v.empty() || parse_float(v, value));
  uv_valid_.push_back(valid);
  if (!valid) ++bad_uvs_;
  result_.bytes += "vt ";
  result_.bytes.append(valid ? u : "0").append(1, ' ').append(valid && !v.empty() ? v : "0");
  result_.bytes += '\n';
}

// A normal that cannot be read becomes zero, i.e. one to be computed and counted as invalid.
void ObjTranscriber::read_normal(std::string_view rest) {
  std::array<std::string_view, 3> words;
  bool valid = true;
  for (std::string_view& word : words) {
    word = next_word(rest);
    float value = 0;
    valid = parse_float(word, value) && valid;
  }
  ++normals_;
  result_.bytes += "vn";
  for (const std::string_view word : words) result_.bytes.append(1, ' ').append(valid ? word : "0");
  result_.bytes += '\n';
}

// Pass 2.
void ObjTranscriber::read_faces() {
  last_face_.assign(vertex_line_.size(), 0);
  std::string faces;
  faces.reserve(text_.size() / 2);
  ObjCounts before;
  LineReader lines(text_, true);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view keyword = next_word(line);
    if (keyword == "v") ++before.vertices;
    if (keyword == "vt") ++before.uvs;
    if (keyword == "vn") ++before.normals;
    if (keyword != "f") continue;
    face_.clear();
    for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
      if (word[0] == '#') break;
      face_.push_back(read_corner(word, before, lines.number()));
    }
    if (face_.size() < 3)
      ++result_.short_faces;
    else
      write_face(faces);
  }
  result_.bytes += faces;
}

ObjCorner ObjTranscriber::read_corner(std::string_view word, const ObjCounts& before, size_t line) {
  const std::string_view whole = word;
  std::int64_t index[3] = {};
  for (int i = 0; i < 3 && !word.empty(); ++i) {
    const size_t slash = std::min(word.find('/'), word.size());
    const std::string_view part = word.substr(0, slash);
    word.remove_prefix(std::min(slash + 1, word.size()));
    if (part.empty() && i > 0) continue;
    if (!parse_integer(part, index[i]))
      fail(line, fmt::format("face corner {}, expected v, v/vt, v//vn or v/vt/vn", quoted(whole)));
  }
  if (!word.empty())
    fail(line, fmt::format("face corner {} has more than 3 indices", quoted(whole)));

  const auto vertices = static_cast<std::int64_t>(vertex_line_.size());
  const std::int64_t stated = index[0];
  if (index[0] < 0) index[0] += before.vertices + 1;
  if (index[0] < 1 || index[0] > vertices)
    fail(line, fmt::format("face refers to vertex {}, expected 1 to {} (or as many back)", stated,
                           vertices));
  // A UV or normal that is not there is no reason to lose the face: the corner goes without.
  if (index[1] < 0) index[1] = std::max<std::int64_t>(index[1] + before.uvs + 1, -1);
  const auto uvs = static_cast<std::int64_t>(uv_valid_.size());
  if (index[1] < 0 || index[1] > uvs) {
    ++missing_uv_references_;
    index[1] = 0;
  }
  if (index[1] > 0 && !uv_valid_[static_cast<size_t>(index[1] - 1)]) index[1] = 0;
  if (index[2] < 0) index[2] = std::max<std::int64_t>(index[2] + before.normals + 1, -1);
  if (index[2] < 0 || index[2] > static_cast<std::int64_t>(normals_)) {
    ++missing_normal_references_;
    index[2] = 0;
  }
  return {index[0], index[1], index[2]};
}

void ObjTranscriber::write_face(std::string& out) {
  const std::uint64_t face = ++result_.faces;
  out += 'f';
  for (const ObjCorner& corner : face_) {
    auto vertex = static_cast<std::uint64_t>(corner.vertex);
    std::uint64_t& last = last_face_[vertex - 1];
    if (last == face) {  // a repeated corner, which OpenMesh would drop
      result_.alias_of.push_back(static_cast<std::uint32_t>(vertex - 1));
      vertex = vertex_line_.size() + result_.alias_of.size();
    } else {
      last = face;
    }
    const auto end = std::back_inserter(out);
    if (corner.uv > 0 && corner.normal > 0)
      fmt::format_to(end, FMT_STRING(" {}/{}/{}"), vertex, corner.uv, corner.normal);
    else if (corner.uv > 0)
      fmt::format_to(end, FMT_STRING(" {}/{}"), vertex, corner.uv);
    else if (corner.normal > 0)
      fmt::format_to(end, FMT_STRING(" {}//{}"), vertex, corner.normal);
    else
      fmt::format_to(end, FMT_STRING(" {}"), vertex);
  }
  out += '\n';
}

void ObjTranscriber::finish() {
  for (const std::uint32_t original : result_.alias_of) {
    const size_t begin = vertex_line_[original];
    const std::string line =
        result_.bytes.substr(begin, result_.bytes.find('\n', begin) + 1 - begin);
    result_.bytes += line;
  }
  result_.format = "OBJ";
  result_.vertices = result_.file_vertices + result_.alias_of.size();
  result_.has_normals = normals_ > 0;
  result_.has_uvs = !uv_valid_.empty();
  if (bad_uvs_ > 0)
    result_.notes.push_back(
        fmt::format("texture coordinates that are not finite numbers: {}", bad_uvs_));
  if (missing_uv_references_ > 0)
    result_.notes.push_back(fmt::format(
        "corners that refer to a texture coordinate the file lacks: {}", missing_uv_references_));
  if (missing_normal_references_ > 0)
    result_.notes.push_back(fmt::format("corners that refer to a normal the file lacks: {}",
                                        missing_normal_references_));
  if (unknown_lines_ > 0)
    result_.notes.push_back(fmt::format("lines that are no OBJ statements: {}; the first is {}",
                                        unknown_lines_, first_unknown_));
}

}  // namespace

MeshTranscript transcribe_obj(const std::string& path, std::string bytes) {
  const std::string text = decode_text(std::move(bytes));
  return ObjTranscriber(path, text).run();
}

}  // namespace burnish::detail
