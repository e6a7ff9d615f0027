#include "harness/procedural_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "burnish/formats/error.h"
#include "harness/scene_parts.h"
#include "harness/shapes.h"

namespace burnish {
namespace {

ProceduralScene sphere() {
  ProceduralScene scene;
  append_sphere(scene.mesh, Vector3f(0, 1.1f, 0), 1.0, 80, 44);
  paint(scene, {.diffuse = Rgb(0.1f, 0.12f, 0.15f),
                .specular = Rgb(0.4f, 0.4f, 0.4f),
                .model = SpecularModel::ward,
                .alpha_x = 0.3f,
                .alpha_y = 0.1f});
  append_floor(scene.mesh, 4.0, 50, 0.5);
  paint(scene, diffuse_material(kFloorAlbedo));
  scene.camera = {Vector3f(1.2f, 2.6f, 4.8f), Vector3f(0.0f, 0.8f, 0.0f), Vector3f::UnitY(), 42};
  return scene;
}

ProceduralScene plane() {
  ProceduralScene scene;
  append_floor(scene.mesh, 1.0, 32, 1.0);
  paint(scene, {.diffuse = Rgb(0.3f, 0.3f, 0.3f),
                .specular = Rgb(0.2f, 0.2f, 0.2f),
                .model = SpecularModel::ward,
                .alpha_x = 0.3f,
                .alpha_y = 0.1f});
  scene.camera = {Vector3f(0.0f, 1.2f, 2.2f), Vector3f(0, 0, 0), Vector3f::UnitY(), 40};
  return scene;
}

ProceduralScene wall() {
  ProceduralScene scene;
  append_floor(scene.mesh, 2.0, 48, 1.0);
  paint(scene, diffuse_material(kFloorAlbedo));
  // Stands on the floor but for a gap, at z = -0.5, and looks to +z.
  append_rectangle(scene.mesh, Vector3f(-1.0f, 0.002f, -0.5f), Vector3f(2, 0, 0),
                   Vector3f(0, 1.2f, 0), 50, 30);
  paint(scene, diffuse_material(Rgb(0.55f, 0.25f, 0.2f)));
  scene.camera = {Vector3f(1.6f, 1.7f, 3.0f), Vector3f(0, 0.35f, -0.3f), Vector3f::UnitY(), 45};
  return scene;
}

// `fineness`: of all edges.
ProceduralScene knot_scene(double fineness) {
  const auto cells = [&](int count) { return static_cast<int>(std::lround(count * fineness)); };
  ProceduralScene scene;
  append_torus_knot(scene.mesh, Vector3f(0, 0.62f, 0), 1.0, 0.4, 0.18, cells(1100), cells(40));
  paint(scene, {.diffuse = Rgb(0.25f, 0.1f, 0.06f),
                .specular = Rgb(0.3f, 0.3f, 0.3f),
                .model = SpecularModel::ward,
                .alpha_x = 0.1f,
                .alpha_y = 0.2f});
  append_floor(scene.mesh, 3.0, cells(99), 0.5);
  paint(scene, diffuse_material(kFloorAlbedo));
  scene.camera = {Vector3f(0.0f, 2.9f, 3.6f), Vector3f(0, 0.35f, 0), Vector3f::UnitY(), 42};
  return scene;
}

constexpr int kKnotVertices = 54000;
ProceduralScene knot() { return knot_scene(1); }

constexpr std::array<std::pair<const char*, ProceduralScene (*)()>, 12> kScenes = {{
    {"dish", dish_scene},
    {"sphere", sphere},
    {"plane", plane},
    {"wall", wall},
    {"knot", knot},
    {"teapot", teapot_scene},
    {"cylinder", cylinder_scene},
    {"dish-balls", dish_balls_scene},
    {"dragon", dragon_scene},
    {"pillow", pillow_scene},
    {"dish-card", dish_card_scene},
    {"cloth", cloth_scene},
}};

}  // namespace

void paint(ProceduralScene& scene, const Material& material) {
  const auto id = static_cast<std::uint8_t>(scene.materials.size());
  scene.materials.push_back(material);
  scene.material_id.resize(scene.mesh.positions.size(), id);
}

void stand(ProceduralScene& scene, std::uint32_t first, float gap) {
  const auto vertices = std::span(scene.mesh.positions).subspan(first);
  float lowest = std::numeric_limits<float>::infinity();
  for (const Vector3f& p : vertices) lowest = std::min(lowest, p.y());
  for (Vector3f& p : vertices) p.y() += gap - lowest;
}

std::vector<std::string> paper_scene_names() {
  return {"dish", "teapot", "cylinder", "dish-balls", "dragon", "pillow", "cloth"};
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : kScenes) names.emplace_back(name);
  return names;
}

ProceduralScene make_scene(std::string_view name) {
  for (const auto& [known, make] : kScenes) {
    if (name != known) continue;
    ProceduralScene scene = make();
    scene.name = scene.mesh.name = known;
    return scene;
  }
  throw Error(
      ErrorKind::input, std::string(name),
      fmt::format("no such procedural scene, expected one of {}", fmt::join(scene_names(), ", ")));
}

ProceduralScene make_knot(int vertices) {
  constexpr int kFewest = 1000, kMost = 20'000'000;
  if (vertices < kFewest || vertices > kMost)
    throw Error(ErrorKind::input, "knot",
                fmt::format("{} vertices, expected {}..{}", vertices, kFewest, kMost));
  ProceduralScene scene = knot_scene(std::sqrt(double(vertices) / kKnotVertices));
  scene.name = scene.mesh.name = "knot";
  return scene;
}

}  // namespace burnish
