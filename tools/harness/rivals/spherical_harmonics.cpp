#include "harness/rivals/spherical_harmonics.h"

#include <array>
#include <cmath>
#include <vector>

#include "burnish/sphere/gauss_legendre.h"
#include "burnish/visibility/visibility_ladder.h"

namespace burnish {
namespace {

struct Node {
  Vector3f direction;
  float weight;  // sr
};

/// Exact for products of harmonics up to degree 31 in all: that of two, or of three up to ten.
const std::vector<Node>& sphere_nodes() {
  static const std::vector<Node> nodes = [] {
    constexpr int kAzimuths = 32;
    const auto& rule = internal::unit_gauss<16>();
    std::vector<Node> all;
    for (size_t i = 0; i < rule.node.size(); ++i) {
      const double z = 2 * rule.node[i] - 1, radius = std::sqrt(1 - z * z);
      for (int j = 0; j < kAzimuths; ++j) {
        const double azimuth = 2 * kPi<double> * (j + 0.5) / kAzimuths;
        all.push_back(
            {Vector3d(radius * std::cos(azimuth), radius * std::sin(azimuth), z).cast<float>(),
             static_cast<float>(4 * kPi<double> * rule.weight[i] / kAzimuths)});
      }
    }
    return all;
  }();
  return nodes;
}

/// [nodes][bands^2], of the nodes turned by the inverse of a rotation.
RowMatrix node_harmonics(int bands, const Eigen::Matrix3f& rotation) {
  const std::vector<Node>& nodes = sphere_nodes();
  RowMatrix values(static_cast<Eigen::Index>(nodes.size()), Eigen::Index{bands} * bands);
  for (size_t i = 0; i < nodes.size(); ++i)
    eval_harmonics(
        bands, rotation.transpose() * nodes[i].direction,
        {values.row(static_cast<Eigen::Index>(i)).data(), static_cast<size_t>(values.cols())});
  return values;
}

RowMatrix weighted_node_harmonics(int bands) {
  RowMatrix values = node_harmonics(bands, Eigen::Matrix3f::Identity());
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    values.row(i) *= sphere_nodes()[static_cast<size_t>(i)].weight;
  return values;
}

}  // namespace

RgbHarmonics project_environment(const Image& environment, int bands) {
  const Eigen::Index count = Eigen::Index{bands} * bands;
  Eigen::Matrix<double, Eigen::Dynamic, 3> sum =
      Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(count, 3);
  Eigen::VectorXf values(count);
  for (int y = 0; y < environment.height; ++y) {
    RgbHarmonics row = RgbHarmonics::Zero(count, 3);
    for (int x = 0; x < environment.width; ++x) {
      const Vector3d direction =
          direction_from_latlong((x + 0.5) / environment.width, (y + 0.5) / environment.height);
      eval_harmonics(bands, direction.cast<float>(), {values.data(), values.data() + count});
      row += values * environment.at(x, y).matrix().transpose();
    }
    sum += latlong_pixel_solid_angle(environment, y) * row.cast<double>();
  }
  return sum.cast<float>();
}

RowMatrix harmonics_rotation(int bands, const Eigen::Matrix3f& rotation) {
  const RowMatrix weighted = weighted_node_harmonics(bands);
  const RowMatrix turned = node_harmonics(bands, rotation);
  // Bands do not mix.
  RowMatrix result = RowMatrix::Zero(weighted.cols(), weighted.cols());
  for (Eigen::Index l = 0; l < bands; ++l)
    result.block(l * l, l * l, 2 * l + 1, 2 * l + 1) =
        weighted.middleCols(l * l, 2 * l + 1).transpose() * turned.middleCols(l * l, 2 * l + 1);
  return result;
}

void apply_window(int bands, Eigen::Ref<RgbHarmonics> harmonics) {
  for (Eigen::Index l = 0; l < bands; ++l) {
    const float angle = kPi<float> * static_cast<float>(l) / static_cast<float>(bands);
    harmonics.middleRows(l * l, 2 * l + 1) *= (1 + std::cos(angle)) / 2;
  }
}

RowMatrix harmonics_product(int bands) {
  const RowMatrix weighted = weighted_node_harmonics(bands);
  const RowMatrix all = node_harmonics(2 * bands - 1, Eigen::Matrix3f::Identity());
  const Eigen::Index count = weighted.cols();
  const RowMatrix plain = all.leftCols(count);
  RowMatrix result(count * count, all.cols());
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      result.row(i * count + j) =
          (weighted.col(i).array() * plain.col(j).array()).matrix().transpose() * all;
  return result;
}

}  // namespace burnish
