#pragma once

#include <random>
#include <string>
#include <vector>

#include "moving_frame.h"
#include "subject.h"

/// What the frame's tables are measured on.
namespace burnish::tools {

/// A baked scene under the studio's light.
struct ShadeScene {
  std::string name;
  Transfer transfer;
  PreparedTransfer prepared;
  Camera camera;
  Image studio;
  LightRig rig;  ///< fitted to the studio, ten lobes
  PrefilteredEnvironment filtered;
};

/// Bakes the subject, or reads `transfer_file` unless that is empty.
ShadeScene load_shade_scene(const SubjectOptions& options, const std::string& transfer_file,
                            Work& work);

/// Ashikhmin and Shirley's lobe of exponents 8 and 800 over a grey diffuse part.
Material ashikhmin_8_800();

/// A way to shade.
struct NamedOptions {
  std::string name;
  ShadingOptions options;
};
/// The paper's, fast, balanced and accurate.
std::vector<NamedOptions> all_options();

/// The scene as the frame row has it: one Ashikhmin lobe, lit by the rig; highlights of the
/// filtered map or of the lights.
MovingFrame scene_frame(ShadeScene& scene, const NamedOptions& options, bool from_map);

/// A transfer of about as many vertices as asked for (at least 1000) with the bases of `baked` and
/// random coefficients of their variances: what costs as much as a baked one. The vertices are
/// those of make_knot; bases are as coherent along them as in
/// `baked`. Throws Error where that has none.
PreparedTransfer synthetic_transfer(const Transfer& baked, const PreparedTransfer& prepared,
                                    int vertices);

/// Lobes of bandwidths 1 to 100 in random directions, and sphere lights around the origin.
LightRig random_rig(int lobes, int spheres, std::mt19937& random);

}  // namespace burnish::tools
