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
#include "frame_output.h"
#include "harness/error_metrics.h"
#include "harness/reference_integrator.h"
#include "look_options.h"
#include "turning.h"

namespace burnish::tools {
namespace {

/// Primary rays of a picture at most: 3 GB of hits.
constexpr std::int64_t kMaxSamples = std::int64_t{1} << 28;
constexpr int kBenchmarkFrames = 100;

struct Options {
  LookOptions look;
  int width = 720;
  int height = 480;
  int antialias = 2;
  ShadePer per = ShadePer::vertex;
  float exposure_stops = 0;
  int frames = 0;  ///< of a turn; 0: one picture, or kBenchmarkFrames
  Turning turning = Turning::both;
  bool benchmark = false;
  int reference_samples = 0;
  std::uint64_t seed = 1;
  std::string output;  ///< of any kind
  std::string png;     ///< beside or in place of it
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

std::vector<std::string> outputs(const Options& options) {
  std::vector<std::string> names;
  for (const std::string& name : {options.output, options.png})
    if (!name.empty()) names.push_back(name);
  return names;
}

/// A benchmark writes no picture.
void check_benchmark(const Options& options) {
  if (!outputs(options).empty())
    throw UsageError("--benchmark: found an output, expected none: nothing is written");
  if (options.reference_samples > 0 || !options.compare.empty())
    throw UsageError(
        "--benchmark: found --reference or --compare with it, expected neither of them");
}

void check_outputs(const Options& options) {
  if (outputs(options).empty())
    throw UsageError("no output given, expected -o FILE, --png FILE.png or both");
  if (is_animation(options.output) && options.frames == 0)
    throw UsageError(fmt::format("{}: found no --frames, expected --frames N with a .gif or .mp4",
                                 options.output));
  if (options.frames > 0 && options.reference_samples > 0)
    throw UsageError("--frames and --reference: found both, expected one of them");
}

/// All files that are written.
std::vector<std::string> all_files(const Options& options) {
  std::vector<std::string> files = {options.common.report, options.compare};
  for (const std::string& name : outputs(options)) {
    if (options.frames == 0 || is_animation(name)) files.push_back(name);
    if (options.reference_samples > 0) files.push_back(with_infix(name, "reference"));
    if (is_animation(name)) continue;
    for (int frame = 0; frame < options.frames; ++frame) files.push_back(numbered(name, frame));
  }
  return files;
}

void check(const Options& options) {
  if (options.benchmark)
    check_benchmark(options);
  else
    check_outputs(options);
  if (!options.compare.empty() && options.reference_samples == 0)
    throw UsageError("--compare: found no reference to compare with, expected --reference SPP");
  const std::int64_t samples =
      std::int64_t{options.width} * options.height * options.antialias * options.antialias;
  if (samples > kMaxSamples)
    throw UsageError(fmt::format("--size and --antialias: found {} samples, expected at most {}",
                                 samples, kMaxSamples));
  require_writable(all_files(options));
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
  throw_if_interrupted();
  for (const std::string& name : outputs(options))
    write_picture(truth.radiance, with_infix(name, "reference"), options.exposure_stops);
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

/// Draws one picture, reports and prints its times.
Picture draw(const Options& options, const Look& look, const PrimaryHits& hits,
             const EnvironmentLight& background, const std::string& name, Work& work,
             nlohmann::ordered_json& report) {
  throw_if_interrupted();
  RenderTimings timings;
  Picture picture = render(look.subject(), hits, look.lighting(), background, options.per,
                           options.look.shading, &timings);
  throw_if_interrupted();
  report["frames"].push_back(frame_report(hits, timings));
  work.print(frame_summary(name, hits, timings));
  return picture;
}

nlohmann::ordered_json render_still(const Options& options, const Look& look, const View& view,
                                    Work& work) {
  nlohmann::ordered_json report;
  const SceneRays rays(look.transfer);
  const PrimaryHits hits = trace_primary_rays(rays, view);
  const std::vector<std::string> names = outputs(options);
  const Picture picture =
      draw(options, look, hits, look.environment_light(), names[0], work, report);
  for (const std::string& name : names)
    write_picture(picture.radiance, name, options.exposure_stops);
  if (options.reference_samples > 0)
    report["reference"] = render_truth(options, look, look.subject(), rays, hits, picture, work);
  return report;
}

using FrameOutputs = std::vector<std::unique_ptr<FrameOutput>>;

FrameOutputs open_outputs(const Options& options) {
  FrameOutputs files;
  if (options.frames == 0 || options.benchmark) return files;
  for (const std::string& name : outputs(options))
    files.push_back(open_frames(name, options.width, options.height, options.exposure_stops));
  return files;
}

nlohmann::ordered_json render_frames(const Options& options, const View& still,
                                     const FrameOutputs& files, Look& look, Work& work) {
  nlohmann::ordered_json report;
  const SceneRays rays(look.transfer);
  const std::string name = outputs(options)[0];
  for (int frame = 0; frame < options.frames; ++frame) {
    const double angle_rad = 2 * kPi<double> * frame / options.frames;
    const Moment moment = turn_to(options.turning, angle_rad, still, options.look, look);
    const PrimaryHits hits = trace_primary_rays(rays, moment.view);
    const std::string frame_name =
        is_animation(name) ? fmt::format("{}, frame {}", name, frame) : numbered(name, frame);
    const Picture picture = draw(options, look, hits, moment.background, frame_name, work, report);
    for (const auto& file : files) file->add(picture.radiance);
    if (!work.progress()("frames", frame + 1, options.frames)) throw Cancelled();
  }
  for (const auto& file : files) file->commit();
  return report;
}

void run(const Options& options) {
  check(options);
  Work work(options.common);
  const FrameOutputs files = open_outputs(options);  // first: a program may be missing
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
  const View view = {camera, options.width, options.height, options.antialias};
  if (options.benchmark)
    report["benchmark"] = benchmark_frames({options.frames == 0 ? kBenchmarkFrames : options.frames,
                                            view, options.per, options.turning},
                                           options.look, look, work);
  else if (options.frames > 0)
    report.update(render_frames(options, view, files, look, work));
  else
    report.update(render_still(options, look, view, work));
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
  CLI::Option* frames = add_number(
      app, "--frames", "N", options.frames, {0, 10000, "frames"},
      fmt::format(
          "writes one turn about the upward axis as FILE-0000.png and so on, or as one .gif "
          "or .mp4 of {} frames a second (0: one picture; of --benchmark {})",
          kFramesPerSecond, kBenchmarkFrames));
  add_choice(app, "--turn", options.turning,
             {{"eye", Turning::eye}, {"light", Turning::light}, {"both", Turning::both}},
             "what turns: the eye, the environment and distant lights, or both, as an object on a "
             "turntable")
      ->needs(frames);
  app.add_flag("--benchmark", options.benchmark,
               "writes no picture: times the frames, with --per pixel at --size and --antialias");
  add_number(app, "--reference", "SPP", options.reference_samples, {0, 1 << 20, "samples a pixel"},
             "also renders the truth by Monte Carlo, writes it beside the output as "
             "FILE.reference.exr or .png and prints the relative L2 error (0: not)");
  add_number(app, "--seed", "N", options.seed, "of the reference's random numbers");
  add_parsed(
      app, "-o,--output", "FILE",
      "picture to write, linear .exr or sRGB .png; .gif and .mp4 for --frames, by the program "
      "ffmpeg",
      "a file name that ends in .exr, .png, .gif or .mp4", [&options](const std::string& found) {
        options.output = found;
        return lower_extension(found) == ".exr" || lower_extension(found) == ".png" ||
               is_animation(found);
      });
  add_file(app, "--png", "FILE.png", options.png, "picture to write, sRGB", ".png");
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
