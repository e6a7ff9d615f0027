// Based on: fits of a distribution and a smooth factor by turns (wang2009svbrdf; xu2013asg, section
// 5.2), with the squared error of f cos as the only measure. Given D, the BRDF is linear in F and
// the diffuse part, with the same matrix for all channels, and quadratic in S.
#include "brdf_fit/smooth_factor_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <tbb/parallel_for.h>

namespace burnish {
namespace {

constexpr int kNodes = 46;      // of F and of S: every two degrees
constexpr size_t kChunks = 32;  // of the pairs: sums have the same order at any number of threads
// Of the second differences of a table, against the mean weight of its entries: enough to carry the
// table on where there are no pairs, too little to be seen where there are.
constexpr double kSmoothness = 1e-5;

struct Weights {
  int node;
  double low, high;
};

Weights weigh(float place) {
  const int node = std::min(static_cast<int>(place), kNodes - 2);
  return {node, node + 1 - double(place), double(place) - node};
}

double interpolate(const Eigen::VectorXd& table, const Weights& at) {
  return at.low * table[at.node] + at.high * table[at.node + 1];
}

Eigen::Array3d interpolate(const Eigen::Matrix<double, Eigen::Dynamic, 3>& table,
                           const Weights& at) {
  return (at.low * table.row(at.node) + at.high * table.row(at.node + 1)).transpose().array();
}

float place_of(float cosine) {
  const double angle = std::acos(std::clamp(double(cosine), 0.0, 1.0));
  return static_cast<float>(angle * 2 / kPi<double> * (kNodes - 1));
}

/// A row's parts at the present tables.
struct Row {
  Weights difference, outgoing, incoming;
  double masking_o, masking_i;
  Eigen::Array3d color;

  Row(const BrdfRows::Place& place, const SmoothFactor& smooth)
      : difference(weigh(place.difference)),
        outgoing(weigh(place.outgoing)),
        incoming(weigh(place.incoming)),
        masking_o(interpolate(smooth.masking, outgoing)),
        masking_i(interpolate(smooth.masking, incoming)),
        color(interpolate(smooth.color, difference)) {}

  Eigen::Array3d model(float distribution, const SmoothFactor& smooth) const {
    return smooth.diffuse / kPi<double> + color * (double(distribution) * masking_o * masking_i);
  }
};

/// Calls add(pair index, sum) for all pairs, a sum a chunk, and adds the sums up in order.
template <class Sum, class Add>
Sum sum_over_pairs(size_t count, const Sum& zero, const Add& add) {
  std::vector<Sum> sums(kChunks, zero);
  tbb::parallel_for(size_t(0), kChunks, [&](size_t chunk) {
    for (size_t i = chunk * count / kChunks; i < (chunk + 1) * count / kChunks; ++i)
      add(i, sums[chunk]);
  });
  for (size_t chunk = 1; chunk < kChunks; ++chunk) sums[0] += sums[chunk];
  return sums[0];
}

/// Normal equations; several right sides may share a matrix.
struct Normal {
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd right;

  Normal(int unknowns, int sides)
      : matrix(Eigen::MatrixXd::Zero(unknowns, unknowns)),
        right(Eigen::MatrixXd::Zero(unknowns, sides)) {}
  Normal& operator+=(const Normal& other) {
    matrix += other.matrix;
    right += other.right;
    return *this;
  }
};

void add_smoothness(Normal& normal) {
  const double scale = kSmoothness * normal.matrix.diagonal().head(kNodes).mean();
  for (int i = 1; i + 1 < kNodes; ++i) {
    const Eigen::Vector3d second(1, -2, 1);
    normal.matrix.block<3, 3>(i - 1, i - 1) += scale * second * second.transpose();
  }
  normal.matrix.diagonal().array() += 1e-9 * scale + 1e-300;
}

/// Entries that come out negative are held at zero.
Eigen::VectorXd solve_held(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right) {
  std::vector<int> free(static_cast<size_t>(right.size()));
  for (size_t i = 0; i < free.size(); ++i) free[i] = static_cast<int>(i);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(right.size());
  while (!free.empty()) {
    const Eigen::MatrixXd sub = matrix(free, free);
    const Eigen::VectorXd solved = sub.ldlt().solve(right(free));
    std::vector<int> kept;
    for (size_t i = 0; i < free.size(); ++i)
      if (solved[static_cast<int>(i)] > 0) kept.push_back(free[i]);
    if (kept.size() == free.size()) {
      x(free) = solved;
      break;
    }
    free = kept;
  }
  return x;
}

/// The same with at most `most` as the last entry: beyond it, the others are solved beside it.
Eigen::VectorXd solve_bounded(const Normal& normal, int side, double most) {
  const Eigen::VectorXd right = normal.right.col(side);
  Eigen::VectorXd x = solve_held(normal.matrix, right);
  const Eigen::Index last = x.size() - 1;
  if (x[last] <= most) return x;
  x[last] = most;
  x.head(last) = solve_held(normal.matrix.topLeftCorner(last, last),
                            right.head(last) - most * normal.matrix.col(last).head(last));
  return x;
}

void improve_color(const BrdfRows& rows, const std::vector<float>& distribution,
                   SmoothFactor& smooth) {
  const Normal zero(kNodes + 1, 3);
  Normal normal = sum_over_pairs(rows.place.size(), zero, [&](size_t i, Normal& sum) {
    const BrdfPair& pair = rows.samples.pairs[i];
    const Row row(rows.place[i], smooth);
    const double weight2 = double(pair.weight) * double(pair.weight);
    const double specular = double(distribution[i]) * row.masking_o * row.masking_i;
    const int index[3] = {row.difference.node, row.difference.node + 1, kNodes};
    const double slope[3] = {specular * row.difference.low, specular * row.difference.high,
                             1 / kPi<double>};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) sum.matrix(index[a], index[b]) += weight2 * slope[a] * slope[b];
      for (int c = 0; c < 3; ++c)
        sum.right(index[a], c) += weight2 * slope[a] * double(pair.value[c]);
    }
  });
  add_smoothness(normal);
  for (int c = 0; c < 3; ++c) {
    const Eigen::VectorXd x = solve_bounded(normal, c, smooth.max_diffuse);
    smooth.color.col(c) = x.head(kNodes);
    smooth.diffuse[c] = x[kNodes];
  }
}

// The product of two values of the table, linear about the present ones.
void improve_masking(const BrdfRows& rows, const std::vector<float>& distribution,
                     SmoothFactor& smooth) {
  const Normal zero(kNodes, 1);
  Normal normal = sum_over_pairs(rows.place.size(), zero, [&](size_t i, Normal& sum) {
    const BrdfPair& pair = rows.samples.pairs[i];
    const Row row(rows.place[i], smooth);
    const double weight2 = double(pair.weight) * double(pair.weight);
    const Eigen::Array3d by_masking = double(distribution[i]) * row.color;
    const Eigen::Array3d value = pair.value.cast<double>() - smooth.diffuse / kPi<double> +
                                 by_masking * (row.masking_o * row.masking_i);
    const double square = weight2 * by_masking.square().sum();
    const double right = weight2 * (by_masking * value).sum();
    const int index[4] = {row.outgoing.node, row.outgoing.node + 1, row.incoming.node,
                          row.incoming.node + 1};
    const double slope[4] = {row.masking_i * row.outgoing.low, row.masking_i * row.outgoing.high,
                             row.masking_o * row.incoming.low, row.masking_o * row.incoming.high};
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) sum.matrix(index[a], index[b]) += square * slope[a] * slope[b];
      sum.right(index[a], 0) += right * slope[a];
    }
  });
  add_smoothness(normal);
  smooth.masking = solve_held(normal.matrix, normal.right.col(0));
}

}  // namespace

SmoothFactor initial_smooth_factor() {
  SmoothFactor smooth;
  smooth.color.setOnes(kNodes, 3);
  smooth.masking.resize(kNodes);
  for (int i = 0; i < kNodes; ++i)
    smooth.masking[i] = 1 / std::sqrt(std::max(std::cos(kPi<double> / 2 * i / (kNodes - 1)), 0.1));
  return smooth;
}

BrdfRows::BrdfRows(const BrdfSamples& all) : samples(all), place(all.pairs.size()) {
  for (size_t i = 0; i < place.size(); ++i) {
    const BrdfPair& pair = samples.pairs[i];
    place[i] = {place_of(pair.cos_difference), place_of(pair.outgoing.z()),
                place_of(pair.incoming.z())};
    norm2 += (double(pair.weight) * pair.value.cast<double>()).square().sum();
  }
}

void improve_smooth_factor(const BrdfRows& rows, const std::vector<float>& distribution,
                           SmoothFactor& smooth) {
  improve_color(rows, distribution, smooth);
  improve_masking(rows, distribution, smooth);
}

double relative_square(const BrdfRows& rows, const std::vector<float>& distribution,
                       const SmoothFactor& smooth) {
  const double sum = sum_over_pairs(rows.place.size(), 0.0, [&](size_t i, double& part) {
    const BrdfPair& pair = rows.samples.pairs[i];
    const Eigen::Array3d model = Row(rows.place[i], smooth).model(distribution[i], smooth);
    part += (double(pair.weight) * (model - pair.value.cast<double>())).square().sum();
  });
  return sum / rows.norm2;
}

double relative_root_square(const BrdfRows& rows, const std::vector<float>& distribution,
                            const SmoothFactor& smooth) {
  const Eigen::Array2d zero = Eigen::Array2d::Zero();  // of the residual, of the values
  const Eigen::Array2d sum =
      sum_over_pairs(rows.place.size(), zero, [&](size_t i, Eigen::Array2d& part) {
        const BrdfPair& pair = rows.samples.pairs[i];
        const Eigen::Array3d model = Row(rows.place[i], smooth).model(distribution[i], smooth);
        // weight^2 has cos^2, of which the root's square takes cos^(2/3)
        const double measure = double(pair.weight) * double(pair.weight) /
                               std::pow(double(pair.incoming.z()), 4.0 / 3);
        for (int c = 0; c < 3; ++c) {
          const double root = std::cbrt(double(pair.value[c]));
          const double difference = std::cbrt(model[c]) - root;
          part += measure * Eigen::Array2d(difference * difference, root * root);
        }
      });
  return sum[0] / sum[1];
}

CellTarget cell_target(const BrdfRows& rows, const SmoothFactor& smooth) {
  const BrdfSamples& samples = rows.samples;
  const auto cells = static_cast<size_t>(samples.grid.cells());
  CellTarget target{std::vector<double>(cells, 0), std::vector<double>(cells, 0)};
  tbb::parallel_for(size_t(0), cells, [&](size_t cell) {
    double along = 0, square = 0;
    for (size_t i = samples.begin[cell]; i < samples.begin[cell + 1]; ++i) {
      const BrdfPair& pair = samples.pairs[i];
      const Row row(rows.place[i], smooth);
      const Eigen::Array3d factor = row.color * (row.masking_o * row.masking_i);
      const double weight2 = double(pair.weight) * double(pair.weight);
      along +=
          weight2 * (factor * (pair.value.cast<double>() - smooth.diffuse / kPi<double>)).sum();
      square += weight2 * factor.square().sum();
    }
    target.weight[cell] = square;
    target.value[cell] = square > 0 ? std::max(along / square, 0.0) : 0;
  });
  return target;
}

}  // namespace burnish
