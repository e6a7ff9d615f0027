#include "harness/render.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/program.h"
#include "common/reports.h"
#include "frame_benchmark.h"
#include "harness/error_metrics.h"
#include "harness/reference_integrator.h"
#include "look_options.h"

namespace burnish::tools {
namespace {

/// Primary rays of a picture at most: 3 GB of hits.
constexpr std::int64_t kMaxSamples = std::int64_t{1} << 28;

/// The files of one picture; either may be empty.
struct Outputs {
  std::string exr;
  std::string png;
};

struct Options {
  LookOptions look;
  int width = 720;
  int height = 480;
  int antialias = 2;
  ShadePer per = ShadePer::vertex;
  float exposure_stops = 0;
  int turntable = 0;
  bool benchmark = false;
  int frames = 100;  ///< of the benchmark
  int reference_samples = 0;
  std::uint64_t seed = 1;
  Outputs outputs;
  std::string compare;
  CommonOptions common;
};

/// "dir/dish.exr" and "reference" as "dir/dish.reference.exr"; "" stays "".
std::string with_infix(const std::string& path, const std::string& infix) {
  if (path.empty()) return path;
  const std::filesystem::path file(path);
  const std::string name = file.stem().string() + "." + infix + file.extension().string();
  return (file.parent_path() / name).string();
}

Outputs with_infix(const Outputs& outputs, const std::string& infix) {
  return {with_infix(outputs.exr, infix), with_infix(outputs.png, infix)};
}

/// The outputs of a frame: with a turntable, numbered.
Outputs frame_outputs(const Options& options, int frame) {
  if (options.turntable == 0) return options.outputs;
  return with_infix(options.outputs, fmt::format("{:04}", frame));
}

/// A benchmark writes no picture.
void check_benchmark(const Options& options) {
  if (!options.outputs.exr.empty() || !options.outputs.png.empty())
    throw UsageError("--benchmark: found an output, expected none: nothing is written");
  if (options.turntable > 0 || options.reference_samples > 0 || !options.compare.empty())
    throw UsageError(
        "--benchmark: found --turntable, --reference or --compare with it, expected none of them");
}

void check(const Options& options) {
  if (options.benchmark)
    check_benchmark(options);
  else if (options.outputs.exr.empty() && options.outputs.png.empty())
    throw UsageError("no output given, expected -o FILE.exr, --png FILE.png or both");
  if (!options.compare.empty() && options.reference_samples == 0)
    throw UsageError("--compare: found no reference to compare with, expected --reference SPP");
  if (options.reference_samples > 0 && options.turntable > 0)
    throw UsageError("--turntable and --reference: found both, expected one of them");
  const std::int64_t samples =
      std::int64_t{options.width} * options.height * options.antialias * options.antialias;
  if (samples > kMaxSamples)
    throw UsageError(fmt::format("--size and --antialias: found {} samples, expected at most {}",
                                 samples, kMaxSamples));
  std::vector<std::string> outputs = {options.common.report, options.compare};
  const int frames = std::max(options.turntable, 1);
  for (int frame = 0; frame < frames; ++frame) {
    const Outputs named = frame_outputs(options, frame);
    outputs.insert(outputs.end(), {named.exr, named.png});
  }
  if (options.reference_samples > 0) {
    const Outputs named = with_infix(options.outputs, "reference");
    outputs.insert(outputs.end(), {named.exr, named.png});
  }
  require_writable(outputs);
}

void write_picture(const Image& image, const Outputs& outputs, float exposure_stops) {
  throw_if_interrupted();
  if (!outputs.exr.empty()) write_exr(image, outputs.exr);
  if (!outputs.png.empty()) write_png(image, outputs.png, exposure_stops);
}

/// Renders the truth of a view, writes and compares it. Returns the figures.
nlohmann::ordered_json render_truth(const Options& options, const Look& look,
                                    const Subject& subject, const SceneRays& rays,
                                    const PrimaryHits& hits, const Picture& baked, Work& work) {
  const Stopwatch watch;
  const ReferenceOptions sampling = {.samples = options.reference_samples, .seed = options.seed};
  const Picture truth =
      render_reference(subject, rays, hits, look.reference_lights(), sampling, work.progress());
  const double seconds = watch.seconds();
  write_picture(truth.radiance, with_infix(options.outputs, "reference"), options.exposure_stops);
  if (!options.compare.empty()) {
    const std::vector<Image> pictures = {baked.radiance, truth.radiance};
    write_png(side_by_side(pictures), options.compare, options.exposure_stops);
  }
  const RelativeL2 error = relative_l2(baked, truth);
  work.print(error_summary(error));
  nlohmann::ordered_json report = error_report(error);
  report["samples"] = sampling.samples;
  report["seed"] = sampling.seed;
  report["seconds"] = seconds;
  return report;
}

/// The frames, and what the report says of them.
nlohmann::ordered_json render_frames(const Options& options, const Look& look, const Camera& camera,
                                     Work& work) {
  nlohmann::ordered_json report;
  const SceneRays rays(look.transfer);
  const Subject subject = look.subject();
  const Vector3f up = up_direction(options.look.up);
  const int frames = std::max(options.turntable, 1);
  for (int frame = 0; frame < frames; ++frame) {
    const double angle_rad = 2 * kPi<double> * frame / frames;
    const View view = {turned(camera, up, angle_rad), options.width, options.height,
                       options.antialias};
    const PrimaryHits hits = trace_primary_rays(rays, view);
    throw_if_interrupted();
    RenderTimings timings;
    const Picture picture = render(subject, hits, look.lighting(), look.environment_light(),
                                   options.per, options.look.shading, &timings);
    const Outputs outputs = frame_outputs(options, frame);
    write_picture(picture.radiance, outputs, options.exposure_stops);
    report["frames"].push_back(frame_report(hits, timings));
    work.print(frame_summary(outputs.exr.empty() ? outputs.png : outputs.exr, hits, timings));
    if (options.reference_samples > 0)
      report["reference"] = render_truth(options, look, subject, rays, hits, picture, work);
    if (options.turntable > 0 && !work.progress()("frames", frame + 1, frames)) throw Cancelled();
  }
  return report;
}

void run(const Options& options) {
  check(options);
  Work work(options.common);
  Look look = load_look(options.look, work);
  // The truth is that of a map; lobes are what shading makes of it.
  if (options.reference_samples > 0 && look.environment.pixels.empty() && !look.rig.lobes.empty())
    throw UsageError("--reference: found lobes without their environment map, expected --env");
  const float aspect = static_cast<float>(options.width) / static_cast<float>(options.height);
  const Camera camera = look_camera(options.look, look.transfer, aspect);

  nlohmann::ordered_json report = look.report;
  report["camera"] = format_camera(camera);
  report["width"] = options.width;
  report["height"] = options.height;
  if (options.benchmark)
    report["benchmark"] = benchmark_frames(
        {options.frames, {camera, options.width, options.height, options.antialias}, options.per},
        options.look, look, work);
  else
    report.update(render_frames(options, look, camera, work));
  report["machine"] = machine_record(work.threads());
  write_json(options.common.report, report);
}

void add_picture_options(CLI::App& app, Options& options) {
  add_size(app, options.width, options.height);
  add_choice(app, "--per", options.per, {{"vertex", ShadePer::vertex}, {"pixel", ShadePer::pixel}},
             "shade vertices and interpolate, or shade each sample of a pixel");
  add_number(app, "--antialias", "N", options.antialias, {1, 16}, "N x N samples a pixel");
  add_number(app, "--exposure", "EV", options.exposure_stops, {-40, 40, "stops"},
             "brightens PNG pictures, not EXR");
  add_number(app, "--turntable", "N", options.turntable, {0, 9999, "frames"},
             "writes N frames, numbered from 0000, the eye turning about the upward axis (0: one "
             "picture)");
  CLI::Option* benchmark = app.add_flag(
      "--benchmark", options.benchmark,
      "writes no picture: times frames of a moving view and turning lights, with --per pixel at "
      "--size and --antialias");
  add_number(app, "--frames", "N", options.frames, {1, 100000, "frames"}, "of --benchmark")
      ->needs(benchmark);
  add_number(app, "--reference", "SPP", options.reference_samples, {0, 1 << 20, "samples a pixel"},
             "also renders the truth by Monte Carlo, writes it beside the output as "
             "FILE.reference.exr or .png and prints the relative L2 error (0: not)");
  add_number(app, "--seed", "N", options.seed, "of the reference's random numbers");
  add_file(app, "-o,--output", "FILE.exr", options.outputs.exr, "picture to write, linear", ".exr");
  add_file(app, "--png", "FILE.png", options.outputs.png, "picture to write, sRGB", ".png");
  add_file(app, "--compare", "FILE.png", options.compare,
           "writes picture and reference side by side", ".png");
}

}  // namespace

std::function<void()> declare_render(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_look_options(app, options->look);
  add_picture_options(app, *options);
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
