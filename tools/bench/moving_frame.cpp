#include "moving_frame.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "burnish/shading/shade_varying.h"
#include "burnish/sphere/batch.h"
#include "common/interrupt.h"

namespace burnish::tools {
namespace {

/// By which the eye and the lights turn from frame to frame.
constexpr float kEyeStep_rad = 0.02f, kLightStep_rad = 0.03f;

constexpr size_t kGrain = 512;

void shade_range(MovingFrame& frame, const Lighting& lighting, const Vector3f& eye, size_t first,
                 size_t count) {
  const std::span<Rgb> radiance = std::span(frame.radiance).subspan(first, count);
  if (frame.varying)
    shade_vertices(*frame.transfer, lighting, frame.materials[0], variation_of(*frame.varying), eye,
                   frame.options, first, radiance);
  else
    shade_vertices(*frame.transfer, lighting, frame.prepared_materials, frame.material_id, eye,
                   frame.options, first, radiance);
}

}  // namespace

FrameTime draw_frame(MovingFrame& frame, int index) {
  if (frame.prepared_materials.empty())
    frame.prepared_materials = prepare_materials(frame.materials, frame.options);
  frame.radiance.resize(frame.transfer->vertex_count());
  const auto step = static_cast<float>(index);
  const Eigen::AngleAxisf eye_turn(kEyeStep_rad * step, Vector3f::UnitY());
  const Vector3f& target = frame.camera.target;
  const Vector3f eye = target + eye_turn * (frame.camera.origin - target);
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(kLightStep_rad * step, Vector3f::UnitY()).toRotationMatrix();

  FrameTime time;
  const Stopwatch prepare;
  LightRig rig = frame.rig;
  rotate(rig, turn);
  begin_lights(rig, *frame.transfer, frame.options, frame.lights);
  tbb::parallel_for(size_t{0}, frame.transfer->bases.size(), [&](size_t basis) {
    finish_lights(*frame.transfer, frame.options, basis, frame.lights);
  });
  if (frame.environment) frame.environment->environment_from_world = turn.transpose();
  time.prepare_s = prepare.seconds();
  const Stopwatch shade;
  const Lighting lighting = {&frame.lights, frame.environment};
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, frame.radiance.size(), kGrain),
      [&](const auto& range) { shade_range(frame, lighting, eye, range.begin(), range.size()); });
  time.shade_s = shade.seconds();
  return time;
}

std::vector<FrameTiming> measure_frames(std::span<MovingFrame> frames,
                                        const BenchOptions& options) {
  std::vector<std::vector<double>> prepare(frames.size()), shade(frames.size()),
      whole(frames.size());
  for (int run = 0; run < options.warmup + options.repeat; ++run)
    for (size_t i = 0; i < frames.size(); ++i) {
      throw_if_interrupted();
      batch::use_instruction_set(frames[i].instruction_set);
      draw_frame(frames[i], 2 * run);
      const FrameTime time = draw_frame(frames[i], 2 * run + 1);
      if (run < options.warmup) continue;
      prepare[i].push_back(time.prepare_s);
      shade[i].push_back(time.shade_s);
      whole[i].push_back(time.prepare_s + time.shade_s);
    }
  batch::use_instruction_set("");
  std::vector<FrameTiming> timings;
  for (size_t i = 0; i < frames.size(); ++i)
    timings.push_back({summarise(prepare[i]), summarise(shade[i]), summarise(whole[i])});
  return timings;
}

BenchRow frame_row(const std::string& what, const MovingFrame& frame, const FrameTiming& timing,
                   const BenchOptions& options) {
  BenchRow row = {{"what", what}, {"row", frame.name}};
  const auto vertices = static_cast<double>(frame.transfer->vertex_count());
  row["vertices"] = frame.transfer->vertex_count();
  row["terms"] = frame.transfer->terms;
  row["lobes"] = frame.lights.lobes.size();
  row["prepare_ms"] = timing.prepare.median_s * 1e3;
  row["shade_ms"] = timing.shade.median_s * 1e3;
  add_timing(row, timing.frame, options);
  row["fps"] = 1 / timing.frame.median_s;
  row["ns_per_vertex"] = timing.shade.median_s * 1e9 / vertices;
  return row;
}

}  // namespace burnish::tools
