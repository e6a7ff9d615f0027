#pragma once

#include <cstdint>
#include <span>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/precompute/bake_journal.h"
#include "burnish/precompute/progress.h"
#include "burnish/precompute/ray_scene.h"
#include "burnish/shading/transfer.h"

namespace burnish {

/// Dials of a bake.
struct BakeOptions {
  int directions = 512;  ///< visibility on directions^2 octahedral texels, 64..1024, a power of two
  /// Rays go into coarsest^2 directions first and into finer ones where visibility changes: what is
  /// smaller than a coarsest texel may be missed. 16..1024, a power of two; from `directions` up
  /// every ray is cast.
  int coarsest = 64;
  /// Rays leave a vertex this far along its normal, in world units; 0: RayScene::origin_offset().
  double origin_offset = 0;
  int resolution = 128;  ///< SSDF texels along an edge, 16..directions, a power of two
  int terms =
      48;  ///< PCA terms, 1..1024 and resolution^2 (clamped to what the training set can give)
  /// The SSDF is compressed as tanh(distance / amplitude), which spends terms on boundaries; 0: as
  /// it is.
  double amplitude_rad = 0.6;
  int bases = 8;  ///< PCA bases, 1..256, each vertex in one of them; 0: chosen by held-out error
  /// If above 0: the fewest terms, up to `terms`, are taken whose error at bandwidth 128
  /// (Provenance::ssdf_errors) is at most this; all of them where none is enough.
  double target_error = 0;
  int ladder_terms = 48;  ///< of the visibility ladder, 0..1024; 0: none, as in wang2009svbrdf
  /// The bases are trained on this many vertices, spread over the mesh; 0: on all. Their SSDFs are
  /// held in memory at once: 4 training_vertices resolution^2 bytes.
  int training_vertices = 8192;
  int residual_vertices = 256;  ///< held out of the training to measure errors on, 1..4096
};

/// Where the time went, and what else differs from run to run: not part of the transfer.
struct BakeTimings {
  double scene_s = 0;           ///< wall clock: building the ray scene
  double rays_s = 0;            ///< summed over threads
  double distance_s = 0;        ///< summed over threads
  double basis_s = 0;           ///< wall clock: training of the SSDF's bases
  double ladder_s = 0;          ///< wall clock: training of the ladder
  double measure_s = 0;         ///< wall clock: the errors
  double project_s = 0;         ///< summed over threads
  double total_s = 0;           ///< wall clock
  std::uint64_t rays_cast = 0;  ///< in this run; a resumed one casts fewer than the bake needs
  std::uint64_t vertices_resumed = 0;  ///< whose coefficients were in the journal
};

/// How a bake is run: changes nothing of its result.
struct BakeRun {
  /// Hears of the stages "horizon" (in blocks of vertices; ends with the first that is not empty),
  /// "train" and "measure" (in vertices), "basis" (in steps) and "bake" (in vertices).
  Progress progress = {};
  BakeTimings* timings = nullptr;
  /// Takes note of what is finished; `resume` goes on from what it holds, to the same bytes. The
  /// caller removes it once the transfer is safe.
  BakeJournal* journal = nullptr;
  bool resume = false;
  /// make_ray_scene() of the same meshes, if there is one already.
  const RayScene* scene = nullptr;
};

/// The receiver as mesh 0 and the occluders as the meshes that follow, ready for rays.
RayScene make_ray_scene(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders);

/// Bakes the visibility of every vertex of `receiver`, shadowed by itself and by the occluders:
/// rays on the upper hemisphere of its normal, an SSDF and a visibility ladder, and their
/// coefficients in PCA bases. Same input, same bytes, at any number of threads. Memory beyond the
/// scene and the transfer: the training set, and some 5 resolution^2 bytes more for each of the
/// residual vertices.
///
/// - A vertex whose position or normal is not finite, or whose normal is zero, sees nothing that
///   could be shaded: its coefficients are 0 (the mean), and it counts neither for the bases nor
///   for the errors; the transfer has a position of 0 and a normal along y in place of what is not
///   usable. A normal of another length is taken as a direction.
/// - Where nothing but its own horizon occludes any vertex, the transfer has no bases.
///
/// Throws Error for options out of range, arrays that do not match, an index out of range, a
/// receiver without triangles or usable vertices, or a journal that cannot be used; Cancelled when
/// `progress` asked to stop, after what was under way is in the journal.
Transfer bake(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
              const BakeOptions& options, const BakeRun& run = {});

/// How coarse-to-fine sampling compares with casting every ray.
struct VisibilityVerification {
  std::uint64_t vertices = 0;
  std::uint64_t directions = 0;  ///< compared in all
  std::uint64_t differing = 0;   ///< of them
  double worst_ssdf_error_rad = 0;
  std::uint32_t worst_vertex = 0;
};

/// Compares them on `count` usable vertices (or all, if there are fewer), chosen by `seed`.
/// `progress` hears of the stage "verify", in vertices. Throws as bake() does.
VisibilityVerification verify_visibility(const TriangleMesh& receiver,
                                         std::span<const TriangleMesh> occluders,
                                         const BakeOptions& options, int count, std::uint64_t seed,
                                         const BakeRun& run = {});

}  // namespace burnish
