#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "burnish/sphere/frame.h"
#include "support/chi_square.h"
#include "support/quadrature.h"

namespace burnish::test {

/// Cells of the sphere that suit a lobe around z of `frame`: rings of the polar angle whose widths
/// grow from `finest` (radians), cut at azimuths that crowd around the y axis for aspect > 1, as a
/// lobe that is so much wider along y asks for. Every 24th of pi beyond pi/8 is a ring's edge, the
/// horizon among them.
struct SphereCells {
  SphereCells(const Frame<double>& around, double finest, double aspect_ratio)
      : frame(around), aspect(aspect_ratio) {
    edges.push_back(0);
    for (double edge = finest; edge < kPi<double> / 8; edge *= 1.35) edges.push_back(edge);
    for (int i = 3; i <= 24; ++i) edges.push_back(kPi<double> * i / 24);
  }

  size_t rings() const { return edges.size() - 1; }
  size_t size() const { return rings() * kSectors; }

  size_t cell(const Vector3d& direction) const {
    const Vector3d v = frame.to_local(direction);
    const double theta = std::atan2(std::hypot(v.x(), v.y()), v.z());
    const double psi = std::atan2(v.y(), aspect * v.x()) / (2 * kPi<double>)+0.5;
    const auto above = std::upper_bound(edges.begin() + 1, edges.end() - 1, theta);
    const auto ring = static_cast<size_t>(above - edges.begin() - 1);
    return ring * kSectors + static_cast<size_t>(psi * kSectors) % kSectors;
  }

  /// Integral of a density per sr over every cell, by 10 x 10 Gauss-Legendre nodes.
  template <class Pdf>
  std::vector<double> integrate(const Pdf& pdf) const {
    std::vector<double> sums;
    for (size_t ring = 0; ring < rings(); ++ring)
      for (size_t sector = 0; sector < kSectors; ++sector) {
        double sum = 0;
        const double step = 2 * kPi<double> / kSectors, from = step * double(sector) - kPi<double>;
        for (const auto& [theta, theta_weight] : gauss_legendre(10, edges[ring], edges[ring + 1]))
          for (const auto& [psi, psi_weight] : gauss_legendre(10, from, from + step)) {
            // tan(phi) = aspect tan(psi)
            const double c = std::cos(psi), s = aspect * std::sin(psi), norm = std::hypot(c, s);
            const Vector3d v(std::sin(theta) * c / norm, std::sin(theta) * s / norm,
                             std::cos(theta));
            sum += theta_weight * psi_weight * std::sin(theta) * aspect / (norm * norm) *
                   pdf(frame.to_world(v));
          }
        sums.push_back(sum);
      }
    return sums;
  }

  static constexpr size_t kSectors = 16;
  Frame<double> frame;
  double aspect;
  std::vector<double> edges;
};

/// Chi-square test of `sample(u, v)`, a Vector3d, against `pdf(direction)`.
template <class Sample, class Pdf>
ChiSquare chi_square_on_sphere(const SphereCells& cells, const Sample& sample, const Pdf& pdf,
                               int samples, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  std::vector<double> observed(cells.size()), expected = cells.integrate(pdf);
  for (int i = 0; i < samples; ++i) {
    const double u = uniform(random), v = uniform(random);
    observed[cells.cell(sample(u, v))] += 1;
  }
  for (double& e : expected) e *= samples;
  return chi_square(observed, expected);
}

}  // namespace burnish::test
