#pragma once

#include <memory>
#include <vector>

#include "burnish/precompute/bake.h"
#include "burnish/precompute/fit_light.h"
#include "harness/parallel_prefilter.h"
#include "harness/rivals/rival.h"
#include "harness/shapes.h"
#include "harness/studio_environment.h"

/// Small scenes for the rivals, with all that they refer to.
namespace burnish::test {

inline Material shiny(float alpha_x, float alpha_y) {
  Material material;
  material.diffuse = Rgb::Zero();
  material.model = SpecularModel::ashikhmin_shirley;
  material.fresnel.normal_reflectance = Rgb::Constant(0.5f);
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  return material;
}

inline Material matte() {
  Material material;
  material.diffuse = Rgb(0.8f, 0.6f, 0.4f);
  return material;
}

/// A ball alone: nothing occludes.
inline TriangleMesh ball_mesh() {
  TriangleMesh mesh;
  append_sphere(mesh, Vector3f::Zero(), 1, 24, 12);
  return mesh;
}

/// A ball over a floor, each of which shadows the other.
inline TriangleMesh floor_mesh() {
  TriangleMesh mesh;
  append_floor(mesh, 2, 12, 0.5);
  append_sphere(mesh, Vector3f(0, 0.9f, 0), 0.5, 16, 8);
  return mesh;
}

/// Not to be moved: the scene refers to its neighbours.
struct SmallScene {
  std::vector<Material> materials;
  Image map;
  Transfer transfer;
  PreparedTransfer prepared;
  SceneRays rays;
  RivalScene scene;
  Vector3f eye = Vector3f(1.5f, 2.5f, 2);

  SmallScene(const TriangleMesh& mesh, const Material& material, Image environment,
             int light_lobes = 4)
      : materials({material}),
        map(std::move(environment)),
        transfer(bake(mesh, {},
                      {.directions = 64,
                       .resolution = 64,
                       .terms = 16,
                       .bases = 1,
                       .ladder_terms = 8,
                       .residual_vertices = 8})),
        prepared(prepare_transfer(transfer, RowFormat::float32)),
        rays(transfer) {
    scene.subject = {&transfer, materials, {}, nullptr, &prepared};
    scene.rays = &rays;
    scene.map = &map;
    scene.rig = fit_light(map, {.lobes = light_lobes, .cells = 512}).rig;
    scene.filtered = std::make_shared<PrefilteredEnvironment>(prefilter_in_parallel(map));
  }
  SmallScene(const SmallScene&) = delete;
  SmallScene& operator=(const SmallScene&) = delete;
};

/// What a rival makes of all vertices.
inline std::vector<Rgb> shaded(const Rival& rival, const SmallScene& small,
                               const Eigen::Matrix3f& turn = Eigen::Matrix3f::Identity()) {
  rival.prepare_lights(turn);
  return shade_vertices(rival, small.transfer.vertex_count(), small.eye);
}

/// A turn that no axis of the scene shares.
inline Eigen::Matrix3f some_turn() {
  return Eigen::AngleAxisf(0.9f, Vector3f(0.3f, 0.8f, -0.2f).normalized()).toRotationMatrix();
}

}  // namespace burnish::test
