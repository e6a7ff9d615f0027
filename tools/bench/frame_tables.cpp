#include <algorithm>

#include "burnish/sphere/batch.h"
#include "common/interrupt.h"
#include "common/reports.h"
#include "frame_bound.h"
#include "harness/reference_integrator.h"
#include "shade_tables.h"

namespace burnish::tools {
namespace {

std::vector<BenchRow> rows_of(const char* what, std::vector<MovingFrame>& frames,
                              const BenchOptions& options) {
  const std::vector<FrameTiming> timings = measure_frames(frames, options);
  std::vector<BenchRow> rows;
  for (size_t i = 0; i < frames.size(); ++i)
    rows.push_back(frame_row(what, frames[i], timings[i], options));
  return rows;
}

/// All qualities, each with highlights of the lobes and of the map.
std::vector<MovingFrame> all_frames(ShadeScene& scene) {
  std::vector<MovingFrame> frames;
  for (const NamedOptions& options : all_options())
    for (const bool from_map : {false, true})
      frames.push_back(scene_frame(scene, options, from_map));
  return frames;
}

NamedOptions balanced() { return {"balanced", shading_options(Quality::balanced)}; }

// Multiply-adds of what is not a sum over terms, counted from the formulas to the nearest ten: a
// root, a division or an exponential is ten.
constexpr double kVertexSums = 100;   ///< frame, view and what is stored
constexpr double kLobeSums = 60;      ///< visible fraction and cosine of a narrow light lobe
constexpr double kPeakSums = 60;      ///< a highlight's lobe by SpecularForm::peak
constexpr double kMomentsSums = 200;  ///< ... by moments, from six half vectors or more
constexpr double kLookupSums = 60;    ///< of the filtered map: 9 coefficients, 3 channels, 2 levels
constexpr double kProductSums = 60;   ///< a highlight's lobe times a light's, integrated
constexpr double kLocalLightSums = 100;  ///< a local light as a lobe

double multiply_adds_per_vertex(const MovingFrame& frame) {
  const double terms = frame.transfer->terms;
  const PreparedLights& lights = frame.lights;
  const auto narrow = static_cast<double>(lights.narrow.size());
  const double teeth = frame.prepared_materials[0].count;
  const auto local = static_cast<double>(lights.directionals.size() + lights.spheres.size() +
                                         lights.rectangles.size());
  double sums = kVertexSums;
  if (frame.materials[0].diffuse.maxCoeff() > 0) {
    sums += narrow * (3 * terms + kLobeSums);
    if (!lights.tables.empty()) sums += 9.0 * frame.transfer->ladder_terms;
  }
  const bool peak = frame.options.specular.form == SpecularForm::peak;
  double tooth = 4 * terms + (peak ? kPeakSums : kMomentsSums) + local * kProductSums;
  tooth += frame.environment ? frame.options.environment_taps * kLookupSums
                             : static_cast<double>(lights.lobes.size()) * kProductSums;
  return sums + teeth * tooth + local * (4 * terms + kLocalLightSums);
}

double floats_in_bytes(size_t count) { return static_cast<double>(count * sizeof(float)); }

/// All that a frame reads or writes, once; without the filtered map.
double frame_bytes(const MovingFrame& frame) {
  const PreparedTransfer& transfer = *frame.transfer;
  const size_t each = transfer.bytes_per_vertex() + sizeof(Rgb);
  double bytes = static_cast<double>(transfer.vertex_count() * each + frame.material_id.size());
  for (const PreparedTransfer::Basis& basis : transfer.bases)
    bytes += floats_in_bytes(basis.mean.size() + basis.eigen32.size()) +
             2 * static_cast<double>(basis.eigen16.size());
  for (const IrradianceTable& table : frame.lights.tables)
    bytes += floats_in_bytes(table.means.size() + table.entries.size());
  for (const LobeBoundaries& boundary : frame.lights.boundaries)
    bytes += floats_in_bytes(boundary.mean.size() + boundary.rows.size());
  return bytes;
}

void add_bound(const MovingFrame& frame, const MachineLimits& limits, BenchRow& row) {
  const double bytes = frame_bytes(frame);
  const double sums =
      multiply_adds_per_vertex(frame) * static_cast<double>(frame.transfer->vertex_count());
  const double bytes_ms = bytes / limits.copy_bytes_per_s * 1e3;
  const double sums_ms = sums / limits.multiply_adds_per_s * 1e3;
  const double bound_ms = std::max(bytes_ms, sums_ms);
  row["megabytes"] = bytes / 1e6;
  row["million_multiply_adds"] = sums / 1e6;
  row["bytes_ms"] = bytes_ms;
  row["multiply_adds_ms"] = sums_ms;
  row["bound_ms"] = bound_ms;
  row["over_bound"] = row["median_ms"].get<double>() / bound_ms;
  row["copy_gb_per_s"] = limits.copy_bytes_per_s / 1e9;
  row["peak_gmadd_per_s"] = limits.multiply_adds_per_s / 1e9;
}

/// The balanced frame with one part left out each.
std::vector<MovingFrame> parts(ShadeScene& scene) {
  std::vector<MovingFrame> frames(5, scene_frame(scene, balanced(), true));
  frames[0].name = "whole";
  frames[1].name = "diffuse only";
  frames[1].materials[0].model = SpecularModel::none;
  frames[2].name = "specular only";
  frames[2].materials[0].diffuse = Rgb::Zero();
  frames[3].name = "no lights, map only";
  frames[3].rig = {};
  frames[4].name = "no map, no lights";
  frames[4].rig = {};
  frames[4].environment = nullptr;
  return frames;
}

PreparedTransfer unoccluded(const PreparedTransfer& transfer) {
  PreparedTransfer result;
  result.positions = transfer.positions;
  result.normals = transfer.normals;
  result.tangents = transfer.tangents;
  return result;
}

/// Bytes of the arrays that have an entry or more for each vertex.
size_t held_bytes(const PreparedTransfer& transfer) {
  return sizeof(Vector3f) *
             (transfer.positions.size() + transfer.normals.size() + transfer.tangents.size()) +
         transfer.basis_id.size() + sizeof(std::uint16_t) * transfer.rows16.size() +
         sizeof(float) * transfer.rows32.size();
}

}  // namespace

std::vector<BenchRow> frame_table(const ShadeBench& bench) {
  ShadeScene& scene = bench.scene;
  std::vector<MovingFrame> frames = all_frames(scene);
  std::vector<BenchRow> rows = rows_of("frame", frames, bench.options);
  const int samples = bench.subject.reference_samples;
  if (samples == 0) return rows;
  const Subject subject = {&scene.transfer, frames[0].materials, {}, nullptr, &scene.prepared};
  const SceneRays rays(scene.transfer);
  const VertexReference truth = shade_reference_vertices(
      subject, rays, scene.camera.origin, {{&scene.studio}, {}},
      {.samples = samples, .seed = bench.subject.seed}, bench.work.progress());
  for (size_t i = 0; i < frames.size(); ++i) {
    draw_frame(frames[i], 0);
    rows[i].update(error_report(relative_l2(frames[i].radiance, truth.radiance, truth.variance)));
  }
  return rows;
}

std::vector<BenchRow> bound_table(const ShadeBench& bench) {
  std::vector<MovingFrame> frames = all_frames(bench.scene);
  // Before and after: a neighbour on the machine may have been busy at one of the times.
  MachineLimits limits = measure_limits();
  std::vector<BenchRow> rows = rows_of("bound", frames, bench.options);
  const MachineLimits after = measure_limits();
  limits.copy_bytes_per_s = std::max(limits.copy_bytes_per_s, after.copy_bytes_per_s);
  limits.multiply_adds_per_s = std::max(limits.multiply_adds_per_s, after.multiply_adds_per_s);
  for (size_t i = 0; i < frames.size(); ++i) add_bound(frames[i], limits, rows[i]);
  std::vector<MovingFrame> without = parts(bench.scene);
  const std::vector<BenchRow> rest = rows_of("parts", without, bench.options);
  rows.insert(rows.end(), rest.begin(), rest.end());
  return rows;
}

std::vector<BenchRow> targets_table(const ShadeBench& bench) {
  std::vector<MovingFrame> frames;
  for (const Quality quality : {Quality::fast, Quality::balanced})
    for (const std::string_view set : batch::instruction_sets()) {
      const char* name = quality == Quality::fast ? "fast" : "balanced";
      frames.push_back(scene_frame(bench.scene, {name, shading_options(quality)}, true));
      frames.back().instruction_set = set;
    }
  std::vector<BenchRow> rows = rows_of("targets", frames, bench.options);
  for (size_t i = 0; i < rows.size(); ++i) {
    rows[i]["instruction_set"] = std::string(frames[i].instruction_set);
    if (i + 1 == rows.size() || rows[i + 1]["row"] != rows[i]["row"]) continue;
    rows[i]["over_the_next"] =
        rows[i + 1]["median_ms"].get<double>() / rows[i]["median_ms"].get<double>();
  }
  return rows;
}

std::vector<BenchRow> short_table(const ShadeBench& bench) {
  const PreparedTransfer open = unoccluded(bench.scene.prepared);
  std::vector<MovingFrame> frames(6, scene_frame(bench.scene, balanced(), true));
  frames[0].name = "whole";
  frames[1].name = "unoccluded";
  frames[1].transfer = &open;
  frames[2].name = "diffuse material";
  frames[2].materials[0].model = SpecularModel::none;
  frames[3].name = "zero lights";
  frames[3].rig = {};
  frames[4].name = "isotropic lobe";
  frames[4].materials[0].alpha_x = frames[4].materials[0].alpha_y = 0.16f;
  frames[5].name = "no ladder";
  frames[5].options.ladder = false;
  return rows_of("short", frames, bench.options);
}

std::vector<BenchRow> memory_table(const ShadeBench& bench) {
  Transfer without = bench.scene.transfer;
  without.ladder_bases.clear();
  without.ladder_coefficients.clear();
  without.ladder_crossover = 0;
  std::vector<BenchRow> rows;
  for (const Transfer* transfer : {&without, &bench.scene.transfer})
    for (const RowFormat format : {RowFormat::float16, RowFormat::float32}) {
      throw_if_interrupted();
      const PreparedTransfer prepared = prepare_transfer(*transfer, format);
      BenchRow row = {{"what", "memory"}};
      row["row"] = format == RowFormat::float16 ? "float16" : "float32";
      row["vertices"] = prepared.vertex_count();
      row["terms"] = prepared.terms;
      row["ladder_terms"] = prepared.ladder_terms;
      row["bytes_per_vertex"] = prepared.bytes_per_vertex();
      row["held_per_vertex"] =
          static_cast<double>(held_bytes(prepared)) / static_cast<double>(prepared.vertex_count());
      rows.push_back(std::move(row));
    }
  return rows;
}

}  // namespace burnish::tools
