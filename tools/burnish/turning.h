#pragma once

#include "harness/picture.h"
#include "harness/primary_hits.h"
#include "look_options.h"

/// Frames in which the eye, the lights or both turn once about the upward axis.
namespace burnish::tools {

enum class Turning {
  eye,
  light,  ///< environment and distant lights; local lights stay
  both,   ///< the same turn: what is seen of the environment stays, the object turns in it
};

/// What a frame is drawn with beside the look.
struct Moment {
  View view;
  EnvironmentLight background;
};

/// Turns by an angle from the still picture, of angle 0, which it gives to the bit. Where light
/// turns, prepares the look's lights anew and turns its filtered environment; the look's rig and
/// world_from_environment stay those of the still picture.
Moment turn_to(Turning turning, double angle_rad, const View& still, const LookOptions& options,
               Look& look);

}  // namespace burnish::tools
