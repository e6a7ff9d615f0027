#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/formats/mesh_frames.h"

namespace burnish {

/// Version of the scene format that this build reads, and the newest.
inline constexpr int kSceneFormatVersion = 1;

/// Rows of an affine map: world = linear part * mesh + last column.
using Placement = Eigen::Matrix<double, 3, 4>;

/// A mesh, put somewhere.
struct SceneInstance {
  std::string name;  ///< empty: the mesh's
  Placement world_from_mesh = Placement::Identity();
};

enum class SceneRole {
  receiver,  ///< is baked, and casts shadows
  occluder,  ///< casts shadows only
};

struct SceneMesh {
  std::string file;  ///< path, as the program's own folder sees it
  std::string name;  ///< empty: the file's name without its folder
  SceneRole role = SceneRole::receiver;
  std::vector<SceneInstance> instances = {{}};  ///< one or more
  std::string place;  ///< "line 7, /meshes/0/file", for errors; may be empty
};

/// A horizontal square under the scene, a receiver.
struct SceneGround {
  std::optional<double> height;  ///< along up; none: just below the lowest point of the receivers
  double size = 4;               ///< edge, in widths of the receivers, 1..1000
  int cells = 64;                ///< along an edge, 2..4096; finer toward the middle
};

/// What to bake.
struct SceneDescription {
  std::string path;       ///< of the scene file, for errors
  std::string name;       ///< of the receiver; empty: the scene file's name without its folder
  UpAxis up = UpAxis::y;  ///< of the ground, and for the tangents of surfaces without UVs
  std::vector<SceneMesh> meshes;
  std::optional<SceneGround> ground;
};

/// Reads a JSON scene file (formats/FORMAT.md). Unknown fields, bad values, maps that flatten and
/// names that occur twice are refused with their JSON path and line. The meshes are not opened;
/// their paths are relative to the scene file's folder.
SceneDescription read_scene(const std::string& path);

/// The same without a file: `path` stands for the file's path in errors and for relative paths.
SceneDescription parse_scene(std::string_view json, const std::string& path);

/// Whether a map can be undone without losing what a float holds: all elements finite, and its
/// smallest stretch at least 1e-6 of its largest.
bool is_invertible(const Placement& placement);

}  // namespace burnish
