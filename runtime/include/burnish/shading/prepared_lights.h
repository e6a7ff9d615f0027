#pragma once

#include <vector>

#include "burnish/light/light_rig.h"
#include "burnish/light/prefiltered_environment.h"
#include "burnish/shading/prepared_transfer.h"
#include "burnish/shading/shading_options.h"
#include "burnish/sphere/lobe_moments.h"

namespace burnish {

/// A lobe of light with what shading needs of its shape.
struct PreparedLobe {
  AnisotropicGaussian<float> lobe;  ///< unit amplitude
  Rgb color = Rgb::Zero();          ///< radiance at the axis
  float integral = 0;               ///< of the unit-amplitude lobe
  LobeMoments<float> moments;       ///< of the normalised lobe, in its own frame
  /// How much of its diffuse light comes through the ladder's table, 0..1; the rest comes through
  /// the SSDF.
  float ladder_share = 0;
};

/// The irradiance of all wide lobes together, seen through the ladder, as a function of the normal
/// and of a vertex's ladder coefficients, in which it is linear (docs/maths.md, "Irradiance
/// table").
struct IrradianceTable {
  /// Normals are the corners of the cells of an octahedron's faces, unfolded to a square: a normal
  /// between them is in a triangle that does not reach over an edge. (Across the edges the
  /// equal-area map of the SSDFs has a crease, of which an interpolation is off by 4 %.)
  static constexpr int kCells = 32;  ///< along an edge of the square, even
  static constexpr int kCorners = kCells + 1;
  /// By channel: what comes through the ladder's mean, and what the ladder of a bare horizon lacks;
  /// the irradiance without shadow.
  enum { kMean = 0, kUnshadowed = 4, kMeans = 8 };

  int terms = 0;
  bool is_positive = true;     ///< of no light of negative colour
  std::vector<float> means;    ///< [kCorners^2][kMeans]
  std::vector<float> entries;  ///< through the eigenvectors: [kCorners^2][3][padded_terms(terms)]
  size_t entry_size() const { return 3 * padded_terms(terms); }
};

/// The lobes' boundaries as a matrix product: SSDF and gradient at their axes are rows * a vertex's
/// coefficients + mean.
struct LobeBoundaries {
  std::vector<float> mean;  ///< [lobes][3]: value, and derivatives along the lobe's x and y
  std::vector<float> rows;  ///< [terms][boundary_columns(lobes)]
};

/// Three for each lobe, up to whole pairs of vectors.
inline size_t boundary_columns(size_t lobes) { return (3 * lobes + 31) / 32 * 32 + 16; }

/// Lights ready to shade the points of one transfer: prepared once per change of the lights, of
/// their rotation too, but not of the view. Refers to neither rig nor transfer. Immutable while
/// shading, and may be shared between threads.
struct PreparedLights {
  std::vector<PreparedLobe> lobes;
  std::vector<int> narrow;  ///< lobes of ladder_share < 1: those of `boundaries`
  std::vector<DirectionalLight> directionals;
  std::vector<SphereLight> spheres;
  std::vector<RectangleLight> rectangles;
  std::vector<LobeBoundaries> boundaries;  ///< one for each basis
  std::vector<IrradianceTable> tables;     ///< one for each ladder; none without wide lobes
  std::vector<float> scratch;              ///< of preparing; shading does not read it
};

/// Whether there is no light but an environment's map.
inline bool is_dark(const PreparedLights& lights) {
  return lights.lobes.empty() && lights.directionals.empty() && lights.spheres.empty() &&
         lights.rectangles.empty();
}

/// Leaves out black lights. `options` are those of the frame calls. Throws std::invalid_argument
/// for a light that domain_error (lobe_domain.h, local_lights.h) objects to; `lights` are of no use
/// then. The second form reuses the memory of `lights`, yet may allocate. While threads shade with
/// one PreparedLights, another thread may prepare the next frame's in a second.
/// @{
PreparedLights prepare_lights(const LightRig& rig, const PreparedTransfer& transfer,
                              const ShadingOptions& options);
void prepare_lights(const LightRig& rig, const PreparedTransfer& transfer,
                    const ShadingOptions& options, PreparedLights& lights);
/// @}

/// prepare_lights in parts, for callers with threads of their own: first begin_lights, then
/// finish_lights once for each basis of the transfer, in any order and at the same time. What is
/// finished does not depend on it.
/// @{
void begin_lights(const LightRig& rig, const PreparedTransfer& transfer,
                  const ShadingOptions& options, PreparedLights& lights);
void finish_lights(const PreparedTransfer& transfer, const ShadingOptions& options, size_t basis,
                   PreparedLights& lights);
/// @}

/// What lights a frame, in the world's frame. Borrowed: both outlive the calls they are given to.
/// Without an environment the specular term sees the lights' lobes instead of the map.
struct Lighting {
  const PreparedLights* lights = nullptr;               ///< never null
  const PrefilteredEnvironment* environment = nullptr;  ///< may be null
};

}  // namespace burnish
