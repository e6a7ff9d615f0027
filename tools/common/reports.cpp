#include "common/reports.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/work.h"

namespace burnish::tools {

nlohmann::ordered_json bake_report(const Transfer& transfer, const BakeOptions& options,
                                   const BakeTimings& timings, std::uint64_t bytes) {
  const Provenance& made = transfer.provenance;
  nlohmann::ordered_json report;
  report["vertices"] = transfer.vertex_count();
  report["triangles"] = transfer.triangles.size();
  report["occluder_triangles"] = transfer.occluder_triangles.size();
  report["directions"] = options.directions;
  report["resolution"] = options.resolution;
  report["terms"] = transfer.terms();
  report["training_vertices"] = made.training_vertices;
  report["rays"] = made.rays;
  report["rays_per_s"] = static_cast<double>(made.rays) / std::max(timings.total_s, 1e-9);
  report["residual_rms_rad"] = made.residual_rms_rad;
  report["wrong_sign_fraction"] = made.wrong_sign_fraction;
  report["file_bytes"] = bytes;
  report["timings"] = {{"total_s", timings.total_s},
                       {"rays_thread_s", timings.rays_s},
                       {"distance_thread_s", timings.distance_s},
                       {"pca_s", timings.pca_s},
                       {"project_thread_s", timings.project_s}};
  return report;
}

std::string bake_summary(const Transfer& transfer, const BakeTimings& timings) {
  const Provenance& made = transfer.provenance;
  const double seconds = std::max(timings.total_s, 1e-9);
  const auto rays = static_cast<double>(made.rays);
  return fmt::format(
      "{} vertices, {} terms, baked in {:.1f} s ({} rays, {} rays/s)\n"
      "residual {:.2f} degrees rms, {:.2f} % of texels change sides",
      transfer.vertex_count(), transfer.terms(), timings.total_s, count_text(rays),
      count_text(rays / seconds), made.residual_rms_rad * 180 / kPi<double>,
      made.wrong_sign_fraction * 100);
}

nlohmann::ordered_json frame_report(const PrimaryHits& hits, const RenderTimings& timings) {
  return {{"primary_rays_ms", hits.trace_ms},
          {"vertices_ms", timings.vertices_ms},
          {"pixels_ms", timings.pixels_ms}};
}

std::string frame_summary(const std::string& file, const PrimaryHits& hits,
                          const RenderTimings& timings) {
  return fmt::format("{}: {}x{}, vertices {:.1f} ms, pixels {:.1f} ms, primary rays {:.1f} ms",
                     file, hits.view.width, hits.view.height, timings.vertices_ms,
                     timings.pixels_ms, hits.trace_ms);
}

nlohmann::ordered_json error_report(const RelativeL2& error) {
  return {{"relative_l2", error.value},
          {"truth_noise", error.truth_noise},
          {"relative_l2_without_noise", error.without_noise},
          {"standard_error", error.standard_error},
          {"compared", error.count}};
}

std::string error_summary(const RelativeL2& error) {
  return fmt::format(
      "relative L2 error {:.2f} % (the truth's own noise {:.2f} %, without it {:.2f} %)",
      100 * error.value, 100 * error.truth_noise, 100 * error.without_noise);
}

}  // namespace burnish::tools
