// Every operator of the sphere at the product of extreme inputs, in float and in double. The test
// prints its table; docs/sphere-extremes.md keeps it (BURNISH_UPDATE=1 writes it anew).

#include "sphere/extremes.h"

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>

#include <gtest/gtest.h>

#include "burnish/sphere/circular_gaussian.h"

namespace burnish {
namespace {

using test::Claims;
using test::Row;

std::vector<Row> all_rows() {
  std::vector<Row> rows;
  for (const auto& family :
       {test::sg_rows(), test::asg_rows(), test::visibility_rows(), test::direction_rows()})
    rows.insert(rows.end(), family.begin(), family.end());
  return rows;
}

/// "| name | bound |", the part of a row that does not depend on the compiler.
std::string row_start(const Claims& claims) {
  std::ostringstream text;
  text.precision(2);
  text << "| " << claims.name << " | " << claims.float_bound << " | ";
  return text.str();
}

constexpr const char* kIntroduction = R"(# The sphere's operators at extreme inputs

Written by the test `SphereExtremes.*` with `BURNISH_UPDATE=1`. Inputs are all combinations of a width (sharpness or
larger bandwidth) in {0, least denormal, 1e-8, 1e-3, 1, 1e3, 1e8, largest finite}, a ratio of bandwidths in {1, 1 + ε,
10, 1e6}, the same of a second lobe, an angle in {0, ε, 1e-4, π/2, π/2 ± ε, π − ε, π}, an azimuth in {0, 0.7, π/2} and an
amplitude in {0, least denormal, 1, 1e30, −2}, as far as the operator has them, in a straight and in a turned world.
Every result is finite in float and in double, not negative where the quantity is not, and monotone in the angle where
the quantity is. The difference is |float − double| at equal inputs, over |double| or, where a result may be small, over
what it is a part of; tests/sphere/extremes_*.cpp say which. No difference is claimed where widths add up to more than
float holds, opposite to the axis of an anisotropic NASG, which has no limit there, and for bandwidths warped for a view
from behind, whose amplitude is 0. Where: narrow/wide bandwidth of the lobe, of the second lobe, and the rest.

| operator | bound | worst difference | cases | where |
|---|---|---|---|---|
)";

std::string page(const std::vector<Row>& rows) {
  std::ostringstream text;
  text.precision(2);
  text << kIntroduction;
  for (const Row& row : rows)
    text << row_start(row.claims) << row.findings.worst << " | " << row.findings.cases << " | "
         << row.findings.where << " |\n";
  return text.str();
}

const std::string kPage = std::string(BURNISH_SOURCE_DIR) + "/docs/sphere-extremes.md";

TEST(SphereExtremes, EveryOperatorIsSoundAndFloatAgreesWithDouble) {
  const std::vector<Row> rows = all_rows();
  std::cout << page(rows);
  if (std::getenv("BURNISH_UPDATE")) std::ofstream(kPage) << page(rows);
  std::ifstream in(kPage);
  const std::string kept{std::istreambuf_iterator<char>(in), {}};
  for (const Row& row : rows) {
    EXPECT_EQ(row.findings.first_fault, "") << row.claims.name;
    EXPECT_LE(row.findings.worst, row.claims.float_bound)
        << row.claims.name << " at " << row.findings.where;
    EXPECT_GE(row.findings.cases, 16u) << row.claims.name;  // eight widths, twice
    EXPECT_NE(kept.find(row_start(row.claims)), std::string::npos)
        << row.claims.name << " and its bound are not in " << kPage
        << ": run with BURNISH_UPDATE=1";
  }
}

template <class T>
class SphereExtremesOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(SphereExtremesOf, Scalars);

TYPED_TEST(SphereExtremesOf, WidthsOrderIntegralsMeansAndSupports) {
  using T = TypeParam;
  const T infinity = std::numeric_limits<T>::infinity();
  T integral_before = infinity, round_before = infinity, circle_before = infinity, mean_before = 0,
    support_before = infinity;
  T width_before = 0;
  for (const test::Extreme<T>& x : test::all_extremes<T>(0)) {
    if (x.narrow < width_before) break;  // widths rise, and begin anew in the turned world
    width_before = x.narrow;
    // Two results in their last place may change order.
    const T up = 1 + 4 * std::numeric_limits<T>::epsilon();
    const T whole = integral(test::asg(x)), round = integral(test::sg(x));
    const T circle = integral(CircularGaussian<T>{0, x.narrow, 1});
    const T mean = mean_cosine(x.narrow), angle = support(test::asg(x), T(0.1)).angle_x;
    EXPECT_LE(whole, integral_before * up) << x.narrow;
    EXPECT_LE(round, round_before * up) << x.narrow;
    EXPECT_LE(circle, circle_before * up) << x.narrow;
    EXPECT_GE(mean * up, mean_before) << x.narrow;
    EXPECT_LE(angle, support_before * up) << x.narrow;
    integral_before = whole;
    round_before = round;
    circle_before = circle;
    mean_before = mean;
    support_before = angle;
  }
}

}  // namespace
}  // namespace burnish
