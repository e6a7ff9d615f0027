#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace burnish {

/// Vectors as rows.
using RowMatrixf = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A mean and orthonormal directions around it, the one of largest variance first.
struct PcaBasis {
  Eigen::RowVectorXf mean;         ///< [D]
  RowMatrixf components;           ///< [D][terms]: column k is direction k
  std::vector<double> deviations;  ///< [terms] rms of the training data along each direction
  Eigen::Index terms() const { return components.cols(); }
};

/// Dials of the randomized decomposition.
struct PcaOptions {
  int terms = 48;                 ///< at least 1
  int oversampling = 16;          ///< further directions that are followed and then dropped
  int iterations = 3;             ///< power iterations
  std::uint64_t seed = 20110501;  ///< of the random start
};

/// Called between passes over the data: how many are done, of how many.
using PcaProgress = std::function<void(int done, int total)>;

/// Principal components of the rows of `data` ([vectors][D], at least one row), by subspace
/// iteration from a random start (halko2011randomized, Algorithms 4.4 and 5.1). `data` is centred
/// in place: the mean is subtracted. Same bytes at any number of threads.
///
/// Fewer components than asked for come back when the data do not span as many: those along which
/// it deviates by less than float rounding of the data are dropped. At least one comes back; when
/// all rows are equal it is zero. The component of largest magnitude in each direction is positive.
PcaBasis train_pca(RowMatrixf& data, const PcaOptions& options, const PcaProgress& progress = {});

}  // namespace burnish
