#include "burnish/formats/mesh_assembly.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include <Eigen/LU>
#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

constexpr std::uint64_t kMaxCount = std::numeric_limits<std::uint32_t>::max();

void check_counts(const std::string& subject, std::uint64_t vertices, std::uint64_t triangles) {
  if (vertices > kMaxCount || triangles > kMaxCount)
    throw Error(ErrorKind::input, subject,
                fmt::format("{} vertices and {} triangles together, expected at most {} of each",
                            vertices, triangles, kMaxCount));
}

/// Before anything is copied.
void check_counts(const SceneDescription& scene, std::span<const TriangleMesh> meshes) {
  std::uint64_t vertices = 0, triangles = 0;
  for (size_t i = 0; i < meshes.size(); ++i) {
    const std::uint64_t instances = scene.meshes[i].instances.size();
    vertices += instances * meshes[i].positions.size();
    triangles += instances * meshes[i].triangles.size();
  }
  if (scene.ground) {
    const auto cells = static_cast<std::uint64_t>(scene.ground->cells);
    vertices += (cells + 1) * (cells + 1);
    triangles += 2 * cells * cells;
  }
  check_counts(scene.path, vertices, triangles);
}

/// Hands out names that are unlike each other; those of instances are taken from the start.
class Names {
 public:
  explicit Names(const SceneDescription& scene) {
    for (const SceneMesh& mesh : scene.meshes)
      for (const SceneInstance& instance : mesh.instances)
        if (!instance.name.empty()) taken_.insert(instance.name);
  }

  std::string next(const std::string& wanted) {
    int& uses = uses_[wanted];
    while (true) {
      const std::string name = ++uses == 1 ? wanted : fmt::format("{} #{}", wanted, uses);
      if (taken_.insert(name).second) return name;
    }
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> uses_;
};

std::string name_of(const SceneMesh& mesh) {
  return mesh.name.empty() ? std::filesystem::path(mesh.file).filename().string() : mesh.name;
}

[[noreturn]] void fail(const SceneDescription& scene, const SceneMesh& mesh, ErrorKind kind,
                       const std::string& message) {
  throw Error(kind, scene.path, (mesh.place.empty() ? "" : mesh.place + ": ") + message);
}

TriangleMesh place_instance(const SceneDescription& scene, const SceneMesh& description,
                            const TriangleMesh& mesh, const SceneInstance& instance,
                            const std::string& name) {
  if (!is_invertible(instance.world_from_mesh))
    fail(scene, description, ErrorKind::input, fmt::format("the map of '{}' flattens it", name));
  TriangleMesh placed = place_mesh(mesh, instance.world_from_mesh);
  placed.name = name;
  for (size_t v = 0; v < placed.positions.size(); ++v)
    if (mesh.positions[v].allFinite() && !placed.positions[v].allFinite())
      fail(scene, description, ErrorKind::input,
           fmt::format("the map of '{}' takes vertex {} beyond the range of float", name, v));
  return placed;
}

/// Of what can be seen: vertices in no triangle do not count.
void extend(Eigen::AlignedBox3f& bounds, const TriangleMesh& mesh) {
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle)
      if (mesh.positions[v].allFinite()) bounds.extend(mesh.positions[v]);
}

void add_ground(const SceneDescription& scene, const std::string& name, SceneMeshes& meshes) {
  Eigen::AlignedBox3f receivers, all;
  extend(receivers, meshes.receiver);
  for (const TriangleMesh& occluder : meshes.occluders) extend(all, occluder);
  if (receivers.isEmpty()) receivers = all;
  all.extend(receivers);
  if (receivers.isEmpty() || !(receivers.sizes().maxCoeff() > 0))
    throw Error(ErrorKind::input, scene.path,
                "the ground needs a mesh with extent, the meshes have none");
  const auto up = static_cast<Eigen::Index>(scene.up);
  double height = scene.ground->height.value_or(0);
  if (!scene.ground->height) {
    // Vertices that stand on the ground must not see through it: it lies below them by eight of
    // the distances by which a ray's origin leaves a surface (RayScene::origin_offset).
    Eigen::AlignedBox3f whole = all;
    extend(whole, ground_plane(receivers, scene.up, receivers.min()[up], *scene.ground));
    const double largest =
        std::max(whole.min().cwiseAbs().maxCoeff(), whole.max().cwiseAbs().maxCoeff());
    const double gap = std::max(std::ldexp(double(whole.sizes().maxCoeff()), -13),
                                32 * largest * double(std::numeric_limits<float>::epsilon()));
    height = receivers.min()[up] - gap;
  }
  const TriangleMesh ground = ground_plane(receivers, scene.up, height, *scene.ground);
  for (const Vector3f& p : ground.positions)
    if (!p.allFinite())
      throw Error(ErrorKind::input, scene.path, "the ground reaches beyond the range of float");
  append_part(meshes.receiver, ground, name);
}

}  // namespace

TriangleMesh place_mesh(const TriangleMesh& mesh, const Placement& world_from_mesh) {
  TriangleMesh placed = mesh;
  if (world_from_mesh == Placement::Identity()) return placed;
  const Eigen::Matrix3d linear = world_from_mesh.leftCols<3>();
  const Eigen::Matrix3d scaled = linear / linear.cwiseAbs().maxCoeff();
  const bool mirrors = scaled.determinant() < 0;
  // The inverse transpose up to a positive factor, which keeps a normal on its side even in a
  // mirror: the cofactors, by the determinant's sign.
  Eigen::Matrix3d cofactors;
  cofactors << Vector3d(scaled.col(1)).cross(scaled.col(2)),
      Vector3d(scaled.col(2)).cross(scaled.col(0)), Vector3d(scaled.col(0)).cross(scaled.col(1));
  if (mirrors) cofactors = -cofactors;
  for (size_t v = 0; v < placed.positions.size(); ++v) {
    placed.positions[v] =
        (linear * mesh.positions[v].cast<double>() + world_from_mesh.col(3)).cast<float>();
    const Vector3d normal = (cofactors * mesh.normals[v].cast<double>()).stableNormalized();
    const Vector3d tangent = scaled * mesh.tangents[v].cast<double>();
    placed.normals[v] = normal.cast<float>();
    placed.tangents[v] = frame_from_normal_tangent<double>(normal, tangent).x.cast<float>();
  }
  if (mirrors)
    for (Triangle& triangle : placed.triangles) std::swap(triangle[1], triangle[2]);
  return placed;
}

void append_part(TriangleMesh& scene, const TriangleMesh& mesh, const std::string& name) {
  const size_t first = scene.positions.size(), first_triangle = scene.triangles.size();
  const size_t vertices = mesh.positions.size();
  check_counts(scene.name.empty() ? "scene" : scene.name, first + vertices,
               first_triangle + mesh.triangles.size());
  const auto number = [](size_t n) { return static_cast<std::uint32_t>(n); };
  if (scene.parts.empty() && first > 0)
    scene.parts.push_back({scene.name, 0, number(first), 0, number(first_triangle)});
  scene.parts.push_back({name, number(first), number(vertices), number(first_triangle),
                         number(mesh.triangles.size())});

  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  if (!scene.uvs.empty() || !mesh.uvs.empty()) {
    scene.uvs.resize(first, Eigen::Vector2f::Zero());
    append(scene.uvs, mesh.uvs);
    scene.uvs.resize(first + vertices, Eigen::Vector2f::Zero());
  }
  append(scene.positions, mesh.positions);
  append(scene.normals, mesh.normals);
  append(scene.tangents, mesh.tangents);
  append(scene.file_vertex, mesh.file_vertex);
  append(scene.triangles, mesh.triangles);
  for (size_t t = first_triangle; t < scene.triangles.size(); ++t)
    for (std::uint32_t& v : scene.triangles[t]) v += number(first);
}

TriangleMesh ground_plane(const Eigen::AlignedBox3f& bounds, UpAxis up, double height,
                          const SceneGround& ground) {
  constexpr double kMiddleScale = 0.25;
  const Vector3d normal = up_direction(up).cast<double>();
  const Vector3d along = tangent_from_up(normal.cast<float>(), up).cast<double>();
  const Vector3d across = normal.cross(along);
  const Vector3d sizes = bounds.sizes().cast<double>();
  double width = (sizes - sizes.dot(normal) * normal).maxCoeff();
  if (!(width > 0)) width = sizes.maxCoeff();  // an upright line or sheet's edge
  const Vector3d middle = (bounds.min().cast<double>() + bounds.max().cast<double>()) / 2;
  const Vector3d below = middle + (height - middle.dot(normal)) * normal;
  const auto coordinate = [&](int i) {
    const double t = 2.0 * i / ground.cells - 1;
    return ground.size * width / 2 * t * (kMiddleScale + (1 - kMiddleScale) * t * t * t * t);
  };

  TriangleMesh mesh;
  mesh.name = "ground";
  const auto columns = static_cast<std::uint32_t>(ground.cells + 1);
  for (int row = 0; row <= ground.cells; ++row)
    for (int column = 0; column <= ground.cells; ++column) {
      mesh.file_vertex.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(
          (below + coordinate(column) * along + coordinate(row) * across).cast<float>());
    }
  mesh.normals.assign(mesh.positions.size(), normal.cast<float>());
  mesh.tangents.assign(mesh.positions.size(), along.cast<float>());
  for (std::uint32_t row = 0; row + 1 < columns; ++row)
    for (std::uint32_t column = 0; column + 1 < columns; ++column) {
      const std::uint32_t a = row * columns + column, b = a + columns;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  return mesh;
}

SceneMeshes assemble_scene(const SceneDescription& scene, std::span<const TriangleMesh> meshes) {
  check_counts(scene, meshes);
  SceneMeshes assembled;
  TriangleMesh& receiver = assembled.receiver;
  receiver.name =
      scene.name.empty() ? std::filesystem::path(scene.path).filename().string() : scene.name;
  Names names(scene);
  for (size_t i = 0; i < meshes.size(); ++i) {
    const SceneMesh& description = scene.meshes[i];
    for (const SceneInstance& instance : description.instances) {
      const std::string name =
          instance.name.empty() ? names.next(name_of(description)) : instance.name;
      TriangleMesh placed = place_instance(scene, description, meshes[i], instance, name);
      if (description.role == SceneRole::receiver)
        append_part(receiver, placed, name);
      else
        assembled.occluders.push_back(std::move(placed));
    }
  }
  if (scene.ground) add_ground(scene, names.next("ground"), assembled);
  if (receiver.positions.empty())
    throw Error(ErrorKind::input, scene.path, "has no receiver, expected a mesh or a ground");
  return assembled;
}

SceneMeshes load_scene(const SceneDescription& scene, MeshReadOptions options,
                       const std::function<void(const SceneMesh&, const MeshReport&)>& on_read) {
  options.up = scene.up;
  std::vector<TriangleMesh> meshes;
  for (const SceneMesh& mesh : scene.meshes) {
    MeshReport report;
    try {
      meshes.push_back(read_mesh(mesh.file, options, &report));
    } catch (const Error& error) {
      fail(scene, mesh, error.kind(), error.what());
    }
    if (on_read) on_read(mesh, report);
  }
  return assemble_scene(scene, meshes);
}

}  // namespace burnish
