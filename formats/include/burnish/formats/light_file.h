#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "burnish/light/light_rig.h"

namespace burnish {

/// Version of the light format that this build writes, and the newest that it reads.
inline constexpr int kLightFormatVersion = 2;

/// A light rig as it is stored: the distant lights in the environment's own frame, as fitted, the
/// local ones in the world. To shade with it: world_lights.
struct LightFile {
  std::string name;    ///< for people; may be empty
  std::string source;  ///< file name of the environment the lobes were fitted to; may be empty
  Eigen::Matrix3f world_from_environment = Eigen::Matrix3f::Identity();  ///< a rotation
  float scale = 1;  ///< of all lights, and of the environment they stand for; >= 0
  std::optional<double> fit_relative_l2;             ///< the fit's own error over the sphere, >= 0
  std::optional<double> fit_irradiance_relative_l2;  ///< that of the irradiance, over all normals
  LightRig rig;                                      ///< not turned, not scaled
};

/// The rig of a file, turned and scaled as the file says; frames exactly orthonormal.
LightRig world_lights(const LightFile& file);

/// Reads a JSON light file (formats/FORMAT.md) of this or an earlier version. Unknown fields and
/// bad values are refused with their JSON path and line. Frames, rectangles and the rotation are
/// re-orthonormalised; off by more than 1e-3 they are refused. Powers become radiances.
LightFile read_lights(const std::string& path);

/// Writes a light file, a line a light; float values are exact (shortest form that reads back
/// equal). A lobe's amplitude is multiplied into its color. Throws Error(ErrorKind::output), also
/// for values that read_lights would refuse.
void write_lights(const LightFile& lights, const std::string& path);

/// The same without a file: `subject` stands for the file's name in errors.
/// @{
LightFile parse_lights(std::string_view json, const std::string& subject);
std::string format_lights(const LightFile& lights, const std::string& subject);
/// @}

}  // namespace burnish
