#pragma once

#include <span>

#include "burnish/precompute/pca.h"

namespace burnish {

/// Mean of the rows, summed in double.
Eigen::RowVectorXf mean_row(const RowMatrixf& data);

/// Where data vary most.
struct PrincipalSubspace {
  RowMatrixf directions;           ///< [D][count], orthonormal columns, the largest first
  RowMatrixf coordinates;          ///< [rows][count], of the centred data
  std::vector<double> deviations;  ///< [count] rms of the data along each direction
};

/// Principal directions of the rows of `data`, less `centre` (their mean; empty when they are
/// centred already). At most options.terms of them; none when all rows are equal.
PrincipalSubspace find_principal_subspace(const RowMatrixf& data, std::span<const float> centre,
                                          const PcaOptions& options, const PcaProgress& progress);

/// The element of largest magnitude of each column (the first of equals) becomes positive.
void fix_signs(RowMatrixf& columns);

}  // namespace burnish
