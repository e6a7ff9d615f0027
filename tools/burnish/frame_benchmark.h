#pragma once

#include <nlohmann/json.hpp>

#include "common/work.h"
#include "harness/camera.h"
#include "harness/render.h"
#include "look_options.h"
#include "turning.h"

/// render --benchmark: how long frames take while view and lights move.
namespace burnish::tools {

struct FrameBenchmark {
  int frames = 100;  ///< of one turn
  View view;         ///< of the first frame
  ShadePer per = ShadePer::vertex;
  Turning turning = Turning::both;
};

/// Draws the frames, after one that does not count, prints their times and returns them. Turns the
/// look's environment, and prepares its lights anew. Throws Cancelled after Ctrl-C.
nlohmann::ordered_json benchmark_frames(const FrameBenchmark& benchmark, const LookOptions& options,
                                        Look& look, Work& work);

}  // namespace burnish::tools
