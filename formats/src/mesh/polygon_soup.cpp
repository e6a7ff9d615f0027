#include "polygon_soup.h"

#include <locale>
#include <mutex>
#include <sstream>

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <fmt/format.h>

#include "burnish/formats/error.h"

namespace burnish::detail {
namespace {

namespace om = OpenMesh;

constexpr size_t kMaxCorners = PolygonSoup::kNone;  // indices of corners are 32 bits

/// Receives what OpenMesh's readers find, in place of OpenMesh's own half-edge mesh.
///
/// The OBJ reader delivers the normal and UV of a corner as those of its vertex, in the order of
/// the corners, just before the face: they wait in `pending` until the face comes. Vertices are
/// unique within a face of the transcript, so that this is unambiguous.
class SoupImporter final : public om::IO::BaseImporter {
 public:
  SoupImporter(PolygonSoup& soup, const MeshTranscript& transcript)
      : soup_(soup),
        per_corner_(transcript.dialect == MeshTranscript::Dialect::obj),
        alias_of_(transcript.alias_of),
        file_vertices_(transcript.file_vertices) {}

  bool had_bad_index() const { return had_bad_index_; }

  om::VertexHandle add_vertex(const om::Vec3f& p) override {
    soup_.positions.emplace_back(p[0], p[1], p[2]);
    return om::VertexHandle(static_cast<int>(soup_.positions.size()) - 1);
  }
  om::VertexHandle add_vertex() override { return add_vertex(om::Vec3f(0, 0, 0)); }
  void set_point(om::VertexHandle v, const om::Vec3f& p) override {
    if (is_valid(v)) soup_.positions[index_of(v)] = {p[0], p[1], p[2]};
  }

  void set_normal(om::VertexHandle v, const om::Vec3f& n) override {
    if (is_valid(v)) add_attribute(v, Vector3f(n[0], n[1], n[2]), soup_.normals, pending_normals_);
  }
  void set_texcoord(om::VertexHandle v, const om::Vec2f& t) override {
    if (is_valid(v)) add_attribute(v, Eigen::Vector2f(t[0], t[1]), soup_.uvs, pending_uvs_);
  }

  om::FaceHandle add_face(const VHandles& vertices) override {
    auto normal = pending_normals_.begin();
    auto uv = pending_uvs_.begin();
    for (const om::VertexHandle v : vertices) {
      if (!is_valid(v)) continue;
      PolygonSoup::Corner corner;
      corner.vertex = file_vertex(v);
      if (!per_corner_) {
        if (!soup_.normals.empty()) corner.normal = corner.vertex;
        if (!soup_.uvs.empty()) corner.uv = corner.vertex;
      }
      if (normal != pending_normals_.end() && normal->first == v) corner.normal = normal++->second;
      if (uv != pending_uvs_.end() && uv->first == v) corner.uv = uv++->second;
      soup_.corners.push_back(corner);
    }
    pending_normals_.clear();
    pending_uvs_.clear();
    soup_.face_begin.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    return om::FaceHandle(static_cast<int>(soup_.face_count()) - 1);
  }

  size_t n_vertices() const override { return soup_.positions.size(); }
  size_t n_faces() const override { return soup_.face_count(); }
  size_t n_edges() const override { return 0; }
  void reserve(unsigned vertices, unsigned, unsigned faces) override {
    soup_.positions.reserve(vertices);
    soup_.face_begin.reserve(size_t{faces} + 1);
    soup_.corners.reserve(size_t{faces} * 3);
  }

  // Not delivered by the readers of these formats, or of no use here: double precision is narrowed
  // by the readers, STL's facet normals are computed, colours and textures belong to materials.
  om::HalfedgeHandle add_edge(om::VertexHandle, om::VertexHandle) override {
    return om::HalfedgeHandle();
  }
  om::FaceHandle add_face(om::HalfedgeHandle) override { return om::FaceHandle(); }
  void add_face_texcoords(om::FaceHandle, om::VertexHandle,
                          const std::vector<om::Vec2f>&) override {}
  void add_face_texcoords(om::FaceHandle, om::VertexHandle,
                          const std::vector<om::Vec3f>&) override {}
  void set_face_texindex(om::FaceHandle, int) override {}
  void set_halfedge(om::VertexHandle, om::HalfedgeHandle) override {}
  void set_normal(om::VertexHandle v, const om::Vec3d& n) override {
    set_normal(
        v, om::Vec3f(static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])));
  }
  void set_normal(om::FaceHandle, const om::Vec3f&) override {}
  void set_normal(om::FaceHandle, const om::Vec3d&) override {}
  void set_color(om::VertexHandle, const om::Vec3uc&) override {}
  void set_color(om::VertexHandle, const om::Vec4uc&) override {}
  void set_color(om::VertexHandle, const om::Vec3f&) override {}
  void set_color(om::VertexHandle, const om::Vec4f&) override {}
  void set_color(om::EdgeHandle, const om::Vec3uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec4uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec3f&) override {}
  void set_color(om::EdgeHandle, const om::Vec4f&) override {}
  void set_color(om::FaceHandle, const om::Vec3uc&) override {}
  void set_color(om::FaceHandle, const om::Vec4uc&) override {}
  void set_color(om::FaceHandle, const om::Vec3f&) override {}
  void set_color(om::FaceHandle, const om::Vec4f&) override {}
  void set_texcoord(om::VertexHandle, const om::Vec3f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec2f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec3f&) override {}
  void set_status(om::VertexHandle, const om::Attributes::StatusInfo&) override {}
  void set_status(om::HalfedgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_status(om::EdgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_status(om::FaceHandle, const om::Attributes::StatusInfo&) override {}
  void set_next(om::HalfedgeHandle, om::HalfedgeHandle) override {}
  void set_face(om::HalfedgeHandle, om::FaceHandle) override {}
  void request_face_texcoords2D() override {}
  void add_texture_information(int, std::string) override {}

 private:
  using Pending = std::vector<std::pair<om::VertexHandle, std::uint32_t>>;

  static size_t index_of(om::VertexHandle v) { return static_cast<size_t>(v.idx()); }

  bool is_valid(om::VertexHandle v) {
    const bool valid = v.idx() >= 0 && index_of(v) < soup_.positions.size();
    had_bad_index_ = had_bad_index_ || !valid;
    return valid;
  }

  std::uint32_t file_vertex(om::VertexHandle v) const {
    const auto index = static_cast<std::uint32_t>(v.idx());
    return index < file_vertices_ || alias_of_.empty() ? index : alias_of_[index - file_vertices_];
  }

  template <class T>
  void add_attribute(om::VertexHandle v, const T& value, std::vector<T>& values, Pending& pending) {
    if (per_corner_) {
      pending.emplace_back(v, static_cast<std::uint32_t>(values.size()));
      values.push_back(value);
    } else {
      values.resize(soup_.positions.size(), T::Zero());
      values[index_of(v)] = value;
    }
  }

  PolygonSoup& soup_;
  const bool per_corner_;
  const std::vector<std::uint32_t>& alias_of_;
  const std::uint64_t file_vertices_;
  Pending pending_normals_;
  Pending pending_uvs_;
  bool had_bad_index_ = false;
};

/// OpenMesh reports on stderr and stdout; what it has to say is known from the transcript.
class SilentOpenMesh {
 public:
  SilentOpenMesh() : errors_(::omerr().is_enabled()), log_(::omlog().is_enabled()) {
    ::omerr().disable();
    ::omlog().disable();
  }
  ~SilentOpenMesh() {
    if (errors_) ::omerr().enable();
    if (log_) ::omlog().enable();
  }

 private:
  bool errors_;
  bool log_;
};

/// The OBJ reader makes its own string streams, which take the program's locale: in a program that
/// writes 0,5 it would read 0.5 as 0.
class PlainNumbers {
 public:
  PlainNumbers() {
    const auto& style = std::use_facet<std::numpunct<char>>(previous_);
    changed_ = style.decimal_point() != '.' || !style.grouping().empty();
    if (changed_) std::locale::global(std::locale::classic());
  }
  ~PlainNumbers() {
    if (changed_) std::locale::global(previous_);
  }

 private:
  std::locale previous_;
  bool changed_ = false;
};

bool run_reader(MeshTranscript& transcript, SoupImporter& importer) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  const SilentOpenMesh silent;
  const PlainNumbers plain;
  om::IO::Options options = om::IO::Options::Default;
  if (transcript.has_normals) options += om::IO::Options::VertexNormal;
  if (transcript.has_uvs) options += om::IO::Options::VertexTexCoord;
  std::istringstream stream(std::move(transcript.bytes), std::ios::in | std::ios::binary);
  switch (transcript.dialect) {
    case MeshTranscript::Dialect::obj:
      return om::IO::OBJReader().read(stream, importer, options);
    case MeshTranscript::Dialect::ply:
      return om::IO::PLYReader().read(stream, importer, options);
    case MeshTranscript::Dialect::stl:
      options += om::IO::Options::Binary;
      return om::IO::STLReader().read(stream, importer, options);
  }
  return false;
}

}  // namespace

PolygonSoup read_soup(const std::string& path, MeshTranscript& transcript) {
  if (transcript.vertices > kMaxElements || transcript.faces > kMaxElements)
    throw Error(ErrorKind::unsupported, path,
                fmt::format("has {} vertices and {} faces, expected at most {} of each",
                            transcript.vertices, transcript.faces, kMaxElements));
  PolygonSoup soup;
  SoupImporter importer(soup, transcript);
  const bool read = run_reader(transcript, importer);
  const bool is_stl = transcript.dialect == MeshTranscript::Dialect::stl;
  if (!read || importer.had_bad_index() || soup.face_count() != transcript.faces ||
      (!is_stl && soup.positions.size() != transcript.vertices))
    throw Error(
        ErrorKind::input, path,
        fmt::format("OpenMesh read {} vertices and {} faces, expected {} and {}",
                    soup.positions.size(), soup.face_count(),
                    is_stl ? soup.positions.size() : transcript.vertices, transcript.faces));
  if (soup.corners.size() > kMaxCorners)
    throw Error(ErrorKind::unsupported, path,
                fmt::format("has {} corners of faces, expected at most {}", soup.corners.size(),
                            kMaxCorners));
  if (!transcript.alias_of.empty()) soup.positions.resize(transcript.file_vertices);
  const bool is_ply = transcript.dialect == MeshTranscript::Dialect::ply;
  // Of an OBJ without faces OpenMesh delivers the normals by vertex, if there are as many.
  const bool is_cloud = !is_ply && soup.face_count() == 0 && !soup.normals.empty() &&
                        soup.normals.size() == soup.positions.size();
  soup.per_vertex_normals = (is_ply && transcript.has_normals) || is_cloud;
  soup.per_vertex_uvs = is_ply && transcript.has_uvs;
  return soup;
}

}  // namespace burnish::detail
