// Stand-ins for the scenes of xu2013asg, Table 1: of the same kind and vertex count.
#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/material/presets.h"
#include "harness/draped_shapes.h"
#include "harness/mesh_building.h"
#include "harness/scene_parts.h"
#include "harness/shapes.h"
#include "harness/teapot.h"

namespace burnish {
namespace {

Material preset(const char* name) { return find_material_preset(name)->material; }

/// Ashikhmin's model of 10:1, as xu2013asg have it in Fig. 1 and 11.
Material brushed(const Rgb& diffuse, const Rgb& reflectance) {
  return {.diffuse = diffuse,
          .specular = Rgb::Ones(),
          .model = SpecularModel::ashikhmin_shirley,
          .alpha_x = 0.3f,
          .alpha_y = 0.03f,
          .fresnel = {.normal_reflectance = reflectance}};
}

Material ward(const Rgb& reflectance, float alpha_x, float alpha_y) {
  return {.diffuse = 0.1f * reflectance,
          .specular = reflectance,
          .model = SpecularModel::ward,
          .alpha_x = alpha_x,
          .alpha_y = alpha_y};
}

void append_painted_dish(ProceduralScene& scene, int segments, const Material& material) {
  append_dish(scene.mesh, 0.004, 0.03, segments);
  paint(scene, material);
}

void append_painted_floor(ProceduralScene& scene, double half_size, int cells) {
  append_floor(scene.mesh, half_size, cells, 0.5);
  paint(scene, diffuse_material(kFloorAlbedo));
}

/// A ball turned about `axis`, its grooves around it.
void append_ball(ProceduralScene& scene, const Vector3d& center, double radius,
                 const Vector3d& axis, const Material& material) {
  const std::uint32_t first = next_vertex(scene.mesh);
  append_sphere(scene.mesh, Vector3f::Zero(), radius, 46, 26);
  move_vertices(scene.mesh, first, Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(), axis),
                center);
  paint(scene, material);
}

}  // namespace

ProceduralScene dish_scene() {
  ProceduralScene scene;
  append_painted_dish(scene, 160,
                      {.diffuse = Rgb(0.05f, 0.045f, 0.04f),
                       .specular = Rgb(0.55f, 0.50f, 0.42f),
                       .model = SpecularModel::ward,
                       .alpha_x = 0.3f,
                       .alpha_y = 0.03f});
  append_painted_floor(scene, 2.5, 100);
  scene.camera = {Vector3f(0.0f, 1.75f, 2.45f), Vector3f(0.0f, 0.04f, 0.05f), Vector3f::UnitY(),
                  42};
  return scene;
}

ProceduralScene teapot_scene() {
  ProceduralScene scene;
  std::uint32_t first = next_vertex(scene.mesh);
  append_teapot(scene.mesh, 0.35, {31, 49});
  move_vertices(scene.mesh, first, Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitY())),
                Vector3d(-0.35, 0, 0.1));
  paint(scene, brushed(Rgb(0.04f, 0.04f, 0.045f), Rgb(0.56f, 0.57f, 0.58f)));
  stand(scene, 0);
  first = next_vertex(scene.mesh);
  append_cylinder(scene.mesh, 0.32, 1.0, 0.03, {8, 6, 32}, 90);
  move_vertices(scene.mesh, first, Eigen::Quaterniond::Identity(), Vector3d(0.95, 0, -0.55));
  paint(scene, brushed(Rgb(0.06f, 0.03f, 0.02f), Rgb(0.6f, 0.4f, 0.28f)));
  stand(scene, first);
  append_painted_floor(scene, 3.0, 100);
  scene.camera = {Vector3f(0.3f, 1.9f, 2.9f), Vector3f(0.05f, 0.4f, -0.05f), Vector3f::UnitY(), 40};
  return scene;
}

ProceduralScene cylinder_scene() {
  ProceduralScene scene;
  append_cylinder(scene.mesh, 0.5, 1.2, 0.04, {30, 10, 150}, 190);
  paint(scene, brushed(Rgb(0.04f, 0.04f, 0.045f), Rgb(0.56f, 0.57f, 0.58f)));
  stand(scene, 0);
  append_painted_floor(scene, 3.0, 104);
  scene.camera = {Vector3f(0.4f, 1.9f, 2.7f), Vector3f(0.0f, 0.5f, 0.0f), Vector3f::UnitY(), 40};
  return scene;
}

ProceduralScene dish_balls_scene() {
  ProceduralScene scene;
  append_painted_dish(scene, 150, ward(Rgb(0.5f, 0.47f, 0.42f), 0.3f, 0.03f));
  append_ball(scene, {-0.02, 0.235, 0.25}, 0.19, {0, 0, 1},
              ward(Rgb(0.6f, 0.4f, 0.15f), 0.2f, 0.04f));
  append_ball(scene, {0.23, 0.235, -0.13}, 0.19, {1, 1, 0.3},
              ward(Rgb(0.5f, 0.5f, 0.5f), 0.3f, 0.03f));
  append_ball(scene, {-0.22, 0.235, -0.15}, 0.19, {0, 1, 0},
              ward(Rgb(0.5f, 0.25f, 0.2f), 0.3f, 0.1f));
  append_ball(scene, {1.15, 0.274, 0.62}, 0.27, {1, 0.2, 0},
              ward(Rgb(0.3f, 0.4f, 0.5f), 0.15f, 0.05f));
  append_painted_floor(scene, 2.5, 96);
  scene.camera = {Vector3f(0.3f, 1.7f, 2.6f), Vector3f(0.1f, 0.08f, 0.05f), Vector3f::UnitY(), 42};
  return scene;
}

ProceduralScene dragon_scene() {
  ProceduralScene scene;
  append_scaly_knot(scene.mesh, 720, 52);
  stand(scene, 0);
  paint(scene, preset("brushed aluminium"));
  append_painted_floor(scene, 3.2, 91);
  scene.camera = {Vector3f(0.2f, 2.6f, 3.3f), Vector3f(0.1f, 0.6f, 0.0f), Vector3f::UnitY(), 42};
  return scene;
}

ProceduralScene pillow_scene() {
  ProceduralScene scene;
  append_pillow(scene.mesh, 1.0, 0.34, 42);
  stand(scene, 0);
  paint(scene, preset("satin"));
  append_painted_floor(scene, 2.5, 47);
  scene.camera = {Vector3f(0.9f, 1.9f, 2.6f), Vector3f(0.0f, 0.15f, 0.0f), Vector3f::UnitY(), 42};
  return scene;
}

ProceduralScene dish_card_scene() {
  ProceduralScene scene;
  append_painted_dish(scene, 100, preset("satin"));
  append_card(scene.mesh, 0.6, 0.95, 0.012, 24, 36);
  paint(scene, ward(Rgb(0.35f, 0.33f, 0.3f), 0.082f, 0.082f));
  append_painted_floor(scene, 2.5, 73);
  scene.camera = {Vector3f(0.5f, 1.7f, 2.4f), Vector3f(0.0f, 0.1f, 0.0f), Vector3f::UnitY(), 42};
  return scene;
}

ProceduralScene cloth_scene() {
  ProceduralScene scene;
  append_draped_cloth(scene.mesh, 0.012, 70);
  stand(scene, 0, 0.01f);
  paint(scene, {.diffuse = Rgb(0.12f, 0.03f, 0.05f),
                .specular = Rgb(0.3f, 0.12f, 0.14f),
                .model = SpecularModel::ward,
                .alpha_x = 0.35f,
                .alpha_y = 0.12f});
  append_painted_floor(scene, 2.5, 72);
  scene.camera = {Vector3f(0.7f, 1.6f, 2.4f), Vector3f(0.0f, 0.4f, 0.0f), Vector3f::UnitY(), 42};
  return scene;
}

}  // namespace burnish
