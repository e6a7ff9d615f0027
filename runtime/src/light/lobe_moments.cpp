#include "burnish/light/lobe_moments.h"

#include <array>

namespace burnish {
namespace {

/// Integrals over t in [0, 1] of exp(-k t) times 1, t, and sqrt(1 - t).
struct RadialIntegrals {
  double one, t, root;
};

RadialIntegrals radial_integrals(double k) {
  RadialIntegrals r;
  r.one = one_minus_exp_over(k);
  if (k > 40) {
    r.t = 1 / (k * k);
    const double x = 1 / (2 * k);  // asymptotic series of Dawson's integral
    r.root = (1 - x - x * x - 3 * x * x * x - 15 * x * x * x * x) / k;
    return r;
  }
  r.t = k > 1e-3 ? (r.one - std::exp(-k)) / k : 0.5 - k / 3;
  // Gauss-Legendre in s = sqrt(1 - t): 2 s^2 exp(-k (1 - s^2)) is entire, 20 points reach 1e-12 at
  // k = 40.
  static constexpr std::array<double, 10> kNode = {
      0.0765265211334973, 0.2277858511416451, 0.3737060887154195, 0.5108670019508271,
      0.6360536807265150, 0.7463319064601508, 0.8391169718222188, 0.9122344282513259,
      0.9639719272779138, 0.9931285991850949};
  static constexpr std::array<double, 10> kWeight = {
      0.1527533871307258, 0.1491729864726037, 0.1420961093183820, 0.1316886384491766,
      0.1181945319615184, 0.1019301198172404, 0.0832767415767048, 0.0626720483341091,
      0.0406014298003869, 0.0176140071391521};
  double root = 0;
  for (size_t i = 0; i < kNode.size(); ++i) {
    for (const double node : {-kNode[i], kNode[i]}) {
      const double s = (1 + node) / 2;
      root += kWeight[i] * s * s * std::exp(-k * (1 - s * s));
    }
  }
  r.root = root;
  return r;
}

}  // namespace

LobeMoments<double> asg_moments(double bandwidth_x, double bandwidth_y) {
  // In polar coordinates of the orthographic disc, t = r^2, exponent k t with k = b_x cos^2 + b_y
  // sin^2. The azimuth is that of an ellipse, so that equal steps follow a long lobe; near-round
  // lobes reduce to equal angles. The floor keeps the ellipse finite for zero bandwidths.
  const double root_x = std::sqrt(bandwidth_x + 1), root_y = std::sqrt(bandwidth_y + 1);
  constexpr int kSteps = 512;  // of a quarter turn
  double sum = 0, sum_z = 0, sum_xx = 0, sum_yy = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double psi = (i + 0.5) / kSteps * kPi<double> / 2;
    const double x = root_y * std::cos(psi), y = root_x * std::sin(psi);
    const double cos2 = x * x / (x * x + y * y), sin2 = y * y / (x * x + y * y);
    const double weight = root_x * root_y / (x * x + y * y);  // d phi / d psi
    const RadialIntegrals radial = radial_integrals(bandwidth_x * cos2 + bandwidth_y * sin2);
    sum += weight * radial.one;
    sum_z += weight * radial.root;
    sum_xx += weight * cos2 * radial.t;
    sum_yy += weight * sin2 * radial.t;
  }
  LobeMoments<double> m;
  m.mean_z = sum_z / sum;
  m.mean_xx = sum_xx / sum;
  m.mean_yy = sum_yy / sum;
  // 1 - E[t] - E[z]^2 cancels for narrow lobes, where Var[z] = (b_x^-2 + b_y^-2) / 8.
  const double direct = 1 - m.mean_xx - m.mean_yy - m.mean_z * m.mean_z;
  const double narrow = (1 / (bandwidth_x * bandwidth_x) + 1 / (bandwidth_y * bandwidth_y)) / 8;
  m.variance_z = std::min(bandwidth_x, bandwidth_y) > 1e3 ? narrow : std::max(direct, 0.0);
  return m;
}

}  // namespace burnish
