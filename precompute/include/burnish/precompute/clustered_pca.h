#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "burnish/precompute/pca.h"

namespace burnish {

/// Dials of clustered PCA.
struct ClusteredPcaOptions {
  int terms =
      48;  ///< of each basis, at least 1; fewer come back where the data do not span as many
  /// 1..256 at most; 0: doubled from 1 up to 16 as long as that lowers the residual (rms) of every
  /// eighth row, not trained on, by a tenth or more. There are never more than one for each
  /// 2 * terms rows.
  int bases = 8;
  int restarts = 2;  ///< random starts, of which the one with the smallest residual wins
  std::uint64_t seed = 20110501;  ///< of the starts
};

/// Bases of equally many terms for the rows of `data` ([vertices][D], at least one row; not
/// centred), each best for those rows that it reconstructs best (sloan2003clustered). Rows are
/// grouped by Lloyd iterations in the data's principal subspace, from a k-means++ start
/// (arthur2007kmeans); the basis of a group is that of train_pca for its rows. Directions that a
/// group does not span are zero. Same bytes at any number of threads. Memory beyond the data's:
/// 80 MB for 16 bases of 48 terms at D = 128^2.
/// Throws Error for options out of range.
std::vector<PcaBasis> train_clustered_pca(const RowMatrixf& data,
                                          const ClusteredPcaOptions& options,
                                          const PcaProgress& progress = {});

/// Assigns vectors to bases, and gives their coefficients.
class ClusteredProjector {
 public:
  /// Copies the bases: 1..256, equal in size. Throws Error when they are not.
  explicit ClusteredProjector(std::span<const PcaBasis> bases);
  ~ClusteredProjector();
  ClusteredProjector(ClusteredProjector&&) noexcept;
  ClusteredProjector& operator=(ClusteredProjector&&) noexcept;

  /// Memory to be reused from one call to the next; one a thread.
  struct Scratch {
    RowMatrixf products;
    std::vector<double> squared_norms;
  };

  /// For each row of `rows` ([vertices][D], not centred) the basis that reconstructs it best (the
  /// first of equals), its coefficients there, [vertices][terms], and the squared distance of the
  /// reconstruction (float rounding: 1e-6 of the row's squared distance from the bases' mean).
  /// One thread, thread-safe; a row's result does not depend on the other rows.
  void project(const Eigen::Ref<const RowMatrixf>& rows, std::span<float> coefficients,
               std::span<std::uint8_t> basis_id, std::span<double> squared_residuals,
               Scratch& scratch) const;

  Eigen::Index terms() const;
  Eigen::Index size() const;  ///< D

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace burnish
