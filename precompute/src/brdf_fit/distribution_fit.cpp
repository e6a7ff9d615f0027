// Based on: the fit of a distribution by lobes (xu2013asg, section 5.2), with the solver of the
// light fit (docs/lights.md): shapes by Levenberg-Marquardt, amplitudes by variable projection.
#include "brdf_fit/distribution_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

#include "burnish/sphere/frame.h"

namespace burnish {
namespace {

constexpr size_t kBlocks = 4096;  // that cells are joined in
constexpr int kBlockEdge = 16;    // of the first blocks
constexpr int kCandidates = 24;   // axes that a new lobe may have
constexpr int kStepsPerLobe = 20;
constexpr double kTolerance = 1e-6;
constexpr double kMinBandwidth = 0.05;
// A lobe whose axis is below the horizon has no peak to see, and no frame to shade in.
constexpr double kLeastAxisCosine = 0.02;

/// A rectangle of cells.
struct Block {
  int row, column, rows, columns;
  double weight = 0, value = 0, spread = 0;
  Vector3d direction = Vector3d::Zero();

  bool operator<(const Block& other) const { return spread < other.spread; }
};

Block make_block(const BrdfSamples& samples, const CellTarget& table, int row, int column, int rows,
                 int columns) {
  Block block{row, column, rows, columns};
  double square = 0;
  for (int j = row; j < row + rows; ++j)
    for (int i = column; i < column + columns; ++i) {
      const auto cell = static_cast<size_t>(j * samples.grid.azimuths + i);
      const double weight = table.weight[cell], value = table.value[cell];
      block.weight += weight;
      block.value += weight * value;
      square += weight * value * value;
      block.direction += weight * samples.center[cell];
    }
  if (!(block.weight > 0)) return block;
  block.value /= block.weight;
  block.spread =
      rows * columns > 1 ? std::max(square - block.weight * block.value * block.value, 0.0) : 0;
  block.direction.normalize();
  return block;
}

std::vector<Block> join_cells(const BrdfSamples& samples, const CellTarget& table) {
  const HalfVectorGrid& grid = samples.grid;
  std::priority_queue<Block> queue;
  const int edge_rows = std::min(kBlockEdge, grid.azimuths == 1 ? 1 : grid.angles);
  const int edge_columns = std::min(kBlockEdge, grid.azimuths);
  for (int row = 0; row < grid.angles; row += edge_rows)
    for (int column = 0; column < grid.azimuths; column += edge_columns)
      queue.push(make_block(samples, table, row, column, std::min(edge_rows, grid.angles - row),
                            std::min(edge_columns, grid.azimuths - column)));
  while (queue.size() < kBlocks && queue.top().spread > 0) {
    const Block block = queue.top();
    queue.pop();
    const int down = (block.rows + 1) / 2, across = (block.columns + 1) / 2;
    for (int j = 0; j < block.rows; j += down)
      for (int i = 0; i < block.columns; i += across)
        queue.push(make_block(samples, table, block.row + j, block.column + i,
                              std::min(down, block.rows - j), std::min(across, block.columns - i)));
  }
  std::vector<Block> blocks;
  for (; !queue.empty(); queue.pop())
    if (queue.top().weight > 0) blocks.push_back(queue.top());
  return blocks;
}

}  // namespace

std::vector<AnisotropicGaussian<double>> DistributionLobes::mixture() const {
  std::vector<AnisotropicGaussian<double>> lobes;
  for (size_t k = 0; k < shapes.size(); ++k) {
    const Eigen::Matrix3d axes = shapes[k].rotation.toRotationMatrix();
    lobes.push_back({{axes.col(0), axes.col(1), axes.col(2)},
                     std::exp(shapes[k].log_bandwidth[0]),
                     std::exp(shapes[k].log_bandwidth[1]),
                     amplitudes[k]});
  }
  return lobes;
}

DistributionFit::DistributionFit(const BrdfSamples& samples, const CellTarget& table)
    : isotropic_(samples.isotropic),
      limits_{kMinBandwidth, samples.max_bandwidth, samples.isotropic, samples.isotropic} {
  const std::vector<Block> blocks = join_cells(samples, table);
  double norm2 = 0;
  for (const Block& block : blocks) norm2 += block.weight * block.value * block.value;
  if (!(norm2 > 0)) return;
  scale_ = 1 / std::sqrt(norm2);
  const auto count = static_cast<Eigen::Index>(blocks.size());
  target_.scale.resize(count);
  target_.irradiance.resize(0, count);
  target_.value.setZero(count, 3);  // one channel is in use
  for (Eigen::Index i = 0; i < count; ++i) {
    const Block& block = blocks[static_cast<size_t>(i)];
    target_.direction.push_back(block.direction);
    target_.variance.push_back(0);
    target_.scale[i] = std::sqrt(block.weight) * scale_;
    target_.value(i, 0) = target_.scale[i] * block.value;
  }
}

void DistributionFit::add_lobe(DistributionLobes& lobes) const {
  const LightFitResidual residual = mixture_residual(target_, lobes.shapes);
  std::vector<Vector3d> axes = {Vector3d::UnitZ()};
  if (!isotropic_) {
    const Eigen::VectorXd density = residual.col(0).cwiseQuotient(target_.scale);
    std::vector<int> order(static_cast<size_t>(density.size()));
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      const double da = residual(a, 0) * density[a], db = residual(b, 0) * density[b];
      return da != db ? da > db : a < b;
    });
    for (size_t i = 0; i < order.size() && axes.size() < kCandidates; ++i)
      axes.push_back(target_.direction[static_cast<size_t>(order[i])]);
  }
  std::vector<LobeShape> candidates;
  for (const Vector3d& axis : axes)
    for (double bandwidth = 0.25; bandwidth < std::min(2e7, limits_.max_bandwidth);
         bandwidth *= isotropic_ ? 2 : 4)
      candidates.push_back(round_lobe(axis, bandwidth));
  const Eigen::MatrixXd samples = sample_lobes(target_, candidates);
  const Eigen::VectorXd along = (samples.transpose() * residual.col(0)).cwiseMax(0.0);
  const Eigen::VectorXd square = samples.colwise().squaredNorm().transpose();
  Eigen::Index best = 0;
  (square.array() > 0).select(along.array().square() / square.array(), 0.0).maxCoeff(&best);
  lobes.shapes.push_back(candidates[static_cast<size_t>(best)]);
  refine(kStepsPerLobe, lobes);
}

void DistributionFit::refine(int steps, DistributionLobes& lobes) const {
  refine_lobes(
      target_, limits_, steps, kTolerance, [] { return true; }, lobes.shapes);
  for (LobeShape& shape : lobes.shapes) {
    Vector3d axis = shape.rotation * Vector3d::UnitZ();
    if (axis.z() >= kLeastAxisCosine) continue;
    Vector3d raised(axis.x(), axis.y(), 0);
    raised = (raised.normalized() + kLeastAxisCosine * Vector3d::UnitZ()).normalized();
    shape.rotation =
        (Eigen::Quaterniond::FromTwoVectors(axis, raised) * shape.rotation).normalized();
  }
  solve_amplitudes(lobes);
}

void DistributionFit::solve_amplitudes(DistributionLobes& lobes) const {
  const LobeColors solved = solve_colors(target_, sample_lobes(target_, lobes.shapes));
  lobes.amplitudes.resize(lobes.shapes.size());
  for (size_t k = 0; k < lobes.shapes.size(); ++k)
    lobes.amplitudes[k] = solved.color(static_cast<Eigen::Index>(k), 0);
}

}  // namespace burnish
