// Shades a baked mesh on threads of its own, while its lights turn and the eye moves.
#include <barrier>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include <Eigen/Geometry>

#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/material/presets.h"
#include "burnish/shading/shade.h"

int main(int argc, char** argv) try {
  const auto* preset = argc < 4 ? nullptr : burnish::find_material_preset(argv[3]);
  if (!preset) throw std::invalid_argument("usage: TRANSFER.h5 LIGHTS.json PRESET [MAP.exr|.hdr]");
  const auto transfer = burnish::prepare_transfer(burnish::read_transfer(argv[1]));
  const burnish::LightRig rig = burnish::world_lights(burnish::read_lights(argv[2]));
  burnish::PrefilteredEnvironment map;  // for the highlights
  if (argc > 4) map = burnish::prefilter_environment(burnish::read_environment(argv[4]));
  const burnish::ShadingOptions options;  // or shading_options(burnish::Quality::fast)
  const auto material = burnish::prepare_material(preset->material, options.specular);
  burnish::PreparedLights lights = prepare_lights(rig, transfer, options);
  burnish::Vector3f eye;
  std::vector<burnish::Rgb> radiance(transfer.vertex_count());
  constexpr int kFrames = 200;
  const size_t threads = std::max(1u, std::thread::hardware_concurrency());
  std::barrier all_threads(static_cast<std::ptrdiff_t>(threads));
  const auto shade_part = [&](size_t part) {
    const size_t first = radiance.size() * part / threads;
    const size_t count = radiance.size() * (part + 1) / threads - first;
    for (int frame = 1; frame <= kFrames; ++frame) {
      if (part == 0) {  // what changes from frame to frame, while nobody shades
        const Eigen::Matrix3f turn(Eigen::AngleAxisf(0.01f * frame, burnish::Vector3f::UnitY()));
        burnish::LightRig turned = rig;
        rotate(turned, turn);
        prepare_lights(turned, transfer, options, lights);
        map.environment_from_world = turn.transpose();
        eye = turn.transpose() * burnish::Vector3f(0, 3, 5);
      }
      all_threads.arrive_and_wait();
      shade_vertices(transfer, {&lights, argc > 4 ? &map : nullptr}, {&material, 1}, {}, eye,
                     options, first, std::span(radiance).subspan(first, count));
      all_threads.arrive_and_wait();
    }
  };
  const auto start = std::chrono::steady_clock::now();
  std::vector<std::jthread> others;
  for (size_t part = 1; part < threads; ++part) others.emplace_back(shade_part, part);
  shade_part(0);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  float mean = 0;
  for (const burnish::Rgb& value : radiance) mean += value.mean() / float(radiance.size());
  std::printf("mean radiance %.6f\n%.1f frames/s\n", mean, kFrames / spent.count());
} catch (const std::exception& error) {
  return std::fprintf(stderr, "relight: %s\n", error.what()), 1;
}
