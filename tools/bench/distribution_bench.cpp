#include "distribution_bench.h"

#include <array>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "common/interrupt.h"
#include "harness/round_lobe_fit.h"

namespace burnish::tools {
namespace {

struct Exponents {
  double u, v;
};
constexpr std::array<Exponents, 3> kExponents = {{{8, 800}, {200, 22}, {20000, 200}}};
constexpr size_t kMostLobes = 41;

Material ashikhmin(const Exponents& exponents) {
  Material material;
  material.model = SpecularModel::ashikhmin_shirley;
  material.alpha_x = static_cast<float>(std::sqrt(2 / exponents.u));
  material.alpha_y = static_cast<float>(std::sqrt(2 / exponents.v));
  return material;
}

double lobe_error(const HalfVectorDistribution& distribution,
                  const AnisotropicGaussian<float>& lobe) {
  return relative_l2(distribution, [&](const Vector3<double>& half) {
    return static_cast<double>(eval(lobe, Vector3f(half.cast<float>())));
  });
}

/// The least number of SGs with at most this error.
std::string count_to_match(const std::array<double, kMostLobes>& errors, double error) {
  for (size_t n = 1; n <= kMostLobes; ++n)
    if (errors[n - 1] <= error) return std::to_string(n);
  return fmt::format("> {}", kMostLobes);
}

BenchRow measure(const Exponents& exponents) {
  const Material material = ashikhmin(exponents);
  const HalfVectorDistribution distribution = distribution_of(material);
  AnisotropicGaussian<float> paper;
  paper.bandwidth_x = 1 / (material.alpha_x * material.alpha_x);
  paper.bandwidth_y = 1 / (material.alpha_y * material.alpha_y);
  const double paper_error = lobe_error(distribution, paper);
  const double own_error = lobe_error(distribution, half_vector_lobes(material, 1).lobe[0]);
  std::array<double, kMostLobes> errors;
  tbb::parallel_for(size_t{0}, kMostLobes, [&](size_t n) {
    errors[n] = fit_round_lobes(distribution, static_cast<int>(n) + 1).relative_l2;
  });
  BenchRow row = {{"what", "distribution"}, {"model", "ashikhmin"}};
  row["n_u"] = exponents.u;
  row["n_v"] = exponents.v;
  row["asg_paper"] = paper_error;
  row["asg"] = own_error;
  for (const size_t n : {1, 3, 5, 13, 19}) row[fmt::format("{}_sg", n)] = errors[n - 1];
  row["sg_as_asg_paper"] = count_to_match(errors, paper_error);
  row["sg_as_asg"] = count_to_match(errors, own_error);
  return row;
}

}  // namespace

std::vector<BenchRow> measure_distributions() {
  std::vector<BenchRow> rows;
  for (const Exponents& exponents : kExponents) {
    throw_if_interrupted();
    rows.push_back(measure(exponents));
  }
  return rows;
}

}  // namespace burnish::tools
