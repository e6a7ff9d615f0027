#pragma once

#include "harness/procedural_scenes.h"

/// What procedural scenes have in common.
namespace burnish {

inline const Rgb kFloorAlbedo(0.40f, 0.38f, 0.35f);

inline Material diffuse_material(const Rgb& albedo) {
  return {.diffuse = albedo, .specular = Rgb::Zero()};
}

/// Gives a material to all vertices that have none yet.
void paint(ProceduralScene& scene, const Material& material);

/// Lifts the vertices from `first` on until the lowest is at y = `gap`: far below a floor cell, so
/// that a body seems to stand on it, and no two surfaces coincide.
void stand(ProceduralScene& scene, std::uint32_t first, float gap = 0.004f);

/// The scenes of xu2013asg, by likeness.
/// @{
ProceduralScene dish_scene();
ProceduralScene teapot_scene();
ProceduralScene cylinder_scene();
ProceduralScene dish_balls_scene();
ProceduralScene dragon_scene();
ProceduralScene pillow_scene();
ProceduralScene dish_card_scene();
ProceduralScene cloth_scene();
/// @}

}  // namespace burnish
