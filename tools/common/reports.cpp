#include "common/reports.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/work.h"

namespace burnish::tools {

namespace {

nlohmann::ordered_json errors_json(const std::vector<LobeError>& errors) {
  auto list = nlohmann::ordered_json::array();
  for (const LobeError& error : errors)
    list.push_back({{"bandwidth", error.bandwidth}, {"relative_rms", error.relative_rms}});
  return list;
}

std::string errors_text(const std::vector<LobeError>& errors) {
  std::string bandwidths, values;
  for (const LobeError& error : errors) {
    bandwidths += fmt::format("{}{:g}", bandwidths.empty() ? "" : "/", error.bandwidth);
    values += fmt::format("{}{:.2g}", values.empty() ? "" : "/", 100 * error.relative_rms);
  }
  return fmt::format("{} % at bandwidth {}", values, bandwidths);
}

}  // namespace

nlohmann::ordered_json bake_report(const Transfer& transfer, const BakeOptions& options,
                                   const BakeTimings& timings, std::uint64_t bytes) {
  const Provenance& made = transfer.provenance;
  nlohmann::ordered_json report;
  report["vertices"] = transfer.vertex_count();
  report["triangles"] = transfer.triangles.size();
  report["occluder_triangles"] = transfer.occluder_triangles.size();
  auto parts = nlohmann::ordered_json::array();
  for (const MeshPart& part : transfer.parts)
    parts.push_back({{"name", part.name}, {"vertices", part.vertices}});
  report["parts"] = std::move(parts);
  report["mesh_hash"] = made.mesh_hash;
  report["occluder_hash"] = made.occluder_hash;
  report["directions"] = options.directions;
  report["coarsest"] = made.coarsest;
  report["origin_offset"] = made.origin_offset;
  report["resolution"] = options.resolution;
  report["bases"] = transfer.bases.size();
  report["terms"] = transfer.terms();
  report["ladder_terms"] = transfer.ladder_terms();
  report["ladder_crossover"] = transfer.ladder_crossover;
  report["training_vertices"] = made.training_vertices;
  report["rays"] = made.rays;
  report["rays_cast"] = timings.rays_cast;
  report["vertices_resumed"] = timings.vertices_resumed;
  report["rays_per_thread_s"] =
      static_cast<double>(timings.rays_cast) / std::max(timings.rays_s, 1e-9);
  report["residual_vertices"] = made.residual_vertices;
  report["residual_held_out"] = made.residual_held_out;
  report["residual_rms_rad"] = made.residual_rms_rad;
  report["wrong_sign_fraction"] = made.wrong_sign_fraction;
  report["ssdf_errors"] = errors_json(made.ssdf_errors);
  report["ladder_errors"] = errors_json(made.ladder_errors);
  report["file_bytes"] = bytes;
  report["timings"] = {{"total_s", timings.total_s},      {"scene_s", timings.scene_s},
                       {"rays_thread_s", timings.rays_s}, {"distance_thread_s", timings.distance_s},
                       {"basis_s", timings.basis_s},      {"ladder_s", timings.ladder_s},
                       {"measure_s", timings.measure_s},  {"project_thread_s", timings.project_s}};
  return report;
}

std::string bake_summary(const Transfer& transfer, const BakeTimings& timings) {
  const Provenance& made = transfer.provenance;
  std::string text = fmt::format(
      "{} vertices, {} + {} terms, {} {}, baked in {:.1f} s ({} rays, {} a vertex)",
      transfer.vertex_count(), transfer.terms(), transfer.ladder_terms(), transfer.bases.size(),
      transfer.bases.size() == 1 ? "basis" : "bases", timings.total_s,
      count_text(static_cast<double>(made.rays)),
      count_text(static_cast<double>(made.rays) / static_cast<double>(transfer.vertex_count())));
  if (transfer.bases.empty()) return text + "\nnothing occludes but the horizon: no coefficients";
  text += fmt::format("\nresidual {:.2f} degrees rms, {:.2f} % of texels change sides ({} {})",
                      made.residual_rms_rad * 180 / kPi<double>, made.wrong_sign_fraction * 100,
                      made.residual_vertices,
                      made.residual_held_out ? "held-out vertices" : "training vertices");
  text += "\nerror of a lobe's visible share by compression: " + errors_text(made.ssdf_errors);
  if (!made.ladder_errors.empty()) text += "; ladder " + errors_text(made.ladder_errors);
  return text;
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
