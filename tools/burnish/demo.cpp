#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/fit_light.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/reports.h"
#include "common/work.h"
#include "harness/parallel_prefilter.h"
#include "harness/procedural_scenes.h"
#include "harness/reference_integrator.h"
#include "harness/studio_environment.h"

namespace burnish::tools {
namespace {

/// Frames that the frame time is the median of, after one to warm up.
constexpr int kTimedFrames = 5;

struct Options {
  std::string scene = "dish";
  std::string folder;
  BakeOptions bake;
  LightFitOptions fit;
  int width = 720;
  int height = 480;
  int antialias = 2;
  int reference_samples = 128;
  std::uint64_t seed = 1;
  CommonOptions common;

  std::string file(const std::string& suffix) const {
    return (std::filesystem::path(folder) / (scene + suffix)).string();
  }
};

Transfer bake_scene(const Options& options, const ProceduralScene& scene, Work& work,
                    nlohmann::ordered_json& report) {
  BakeTimings timings;
  const Transfer transfer =
      bake(scene.mesh, {}, options.bake, {.progress = work.progress(), .timings = &timings});
  throw_if_interrupted();
  write_transfer(transfer, options.file(".h5"));
  const std::uint64_t bytes = std::filesystem::file_size(options.file(".h5"));
  report["bake"] = bake_report(transfer, options.bake, timings, bytes);
  work.print(bake_summary(transfer, timings));
  work.print(fmt::format("{}: {}", options.file(".h5"), bytes_text(static_cast<double>(bytes))));
  return transfer;
}

LightRig fit_studio(const Options& options, const Image& studio, Work& work,
                    nlohmann::ordered_json& report) {
  const Stopwatch watch;
  const LightFit fit = fit_light(studio, options.fit, work.progress());
  const double seconds = watch.seconds();
  throw_if_interrupted();
  LightFile file;
  file.name = "studio";
  file.fit_relative_l2 = fit.error.relative_l2;
  file.fit_irradiance_relative_l2 = fit.error.irradiance_relative_l2;
  file.rig = fit.rig;
  write_lights(file, options.file(".lights.json"));
  report["fit"] = {{"lobes", fit.rig.lobes.size()},
                   {"relative_l2", fit.error.relative_l2},
                   {"seconds", seconds}};
  work.print(fmt::format("{}: {} lobes fitted to the studio in {:.1f} s",
                         options.file(".lights.json"), fit.rig.lobes.size(), seconds));
  return fit.rig;
}

/// The baked picture; its frame time is the median of several.
Picture render_baked(const Subject& subject, const PrimaryHits& hits, const Lighting& lighting,
                     const EnvironmentLight& background, Work& work,
                     nlohmann::ordered_json& report) {
  const auto frame_ms = [](const RenderTimings& t) { return t.vertices_ms + t.pixels_ms; };
  std::vector<RenderTimings> timings(kTimedFrames);
  Picture picture = render(subject, hits, lighting, background, ShadePer::vertex, {});
  for (RenderTimings& timing : timings) {
    picture = render(subject, hits, lighting, background, ShadePer::vertex, {}, &timing);
    throw_if_interrupted();
  }
  std::nth_element(timings.begin(), timings.begin() + kTimedFrames / 2, timings.end(),
                   [&](const auto& a, const auto& b) { return frame_ms(a) < frame_ms(b); });
  const RenderTimings& median = timings[kTimedFrames / 2];
  report["frame"] = frame_report(hits, median);
  report["frame"]["frame_ms"] = frame_ms(median);
  work.print(fmt::format("frame time {:.1f} ms: vertices {:.1f} ms, pixels {:.1f} ms",
                         frame_ms(median), median.vertices_ms, median.pixels_ms));
  return picture;
}

void run(const Options& options) {
  check_bake_options(options.bake);
  std::error_code error;
  std::filesystem::create_directories(options.folder, error);
  std::vector<std::string> outputs = {options.common.report};
  for (const char* suffix : {".h5", ".lights.json", ".exr", ".reference.exr", ".png"})
    outputs.push_back(options.file(suffix));
  require_writable(outputs);
  Work work(options.common);
  nlohmann::ordered_json report = {{"scene", options.scene}};

  const ProceduralScene scene = make_scene(options.scene);
  const Transfer transfer = bake_scene(options, scene, work, report);
  const Image studio = studio_environment();
  const LightRig rig = fit_studio(options, studio, work, report);
  const PreparedTransfer prepared = prepare_transfer(transfer);
  const PreparedLights lights = prepare_lights(rig, prepared, {});
  const PrefilteredEnvironment filtered = prefilter_in_parallel(studio);
  const EnvironmentLight environment = {&studio};
  throw_if_interrupted();

  const SceneRays rays(transfer);
  const Subject subject = {&transfer, scene.materials, scene.material_id, nullptr, &prepared};
  const View view = {scene.camera, options.width, options.height, options.antialias};
  const PrimaryHits hits = trace_primary_rays(rays, view);
  const Picture baked =
      render_baked(subject, hits, {&lights, &filtered}, environment, work, report);

  const Stopwatch watch;
  const Picture truth = render_reference(
      subject, rays, hits, {environment, {}},
      {.samples = options.reference_samples, .seed = options.seed}, work.progress());
  report["reference_s"] = watch.seconds();
  work.print(fmt::format("reference with {} samples a pixel in {:.1f} s", options.reference_samples,
                         watch.seconds()));
  const RelativeL2 difference = relative_l2(baked, truth);
  report["reference"] = error_report(difference);
  work.print(error_summary(difference));

  write_exr(baked.radiance, options.file(".exr"));
  write_exr(truth.radiance, options.file(".reference.exr"));
  const std::vector<Image> pictures = {baked.radiance, truth.radiance};
  write_png(side_by_side(pictures), options.file(".png"));
  work.print(fmt::format("{}: baked and relit (left), the truth (right)", options.file(".png")));
  report["machine"] = machine_record(work.threads());
  write_json(options.common.report, report);
}

}  // namespace

std::function<void()> declare_demo(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  std::vector<std::pair<std::string, std::string>> scenes;
  for (const std::string& name : scene_names()) scenes.emplace_back(name, name);
  add_choice(app, "--scene", options->scene, scenes, "built-in scene");
  add_file(app, "-o,--output", "DIR", options->folder,
           "folder for the transfer, the lights and the pictures; made if missing (required)")
      ->required();
  add_bake_options(app, options->bake);
  add_number(app, "--lobes", "N", options->fit.lobes, {1, 128}, "lights to fit, at most");
  add_size(app, options->width, options->height);
  add_number(app, "--reference", "SPP", options->reference_samples, {1, 1 << 20, "samples a pixel"},
             "of the Monte Carlo picture");
  add_number(app, "--seed", "N", options->seed, "of the reference's random numbers");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
