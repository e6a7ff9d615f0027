#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench.h"
#include "burnish/material/varying_material.h"
#include "burnish/shading/shade.h"
#include "harness/camera.h"

/// What the frame's tables time: frames of a moving view and turning lights.
namespace burnish::tools {

/// All that a frame is made of, and where its results go. Each frame the eye moves about the
/// upward axis, +y, and the lights and the environment turn about it.
struct MovingFrame {
  std::string name;
  const PreparedTransfer* transfer = nullptr;  ///< never null
  LightRig rig;                                ///< of frame 0
  std::vector<Material> materials;
  std::vector<std::uint8_t> material_id;    ///< #V, or empty
  const MaterialArrays* varying = nullptr;  ///< over materials[0]; null: nothing varies
  /// Is turned with the lights; null: highlights are of the lights' lobes.
  PrefilteredEnvironment* environment = nullptr;
  ShadingOptions options;
  Camera camera;                          ///< of frame 0
  std::string_view instruction_set = {};  ///< empty: the best one

  std::vector<PreparedMaterial> prepared_materials;  ///< filled by the first frame
  PreparedLights lights;
  std::vector<Rgb> radiance;  ///< #V
};

/// Wall clock of one frame.
struct FrameTime {
  double prepare_s = 0;  ///< prepare_lights
  double shade_s = 0;    ///< all vertices, in parallel
};

FrameTime draw_frame(MovingFrame& frame, int index);

struct FrameTiming {
  Timing prepare, shade, frame;
};

/// The frames' repetitions are interleaved, so that a busy neighbour on the machine hits all alike;
/// each timed frame comes after one that brings its data back to the caches. Throws Cancelled
/// between frames after Ctrl-C.
std::vector<FrameTiming> measure_frames(std::span<MovingFrame> frames, const BenchOptions& options);

/// Name, vertices, terms, lobes and times. "median_ms" and its like are of the whole frame.
BenchRow frame_row(const std::string& what, const MovingFrame& frame, const FrameTiming& timing,
                   const BenchOptions& options);

}  // namespace burnish::tools
