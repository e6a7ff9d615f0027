#include "burnish/precompute/buried_vertices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include <tbb/parallel_for.h>

#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

constexpr int kRays = 64;
constexpr int kMostOthers = 8;     // rays that escape or meet a front, of a vertex that is inside
constexpr float kReach = 8;        // offsets
constexpr float kBeneath = 0.02f;  // offsets

// Directions over the upper hemisphere, evenly spread: a spiral by the golden angle.
std::vector<Vector3f> hemisphere_directions() {
  const double golden_angle = kPi<double> * (3 - std::sqrt(5.0));
  std::vector<Vector3f> directions;
  for (int i = 0; i < kRays; ++i) {
    const double z = (i + 0.5) / kRays, r = std::sqrt(1 - z * z), phi = golden_angle * i;
    directions.push_back(Vector3d(r * std::cos(phi), r * std::sin(phi), z).cast<float>());
  }
  return directions;
}

std::array<std::uint32_t, 3> position_bits(const Vector3f& p) {
  return {std::bit_cast<std::uint32_t>(p.x() + 0.f), std::bit_cast<std::uint32_t>(p.y() + 0.f),
          std::bit_cast<std::uint32_t>(p.z() + 0.f)};
}

// Orthogonal to a triangle, to the side of its normals.
Vector3d front_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vector3d a = mesh.positions[t[0]].cast<double>();
  const Vector3d across =
      (mesh.positions[t[1]].cast<double>() - a).cross(mesh.positions[t[2]].cast<double>() - a);
  const Vector3f sum = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
  return across.dot(sum.cast<double>()) < 0 ? Vector3d(-across) : across;
}

// Triangles that share their three positions with one that faces the other way: a leaf's two sides.
// A ray may meet either first.
std::vector<char> find_two_sided(const TriangleMesh& mesh) {
  struct Corners {
    std::array<std::array<std::uint32_t, 3>, 3> positions;
    std::uint32_t triangle;
  };
  std::vector<Corners> corners(mesh.triangles.size());
  for (std::uint32_t t = 0; t < corners.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k)
      corners[t].positions[k] = position_bits(mesh.positions[mesh.triangles[t][k]]);
    std::sort(corners[t].positions.begin(), corners[t].positions.end());
    corners[t].triangle = t;
  }
  std::sort(corners.begin(), corners.end(), [](const Corners& a, const Corners& b) {
    return a.positions != b.positions ? a.positions < b.positions : a.triangle < b.triangle;
  });
  std::vector<char> two_sided(corners.size(), 0);
  for (std::size_t begin = 0, end = 0; begin < corners.size(); begin = end) {
    while (end < corners.size() && corners[end].positions == corners[begin].positions) ++end;
    const Vector3d front = front_of(mesh, mesh.triangles[corners[begin].triangle]);
    bool opposed = false;
    for (std::size_t i = begin + 1; i < end; ++i)
      opposed |= front.dot(front_of(mesh, mesh.triangles[corners[i].triangle])) < 0;
    for (std::size_t i = begin; i < end; ++i) two_sided[corners[i].triangle] = opposed;
  }
  return two_sided;
}

class BurialTest {
 public:
  BurialTest(const RayScene& scene, const TriangleMesh& receiver,
             std::span<const TriangleMesh> occluders, double origin_offset)
      : scene_(scene),
        receiver_(receiver),
        occluders_(occluders),
        offset_(origin_offset > 0 ? static_cast<float>(origin_offset) : scene.origin_offset()),
        directions_(hemisphere_directions()) {
    two_sided_.push_back(find_two_sided(receiver));
    for (const TriangleMesh& occluder : occluders) two_sided_.push_back(find_two_sided(occluder));
  }

  Burial of(std::uint32_t vertex) const {
    const Vector3f& position = receiver_.positions[vertex];
    const Vector3d wide = receiver_.normals[vertex].cast<double>();
    const double length = wide.norm();
    if (!position.allFinite() || !std::isfinite(length) || !(length > 0)) return Burial::none;
    const Vector3f normal = (wide / length).cast<float>();
    const Vector3f origin = position + offset_ * normal;
    const auto another_lies = [&](const Vector3f& start, float direction, float reach, int facing) {
      RayHit hit;
      return scene_.intersect(start, direction * normal, hit) && hit.distance < reach * offset_ &&
             !has_corner_at(hit, position) && facing * front(hit).dot(normal.cast<double>()) > 0;
    };
    if (another_lies(origin, 1, kReach - 1, 1)) return Burial::covered;
    // Its own triangles would hide what lies behind: the second ray starts beneath them.
    const Vector3f beneath = position - kBeneath * offset_ * normal;
    if (another_lies(origin, -1, 1 + kBeneath, -1) || another_lies(beneath, -1, 1 - kBeneath, -1))
      return Burial::pierced;
    return is_inside(origin, normal) ? Burial::inside : Burial::none;
  }

 private:
  const TriangleMesh& mesh_of(const RayHit& hit) const {
    return hit.mesh == 0 ? receiver_ : occluders_[hit.mesh - 1];
  }

  bool has_corner_at(const RayHit& hit, const Vector3f& position) const {
    const TriangleMesh& mesh = mesh_of(hit);
    const Triangle& triangle = mesh.triangles[hit.triangle];
    return std::any_of(triangle.begin(), triangle.end(),
                       [&](std::uint32_t v) { return mesh.positions[v] == position; });
  }

  Vector3d front(const RayHit& hit) const {
    return front_of(mesh_of(hit), mesh_of(hit).triangles[hit.triangle]);
  }

  bool is_inside(const Vector3f& origin, const Vector3f& normal) const {
    const Frame<float> frame = frame_from_axis<float>(normal);
    int others = 0;
    for (const Vector3f& local : directions_) {
      const Vector3f direction = frame.to_world(local);
      RayHit hit;
      const bool meets_back = scene_.intersect(origin, direction, hit) &&
                              !two_sided_[hit.mesh][hit.triangle] &&
                              front(hit).dot(direction.cast<double>()) > 0;
      if (!meets_back && ++others > kMostOthers) return false;
    }
    return true;
  }

  const RayScene& scene_;
  const TriangleMesh& receiver_;
  std::span<const TriangleMesh> occluders_;
  float offset_;
  std::vector<Vector3f> directions_;
  std::vector<std::vector<char>> two_sided_;  // [mesh of the scene][triangle]
};

}  // namespace

BuriedVertices find_buried_vertices(const RayScene& scene, const TriangleMesh& receiver,
                                    std::span<const TriangleMesh> occluders, double origin_offset) {
  std::vector<char> used(receiver.positions.size(), 0);
  for (const Triangle& triangle : receiver.triangles)
    for (const std::uint32_t v : triangle) used[v] = 1;
  const BurialTest test(scene, receiver, occluders, origin_offset);
  std::vector<Burial> burials(used.size(), Burial::none);
  tbb::parallel_for(std::size_t{0}, used.size(), [&](std::size_t v) {
    if (used[v]) burials[v] = test.of(static_cast<std::uint32_t>(v));
  });

  BuriedVertices found;
  const auto kind_of = [&](Burial burial) -> BuriedVertices::Kind& {
    return burial == Burial::covered   ? found.covered
           : burial == Burial::pierced ? found.pierced
                                       : found.inside;
  };
  const std::size_t parts = std::max<std::size_t>(receiver.parts.size(), 1);
  for (BuriedVertices::Kind* kind : {&found.covered, &found.pierced, &found.inside})
    kind->per_part.resize(parts);
  std::size_t part = 0;
  for (std::uint32_t v = 0; v < burials.size(); ++v) {
    while (part + 1 < parts && v >= receiver.parts[part + 1].first_vertex) ++part;
    if (burials[v] == Burial::none) continue;
    BuriedVertices::Kind& kind = kind_of(burials[v]);
    ++kind.count;
    ++kind.per_part[part];
    if (kind.first.size() < BuriedVertices::kExamples) kind.first.push_back(v);
  }
  return found;
}

}  // namespace burnish
