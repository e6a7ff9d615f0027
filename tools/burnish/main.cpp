#include <array>

#include "commands.h"

int main(int argc, char** argv) {
  using namespace burnish::tools;
  constexpr std::array kCommands = {
      Command{"bake", "bake the visibility of every vertex of a mesh", declare_bake},
      Command{"info", "say what is in a mesh, picture, transfer, light file or material",
              declare_info},
      Command{"fit-light", "fit anisotropic Gaussian lights to an environment map",
              declare_fit_light},
      Command{"fit-brdf", "fit a material to a measured BRDF", declare_fit_brdf},
      Command{"render", "draw a baked mesh under an environment, and the truth beside it",
              declare_render},
      Command{"shade", "write the radiance of every vertex as PLY", declare_shade},
      Command{"tune", "find the settings that are accurate or fast enough on a scene",
              declare_tune},
      Command{"demo", "bake, light and draw a built-in scene", declare_demo},
  };
  const Program program{"burnish",
                        "Bakes what every vertex of a mesh can see, then relights the mesh under "
                        "any environment and material.",
                        kCommands};
  return run_program(program, argc, argv);
}
