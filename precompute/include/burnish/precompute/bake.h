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
  int training_vertices =
      8192;  ///< the basis is trained on this many vertices, evenly spread; 0: on all
};

/// Where the time went. Not part of the transfer: differs from run to run.
struct BakeTimings {
  double rays_s = 0;      ///< summed over threads
  double distance_s = 0;  ///< summed over threads
  double pca_s = 0;       ///< wall clock
  double project_s = 0;   ///< summed over threads
  double total_s = 0;     ///< wall clock
};

/// Bakes the visibility of every vertex of `receiver`, shadowed by itself and by the occluders.
/// Same input, same bytes, at any number of threads. Throws Error for options out of range or a
/// mesh without triangles, Cancelled when `progress` asked to stop.
Transfer bake(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
              const BakeOptions& options, const Progress& progress = {},
              BakeTimings* timings = nullptr);

}  // namespace burnish
