#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "burnish/light/light_rig.h"
#include "burnish/light/prefiltered_environment.h"
#include "harness/primary_hits.h"

/// Other ways to shade the vertices of a mesh, behind one interface, to compare ours with: what
/// each is and cannot do is in docs/rivals.md.
namespace burnish {

/// What a rival is built on. It refers to all of it, which stays as it is.
struct RivalScene {
  Subject subject;                  ///< with `prepared`; without `varying`
  const SceneRays* rays = nullptr;  ///< of the whole scene, of which the subject may be a part
  const Image* map = nullptr;       ///< the environment, in its own frame
  LightRig rig;                     ///< what stands for the map, in its frame; and local lights
  /// Of the map. The rivals of one scene share it and its rotation: one that shades was the last to
  /// be prepared, or all are prepared alike.
  std::shared_ptr<PrefilteredEnvironment> filtered;
  double transfer_bake_s = 0;  ///< what the transfer took

  size_t vertex_count() const { return subject.transfer->vertex_count(); }
};

struct Rival {
  std::string name;
  double bake_s = 0;            ///< wall clock, of all that is neither per light nor per view
  size_t bytes_per_vertex = 0;  ///< of what shading keeps of a vertex, place and frame included
  size_t bytes_shared = 0;      ///< of the rest
  /// Once per change of the lights: the distant ones, and the map with them, stand in the world by
  /// this rotation. On all threads.
  std::function<void(const Eigen::Matrix3f& world_from_environment)> prepare_lights;
  /// Radiance of the vertices [first, first + radiance.size()) toward an eye, as shade_vertices.
  /// From as many threads as you like, on ranges that do not overlap.
  std::function<void(const Vector3f& eye, size_t first, std::span<Rgb> radiance)> shade;
};

/// Throws std::invalid_argument for a scene that lacks something or whose material varies.
void require_complete(const RivalScene& scene);

/// All vertices, in parallel.
std::vector<Rgb> shade_vertices(const Rival& rival, size_t vertices, const Vector3f& eye);

/// `wanted` of `count` vertices (or all, if there are fewer), rising, drawn by `seed`.
std::vector<std::uint32_t> draw_vertices(size_t count, size_t wanted, std::uint64_t seed);

/// Those vertices of a transfer as one of their own, without triangles: what shading and
/// shade_reference_vertices need of it, if they have the rays of the whole.
Transfer vertex_subset(const Transfer& transfer, std::span<const std::uint32_t> vertices);

/// What every rival keeps of a vertex: position, normal and tangent.
inline constexpr size_t kPlaceBytes = 3 * sizeof(Vector3f);

/// A vertex's frame, and the view from it in that frame, lifted above the horizon.
struct VertexView {
  Frame<float> frame;
  Vector3f outgoing;
};
VertexView view_vertex(const Transfer& transfer, size_t vertex, const Vector3f& eye);

}  // namespace burnish
