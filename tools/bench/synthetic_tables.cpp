#include <array>
#include <cmath>
#include <memory>

#include "harness/rivals/runtime_rival.h"
#include "shade_tables.h"

namespace burnish::tools {
namespace {

/// A row of xu2013asg, Table 1: 720 x 480 pixels on a GeForce GTX 680.
struct PaperScene {
  const char* name;
  int vertices;
  Material material;
  bool varies;  ///< from vertex to vertex
  int environment_lobes, local_lights;
  double paper_fps;
};

/// As a fit of a measured metal: so many lobes, from narrow to wide.
Material fitted_metal(int lobes) {
  const auto fitted = std::make_shared<FittedSpecular>();
  for (int i = 0; i < lobes; ++i) {
    AnisotropicGaussian<float> lobe;
    lobe.frame = frame_from_axis(Vector3f(0, 0, 1));
    lobe.bandwidth_x = 400 * std::pow(0.25f, static_cast<float>(i));
    lobe.bandwidth_y = lobe.bandwidth_x / 4;
    lobe.amplitude = lobe.bandwidth_x / 100;
    fitted->lobes.push_back(lobe);
  }
  fitted->color_by_difference.assign(2, Rgb::Ones());
  fitted->masking.assign(2, 1.0f);
  Material material;
  material.diffuse = Rgb::Constant(0.1f);
  material.model = SpecularModel::fitted;
  material.fitted = fitted;
  return material;
}

std::array<PaperScene, 8> paper_scenes() {
  Material ward;
  ward.model = SpecularModel::ward;
  ward.specular = Rgb::Constant(0.5f);
  ward.alpha_x = 0.3f;
  ward.alpha_y = 0.03f;
  const Material ashikhmin = ashikhmin_8_800();
  return {{{"dish", 25000, ashikhmin, false, 10, 2, 125},
           {"teapot", 54000, ashikhmin, false, 10, 0, 201},
           {"dish and balls", 29000, ward, false, 10, 2, 120},
           {"dragon", 46000, fitted_metal(4), false, 8, 0, 83},
           {"dish, varying", 25000, fitted_metal(1), true, 14, 0, 218},
           {"pillow, varying", 6000, fitted_metal(1), true, 8, 0, 278},
           {"dish card, varying", 17000, fitted_metal(2), true, 12, 0, 245},
           {"cloth", 16000, fitted_metal(2), false, 12, 0, 182}}};
}

/// Scale and grooves that differ from vertex to vertex.
MaterialArrays varying(size_t vertices, std::mt19937& random) {
  std::uniform_real_distribution<float> uniform;
  MaterialArrays arrays;
  for (size_t v = 0; v < vertices; ++v) {
    arrays.specular.push_back(Rgb::Constant(0.2f + 0.8f * uniform(random)));
    arrays.tangent_rotation_rad.push_back(kPi<float> * uniform(random));
  }
  return arrays;
}

/// What the frames refer to.
struct StandIn {
  PreparedTransfer transfer;
  MaterialArrays varying;
};

Camera camera_of(const PreparedTransfer& transfer) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& position : transfer.positions) box.extend(position);
  return frame_bounds(box.min(), box.max(), 1.5f);
}

}  // namespace

std::vector<BenchRow> table1(const ShadeBench& bench) {
  std::mt19937 random(1);
  const std::array<PaperScene, 8> scenes = paper_scenes();
  std::array<StandIn, 8> stand_ins;
  std::vector<MovingFrame> frames;
  for (size_t i = 0; i < scenes.size(); ++i) {
    const PaperScene& scene = scenes[i];
    StandIn& own = stand_ins[i];
    own.transfer = synthetic_transfer(bench.scene.transfer, bench.scene.prepared, scene.vertices);
    if (scene.varies) own.varying = varying(own.transfer.vertex_count(), random);
    const LightRig rig = random_rig(scene.environment_lobes, scene.local_lights, random);
    // The paper's highlights are of the lights; ours, of the map.
    for (const bool ours : {false, true}) {
      const ShadingOptions options =
          ours ? shading_options(Quality::balanced) : paper_shading_options();
      MovingFrame frame = scene_frame(bench.scene, {scene.name, options}, ours);
      frame.name = scene.name;
      frame.transfer = &own.transfer;
      frame.rig = rig;
      frame.materials = {scene.material};
      if (scene.varies) frame.varying = &own.varying;
      frame.camera = camera_of(own.transfer);
      frames.push_back(std::move(frame));
    }
  }
  const std::vector<FrameTiming> timings = measure_frames(frames, bench.options);
  std::vector<BenchRow> rows;
  for (size_t i = 0; i < frames.size(); ++i) {
    BenchRow row = frame_row("table1", frames[i], timings[i], bench.options);
    row["settings"] = i % 2 == 0 ? "paper" : "balanced";
    row["local_lights"] = scenes[i / 2].local_lights;
    row["paper_fps"] = scenes[i / 2].paper_fps;
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<BenchRow> growth_table(const ShadeBench& bench) {
  std::vector<PreparedTransfer> transfers;
  for (const int vertices : {10000, 30000, 100000, 300000, 1000000})
    transfers.push_back(synthetic_transfer(bench.scene.transfer, bench.scene.prepared, vertices));
  std::vector<MovingFrame> frames;
  for (const Quality quality : {Quality::fast, Quality::balanced})
    for (const PreparedTransfer& transfer : transfers) {
      const char* name = quality == Quality::fast ? "fast" : "balanced";
      frames.push_back(scene_frame(bench.scene, {name, shading_options(quality)}, true));
      frames.back().transfer = &transfer;
      frames.back().camera = camera_of(transfer);
    }
  const std::vector<FrameTiming> timings = measure_frames(frames, bench.options);
  std::vector<BenchRow> rows;
  for (size_t i = 0; i < frames.size(); ++i)
    rows.push_back(frame_row("growth", frames[i], timings[i], bench.options));
  return rows;
}

}  // namespace burnish::tools
