// The batch forms of values, integrals and visible fractions, and what holds for all of them.

#include <functional>

#include "burnish/sphere/asg_convolution.h"
#include "burnish/sphere/asg_product.h"
#include "sphere/batch_support.h"

namespace burnish::test {
namespace {

std::vector<std::string> sets() {
  const auto views = batch::instruction_sets();
  return {views.begin(), views.end()};
}
INSTANTIATE_TEST_SUITE_P(On, Batch, testing::ValuesIn(sets()),
                         [](const auto& info) { return info.param; });

TEST_P(Batch, ExpMatchesTheStandardLibrary) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-84.9f, 88);
  std::vector<float> x = {0, -0.0f, kDenormal, -kDenormal, 1e-8f, -1e-8f, 88, -84.9f};
  for (int i = 0; i < 20000; ++i) x.push_back(uniform(random));
  std::vector<float> results(x.size());
  batch::exp(x, results);
  double worst = 0;
  for (size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, std::abs(results[i] / std::exp(double(x[i])) - 1));
  // A last place is 2^-23 = 1.2e-7; the polynomial, the reduced argument and the result each round.
  EXPECT_LT(worst, 2e-7);
  const std::vector<float> far = {-85.1f, -1e4f, -kMax, -std::numeric_limits<float>::infinity()};
  std::vector<float> zeros(far.size(), 1);
  batch::exp(far, zeros);
  for (const float value : zeros) EXPECT_EQ(value, 0);
}

TEST_P(Batch, SphericalGaussianMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const float sharpness : magnitudes(20, random)) {
    const Vector3d axis = random_direction(random);
    const SphericalGaussian<float> lobe = {axis.cast<float>(), sharpness, 3};
    const DirectionArrays directions = directions_around(axis, 50, random);
    std::vector<float> results(directions.x.size());
    batch::eval(lobe, directions.spans(), results);
    for (size_t i = 0; i < results.size(); ++i) {
      const Vector3d v = directions.at(i).cast<double>(), p = lobe.axis.cast<double>();
      const double exponent = double(sharpness) / 2 * (v - p).squaredNorm();
      // Three roundings in the square of each difference, and those of exp; 0 below its range.
      const double bound = 3 * std::exp(-exponent) * (3e-7 + 4e-7 * exponent) + 3 * 1.4e-37;
      ASSERT_NEAR(results[i], 3 * std::exp(-exponent), bound) << sharpness << ", seed " << kSeed;
    }
  }
}

TEST_P(Batch, AnisotropicGaussianMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  for (const float bandwidth_x : magnitudes(10, random)) {
    for (const float bandwidth_y : kExtremes) {
      const Vector3d axis = random_direction(random);
      const AnisotropicGaussian<float> lobe = {random_frame(axis, random).cast<float>(),
                                               bandwidth_x, bandwidth_y, -2};
      const DirectionArrays directions = directions_around(axis, 20, random);
      std::vector<float> results(directions.x.size());
      batch::eval(lobe, directions.spans(), results);
      for (size_t i = 0; i < results.size(); ++i) {
        const auto [value, bound] = asg_and_bound(lobe, directions.at(i));
        ASSERT_NEAR(results[i], value, bound)
            << bandwidth_x << " " << bandwidth_y << ", seed " << kSeed;
      }
    }
  }
}

TEST_P(Batch, ManyLobesAreTheSameAsOneByOne) {
  std::mt19937 random(kSeed);
  DirectionArrays directions;
  for (int i = 0; i < 1500; ++i) directions.add(random_direction(random));
  const size_t size = directions.x.size();
  std::vector<AnisotropicGaussian<float>> asgs(3);
  std::vector<SphericalGaussian<float>> sgs(3);
  for (size_t l = 0; l < 3; ++l) {
    const Vector3d axis = random_direction(random);
    asgs[l] = {random_frame(axis, random).cast<float>(), 20, float(l), 1};
    sgs[l] = {axis.cast<float>(), float(l), 1};
  }
  std::vector<float> all(3 * size), one(size);
  batch::eval(asgs, directions.spans(), all);
  for (size_t l = 0; l < 3; ++l) {
    batch::eval(asgs[l], directions.spans(), one);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + l * size));
  }
  batch::eval(sgs, directions.spans(), all);
  for (size_t l = 0; l < 3; ++l) {
    batch::eval(sgs[l], directions.spans(), one);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + l * size));
  }
}

TEST_P(Batch, AsgIntegralMatchesTheExactFormInDouble) {
  std::mt19937 random(kSeed);
  std::vector<float> bx, by;
  for (const float x : magnitudes(40, random)) {
    for (const float y : magnitudes(10, random)) {
      bx.push_back(x);
      by.push_back(y);
    }
    for (const float ratio : {1.0f, 1 + 1e-7f, 10.0f, 1e6f}) {
      bx.push_back(x);
      by.push_back(x / ratio);
    }
  }
  std::vector<float> exact(bx.size()), fast(bx.size());
  batch::asg_integral(bx, by, AsgIntegral::exact, exact);
  batch::asg_integral(bx, by, AsgIntegral::fast, fast);
  for (size_t i = 0; i < bx.size(); ++i) {
    const double truth = asg_integral_exact(double(bx[i]), double(by[i]));
    // The polynomial errs by 4e-7; a dozen roundings of terms that hardly cancel.
    ASSERT_NEAR(exact[i] / truth, 1, 1e-6) << bx[i] << " " << by[i] << ", seed " << kSeed;
    const double quick = asg_integral_fast(double(bx[i]), double(by[i]));
    ASSERT_NEAR(fast[i] / quick, 1, 4e-7) << bx[i] << " " << by[i];
  }
}

/// Runs a visibility fraction over widths and distances; compares with the scalar form in double.
void expect_fractions(const std::function<void(std::span<const float>, std::span<const float>,
                                               std::span<float>)>& subject,
                      const std::function<double(double, double)>& scalar) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-1.6f, 1.6f);
  std::vector<float> widths, distances;
  for (const float width : magnitudes(300, random)) {
    for (float distance : {0.0f, 1e-7f, 1e-4f, 1.57079f, 1.5708f, 3.14159f, uniform(random),
                           uniform(random), uniform(random) / std::sqrt(1 + width)}) {
      for (const float sign : {1.0f, -1.0f}) {
        widths.push_back(width);
        distances.push_back(sign * distance);
      }
    }
  }
  std::vector<float> results(widths.size());
  subject(widths, distances, results);
  for (size_t i = 0; i < widths.size(); ++i) {
    const double truth = scalar(widths[i], distances[i]);
    ASSERT_NEAR(results[i], truth, 1e-6) << widths[i] << " " << distances[i] << ", seed " << kSeed;
    // The tail's exponent is at most 81; five roundings of its root.
    if (distances[i] < 0 && distances[i] > -1.5f && truth > 1e-35) {
      ASSERT_NEAR(results[i] / truth, 1, 81 * 2 * 5 * 6e-8 + 1e-6)
          << widths[i] << " " << distances[i] << ", seed " << kSeed;
    }
  }
}

TEST_P(Batch, DirectionalMatchesTheScalarForm) {
  expect_fractions(
      [](auto widths, auto distances, auto results) {
        batch::visible_fraction_directional(widths, distances, results);
      },
      [](double width, double distance) { return visible_fraction_directional(width, distance); });
}

TEST_P(Batch, HemisphereMatchesTheScalarForm) {
  expect_fractions(
      [](auto widths, auto distances, auto results) {
        batch::visible_fraction_hemisphere(widths, distances, results);
      },
      [](double width, double distance) { return visible_fraction_hemisphere(width, distance); });
}

TEST_P(Batch, HemisphereOfOneLobeIsThatOfManyEqualOnes) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> angle(-1.7f, 1.7f);
  std::vector<float> distances(257);
  for (float& distance : distances) distance = angle(random);
  for (const float sharpness : {0.0f, 1e-3f, 2.0f, 60.0f, 5e3f, kMax}) {
    std::vector<float> one(distances.size()), many(distances.size());
    batch::visible_fraction_hemisphere(sharpness, distances, one);
    batch::visible_fraction_hemisphere(std::vector<float>(distances.size(), sharpness), distances,
                                       many);
    for (size_t i = 0; i < one.size(); ++i)
      EXPECT_NEAR(one[i], many[i], 1.2e-7) << sharpness << " " << distances[i];
  }
}

TEST_P(Batch, ExactHemisphereMatchesTheScalarForm) {
  expect_fractions(
      [](auto widths, auto distances, auto results) {
        batch::visible_fraction_hemisphere(widths, distances, results, HemisphereLevel::exact);
      },
      [](double width, double distance) {
        return visible_fraction_hemisphere(width, distance, HemisphereLevel::exact);
      });
}

TEST_P(Batch, OctahedralMapMatchesTheScalarForm) {
  std::mt19937 random(kSeed);
  DirectionArrays directions;
  for (int i = 0; i < 3000; ++i) directions.add(random_direction(random));
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1)}) {
    directions.add(axis);
    directions.add(-axis);
    for (int i = 0; i < 30; ++i)
      directions.add((axis + random_direction(random) * std::pow(10.0, -i)).normalized());
  }
  for (const double x : {1.0, -1.0})
    for (const double y : {1.0, -1.0}) directions.add(Vector3d(x, y, 0).normalized());
  std::vector<float> u(directions.x.size()), v(directions.x.size());
  batch::direction_to_octahedral(directions.spans(), u, v);
  for (size_t i = 0; i < u.size(); ++i) {
    const Vector2<double> truth =
        direction_to_octahedral(Vector3d(directions.at(i).cast<double>()));
    // Three roundings of numbers of at most 1; both are halved.
    ASSERT_NEAR(u[i], truth.x(), 2e-7) << directions.at(i).transpose() << ", seed " << kSeed;
    ASSERT_NEAR(v[i], truth.y(), 2e-7) << directions.at(i).transpose() << ", seed " << kSeed;
  }
}

/// Calls on lengths 0..40, from unaligned starts: each element the same as in one long call, and
/// what surrounds the results untouched.
TEST_P(Batch, AnyLengthAndAlignmentGivesTheSame) {
  std::mt19937 random(kSeed);
  std::vector<float> a(64), b(64), c(64), whole(64);
  for (size_t i = 0; i < 64; ++i) {
    const Vector3d v = random_direction(random);
    a[i] = float(std::abs(v.x()));
    b[i] = float(std::abs(v.y()));
    c[i] = float(v.z());
  }
  const AnisotropicGaussian<float> asg = {{}, 5, 2, 1};
  const SphericalGaussian<float> sg;
  const LobeMoments<float> moments = asg_moments(5.0f, 2.0f);
  const LobeShape<float> shape = make_lobe_shape(20.0f, 80.0f);
  const PreparedClampedCosine<float> prepared = prepare_clamped_cosine(sg);
  using Span = std::span<const float>;
  using Call = std::function<void(Span, Span, Span, std::span<float>)>;
  std::vector<std::pair<const char*, Call>> calls = {
      {"exp", [](Span, Span, Span z, auto out) { batch::exp(z, out); }},
      {"sg",
       [&](Span x, Span y, Span z, auto out) {
         batch::eval(sg, {x, y, z}, out);
       }},
      {"asg",
       [&](Span x, Span y, Span z, auto out) {
         batch::eval(asg, {x, y, z}, out);
       }},
      {"fast integral",
       [](Span x, Span y, Span, auto out) { batch::asg_integral(x, y, AsgIntegral::fast, out); }},
      {"exact integral",
       [](Span x, Span y, Span, auto out) { batch::asg_integral(x, y, AsgIntegral::exact, out); }},
      {"directional",
       [](Span x, Span, Span z, auto out) { batch::visible_fraction_directional(x, z, out); }},
      {"hemisphere",
       [](Span x, Span, Span z, auto out) { batch::visible_fraction_hemisphere(x, z, out); }},
      {"exact hemisphere",
       [](Span x, Span, Span z, auto out) {
         batch::visible_fraction_hemisphere(x, z, out, HemisphereLevel::exact);
       }},
      {"SG integral", [](Span x, Span, Span, auto out) { batch::sg_integral(x, out); }},
      {"SG inner product",
       [&](Span x, Span y, Span z, auto out) {
         batch::inner_product(sg, {{x, y, z}, x, y}, out);
       }},
      {"pairs",
       [&](Span x, Span y, Span z, auto out) {
         batch::eval({{x, y, z}, {y, x, z}, x, y, y}, {x, y, z}, out);
       }},
      {"ASG inner product",
       [&](Span x, Span y, Span z, auto out) {
         batch::inner_product(asg, {{x, y, z}, {y, x, z}, x, y, y}, out);
       }},
      {"dot",
       [&](Span x, Span y, Span z, auto out) {
         batch::dot(Vector3f(1, 2, 3), {x, y, z}, out);
       }},
      {"directional bandwidth",
       [&](Span x, Span y, Span z, auto out) { batch::directional_bandwidth(x, y, z, x, out); }},
      {"clamped cosine",
       [&](Span x, Span y, Span z, auto out) {
         batch::mean_clamped_cosine(moments, Frame<float>(), {x, y, z}, out);
       }},
      {"clamped cosine of an SG",
       [&](Span x, Span y, Span z, auto out) {
         batch::clamped_cosine_integral(prepared, {x, y, z}, out);
       }},
      {"octahedral u",
       [&](Span x, Span y, Span z, auto out) {
         std::vector<float> v(out.size());
         batch::direction_to_octahedral({x, y, z}, out, v);
       }},
      {"octahedral v",
       [&](Span x, Span y, Span z, auto out) {
         std::vector<float> u(out.size());
         batch::direction_to_octahedral({x, y, z}, u, out);
       }},
  };
  // Of those with several results, each in its turn; the others are of the exact length.
  for (int result = 0; result < 3; ++result) {
    calls.push_back({"convolution", [result](Span x, Span y, Span, auto out) {
                       std::vector<float> rest[3];
                       for (auto& array : rest) array.resize(out.size());
                       std::span<float> all[3] = {rest[0], rest[1], rest[2]};
                       all[result] = out;
                       batch::convolve(x, y, 3, {all[0], all[1], all[2]});
                     }});
    calls.push_back({"convolution with each", [result](Span x, Span y, Span, auto out) {
                       std::vector<float> rest[3];
                       for (auto& array : rest) array.resize(out.size());
                       std::span<float> all[3] = {rest[0], rest[1], rest[2]};
                       all[result] = out;
                       batch::convolve(x, y, y, {all[0], all[1], all[2]});
                     }});
  }
  for (int result = 0; result < 10; ++result) {
    const auto with_results = [result](std::span<float> out, auto call) {
      WarpedArrays rest(out.size());
      std::vector<std::span<float>> all(rest.all.begin(), rest.all.end());
      all[result] = out;
      call({{all[0], all[1], all[2]}, {all[3], all[4], all[5]}, all[6], all[7], all[8], all[9]});
    };
    calls.push_back({"warp", [=](Span x, Span y, Span z, auto out) {
                       with_results(out, [&](const batch::WarpedLobes& all) {
                         batch::warp_to_incoming(5, 2, {{x, y, z}, {y, x, z}}, {z, y, x}, all);
                       });
                     }});
    calls.push_back({"warp of each", [=](Span x, Span y, Span z, auto out) {
                       with_results(out, [&](const batch::WarpedLobes& all) {
                         batch::warp_to_incoming({{x, y, z}, {y, x, z}, x, y, y}, {z, y, x}, all);
                       });
                     }});
    calls.push_back(
        {"mean warp", [=](Span x, Span y, Span z, auto out) {
           with_results(out, [&](const batch::WarpedLobes& all) {
             batch::warp_mean_to_incoming(20, 80, shape, {{x, y, z}, {y, x, z}}, {z, y, x}, all);
           });
         }});
  }
  for (const auto& [name, call] : calls) {
    call(a, b, c, whole);
    for (size_t start = 0; start < 4; ++start) {
      for (size_t length = 0; length <= 40; ++length) {
        // Inputs of their own, so that the address sanitizer sees a read past their end.
        const std::vector<float> x(a.begin() + start, a.begin() + start + length),
            y(b.begin() + start, b.begin() + start + length),
            z(c.begin() + start, c.begin() + start + length);
        constexpr float kCanary = -77;
        std::vector<float> results(start + length + 20, kCanary);
        call(x, y, z, std::span(results).subspan(start, length));
        for (size_t i = 0; i < results.size(); ++i) {
          const bool inside = i >= start && i < start + length;
          ASSERT_EQ(results[i], inside ? whole[i] : kCanary)
              << name << ": element " << i << " of " << length << " from " << start;
        }
      }
    }
    // Over an input.
    std::vector<float> x = a, z = c;
    call(x, b, z, x);
    EXPECT_EQ(x, whole) << name;
  }
}

TEST_P(Batch, NaNAndInfinityDoNotHang) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  for (const float bad : {nan, infinity, -infinity}) {
    const std::vector<float> x(20, bad);
    std::vector<float> results(20);
    batch::exp(x, results);
    batch::eval(AnisotropicGaussian<float>(), {x, x, x}, results);
    batch::eval(SphericalGaussian<float>(), {x, x, x}, results);
    batch::asg_integral(x, x, AsgIntegral::exact, results);
    batch::visible_fraction_directional(x, x, results);
    batch::visible_fraction_hemisphere(x, x, results);
    batch::visible_fraction_hemisphere(x, x, results, HemisphereLevel::exact);
    batch::sg_integral(x, results);
    batch::inner_product(SphericalGaussian<float>(), {{x, x, x}, x, x}, results);
    batch::eval({{x, x, x}, {x, x, x}, x, x, x}, {x, x, x}, results);
    batch::inner_product(AnisotropicGaussian<float>(), {{x, x, x}, {x, x, x}, x, x, x}, results);
    batch::directional_bandwidth(x, x, x, x, results);
    batch::mean_clamped_cosine(LobeMoments<float>(), Frame<float>(), {x, x, x}, results);
    std::vector<float> more(20);
    batch::direction_to_octahedral({x, x, x}, results, more);
    batch::clamped_cosine_integral({}, {x, x, x}, results);
    batch::convolve(x, x, x, {results, more, more});
    WarpedArrays warped(20);
    batch::warp_to_incoming({{x, x, x}, {x, x, x}, x, x, x}, {x, x, x}, warped.spans());
    batch::warp_mean_to_incoming(1, 1, {}, {{x, x, x}, {x, x, x}}, {x, x, x}, warped.spans());
  }
}

TEST(InstructionSets, UnknownNamesAreRefused) {
  EXPECT_FALSE(batch::instruction_sets().empty());
  EXPECT_FALSE(batch::use_instruction_set("Z80"));
}

}  // namespace
}  // namespace burnish::test
