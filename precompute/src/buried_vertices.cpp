#include "burnish/precompute/buried_vertices.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

constexpr int kRays = 64;
constexpr int kMostOthers = 8;  // rays that escape or meet a front, of a vertex that is inside
constexpr float kReach = 8;     // offsets

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

class BurialTest {
 public:
  BurialTest(const RayScene& scene, const TriangleMesh& receiver,
             std::span<const TriangleMesh> occluders, double origin_offset)
      : scene_(scene),
        receiver_(receiver),
        occluders_(occluders),
        offset_(origin_offset > 0 ? static_cast<float>(origin_offset) : scene.origin_offset()),
        directions_(hemisphere_directions()) {}

  Burial of(std::uint32_t vertex) const {
    const Vector3f& position = receiver_.positions[vertex];
    const Vector3d wide = receiver_.normals[vertex].cast<double>();
    const double length = wide.norm();
    if (!position.allFinite() || !std::isfinite(length) || !(length > 0)) return Burial::none;
    const Vector3f normal = (wide / length).cast<float>();
    const Vector3f origin = position + offset_ * normal;
    RayHit hit;
    if (scene_.intersect(origin, normal, hit) && hit.distance < (kReach - 1) * offset_ &&
        !has_corner_at(hit, position) && front(hit).dot(normal.cast<double>()) > 0)
      return Burial::covered;
    if (scene_.intersect(origin, -normal, hit) && hit.distance < 2 * offset_ &&
        !has_corner_at(hit, position) && front(hit).dot(normal.cast<double>()) < 0)
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

  // Orthogonal to the triangle, to the side of its normals.
  Vector3d front(const RayHit& hit) const {
    const TriangleMesh& mesh = mesh_of(hit);
    const Triangle& t = mesh.triangles[hit.triangle];
    const Vector3d a = mesh.positions[t[0]].cast<double>();
    const Vector3d across =
        (mesh.positions[t[1]].cast<double>() - a).cross(mesh.positions[t[2]].cast<double>() - a);
    const Vector3f sum = mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]];
    return across.dot(sum.cast<double>()) < 0 ? Vector3d(-across) : across;
  }

  bool is_inside(const Vector3f& origin, const Vector3f& normal) const {
    const Frame<float> frame = frame_from_axis<float>(normal);
    int others = 0;
    for (const Vector3f& local : directions_) {
      const Vector3f direction = frame.to_world(local);
      RayHit hit;
      const bool meets_back =
          scene_.intersect(origin, direction, hit) && front(hit).dot(direction.cast<double>()) > 0;
      if (!meets_back && ++others > kMostOthers) return false;
    }
    return true;
  }

  const RayScene& scene_;
  const TriangleMesh& receiver_;
  std::span<const TriangleMesh> occluders_;
  float offset_;
  std::vector<Vector3f> directions_;
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
