// Based on: the active-set method of Lawson and Hanson (lawson1974least, ch. 23), on the normal
// equations: there are tens of unknowns and thousands of rows.
#include "light_fit/nonnegative_least_squares.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace burnish {
namespace {

Eigen::VectorXd solve_passive(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                              const std::vector<int>& passive) {
  const Eigen::MatrixXd sub = gram(passive, passive);
  return sub.llt().solve(rhs(passive));
}

// Whether column `next` is independent of those in use: the share of it that they leave over.
bool independent(const Eigen::MatrixXd& gram, const std::vector<int>& passive, int next,
                 double least_share) {
  if (!(gram(next, next) > 0)) return false;
  if (passive.empty()) return true;
  const Eigen::VectorXd cross = gram(passive, std::vector<int>{next});
  const Eigen::MatrixXd sub = gram(passive, passive);
  const double rest = gram(next, next) - cross.dot(sub.llt().solve(cross));
  return rest > least_share * gram(next, next);
}

// Where the Cholesky factor of a Gram matrix still holds.
constexpr double kLeastShare = 1e-10;
// Without bounds, lobes much alike would take huge colours of opposite sign: up to 1 / sqrt(this).
constexpr double kLeastSignedShare = 1e-3;

}  // namespace

Eigen::VectorXd solve_nonnegative(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                                  std::vector<int>& passive) {
  const int n = static_cast<int>(rhs.size());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<char> barred(n, 0);
  passive.clear();
  // Each pass lowers the error, so that no set comes twice; the bound is for rounding alone.
  for (int pass = 0; pass < 3 * n + 10; ++pass) {
    const Eigen::VectorXd gradient = rhs - gram * x;
    int next = -1;
    double steepest = 0;
    for (int i = 0; i < n; ++i) {
      if (barred[i] || std::binary_search(passive.begin(), passive.end(), i)) continue;
      // Relative to the column's and the right side's size: below it is rounding.
      if (!(gram(i, i) > 0) || gradient[i] <= 1e-12 * std::abs(rhs[i])) continue;
      const double slope = gradient[i] / std::sqrt(gram(i, i));
      if (slope > steepest) {
        steepest = slope;
        next = i;
      }
    }
    if (next < 0) break;
    if (!independent(gram, passive, next, kLeastShare)) {
      barred[next] = 1;
      continue;
    }
    passive.insert(std::lower_bound(passive.begin(), passive.end(), next), next);
    for (;;) {
      const Eigen::VectorXd wanted = solve_passive(gram, rhs, passive);
      double step = 1;
      int blocking = -1;
      for (size_t i = 0; i < passive.size(); ++i) {
        if (wanted[i] > 0) continue;
        const double current = x[passive[i]];
        const double allowed = current > 0 ? current / (current - wanted[i]) : 0;
        if (blocking < 0 || allowed < step) {
          step = allowed;
          blocking = static_cast<int>(i);
        }
      }
      for (size_t i = 0; i < passive.size(); ++i)
        x[passive[i]] += step * (wanted[i] - x[passive[i]]);
      if (blocking < 0) break;
      x[passive[blocking]] = 0;
      if (passive[blocking] == next) barred[next] = 1;
      passive.erase(passive.begin() + blocking);
      if (passive.empty()) break;
    }
  }
  return x;
}

Eigen::VectorXd solve_signed(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rhs,
                             std::vector<int>& passive) {
  passive.clear();
  for (int i = 0; i < rhs.size(); ++i)
    if (independent(gram, passive, i, kLeastSignedShare)) passive.push_back(i);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rhs.size());
  if (!passive.empty()) x(passive) = solve_passive(gram, rhs, passive);
  return x;
}

}  // namespace burnish
