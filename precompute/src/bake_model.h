#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "burnish/precompute/bake.h"
#include "burnish/precompute/clustered_pca.h"
#include "burnish/precompute/visibility_ladder.h"
#include "burnish/precompute/visibility_mask.h"
#include "byte_stream.h"

namespace burnish {

/// What is compressed of some vertices' visibility, a row each.
class VisibilityRows {
 public:
  void resize(std::size_t vertices, const BakeOptions& options);
  std::size_t size() const { return static_cast<std::size_t>(ssdfs_.rows()); }

  std::span<float> ssdf(std::size_t row);  ///< [resolution^2], radians, or encoded
  void count_coverage(const VisibilityMask& mask, std::size_t row);

  const RowMatrixf& ssdfs() const { return ssdfs_; }
  /// Of `count` rows from `first` on.
  std::span<const std::uint8_t> coverage(std::size_t first, std::size_t count) const;

 private:
  RowMatrixf ssdfs_;
  std::vector<std::uint8_t> coverage_;
  bool with_coverage_ = false;  // only a ladder needs it
};

class BakeModel;

/// The coefficients of a block of vertices.
struct BlockCoefficients {
  std::vector<float> ssdf, ladder;  ///< [vertices][terms]
  std::vector<std::uint8_t> basis_id;

  BlockCoefficients(std::size_t vertices, const BakeModel& model);
  void write(ByteWriter& to) const;
  void read(ByteReader& from);
};

/// The bases of a bake: of the SSDF and of the visibility ladder.
class BakeModel {
 public:
  struct Scratch {
    ClusteredProjector::Scratch ssdf;
    std::vector<double> squared_residuals;
  };

  /// `training` is encoded; `measured`, from which a target error is judged, is not. `step` hears
  /// how far it is.
  BakeModel(const VisibilityRows& training, const VisibilityRows& measured,
            const BakeOptions& options,
            const std::function<void(std::uint64_t done, std::uint64_t total)>& step,
            BakeTimings& timings);

  std::size_t terms() const { return static_cast<std::size_t>(projector_->terms()); }
  std::size_t ladder_terms() const {
    return ladders_.empty() ? 0 : static_cast<std::size_t>(ladders_[0].basis.terms);
  }

  /// Finds the errors on vertices with these rows (not encoded) and masks.
  void measure(const VisibilityRows& rows, std::span<const VisibilityMask> masks,
               Provenance& provenance);

  /// Coefficients of rows first.. of `rows` (encoded), as many as `result` has room for. One
  /// thread.
  void project(const VisibilityRows& rows, std::size_t first, BlockCoefficients& result,
               Scratch& scratch) const;

  /// A hash of all bases: equal for those that coefficients can be exchanged between.
  std::uint64_t fingerprint() const { return fingerprint_; }

  /// The bases, and where the ladder ends.
  void write_bases(Transfer& transfer) const;

 private:
  const BakeOptions& options_;
  std::vector<SsdfBasis> bases_;
  std::optional<ClusteredProjector> projector_;
  std::vector<VisibilityLadder> ladders_;  // none, or one
  float ladder_crossover_ = 0;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace burnish
