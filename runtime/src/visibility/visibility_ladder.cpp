#include "burnish/visibility/visibility_ladder.h"

#include <algorithm>

#include "burnish/sphere/direction.h"

namespace burnish {
namespace {

constexpr int kLanes = 4;  ///< azimuthal orders that are computed together

using Row = std::array<float, kMaxLadderBands>;

/// q(l, m) = a z q(l - 1, m) - b q(l - 2, m) + d, the associated Legendre functions with the
/// harmonics' normalisation and without sin^m(polar angle); zero for m > l.
struct Recurrence {
  alignas(16) std::array<Row, kMaxLadderBands> a = {}, b = {}, d = {};

  Recurrence() {
    const auto previous = [](double l, double m) {  // what q(l, m) divides by, relative to l - 1
      return std::sqrt((l * l - m * m) / (4 * l * l - 1));
    };
    double diagonal = 1 / std::sqrt(4 * kPi<double>);
    for (int l = 0; l < kMaxLadderBands; ++l) {
      if (l > 0) diagonal *= std::sqrt((2 * l + 1) / (2.0 * l) * (l == 1 ? 2 : 1));
      d[l][l] = static_cast<float>(diagonal);
      for (int m = 0; m < l; ++m) {
        a[l][m] = static_cast<float>(1 / previous(l, m));
        if (l > m + 1) b[l][m] = static_cast<float>(previous(l - 1, m) / previous(l, m));
      }
    }
  }
};
const Recurrence kRecurrence;

/// Calls visit(band, q, azimuth_cosine, azimuth_sine), rows of orders m, for each band: the
/// harmonics are q azimuth_cosine and q azimuth_sine.
template <class Visit>
void for_each_band(int bands, const Vector3f& direction, const Visit& visit) {
  alignas(16) Row cosine = {1}, sine = {};  // real and imaginary part of (x + iy)^m
  for (int m = 1; m < bands; ++m) {
    cosine[m] = direction.x() * cosine[m - 1] - direction.y() * sine[m - 1];
    sine[m] = direction.x() * sine[m - 1] + direction.y() * cosine[m - 1];
  }
  alignas(16) Row q = {}, before = {};
  for (int l = 0; l < bands; ++l) {
    for (int m = 0; m <= l; m += kLanes)
      for (int i = m; i < m + kLanes; ++i) {
        const float next = kRecurrence.a[l][i] * direction.z() * q[i] -
                           kRecurrence.b[l][i] * before[i] + kRecurrence.d[l][i];
        before[i] = q[i];
        q[i] = next;
      }
    visit(l, q, cosine, sine);
  }
}

}  // namespace

void eval_harmonics(int bands, const Vector3f& direction, std::span<float> values) noexcept {
  for_each_band(bands, direction, [&](int l, const Row& q, const Row& cosine, const Row& sine) {
    float* band = values.data() + l * l;
    for (int m = 0; m <= l; ++m) band[m] = q[m] * cosine[m];
    for (int m = 1; m <= l; ++m) band[l + m] = q[m] * sine[m];
  });
}

LobeBands lobe_bands(float bandwidth) noexcept {
  constexpr float kNegligible = 1e-4f;
  const float sharpness = 2 * std::min(bandwidth, 1e30f);  // all factors are 1 long before
  // i(l) / i(l - 1) = s / (2 l + 1 + s i(l + 1) / i(l)), downward, which is stable. The start is
  // s / (l + sqrt((l + 1/2)^2 + s^2)), between the bounds with l and with l + 1 in the root.
  std::array<float, kMaxLadderBands> ratio;
  constexpr float kAbove = kMaxLadderBands;
  float next = sharpness / (kAbove + std::hypot(kAbove + 0.5f, sharpness));
  for (int l = kMaxLadderBands - 1; l > 0; --l)
    ratio[l] = next = sharpness / (static_cast<float>(2 * l + 1) + sharpness * next);
  LobeBands lobe;
  float factor = 1;
  while (factor > kNegligible) {
    lobe.factor[lobe.bands++] = factor;
    if (lobe.bands == kMaxLadderBands) break;
    factor *= ratio[lobe.bands];
  }
  return lobe;
}

VisibilityHarmonics reconstruct_harmonics(const LadderBasis& basis,
                                          const float* coefficients) noexcept {
  using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  constexpr int kMost = kMaxLadderBands * kMaxLadderBands;
  VisibilityHarmonics result;
  result.bands = std::min(basis.bands, kMaxLadderBands);
  const int count = result.bands * result.bands;
  const Eigen::Map<const Matrix> eigen(basis.eigen.data(), count, basis.terms);
  const Eigen::Map<const Eigen::VectorXf> mean(basis.mean.data(), count);
  const Eigen::Map<const Eigen::VectorXf> weights(coefficients, basis.terms);
  Eigen::Matrix<float, Eigen::Dynamic, 1, Eigen::ColMajor, kMost, 1> harmonics = mean;
  harmonics.noalias() += eigen * weights;
  for (int l = 0; l < result.bands; ++l) {
    const float* band = harmonics.data() + l * l;
    std::copy_n(band, l + 1, result.cosine[l].begin());
    std::copy_n(band + l + 1, l, result.sine[l].begin() + 1);
  }
  return result;
}

float visible_fraction(const VisibilityHarmonics& visibility, const Vector3f& direction,
                       const LobeBands& lobe) noexcept {
  alignas(16) std::array<float, kLanes> sum = {};
  for_each_band(std::min(visibility.bands, lobe.bands), direction,
                [&](int l, const Row& q, const Row& cosine, const Row& sine) {
                  const Row &c = visibility.cosine[l], &s = visibility.sine[l];
                  for (int m = 0; m <= l; m += kLanes)
                    for (int i = 0; i < kLanes; ++i)
                      sum[i] += lobe.factor[l] * q[m + i] *
                                (c[m + i] * cosine[m + i] + s[m + i] * sine[m + i]);
                });
  return std::clamp(sum[0] + sum[1] + sum[2] + sum[3], 0.0f, 1.0f);
}

}  // namespace burnish
