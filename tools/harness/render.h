#pragma once

#include <string_view>

#include "burnish/shading/shade.h"
#include "harness/picture.h"
#include "harness/primary_hits.h"

namespace burnish {

/// Where the runtime shades.
enum class ShadePer {
  vertex,  ///< radiance at the vertices, interpolated
  pixel,   ///< coefficients, position and frame interpolated, radiance at each sample
};

/// Wall clock of a frame, apart from its primary rays (PrimaryHits::trace_ms).
struct RenderTimings {
  double vertices_ms = 0;  ///< shade_vertices over all vertices; 0 for ShadePer::pixel
  double pixels_ms = 0;    ///< interpolation, and shade_point for ShadePer::pixel
};

/// The picture of a transfer by the runtime, in parallel. `background` is seen where nothing is
/// hit; it is not a light here. Back sides are black and silhouettes lifted as in primary_hits.h.
Picture render(const Subject& subject, const PrimaryHits& hits, const Lighting& lighting,
               const EnvironmentLight& background, ShadePer per, const ShadingOptions& options,
               RenderTimings* timings = nullptr);

/// shade_vertices over all vertices, in parallel.
std::vector<Rgb> shade_all_vertices(const Subject& subject, const Lighting& lighting,
                                    const Vector3f& eye, const ShadingOptions& options);

}  // namespace burnish
