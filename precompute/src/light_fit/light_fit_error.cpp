#include "light_fit/light_fit_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <tbb/parallel_for.h>

#include "burnish/precompute/fit_light.h"
#include "burnish/sphere/octahedral_map.h"
#include "light_fit/flux.h"

namespace burnish {
namespace {

constexpr int kNormals = 32;  // per edge of an equal-area map

struct Squares {
  double error = 0, truth = 0;
};

double relative(const std::vector<Squares>& parts) {
  Squares sum;
  for (const Squares& part : parts) {
    sum.error += part.error;
    sum.truth += part.truth;
  }
  if (sum.error == 0) return 0;
  return sum.truth > 0 ? std::sqrt(sum.error / sum.truth) : std::numeric_limits<double>::infinity();
}

// Pixels coarser than half a degree are sampled at several points.
Squares row_squares(const Image& environment, const LightRig& rig, int row) {
  const int down = std::max(1, (360 + environment.height - 1) / environment.height);
  const int across = std::max(1, (720 + environment.width - 1) / environment.width);
  Squares sum;
  for (int sub = 0; sub < down; ++sub) {
    const double v = (row + (sub + 0.5) / down) / environment.height;
    const double solid_angle = 4 * kPi<double> / (double(environment.width) * across) *
                               std::sin(kPi<double> / (2.0 * environment.height * down)) *
                               std::sin(kPi<double> * v);
    Squares part;
    for (int i = 0; i < environment.width * across; ++i) {
      const Vector3d direction =
          direction_from_latlong((i + 0.5) / (double(environment.width) * across), v);
      const Eigen::Array3d truth = environment.at(i / across, row).cast<double>();
      part.error +=
          (truth - eval_lobes(rig, direction.cast<float>()).cast<double>()).square().sum();
      part.truth += truth.square().sum();
    }
    sum.error += solid_angle * part.error;
    sum.truth += solid_angle * part.truth;
  }
  return sum;
}

}  // namespace

double radiance_error(const ReducedEnvironment& map, const LightRig& rig) {
  std::vector<Squares> rows(map.image.height);
  tbb::parallel_for(0, map.image.height,
                    [&](int row) { rows[row] = row_squares(map.image, rig, row); });
  // What varies within a pixel of the reduced map is error whole: a lobe hardly varies there.
  rows.push_back({map.spread, map.spread});
  return relative(rows);
}

LightFitError measure_light_fit(const ReducedEnvironment& map, const LightRig& rig) {
  const FluxVectors of_map = environment_flux(map.image);
  FluxVectors of_rig;
  for (const EnvironmentLobe& light : rig.lobes) append_lobe_flux(light, of_rig);
  std::vector<Squares> normals(size_t(kNormals) * kNormals);
  tbb::parallel_for(0, kNormals * kNormals, [&](int i) {
    const Vector3d normal =
        octahedral_texel_direction<double>(i % kNormals, i / kNormals, kNormals);
    const Eigen::RowVector3d truth = irradiance_of_flux(of_map, normal);
    normals[i] = {(truth - irradiance_of_flux(of_rig, normal)).squaredNorm(), truth.squaredNorm()};
  });
  return {radiance_error(map, rig), relative(normals)};
}

LightFitError measure_light_fit(const Image& environment, const LightRig& rig) {
  return measure_light_fit(reduce_environment(environment), rig);
}

}  // namespace burnish
