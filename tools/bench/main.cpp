#include <array>

#include "stations.h"

int main(int argc, char** argv) {
  using namespace burnish::tools;
  constexpr std::array kStations = {
      Command{"bake", "time of a bake, and the diffuse error of what it baked", declare_bake_bench},
      Command{"guard", "errors of small scenes against those that are written down",
              declare_guard_bench},
      Command{"light", "time and error of fitted lights and of the filtered environment",
              declare_light_bench},
      Command{"material", "error of specular materials as lobes, by model, roughness and view",
              declare_material_bench},
      Command{"presets",
              "what fast, balanced and accurate should be: the dials of shading on many scenes",
              declare_presets_bench},
      Command{"promise", "what burnish tune promises against what whole scenes measure",
              declare_promise_bench},
      Command{"report", "one HTML page of what tradeoff and reproduce measured",
              declare_report_bench},
      Command{"reproduce", "the papers' figures and tables, made again: pictures and numbers",
              declare_reproduce_bench},
      Command{"rivals", "other ways to shade a scene's vertices: errors and times",
              declare_rivals_bench},
      Command{"shade", "the frame: times, errors, bounds and growth", declare_shade_bench},
      Command{"sphere", "ns a call of each operator of the sphere, and the error it has for that",
              declare_sphere_bench},
      Command{"tradeoff", "settings and rivals on one scene: errors against time, memory and bake",
              declare_tradeoff_bench},
  };
  const Program program{"burnish-bench", "Measures the stations of burnish, one by one.",
                        kStations};
  return run_program(program, argc, argv);
}
