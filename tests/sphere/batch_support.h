#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/sphere/batch.h"
#include "burnish/sphere/spherical_warp.h"
#include "support/quadrature.h"

/// What the tests of the batch forms share.
namespace burnish::test {

inline constexpr unsigned kSeed = 20;
inline constexpr float kMax = std::numeric_limits<float>::max();
inline constexpr float kDenormal = std::numeric_limits<float>::denorm_min();
inline constexpr double kDotError = 2e-7;  // of unit vectors: three roundings of terms of at most 1
inline const std::vector<float> kExtremes = {0, kDenormal, 1e-8f, 1e-3f, 1, 1e3f, 1e8f, kMax};

/// A test that runs on each instruction set that this processor has, and restores the best one
/// whatever happens.
class Batch : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(batch::use_instruction_set(GetParam())); }
  void TearDown() override { batch::use_instruction_set(""); }
};

/// Numbers of every magnitude, and the extremes.
inline std::vector<float> magnitudes(int count, std::mt19937& random) {
  std::uniform_real_distribution<float> exponent(-10, 10);
  std::vector<float> values = kExtremes;
  for (int i = 0; i < count; ++i) values.push_back(std::pow(10.0f, exponent(random)));
  return values;
}

struct DirectionArrays {
  std::vector<float> x, y, z;
  batch::Directions spans() const { return {x, y, z}; }
  Vector3f at(size_t i) const { return {x[i], y[i], z[i]}; }
  void add(const Vector3d& v) {
    x.push_back(float(v.x()));
    y.push_back(float(v.y()));
    z.push_back(float(v.z()));
  }
};

/// Directions all over the sphere, and close to an axis and to its opposite.
inline DirectionArrays directions_around(const Vector3d& axis, int count, std::mt19937& random) {
  DirectionArrays directions;
  for (int i = 0; i < count; ++i) directions.add(random_direction(random));
  for (const double sign : {1.0, -1.0}) {
    directions.add(sign * axis);
    for (double distance = 1e-7; distance < 1; distance *= 3)
      directions.add((sign * axis + distance * random_direction(random)).normalized());
  }
  return directions;
}

/// The value in double of a float lobe, and the error of a float evaluation: each dot product
/// errs by three roundings of terms of at most 1.
inline std::pair<double, double> asg_and_bound(const AnisotropicGaussian<float>& lobe,
                                               const Vector3f& v) {
  const Vector3d local = lobe.frame.cast<double>().to_local(v.cast<double>());
  const double bx = lobe.bandwidth_x, by = lobe.bandwidth_y, kDot = 3 * 6e-8 * 1.5;
  const double ex = bx * local.x() * local.x(), ey = by * local.y() * local.y();
  const double slack = 2 * kDot * (std::sqrt(ex * bx) + std::sqrt(ey * by)) +
                       kDot * kDot * (bx + by) + 4e-7 * (ex + ey);
  const double low = std::exp(-std::min(ex + ey + slack, 700.0)),
               high = std::exp(-std::max(ex + ey - slack, 0.0));
  const double z = std::max(local.z(), 0.0), value = z * std::exp(-(ex + ey));
  const double bound = std::max((z + kDot) * high - value, value - (z - kDot) * low);
  return {lobe.amplitude * value, std::abs(lobe.amplitude) * (bound + 3e-7 * value + 1.4e-37)};
}

/// Owns what batch::WarpedLobes points to.
struct WarpedArrays {
  explicit WarpedArrays(size_t size) : all(10, std::vector<float>(size)) {}
  batch::WarpedLobes spans() {
    return {{all[0], all[1], all[2]}, {all[3], all[4], all[5]}, all[6], all[7], all[8], all[9]};
  }
  WarpedLobe<double> at(size_t i) const {
    const Vector3d x(all[0][i], all[1][i], all[2][i]), z(all[3][i], all[4][i], all[5][i]);
    return {{{x, z.cross(x), z}, all[6][i], all[7][i], all[8][i]}, all[9][i]};
  }
  std::vector<std::vector<float>> all;
};

/// The exponent's matrix: in contrast to the axes, it is well conditioned for round lobes, too.
inline Eigen::Matrix3d exponent_matrix(const AnisotropicGaussian<double>& lobe) {
  return lobe.bandwidth_x * lobe.frame.x * lobe.frame.x.transpose() +
         lobe.bandwidth_y * lobe.frame.y * lobe.frame.y.transpose();
}

}  // namespace burnish::test
