#pragma once

#include "burnish/light/light_rig.h"
#include "burnish/material/specular_slice.h"
#include "burnish/precompute/progress.h"
#include "harness/rivals/rival.h"
#include "harness/rivals/runtime_rival.h"

/// Based on: wang2009svbrdf, as far as xu2013asg and others tell of it. D(h) of each material is a
/// row of n SGs along its longer axis, fitted by least squares (round_lobe_fit.h), each warped to
/// incoming directions as a round lobe; its visible part is Wang's f_h of the SSDF at the lobe's
/// axis, the light a single lookup of the filtered map; the smooth factor and the cosine are taken
/// at the axis. For the diffuse part the environment is a sum of SGs.
///
/// It runs on the runtime's kernels, whose lobes are ASGs: the two widths of a warped lobe are only
/// read by their product, as an SG's would be, so that the result is that of SGs (a test compares);
/// the axes that are found in vain are a few ns of a lobe's hundred.
namespace burnish {

struct SgOptions {
  int lobes = 7;  ///< SGs of each material's D, 1..kMaxSpecularTeeth
  int light_lobes =
      10;  ///< SGs that the environment is fitted by, 1..128, where they are not given
  /// Of the diffuse part. `constant`, the cosine at the light's axis, is the published method;
  /// `horizon_normalised` is ours, and for SGs a third of the error.
  CosineModel cosine = CosineModel::constant;
};

/// D(h) of a material as `lobes` SGs. A material without a specular part has none; one of several
/// or displaced lobes (`fitted`, GGX) is fitted as distribution_of allows.
PreparedMaterial sg_material(const Material& material, int lobes);

/// The environment as SGs: fitted once for all rivals of one map.
struct SgLights {
  std::vector<EnvironmentLobe> lobes;  ///< in the map's frame, of equal bandwidths
  double fit_s = 0;                    ///< wall clock
};

/// At most `lobes`, 1..128. Throws as fit_light does.
SgLights fit_sg_lights(const Image& map, int lobes, const Progress& progress = {});

Rival sg_rival(const RivalScene& scene, const SgOptions& options, const SgLights& lights);

/// The same with lights of its own, options.light_lobes.
Rival sg_rival(const RivalScene& scene, const SgOptions& options, const Progress& progress = {});

/// Settings of the runtime in which it does what the SG pipeline does.
ShadingOptions sg_shading_options(const SgOptions& options);

}  // namespace burnish
