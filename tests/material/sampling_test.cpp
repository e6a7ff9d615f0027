#include <random>

#include <gtest/gtest.h>

#include "material/sample_materials.h"
#include "support/chi_square.h"
#include "support/sphere_sampling.h"

namespace burnish {
namespace {

using test::from_angles;

constexpr unsigned kSeed = 17;
constexpr float kBelowOne = 0.99999994f;

class SpecularSampling : public testing::TestWithParam<test::NamedMaterial> {
 protected:
  const Material& material = GetParam().material;
};
INSTANTIATE_TEST_SUITE_P(Of, SpecularSampling, testing::ValuesIn(test::all_materials()),
                         [](const auto& info) { return info.param.name; });

class Sampler {
 public:
  Sampler(const Material& material, const Vector3f& outgoing)
      : material_(material), outgoing_(outgoing) {}
  Vector3f operator()() {
    const float u = std::min(unit_(random_), kBelowOne), v = std::min(unit_(random_), kBelowOne);
    return sample_specular_brdf(material_, outgoing_, u, v);
  }

 private:
  Material material_;
  Vector3f outgoing_;
  std::mt19937 random_{kSeed};
  std::uniform_real_distribution<float> unit_;
};

/// Bins of equal solid angle over the directions above the horizon.
constexpr int kHeights = 16, kAzimuths = 48;

size_t bin_of(const Vector3f& i) {
  const double turn = std::atan2(double(i.y()), double(i.x())) / (2 * kPi<double>)+0.5;
  const int height = std::min(int(i.z() * kHeights), kHeights - 1);
  return size_t(height * kAzimuths + std::min(int(turn * kAzimuths), kAzimuths - 1));
}

/// The pdf's integral over each bin, by a plain grid of angles: in the sampler's own coordinates
/// the map would be tested with itself.
std::vector<double> integrate_bins(const Material& material, const Vector3f& outgoing) {
  constexpr int kSub = 40;
  constexpr double kTurn = 2 * kPi<double> / (kAzimuths * kSub);
  std::vector<double> sums;
  for (int t = 0; t < kHeights; ++t) {
    const double low = std::acos(double(t + 1) / kHeights), high = std::acos(double(t) / kHeights);
    for (int p = 0; p < kAzimuths; ++p) {
      double sum = 0;
      for (int a = 0; a < kSub; ++a)
        for (int b = 0; b < kSub; ++b) {
          const double theta = low + (high - low) * (a + 0.5) / kSub;
          const double phi = (p * kSub + b + 0.5) * kTurn - kPi<double>, r = std::sin(theta);
          const Vector3d i(r * std::cos(phi), r * std::sin(phi), std::cos(theta));
          sum += r * double(pdf_specular_brdf(material, outgoing, i.cast<float>()));
        }
      sums.push_back(sum * (high - low) / kSub * kTurn);
    }
  }
  return sums;
}

TEST_P(SpecularSampling, FollowsItsPdf) {
  constexpr int kSamples = 100000, kTests = 2 * 28;
  for (const double view : {5.0, 65.0}) {
    const Vector3f o = from_angles(view, 40);
    // The last bin is for all directions below the horizon.
    std::vector<double> expected = integrate_bins(material, o), observed(expected.size() + 1);
    Sampler draw(material, o);
    for (int s = 0; s < kSamples; ++s) {
      const Vector3f i = draw();
      ASSERT_NEAR(i.norm(), 1, 1e-4) << "seed " << kSeed;
      observed[i.z() > 0 ? bin_of(i) : expected.size()] += 1;
    }
    double above = 0;
    for (double& e : expected) above += e, e *= kSamples;
    EXPECT_LT(above, 1 + 1e-3) << "view " << view;
    // Not zero, which would make a sample impossible: the quadrature may round up.
    expected.push_back(std::max(1 - above, 1e-5) * kSamples);
    const test::ChiSquare chi = test::chi_square(observed, expected);
    EXPECT_GT(chi.p_value, test::sidak_level(0.01, kTests))
        << "view " << view << " seed " << kSeed << "\n"
        << chi.report("specular");
  }
}

class SamplingWithAlphas : public SpecularSampling {};
INSTANTIATE_TEST_SUITE_P(Of, SamplingWithAlphas,
                         testing::ValuesIn(test::materials_that(test::has_alphas)),
                         [](const auto& info) { return info.param.name; });

TEST_P(SamplingWithAlphas, OfNarrowLobesFollowsItsPdf) {
  constexpr int kTests = 2 * 27;
  Material narrow = material;
  narrow.alpha_x = 0.004f;
  narrow.alpha_y = 0.02f;
  if (narrow.distribution == Distribution::blinn_phong) narrow.alpha_y = narrow.alpha_x;
  for (const double view : {1.0, 50.0}) {
    const Vector3f o = from_angles(view, 0);
    const Vector3d mirror(-o.x(), o.y(), o.z());
    const double aspect = double(narrow.alpha_y / narrow.alpha_x) * mirror.z();
    const test::SphereCells cells(frame_from_normal_tangent<double>(mirror, Vector3d::UnitX()),
                                  narrow.alpha_x, std::max(aspect, 1.0));
    const test::ChiSquare chi = test::chi_square_on_sphere(
        cells,
        [&](double u, double v) {
          return Vector3d(sample_specular_brdf(narrow, o, std::min(float(u), kBelowOne),
                                               std::min(float(v), kBelowOne))
                              .cast<double>());
        },
        [&](const Vector3d& i) { return double(pdf_specular_brdf(narrow, o, i.cast<float>())); },
        50000, kSeed);
    EXPECT_GT(chi.p_value, test::sidak_level(0.01, kTests))
        << "view " << view << " seed " << kSeed << "\n"
        << chi.report("narrow_specular");
  }
}

TEST_P(SpecularSampling, EstimatesTheAlbedoThatQuadratureGives) {
  constexpr int kSamples = 100000;
  for (const double view : {0.0, 45.0, 80.0}) {
    const Vector3f o = from_angles(view, 25);
    const double albedo = test::specular_albedo(material, o);
    Sampler draw(material, o);
    double sum = 0, square = 0;
    for (int s = 0; s < kSamples; ++s) {
      const Vector3f i = draw();
      const double pdf = double(pdf_specular_brdf(material, o, i));
      const double value =
          pdf > 0 ? double(eval_specular_brdf(material, o, i).x()) * double(i.z()) / pdf : 0;
      sum += value;
      square += value * value;
    }
    const double mean = sum / kSamples;
    const double error = std::sqrt((square / kSamples - mean * mean) / kSamples);
    // Four standard errors, and the quadrature's where the horizon cuts its cells.
    EXPECT_NEAR(mean, albedo, 4 * error + 2e-3 * albedo) << "view " << view << " seed " << kSeed;
  }
}

TEST_P(SpecularSampling, StaysFiniteAtTheEdgesOfItsSquare) {
  for (const float alpha : {kMinAlpha, kMaxAlpha})
    for (const double view : {0.0, 60.0, 89.999})
      for (const float u : {0.0f, 0.25f, 0.5f, kBelowOne})
        for (const float v : {0.0f, 0.5f, kBelowOne}) {
          Material m = material;
          m.alpha_x = alpha;
          const Vector3f o = from_angles(view, 40), i = sample_specular_brdf(m, o, u, v);
          EXPECT_NEAR(i.norm(), 1, 1e-4) << alpha << " " << view << " " << u << " " << v;
          EXPECT_TRUE(std::isfinite(pdf_specular_brdf(m, o, i)));
        }
}

TEST(GgxSampling, OfVisibleNormalsHasAWeightOfAtMostOne) {
  // dupuy2023: f cos / pdf = F G / G1(o).
  const Material m = test::white_microfacets(Distribution::ggx, Shadowing::smith, 0.5f, 0.1f);
  for (const double view : {0.0, 60.0, 85.0, 89.9}) {
    const Vector3f o = from_angles(view, 40);
    Sampler draw(m, o);
    for (int s = 0; s < 1000; ++s) {
      const Vector3f i = draw();
      if (i.z() <= 0) continue;
      EXPECT_LE(eval_specular_brdf(m, o, i).x() * i.z() / pdf_specular_brdf(m, o, i), 1 + 1e-4f)
          << view << " seed " << kSeed;
    }
  }
}

}  // namespace
}  // namespace burnish
