#include "frame_benchmark.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "common/interrupt.h"

namespace burnish::tools {
namespace {

struct FrameTimes {
  double prepare_ms = 0;  ///< the lights
  double shade_ms = 0;    ///< all vertices, or all pixels
  double trace_ms = 0;    ///< primary rays; 0 where vertices are shaded
};

FrameTimes draw(const FrameBenchmark& benchmark, const LookOptions& options, const SceneRays& rays,
                double angle_rad, Look& look) {
  FrameTimes times;
  const Stopwatch prepare;
  const Moment moment = turn_to(benchmark.turning, angle_rad, benchmark.view, options, look);
  times.prepare_ms = prepare.seconds() * 1e3;

  const Subject subject = look.subject();
  if (benchmark.per == ShadePer::vertex) {
    const Stopwatch shade;
    shade_all_vertices(subject, look.lighting(), moment.view.camera.origin, options.shading);
    times.shade_ms = shade.seconds() * 1e3;
    return times;
  }
  const PrimaryHits hits = trace_primary_rays(rays, moment.view);
  RenderTimings timings;
  render(subject, hits, look.lighting(), moment.background, benchmark.per, options.shading,
         &timings);
  times.shade_ms = timings.pixels_ms;
  times.trace_ms = hits.trace_ms;
  return times;
}

/// Median, minimum and 95th percentile.
nlohmann::ordered_json spread(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  const auto rank = [&](double share) {
    const double index = std::ceil(share * static_cast<double>(ms.size())) - 1;
    return ms[static_cast<size_t>(std::max(index, 0.0))];
  };
  return {{"median", rank(0.5)}, {"min", ms.front()}, {"percentile_95", rank(0.95)}};
}

std::string spread_line(const char* name, const nlohmann::ordered_json& ms) {
  return fmt::format("{:<9}{:>9.3f}{:>9.3f}{:>9.3f}", name, ms["median"].get<double>(),
                     ms["min"].get<double>(), ms["percentile_95"].get<double>());
}

}  // namespace

nlohmann::ordered_json benchmark_frames(const FrameBenchmark& benchmark, const LookOptions& options,
                                        Look& look, Work& work) {
  const SceneRays rays(look.transfer);
  std::vector<double> prepare, shade, total, trace;
  for (int frame = -1; frame < benchmark.frames; ++frame) {
    throw_if_interrupted();
    const double angle_rad = 2 * kPi<double> * frame / benchmark.frames;
    const FrameTimes times = draw(benchmark, options, rays, angle_rad, look);
    if (frame < 0) continue;
    prepare.push_back(times.prepare_ms);
    shade.push_back(times.shade_ms);
    total.push_back(times.prepare_ms + times.shade_ms);
    trace.push_back(times.trace_ms);
  }
  const bool pixels = benchmark.per == ShadePer::pixel;
  nlohmann::ordered_json report;
  report["frames"] = benchmark.frames;
  report["per"] = pixels ? "pixel" : "vertex";
  report["vertices"] = look.transfer.vertex_count();
  report["prepare_ms"] = spread(prepare);
  report["shade_ms"] = spread(shade);
  report["total_ms"] = spread(total);
  report["fps"] = 1e3 / report["total_ms"]["median"].get<double>();
  if (pixels) report["trace_ms"] = spread(trace);
  work.print(fmt::format("{} frames of {} vertices, shaded per {}\n{:<9}{:>9}{:>9}{:>9}",
                         benchmark.frames, look.transfer.vertex_count(),
                         pixels ? "pixel" : "vertex", "ms", "median", "min", "95 %"));
  for (const char* name : {"prepare", "shade", "total"})
    work.print(spread_line(name, report[std::string(name) + "_ms"]));
  if (pixels) work.print(spread_line("(trace)", report["trace_ms"]));
  work.print(fmt::format("{:.1f} frames/s", report["fps"].get<double>()));
  return report;
}

}  // namespace burnish::tools
