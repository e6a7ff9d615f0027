#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/moving_frame.h"
#include "bench/reproduce/figure.h"
#include "burnish/precompute/bake.h"
#include "harness/error_metrics.h"
#include "harness/procedural_scenes.h"
#include "harness/vertex_truth.h"

/// What the figures of scenes are made on: a procedural scene, baked and lit by the studio.
namespace burnish::tools {

/// A bake that is fast, and fine enough for figures of a few hundred pixels.
inline BakeOptions figure_bake() {
  return {.directions = 128, .resolution = 64, .training_vertices = 2048};
}

struct StageOptions {
  BakeOptions bake = figure_bake();
  int light_lobes = 10;
  bool local_lights = false;  ///< two small spheres above the scene, one warm, one cold
};

/// Not to be moved: its parts refer to each other. Its last material is the floor's.
struct Stage {
  ProceduralScene source;
  Transfer transfer;
  PreparedTransfer prepared;
  SceneRays rays;
  Image map;
  LightRig rig;
  PrefilteredEnvironment filtered;

  Stage(ProceduralScene scene, const StageOptions& options, Work& work);
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// Refers to `materials`, one for each of the source's.
  Subject subject(const std::vector<Material>& materials) const;
  Subject subject() const { return subject(source.materials); }
  ReferenceLights lights() const { return {{&map}, rig.spheres, {}, {}}; }
};

/// The frame of a stage under its lights, highlights of the map; with `transfer` in place of its
/// own, if it is given.
MovingFrame frame_of(Stage& stage, const std::string& name, const ShadingOptions& options,
                     const PreparedTransfer* transfer = nullptr);

/// A picture's size; 2 x 2 samples a pixel.
struct PictureSize {
  int width = 240, height = 160;
};
PrimaryHits hits_of(const Stage& stage, const PictureSize& size);

/// Of a picture to 1 %, kept between runs.
PictureTruth truth_of(const Stage& stage, const std::vector<Material>& materials,
                      const PrimaryHits& hits, const FigureContext& context);

/// The picture of frame 0, shaded at each sample.
Picture draw_by_pixel(const Stage& stage, MovingFrame& frame, const PrimaryHits& hits);

/// The same picture whose mesh is all but the floor: errors over it are of the bodies.
Picture bodies_of(const Stage& stage, Picture picture, const PrimaryHits& hits);

/// relative_l2 over the bodies, without the truth's noise, its square and the mean squared
/// difference of the whole picture as a display shows it, the latter two in percent.
void add_picture_errors(BenchRow& row, const Stage& stage, const Picture& picture,
                        const PictureTruth& truth, const PrimaryHits& hits);

/// Pictures in rows of `columns`, white between them.
Image picture_grid(const std::vector<Image>& pictures, size_t columns);

}  // namespace burnish::tools
