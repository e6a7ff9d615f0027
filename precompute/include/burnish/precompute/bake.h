#pragma once

#include <cstdint>
#include <span>

#include "burnish/formats/triangle_mesh.h"
#include "burnish/precompute/progress.h"
#include "burnish/shading/transfer.h"

namespace burnish {

/// Dials of a bake.
struct BakeOptions {
  int directions = 512;  ///< visibility on directions^2 octahedral texels, 64..1024, a power of two
  int resolution = 128;  ///< SSDF texels along an edge, 16..directions, a power of two
  int terms = 48;        ///< PCA terms, 1..resolution^2 (clamped to what the training set can give)
  /// The basis is trained on this many vertices, evenly spread; 0: on all. Their SSDFs are held in
  /// memory at once: 4 training_vertices resolution^2 bytes.
  int training_vertices = 8192;
};

/// Where the time went. Not part of the transfer: differs from run to run.
struct BakeTimings {
  double rays_s = 0;      ///< summed over threads
  double distance_s = 0;  ///< summed over threads
  double pca_s = 0;       ///< wall clock
  double project_s = 0;   ///< summed over threads
  double total_s = 0;     ///< wall clock
};

/// Bakes the visibility of every vertex of `receiver`, shadowed by itself and by the occluders:
/// rays on the upper hemisphere of its normal, an SSDF, and its coefficients in a PCA basis. Same
/// input, same bytes, at any number of threads.
///
/// A vertex whose position or normal is not finite, or whose normal is zero, sees nothing that
/// could be shaded: its coefficients are 0 (the mean SSDF), and it counts neither for the basis nor
/// for the residual. A normal of another length is taken as a direction.
///
/// `progress` hears of the stages "train" (in vertices), "basis" (in
/// passes over their SSDFs) and "bake" (in vertices that were not trained on).
/// Throws Error for options out of range, arrays that do not match, an index out of range or a
/// receiver without triangles or usable vertices; Cancelled when `progress` asked to stop.
Transfer bake(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
              const BakeOptions& options, const Progress& progress = {},
              BakeTimings* timings = nullptr);

}  // namespace burnish
