#include "turning.h"

#include "burnish/light/light_rig.h"

namespace burnish::tools {
namespace {

EnvironmentLight turn_lights(const Eigen::Matrix3f& turn, const LookOptions& options, Look& look) {
  LightRig rig = look.rig;
  rotate(rig, turn);
  prepare_lights(rig, look.prepared, options.shading, look.lights);
  EnvironmentLight background = look.environment_light();
  background.world_from_environment = turn * look.world_from_environment;
  look.filtered.environment_from_world = background.world_from_environment.transpose();
  return background;
}

}  // namespace

Moment turn_to(Turning turning, double angle_rad, const View& still, const LookOptions& options,
               Look& look) {
  const Vector3f up = up_direction(options.up);
  Moment moment = {still, look.environment_light()};
  if (turning != Turning::light) moment.view.camera = turned(still.camera, up, angle_rad);
  if (turning != Turning::eye)
    moment.background = turn_lights(
        Eigen::AngleAxisf(static_cast<float>(angle_rad), up).toRotationMatrix(), options, look);
  return moment;
}

}  // namespace burnish::tools
