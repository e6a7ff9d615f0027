#include "burnish/precompute/clustered_pca.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "pca_subspace.h"

// Based on: sloan2003clustered, with two differences. Groups are formed in the principal subspace
// of some of the columns, where covariances are small; only the final bases come from the rows
// themselves. And the start is k-means++ (arthur2007kmeans). On SSDFs, groups formed in 96 or in
// 256 dimensions, or from a ninth of the columns, differ in their held-out error by less than two
// starts do.

namespace burnish {
namespace {

using Eigen::Index;

constexpr int kSubspace = 96;     // directions in which groups are formed
constexpr Index kColumns = 2048;  // from about as many columns, where there are more
constexpr int kMostGroupTerms =
    64;  // for which they are formed: more would leave nothing to compare
constexpr int kMostIterations = 30;
constexpr double kStop = 0.9995;  // of the squared residual: two starts differ by more
constexpr int kMostAutoBases = 16;
constexpr Index kBlock = 96;  // rows that are assigned together

using Group = std::vector<std::uint32_t>;  // numbers of rows, rising

struct Assignment {
  std::vector<std::uint8_t> id;
  double squared_residual = 0;  // of all rows
};

Assignment assign(const std::vector<PcaBasis>& bases, const RowMatrixf& rows) {
  const ClusteredProjector projector(bases);
  const auto count = static_cast<std::size_t>(rows.rows());
  const auto terms = static_cast<std::size_t>(projector.terms());
  Assignment result{std::vector<std::uint8_t>(count)};
  std::vector<double> residuals(count);
  tbb::parallel_for(Index{0}, (rows.rows() + kBlock - 1) / kBlock, [&](Index i) {
    const Index first = i * kBlock, size = std::min(kBlock, rows.rows() - first);
    const auto begin = static_cast<std::size_t>(first), n = static_cast<std::size_t>(size);
    ClusteredProjector::Scratch scratch;
    std::vector<float> coefficients(n * terms);
    projector.project(rows.middleRows(first, size), coefficients,
                      std::span(result.id).subspan(begin, n),
                      std::span(residuals).subspan(begin, n), scratch);
  });
  result.squared_residual = std::accumulate(residuals.begin(), residuals.end(), 0.0);
  return result;
}

std::vector<Group> groups_of(const std::vector<std::uint8_t>& id, int bases) {
  std::vector<Group> groups(static_cast<std::size_t>(bases));
  for (std::uint32_t row = 0; row < id.size(); ++row) groups[id[row]].push_back(row);
  return groups;
}

// Some of the columns, evenly spread. Every odd one: images of even width are met in all columns.
RowMatrixf thin_out(const RowMatrixf& data) {
  const Index step = std::max<Index>(1, data.cols() / kColumns) | 1;
  RowMatrixf thin(data.rows(), (data.cols() + step - 1) / step);
  tbb::parallel_for(Index{0}, data.rows(), [&](Index row) {
    for (Index i = 0; i < thin.cols(); ++i) thin(row, i) = data(row, i * step);
  });
  return thin;
}

// The principal directions of a group, from its covariance; `terms` of them, of size 0 or not.
PcaBasis fit_group(const RowMatrixf& rows, const Group& group, Index terms) {
  PcaBasis basis;
  basis.mean = mean_row({rows, {}, group});
  RowMatrixf centred(static_cast<Index>(group.size()), rows.cols());
  for (std::size_t i = 0; i < group.size(); ++i)
    centred.row(static_cast<Index>(i)) = rows.row(group[i]) - basis.mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      multiply_transposed({centred}, PackedFactor(centred)).cast<double>());
  basis.components = eigen.eigenvectors().rowwise().reverse().leftCols(terms).cast<float>();
  return basis;
}

// A number in [0, 1), the same with every standard library.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

// Each row with the nearest of some rows that are chosen with a probability proportional to the
// squared distance from those chosen before (arthur2007kmeans).
std::vector<std::uint8_t> spread_start(const RowMatrixf& rows, int bases, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto count = static_cast<std::size_t>(rows.rows());
  std::vector<double> squared(count, std::numeric_limits<double>::infinity());
  std::vector<std::uint8_t> id(count);
  auto centre = static_cast<Index>(uniform(random) * static_cast<double>(count));
  for (int basis = 0; basis < bases; ++basis) {
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double distance =
          static_cast<double>((rows.row(static_cast<Index>(i)) - rows.row(centre)).squaredNorm());
      if (distance < squared[i]) {
        squared[i] = distance;
        id[i] = static_cast<std::uint8_t>(basis);
      }
      sum += squared[i];
    }
    if (sum == 0) break;  // no row differs from those chosen
    double target = uniform(random) * sum;
    centre = -1;
    for (std::size_t i = 0; i < count; ++i) {
      if (squared[i] == 0) continue;
      centre = static_cast<Index>(i);
      target -= squared[i];
      if (target < 0) break;
    }
  }
  return id;
}

// Alternates between the best basis of each group and the best group of each row, until that hardly
// lowers the residual. A group of too few rows to have a basis of its own is dissolved.
std::vector<PcaBasis> improve(const RowMatrixf& rows, Index terms, int bases,
                              std::vector<std::uint8_t> start, Assignment& assignment) {
  assignment.id = std::move(start);
  std::vector<PcaBasis> fitted;
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    std::vector<Group> groups = groups_of(assignment.id, bases);
    const auto is_small = [&](const Group& group) {
      return static_cast<Index>(group.size()) <= terms;
    };
    const bool dissolved = std::erase_if(groups, is_small) > 0;
    if (groups.empty()) {
      groups.emplace_back(static_cast<std::size_t>(rows.rows()));
      std::iota(groups[0].begin(), groups[0].end(), 0u);
    }
    bases = static_cast<int>(groups.size());
    fitted.resize(groups.size());
    tbb::parallel_for(std::size_t{0}, groups.size(),
                      [&](std::size_t i) { fitted[i] = fit_group(rows, groups[i], terms); });
    const double before =
        iteration > 0 ? assignment.squared_residual : std::numeric_limits<double>::infinity();
    assignment = assign(fitted, rows);
    if (bases == 1 || (!dissolved && assignment.squared_residual >= kStop * before)) break;
  }
  return fitted;
}

// The best of some starts.
std::vector<PcaBasis> form_groups(const RowMatrixf& rows, Index terms, int bases,
                                  const ClusteredPcaOptions& options, Assignment& assignment,
                                  const std::function<void()>& report = {}) {
  std::vector<PcaBasis> best;
  for (int restart = 0; restart < options.restarts; ++restart) {
    Assignment candidate;
    std::vector<PcaBasis> fitted = improve(
        rows, terms, bases,
        spread_start(rows, bases, options.seed + static_cast<std::uint64_t>(restart)), candidate);
    if (restart == 0 || candidate.squared_residual < assignment.squared_residual) {
      best = std::move(fitted);
      assignment = std::move(candidate);
    }
    if (report) report();
  }
  return best;
}

// See ClusteredPcaOptions::bases.
int choose_bases(const RowMatrixf& rows, Index terms, int most,
                 const ClusteredPcaOptions& options) {
  RowMatrixf trained(rows.rows() - rows.rows() / 8, rows.cols());
  RowMatrixf held_out(rows.rows() / 8, rows.cols());
  for (Index i = 0, t = 0, h = 0; i < rows.rows(); ++i)
    (i % 8 == 7 ? held_out.row(h++) : trained.row(t++)) = rows.row(i);
  // Below a thousandth of the vectors' own size there is nothing left to gain.
  const double enough = 1e-6 * held_out.cast<double>().squaredNorm();
  int chosen = 1;
  double least = std::numeric_limits<double>::infinity();
  for (int bases = 1; bases <= most && least > enough; bases *= 2) {
    Assignment assignment;
    const double squared =
        assign(form_groups(trained, terms, bases, options, assignment), held_out).squared_residual;
    if (!(squared < 0.9 * 0.9 * least)) break;
    least = squared;
    chosen = bases;
  }
  return chosen;
}

std::span<const float> span_of(const Eigen::RowVectorXf& row) {
  return {row.data(), static_cast<std::size_t>(row.size())};
}

// Bases of equal size: a direction that is missing becomes zero.
void fill_up(std::vector<PcaBasis>& bases) {
  Index terms = 0;
  for (const PcaBasis& basis : bases) terms = std::max(terms, basis.terms());
  for (PcaBasis& basis : bases) {
    const Index own = basis.terms();
    basis.components.conservativeResize(Eigen::NoChange, terms);
    basis.components.rightCols(terms - own).setZero();
    basis.deviations.resize(static_cast<std::size_t>(terms), 0.0);
  }
}

void check(const RowMatrixf& data, const ClusteredPcaOptions& options) {
  const auto refuse = [](const char* name, auto value, const char* expected) {
    throw Error(ErrorKind::input, "clustered PCA",
                fmt::format("{} is {}, expected {}", name, value, expected));
  };
  if (data.rows() < 1) refuse("rows", data.rows(), "at least 1");
  if (options.terms < 1) refuse("terms", options.terms, "at least 1");
  if (options.bases < 0 || options.bases > 256) refuse("bases", options.bases, "0..256");
  if (options.restarts < 1) refuse("restarts", options.restarts, "at least 1");
}

}  // namespace

std::vector<PcaBasis> train_clustered_pca(const RowMatrixf& data,
                                          const ClusteredPcaOptions& options,
                                          const PcaProgress& progress) {
  check(data, options);
  const PcaOptions basis_options{.terms = options.terms, .iterations = 2, .seed = options.seed};
  const auto train_one = [&](const PcaProgress& told) {
    const Eigen::RowVectorXf mean = mean_row({data});
    return std::vector<PcaBasis>{train_pca({data, span_of(mean)}, basis_options, told)};
  };
  const auto most = static_cast<int>(
      std::max<Index>(1, std::min<Index>(options.bases == 0 ? kMostAutoBases : options.bases,
                                         data.rows() / (2 * Index{options.terms}))));
  if (most == 1) return train_one(progress);

  // Passes of the subspace, starts, and bases.
  const PcaOptions subspace_options{.terms = kSubspace, .iterations = 1, .seed = options.seed};
  const int total = subspace_options.iterations + 2 + options.restarts + most;
  int done = 0;
  const auto report = [&] {
    if (progress) progress(done, total);
  };
  report();
  const RowMatrixf rows = [&] {
    const RowMatrixf thin = thin_out(data);
    const Eigen::RowVectorXf thin_mean = mean_row({thin});
    return find_principal_subspace({thin, span_of(thin_mean)}, subspace_options,
                                   [&](int pass, int) {
                                     if (pass == 0) return;
                                     done = pass;
                                     report();
                                   })
        .coordinates;
  }();
  const Index terms = std::min<Index>({options.terms, kMostGroupTerms, rows.cols()});
  if (terms == 0) return train_one({});  // all rows are equal

  const int bases = options.bases == 0 ? choose_bases(rows, terms, most, options) : most;
  Assignment assignment;
  const auto advance = [&] {
    ++done;
    report();
  };
  const std::vector<PcaBasis> fitted =
      form_groups(rows, terms, bases, options, assignment, advance);
  std::vector<PcaBasis> result;
  for (const Group& group : groups_of(assignment.id, static_cast<int>(fitted.size()))) {
    if (group.empty()) continue;
    const Eigen::RowVectorXf group_mean = mean_row({data, {}, group});
    result.push_back(train_pca({data, span_of(group_mean), group}, basis_options));
    advance();
  }
  fill_up(result);
  if (done < total) {
    done = total;
    report();
  }
  return result;
}

// All bases as one right-hand factor: for each its directions and, last, its mean, relative to the
// mean of all means. With x and m relative to that,
//   coefficients c = directions^T x - directions^T m,   residual = |x|^2 - 2 m.x + |m|^2 - |c|^2.
struct ClusteredProjector::Impl {
  Index terms = 0;
  Eigen::RowVectorXf centre;
  RowMatrixf offsets;  // [bases][terms] directions^T m
  std::vector<double> squared_means;
  PackedFactor factor;
};

ClusteredProjector::ClusteredProjector(std::span<const PcaBasis> bases) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::input, "clustered PCA", what);
  };
  if (bases.empty() || bases.size() > 256)
    refuse(fmt::format("there are {} bases, expected 1..256", bases.size()));
  const Index terms = bases[0].terms(), size = bases[0].mean.size();
  for (const PcaBasis& basis : bases)
    if (basis.terms() != terms || basis.mean.size() != size || basis.components.rows() != size)
      refuse("bases differ in size, expected equal ones");

  Impl impl;
  impl.terms = terms;
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(size);
  for (const PcaBasis& basis : bases) sum += basis.mean.cast<double>();
  impl.centre = (sum / static_cast<double>(bases.size())).cast<float>();
  const auto count = static_cast<Index>(bases.size());
  impl.offsets.resize(count, terms);
  RowMatrixf all(size, count * (terms + 1));
  for (Index i = 0; i < count; ++i) {
    const PcaBasis& basis = bases[static_cast<std::size_t>(i)];
    const Eigen::RowVectorXf mean = basis.mean - impl.centre;
    all.middleCols(i * (terms + 1), terms) = basis.components;
    all.col(i * (terms + 1) + terms) = mean.transpose();
    impl.offsets.row(i) = (mean.cast<double>() * basis.components.cast<double>()).cast<float>();
    impl.squared_means.push_back(mean.cast<double>().squaredNorm());
  }
  impl.factor = PackedFactor(all);
  impl_ = std::make_unique<const Impl>(std::move(impl));
}

ClusteredProjector::~ClusteredProjector() = default;
ClusteredProjector::ClusteredProjector(ClusteredProjector&&) noexcept = default;
ClusteredProjector& ClusteredProjector::operator=(ClusteredProjector&&) noexcept = default;

Index ClusteredProjector::terms() const { return impl_->terms; }
Index ClusteredProjector::size() const { return impl_->centre.size(); }

void ClusteredProjector::project(const Eigen::Ref<const RowMatrixf>& rows,
                                 std::span<float> coefficients, std::span<std::uint8_t> basis_id,
                                 std::span<double> squared_residuals, Scratch& scratch) const {
  const Index terms = impl_->terms, bases = impl_->offsets.rows();
  scratch.products.resize(rows.rows(), impl_->factor.columns());
  scratch.squared_norms.resize(static_cast<std::size_t>(rows.rows()));
  multiply_here(rows, span_of(impl_->centre), impl_->factor, scratch.products,
                scratch.squared_norms);
  Eigen::RowVectorXf candidate(terms);
  for (Index row = 0; row < rows.rows(); ++row) {
    const auto i = static_cast<std::size_t>(row);
    double least = std::numeric_limits<double>::infinity();
    for (Index basis = 0; basis < bases; ++basis) {
      const auto product = scratch.products.row(row).segment(basis * (terms + 1), terms + 1);
      candidate = product.head(terms) - impl_->offsets.row(basis);
      const double residual = scratch.squared_norms[i] - 2 * static_cast<double>(product[terms]) +
                              impl_->squared_means[static_cast<std::size_t>(basis)] -
                              candidate.cast<double>().squaredNorm();
      if (!(residual < least)) continue;
      least = residual;
      basis_id[i] = static_cast<std::uint8_t>(basis);
      Eigen::Map<Eigen::RowVectorXf>(coefficients.data() + row * terms, terms) = candidate;
    }
    squared_residuals[i] = std::max(least, 0.0);  // rounding may take it below
  }
}

}  // namespace burnish
