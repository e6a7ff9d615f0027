#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "burnish/formats/mesh_file.h"
#include "burnish/formats/scene_file.h"
#include "burnish/formats/triangle_mesh.h"

namespace burnish {

/// A scene ready to be baked.
struct SceneMeshes {
  TriangleMesh receiver;                ///< all receivers; one part an instance, the ground last
  std::vector<TriangleMesh> occluders;  ///< one an instance
};

/// Puts meshes where a scene wants them; `meshes[i]` stands for scene.meshes[i]. Each instance has
/// vertices of its own, as each sees something else. An instance at the identity keeps its bytes.
///
/// - Names: an instance's own; else its mesh's; else the file's name. One that is taken gets a
///   number: "dragon", "dragon #2". Names given to instances are taken first.
/// - If some receivers have UVs, those without get (0, 0).
/// - The ground spreads around the middle of the receivers (of all meshes, if none receives).
///
/// Throws Error, with the scene's path, for a map that is not invertible or takes a vertex out of
/// the range of float, more than 2^32 - 1 vertices or triangles together, a scene without receivers
/// and ground, and a ground under meshes without extent.
SceneMeshes assemble_scene(const SceneDescription& scene, std::span<const TriangleMesh> meshes);

/// Reads the meshes of a scene, each once, and assembles them. `options.up` is the scene's. Calls
/// `on_read`, if given, after each mesh. Errors name the scene file and its line, then the mesh's
/// own error.
SceneMeshes load_scene(
    const SceneDescription& scene, MeshReadOptions options = {},
    const std::function<void(const SceneMesh&, const MeshReport&)>& on_read = {});

/// A mesh taken through an invertible map: normals stay on their side and are unit, tangents unit
/// and orthogonal to them; where the map mirrors, triangles are turned round, so that they still
/// run counter-clockwise seen from the normal's side. In double, rounded once. The identity changes
/// nothing.
TriangleMesh place_mesh(const TriangleMesh& mesh, const Placement& world_from_mesh);

/// Appends a mesh as a part of that name. A `scene` that has triangles but no parts is one part
/// itself, of its own name. Throws Error when 32-bit indices do not suffice.
void append_part(TriangleMesh& scene, const TriangleMesh& mesh, const std::string& name);

/// The plane's square of `cells` x `cells` cells at `height` along `up`: its middle below that of
/// `bounds`, its edge `ground.size` times the larger horizontal extent of `bounds` (not 0), normals
/// along `up`. Cells in the middle have a quarter of an even grid's edge.
TriangleMesh ground_plane(const Eigen::AlignedBox3f& bounds, UpAxis up, double height,
                          const SceneGround& ground);

}  // namespace burnish
