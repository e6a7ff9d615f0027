#include "light_fit/flux.h"

#include <algorithm>
#include <cmath>

#include "light_fit/environment_cells.h"

namespace burnish {

FluxVectors environment_flux(const Image& environment) {
  constexpr int kRows = 96;
  FluxVectors flux;
  for (const EnvironmentCell& cell : environment_cells(environment, kRows, 0))
    flux.push_back({cell_vector_irradiance(environment, cell)});
  return flux;
}

// The lobe integrated in latitude a and longitude b about its y axis, v = (cos a sin b, sin a,
// cos a cos b), by the midpoint rule out to five standard deviations. It converges fast: the
// integrand is smooth and vanishes at the hemisphere's edge like cos^2.
void append_lobe_flux(const EnvironmentLobe& light, FluxVectors& flux) {
  constexpr int kNodes = 48;  // per dimension
  const AnisotropicGaussian<float>& lobe = light.lobe;
  const Frame<double> frame = lobe.frame.cast<double>();
  const Eigen::Array3d color = double(lobe.amplitude) * light.color.cast<double>();
  const double bx = lobe.bandwidth_x, by = lobe.bandwidth_y;
  const auto reach = [](double bandwidth, double limit) {
    const double five_sigma = 5 / std::sqrt(2 * std::max(bandwidth, 1e-12));
    return five_sigma < limit ? std::asin(five_sigma / limit) : kPi<double> / 2;
  };
  const double reach_a = reach(by, 1), step_a = 2 * reach_a / kNodes;
  for (int i = 0; i < kNodes; ++i) {
    const double a = -reach_a + (i + 0.5) * step_a, ca = std::cos(a), sa = std::sin(a);
    const double reach_b = reach(bx, ca), step_b = 2 * reach_b / kNodes;
    for (int j = 0; j < kNodes; ++j) {
      const double b = -reach_b + (j + 0.5) * step_b, x = ca * std::sin(b), z = ca * std::cos(b);
      const double f = z * std::exp(-bx * x * x - by * sa * sa) * ca * step_a * step_b;
      flux.push_back({frame.to_world({x, sa, z}) * (f * color.abs()).matrix().transpose(),
                      color.sign().matrix().transpose()});
    }
  }
}

Eigen::RowVector3d irradiance_of_flux(const FluxVectors& flux, const Vector3d& normal) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (const Flux& f : flux)
    sum += f.sign.cwiseProduct((normal.transpose() * f.vector).cwiseMax(0.0));
  return sum;
}

}  // namespace burnish
