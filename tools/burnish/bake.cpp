#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/mesh_assembly.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/buried_vertices.h"
#include "burnish/precompute/mesh_refinement.h"
#include "commands.h"
#include "common/interrupt.h"
#include "common/machine.h"
#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/program.h"
#include "common/reports.h"
#include "common/settings_option.h"
#include "common/work.h"

namespace burnish::tools {
namespace {

using Json = nlohmann::ordered_json;

/// Edges are not halved below this share of the scene's size, unless asked to.
constexpr double kMinEdgeShare = 1.0 / 1024;

struct Options {
  std::vector<std::string> meshes;
  std::vector<std::string> occluders;
  std::string output;
  MeshReadOptions reading;
  CLI::Option* up = nullptr;
  bool ground = false;
  float max_edge = 0;
  float refine_error = 0;
  float min_edge = 0;
  bool checks = true;
  BakeOptions bake;
  WriteTransferOptions writing;
  int verify = 0;
  bool resume = false, restart = false;
  CommonOptions common;

  std::string journal() const { return output + ".journal"; }
};

bool is_scene_file(const std::string& path) { return lower_extension(path) == ".json"; }

void add_mesh(SceneDescription& scene, const std::string& file, SceneRole role) {
  SceneMesh& mesh = scene.meshes.emplace_back();
  mesh.file = file;
  mesh.role = role;
}

SceneDescription describe_scene(const Options& options) {
  SceneDescription scene;
  if (is_scene_file(options.meshes.front())) {
    scene = read_scene(options.meshes.front());
  } else {
    scene.path = options.meshes.front();
    scene.up = options.reading.up;
    for (const std::string& file : options.meshes) add_mesh(scene, file, SceneRole::receiver);
  }
  for (const std::string& file : options.occluders) add_mesh(scene, file, SceneRole::occluder);
  if (options.ground && !scene.ground) scene.ground.emplace();
  return scene;
}

void check_usage(const Options& options) {
  check_bake_options(options.bake);
  if (options.meshes.size() > 1)
    for (const std::string& file : options.meshes)
      if (is_scene_file(file))
        throw UsageError(fmt::format("{}: a scene file is baked alone, found {} inputs", file,
                                     options.meshes.size()));
  if (is_scene_file(options.meshes.front()) && options.up->count() > 0)
    throw UsageError(fmt::format("--up: found beside {}, expected in the scene file, as \"up\"",
                                 options.meshes.front()));
  if (options.min_edge > 0 && options.refine_error == 0)
    throw UsageError("--min-edge: found without --refine-error, expected with it");
  if (options.resume && options.restart)
    throw UsageError("--resume and --restart contradict each other");
}

/// Reads the meshes; says what a user may want to know of them.
SceneMeshes load(const Options& options, Work& work) {
  return load_scene(describe_scene(options), options.reading,
                    [&](const SceneMesh& mesh, const MeshReport& report) {
                      throw_if_interrupted();
                      for (const std::string& note : report.notes)
                        work.print(fmt::format("{}: {}", mesh.file, note));
                    });
}

double size_of(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Vector3f& position : mesh.positions)
    if (position.allFinite()) box.extend(position);
  return box.isEmpty() ? 0 : double(box.sizes().maxCoeff());
}

void print_subdivision(const SubdivisionReport& done, const char* why, Work& work) {
  work.print(fmt::format("{}: {} vertices and {} triangles more, in {} rounds", why,
                         done.added_vertices, done.added_triangles, done.rounds));
}

/// Subdivides the receiver as asked.
void subdivide(const Options& options, SceneMeshes& scene, Work& work, Json& report) {
  if (options.max_edge > 0) {
    const SubdivisionReport done =
        subdivide_long_edges(scene.receiver, static_cast<double>(options.max_edge));
    print_subdivision(done, "long edges halved", work);
    report["max_edge"] = {{"added_vertices", done.added_vertices}};
  }
  if (options.refine_error > 0) {
    RefinementOptions refinement;
    refinement.max_difference = static_cast<double>(options.refine_error);
    refinement.min_edge = options.min_edge > 0 ? static_cast<double>(options.min_edge)
                                               : kMinEdgeShare * size_of(scene.receiver);
    refinement.origin_offset = options.bake.origin_offset;
    const RayScene rays = make_ray_scene(scene.receiver, scene.occluders);
    const RefinementReport done =
        refine_by_visibility(scene.receiver, rays, refinement, work.progress());
    print_subdivision(done, "edges halved where visibility changes", work);
    if (done.left > 0)
      work.print(fmt::format("{} edges still differ by more than {}: too short to halve{}",
                             done.left, options.refine_error,
                             done.out_of_vertices ? ", or no vertices left" : ""));
    report["refine_error"] = {
        {"added_vertices", done.added_vertices}, {"rays", done.rays}, {"left", done.left}};
  }
}

/// What is wrong with the mesh, as far as rays can tell.
void check_scene(const Options& options, const SceneMeshes& scene, const RayScene& rays, Work& work,
                 Json& report) {
  const BuriedVertices buried =
      find_buried_vertices(rays, scene.receiver, scene.occluders, options.bake.origin_offset);
  const auto tell = [&](const BuriedVertices::Kind& kind, const char* what) {
    if (kind.count > 0)
      work.print(
          fmt::format("{} vertices {} (the first: {})", kind.count, what, kind.first.front()));
  };
  tell(buried.covered,
       "lie just under another surface: a larger --origin-offset lifts their rays "
       "past it");
  tell(buried.pierced, "lie on a surface that faces them: their rays start behind it");
  tell(buried.inside, "lie inside other geometry: they see little or nothing");
  const DensityReport density = check_density(scene.receiver, rays, kDensityThreshold,
                                              options.bake.origin_offset, 5, work.progress());
  if (density.exceeding > 0)
    work.print(
        fmt::format("{} triangles ({:.1f} % of the area) have corners that see different "
                    "things: --refine-error subdivides them",
                    density.exceeding, 100 * density.exceeding_area));
  report["covered_vertices"] = buried.covered.count;
  report["pierced_vertices"] = buried.pierced.count;
  report["inside_vertices"] = buried.inside.count;
  report["uneven_triangles"] = density.exceeding;
  report["uneven_area"] = density.exceeding_area;
}

/// Whether there is something to resume. An unfinished bake is not thrown away unasked.
bool resumes(const Options& options, const BakeJournal& journal, Work& work) {
  if (journal.holds_work() && !options.resume && !options.restart)
    throw UsageError(
        fmt::format("{} holds an unfinished bake: --resume goes on with it, --restart "
                    "throws it away",
                    journal.path()));
  if (!journal.holds_work() && options.resume)
    work.print("nothing to resume: this bake starts at its beginning");
  return journal.holds_work() && options.resume;
}

Transfer bake_with_journal(const Options& options, const SceneMeshes& scene, const RayScene& rays,
                           BakeJournal& journal, bool resume, Work& work, BakeTimings& timings) {
  try {
    Transfer transfer = bake(scene.receiver, scene.occluders, options.bake,
                             {.progress = work.progress(),
                              .timings = &timings,
                              .journal = &journal,
                              .resume = resume,
                              .scene = &rays});
    throw_if_interrupted();
    return transfer;
  } catch (const Cancelled&) {
    throw Cancelled(fmt::format("interrupted; the same command with --resume{} goes on",
                                options.restart ? " instead of --restart" : ""));
  }
}

void verify(const Options& options, const SceneMeshes& scene, const RayScene& rays, Work& work,
            Json& report) {
  const VisibilityVerification found =
      verify_visibility(scene.receiver, scene.occluders, options.bake, options.verify, 1,
                        {.progress = work.progress(), .scene = &rays});
  const double share = static_cast<double>(found.differing) /
                       static_cast<double>(std::max<std::uint64_t>(found.directions, 1));
  work.print(
      fmt::format("all rays of {} vertices: {:.4f} % of directions differ, an SSDF by at "
                  "most {:.3f} rad (vertex {})",
                  found.vertices, 100 * share, found.worst_ssdf_error_rad, found.worst_vertex));
  report = {{"vertices", found.vertices},
            {"directions", found.directions},
            {"differing", found.differing},
            {"differing_fraction", share},
            {"worst_ssdf_error_rad", found.worst_ssdf_error_rad},
            {"worst_vertex", found.worst_vertex}};
}

/// Says when a target error was beyond what the terms and bases could do.
void tell_target(const BakeOptions& options, const Transfer& transfer, Work& work, Json& report) {
  if (options.target_error == 0 || transfer.bases.empty()) return;
  double found = 0;
  for (const LobeError& error : transfer.provenance.ssdf_errors)
    if (error.bandwidth == 128) found = error.relative_rms;
  const bool met = found <= options.target_error;
  report["target_error_met"] = met;
  if (!met)
    work.print(
        fmt::format("target error {} not met: {:.3g} at bandwidth 128 with all {} terms of {} "
                    "bases",
                    options.target_error, found, transfer.terms(), transfer.bases.size()));
}

void run(const Options& options) {
  check_usage(options);
  require_writable(std::vector{options.output, options.common.report});
  Work work(options.common);
  const Stopwatch watch;
  Json report = {
      {"inputs", options.meshes}, {"occluders", options.occluders}, {"output", options.output}};
  BakeJournal journal(options.journal());
  const bool resume = resumes(options, journal, work);
  SceneMeshes scene = load(options, work);
  subdivide(options, scene, work, report);
  const Stopwatch scene_watch;
  const RayScene rays = make_ray_scene(scene.receiver, scene.occluders);
  const double scene_s = scene_watch.seconds();
  if (options.checks) check_scene(options, scene, rays, work, report["checks"]);

  BakeTimings timings;
  const Transfer transfer = bake_with_journal(options, scene, rays, journal, resume, work, timings);
  timings.scene_s = scene_s;
  const Stopwatch write_watch;
  write_transfer(transfer, options.output, options.writing);
  const double write_s = write_watch.seconds();
  journal.remove();

  const std::uint64_t bytes = std::filesystem::file_size(options.output);
  report["bake"] = bake_report(transfer, options.bake, timings, bytes);
  report["bake"]["timings"]["write_s"] = write_s;
  work.print(bake_summary(transfer, timings));
  work.print(fmt::format("{}: {}", options.output, bytes_text(static_cast<double>(bytes))));
  tell_target(options.bake, transfer, work, report["bake"]);
  if (options.verify > 0) verify(options, scene, rays, work, report["verification"]);
  report["wall_clock_s"] = watch.seconds();
  report["peak_memory_bytes"] = peak_memory_bytes();
  report["machine"] = machine_record(work.threads());
  write_json(options.common.report, report);
}

}  // namespace

std::function<void()> declare_bake(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("MESH", options->meshes,
                 "meshes to bake: .obj, .ply, .off or .stl; or one .scene.json (required)")
      ->option_text("MESH...|SCENE.json")
      ->required();
  app.add_option("--occluders", options->occluders,
                 "a further mesh that casts shadows and is not baked; may be given more than once")
      ->option_text("MESH")
      ->allow_extra_args(false);
  app.add_flag("--ground", options->ground,
               "bake a ground plane below the meshes, too, as a part of its own");
  add_file(app, "-o,--output", "FILE.h5", options->output, "transfer file to write (required)",
           ".h5")
      ->required();
  add_settings_option(app, {{&SettingsFile::bake, "bake", [options](CLI::App& dials) {
                               add_bake_options(dials, options->bake);
                             }}});
  add_bake_options(app, options->bake);
  add_number(app, "--max-edge", "A", options->max_edge, {0, 1e30f, "world units"},
             "halve longer edges before the bake, 0 for none");
  add_number(app, "--refine-error", "A", options->refine_error, {0, 1},
             "halve edges whose ends see different things in more than this share of directions, 0 "
             "for none");
  add_number(app, "--min-edge", "A", options->min_edge, {0, 1e30f, "world units"},
             "the shortest that --refine-error makes, 0 for 1/1024 of the mesh");
  add_choice(app, "--checks", options->checks, {{"on", true}, {"off", false}},
             "look for vertices inside or on other geometry and for triangles that are too large");
  add_coefficient_option(app, options->writing);
  options->up = add_choice(
      app, "--up", options->reading.up, {{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}},
      "the meshes' upward axis, for the ground and for tangents of surfaces without UVs");
  add_number(app, "--verify", "N", options->verify, {0, 1 << 20},
             "cast all rays for this many vertices, too, and say what differs");
  app.add_flag("--resume", options->resume,
               "go on with the bake of this output that was interrupted");
  app.add_flag("--restart", options->restart, "throw away an unfinished bake of this output");
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
