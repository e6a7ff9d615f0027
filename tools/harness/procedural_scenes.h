#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/material/material.h"
#include "harness/camera.h"

namespace burnish {

/// A scene that needs no file: +y is up, the unit is about the size of the object.
struct ProceduralScene {
  std::string name;
  TriangleMesh mesh;                      ///< named like the scene
  std::vector<Material> materials;        ///< one or more
  std::vector<std::uint8_t> material_id;  ///< #V, index into materials; equal within a triangle
  Camera camera;                          ///< a view that shows what the scene is for
};

/// Names of all scenes, in a fixed order:
/// - dish: a brushed dish on a floor, 25k vertices, the shape of xu2013asg, Fig. 1. Each body is
///   closed but the floor; tangents run across the grooves, and so does alpha_x.
/// - sphere: a brushed sphere above a floor, 6k vertices
/// - plane: a glossy floor and nothing else: nothing occludes
/// - wall: a diffuse floor before a diffuse wall
/// - knot: a glossy torus knot over a floor, 54k vertices
/// and stand-ins for the other scenes of xu2013asg, Table 1, of closed bodies on a diffuse floor:
/// - teapot: a brushed teapot and a brushed cylinder (Fig. 11), 54k vertices
/// - cylinder: a brushed cylinder, 54k vertices
/// - dish-balls: balls in and beside a dish, all brushed along their own axes (Fig. 12), 29k
/// - dragon: a scaly, spiky knot of brushed aluminium (Fig. 13a), 46k
/// - pillow: a satin pillow (Fig. 13c), 6k
/// - dish-card: a card that leans on a satin dish (Fig. 13d), 17k
/// - cloth: a draped cloth with folds (Fig. 14), 16k
std::vector<std::string> scene_names();

/// Those that stand in for the scenes of xu2013asg, one of each kind: what settings are chosen by.
std::vector<std::string> paper_scene_names();

/// Throws Error for a name that scene_names() does not have.
ProceduralScene make_scene(std::string_view name);

/// The knot in about as many vertices (1000..20 million): how cost grows with a mesh.
ProceduralScene make_knot(int vertices);

}  // namespace burnish
