#pragma once

#include <vector>

#include "dense_products.h"

namespace burnish {

/// Mean of the rows (their centre is not looked at), summed in double.
Eigen::RowVectorXf mean_row(const CentredRows& rows);

/// Where data vary most.
struct PrincipalSubspace {
  RowMatrixf directions;           ///< [D][count], orthonormal columns, the largest first
  RowMatrixf coordinates;          ///< [rows][count], of the centred data
  std::vector<double> deviations;  ///< [count] rms of the data along each direction
};

/// Principal directions of rows whose centre is their mean. At most options.terms of them; none
/// when all rows are equal.
PrincipalSubspace find_principal_subspace(const CentredRows& rows, const PcaOptions& options,
                                          const PcaProgress& progress = {});

/// As train_pca, from rows whose centre is their mean.
PcaBasis train_pca(const CentredRows& rows, const PcaOptions& options,
                   const PcaProgress& progress = {});

}  // namespace burnish
