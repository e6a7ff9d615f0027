#pragma once

#include <vector>

#include <Eigen/Core>

namespace burnish {

/// Minimises |A x - b|^2 over x >= 0, given gram = A^T A (n x n) and rhs = A^T b. A column that
/// depends linearly on others in use stays 0. `passive` lists, rising, the entries in use.
Eigen::VectorXd solve_nonnegative(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                                  std::vector<int>& passive);

/// The same without the bounds. Of columns that nearly depend on each other the first are used.
Eigen::VectorXd solve_signed(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                             std::vector<int>& passive);

}  // namespace burnish
