#include "burnish/material/material.h"

#include <random>

#include <gtest/gtest.h>

#include "support/chi_square.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 17;

Material make(SpecularModel model, float alpha_x, float alpha_y) {
  Material m;
  m.diffuse = Rgb::Zero();
  m.specular = Rgb(0.9f, 0.8f, 0.7f);
  m.model = model;
  m.alpha_x = alpha_x;
  m.alpha_y = alpha_y;
  if (model == SpecularModel::ashikhmin_shirley) {
    m.fresnel.normal_reflectance = m.specular;
    m.specular = Rgb::Ones();
  }
  return m;
}

Vector3f from_angles(double theta_deg, double phi_deg) {
  const double t = theta_deg * kPi<double> / 180, p = phi_deg * kPi<double> / 180;
  return Vector3d(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)).cast<float>();
}

class Specular : public testing::TestWithParam<Material> {};
INSTANTIATE_TEST_SUITE_P(Models, Specular,
                         testing::Values(make(SpecularModel::ward, 0.3f, 0.03f),
                                         make(SpecularModel::ward, 0.2f, 0.5f),
                                         make(SpecularModel::ward, 1, 1),
                                         make(SpecularModel::ashikhmin_shirley, 0.3f, 0.03f),
                                         make(SpecularModel::ashikhmin_shirley, 0.1f, 0.4f),
                                         make(SpecularModel::ashikhmin_shirley, 1, 1)));

TEST_P(Specular, IsReciprocalAndNonNegative) {
  std::mt19937 random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    Vector3f o = test::random_direction(random).cast<float>(),
             v = test::random_direction(random).cast<float>();
    o.z() = std::abs(o.z());
    v.z() = std::abs(v.z());
    const Rgb a = eval_brdf(GetParam(), o, v), b = eval_brdf(GetParam(), v, o);
    ASSERT_TRUE((a >= 0).all() && a.allFinite()) << "seed " << kSeed;
    // Exponents reach 2 / .03^2 = 2,000: that many roundings of the half vector.
    ASSERT_NEAR(a.x(), b.x(), 1e-3f * (a.x() + 1e-6f)) << "seed " << kSeed;
  }
}

TEST_P(Specular, IsZeroBelowTheHorizon) {
  EXPECT_EQ(eval_brdf(GetParam(), from_angles(30, 0), from_angles(100, 20)).x(), 0);
  EXPECT_EQ(eval_brdf(GetParam(), from_angles(100, 0), from_angles(30, 20)).x(), 0);
}

TEST_P(Specular, SurvivesOppositeEqualAndGrazingDirections) {
  const Vector3f grazing = from_angles(89.9999, 10), up = from_angles(0, 0);
  for (const auto& [o, i] : {std::pair{grazing, from_angles(89.9999, 190)},
                             {up, up},
                             {grazing, grazing},
                             {up, grazing},
                             {grazing, up}}) {
    const Rgb f = eval_brdf(GetParam(), o, i);
    EXPECT_TRUE(f.allFinite() && (f >= 0).all());
    EXPECT_TRUE(std::isfinite(pdf_specular_brdf(GetParam(), o, i)));
  }
}

TEST_P(Specular, IsItsSmoothFactorTimesItsDistribution) {
  const Vector3f o = from_angles(20, 35);
  for (const double view : {0.0, 30.0, 80.0}) {
    const Vector3f i = from_angles(view, 200);
    const Vector3f h = (o + i).normalized();
    const Rgb split = specular_smooth_factor(GetParam(), o, i) * eval_distribution(GetParam(), h);
    // Exponents reach 2 / .03^2: that many roundings of h.
    EXPECT_TRUE(split.isApprox(eval_specular_brdf(GetParam(), o, i), 1e-3f)) << view;
  }
}

/// Samples against the pdf's integral over bins of the sphere around the reflected direction.
TEST_P(Specular, SamplesFollowThePdf) {
  const Material& m = GetParam();
  constexpr int kSamples = 200000, kTheta = 24, kPhi = 48, kTests = 12;
  for (const double view : {5.0, 60.0}) {
    const Vector3f o = from_angles(view, 40);
    // The last bin is for samples of density 0: a reflected direction whose half vector points down
    // (o.h < 0) contributes nothing anywhere, by convention.
    std::vector<double> observed(kTheta * kPhi + 1), expected(kTheta * kPhi + 1);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<float> unit(0, 1);
    for (int s = 0; s < kSamples; ++s) {
      const Vector3f i =
          sample_specular_brdf(m, o, unit(random), std::min(unit(random), 0.9999999f));
      ASSERT_NEAR(i.norm(), 1, 1e-4);
      if (pdf_specular_brdf(m, o, i) == 0) {
        observed.back() += 1;
        continue;
      }
      const int t = std::min(int((1 - i.z()) / 2 * kTheta), kTheta - 1);
      const double phi = std::atan2(i.y(), i.x()) + kPi<double>;
      observed[t * kPhi + std::min(int(phi / (2 * kPi<double>)*kPhi), kPhi - 1)] += 1;
    }
    // The bins are integrated in half-vector space, where the lobe is smooth and its own shape
    // gives the nodes: a fine grid of the sampler's unit square pushed through an independent map
    // would test the map with itself, so a plain grid over incoming directions is used, 96 x 96
    // points a bin.
    constexpr int kSub = 48;
    for (int t = 0; t < kTheta; ++t) {
      for (int p = 0; p < kPhi; ++p) {
        double sum = 0;
        for (int a = 0; a < kSub; ++a) {
          for (int b = 0; b < kSub; ++b) {
            const double z = 1 - 2 * (t + (a + 0.5) / kSub) / kTheta;
            const double phi = (p + (b + 0.5) / kSub) / kPhi * 2 * kPi<double> - kPi<double>;
            const double r = std::sqrt(1 - z * z);
            sum += pdf_specular_brdf(m, o, Vector3f(r * std::cos(phi), r * std::sin(phi), z));
          }
        }
        expected[t * kPhi + p] = sum / (kSub * kSub) * 4 * kPi<double> / (kTheta * kPhi) * kSamples;
      }
    }
    double total = 0;
    for (const double e : expected) total += e;
    expected.back() = std::max(kSamples - total, 0.0);
    const test::ChiSquare chi = test::chi_square(observed, expected);
    EXPECT_GT(chi.p_value, test::sidak_level(0.01, kTests))
        << "view " << view << " seed " << kSeed << "\n"
        << chi.report("specular");
  }
}

TEST_P(Specular, SamplingEstimatesTheAlbedoThatQuadratureGives) {
  const Material& m = GetParam();
  for (const double view : {0.0, 45.0, 75.0}) {
    const Vector3f o = from_angles(view, 25);
    // Quadrature over half vectors on a dense grid of the slope plane: d omega_i = 4 (o.h) d
    // omega_h and d omega_h = cos^3 d slopes.
    double quadrature = 0;
    const int n = 800;
    for (int a = 0; a < n; ++a) {
      for (int b = 0; b < n; ++b) {
        // slope = alpha * tan(pi/2 s), s in (-1, 1): reaches the horizon, dense at the peak.
        const double s = (a + 0.5) / n * 2 - 1, t = (b + 0.5) / n * 2 - 1;
        const double x = m.alpha_x * std::tan(kPi<double> / 2 * s),
                     y = m.alpha_y * std::tan(kPi<double> / 2 * t);
        const double dx = m.alpha_x * kPi<double> / 2 / std::pow(std::cos(kPi<double> / 2 * s), 2);
        const double dy = m.alpha_y * kPi<double> / 2 / std::pow(std::cos(kPi<double> / 2 * t), 2);
        const Vector3d h = Vector3d(x, y, 1).normalized();
        const double cos_d = h.dot(o.cast<double>());
        if (cos_d <= 0) continue;
        const Vector3d i = 2 * cos_d * h - o.cast<double>();
        if (i.z() <= 0) continue;
        const double f = eval_specular_brdf(m, o, i.cast<float>().normalized()).x();
        quadrature += f * i.z() * 4 * cos_d * std::pow(h.z(), 3) * dx * dy * 4.0 / n / n;
      }
    }
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<float> unit(0, 1);
    double sum = 0, square = 0;
    const int samples = 200000;
    for (int s = 0; s < samples; ++s) {
      const Vector3f i =
          sample_specular_brdf(m, o, unit(random), std::min(unit(random), 0.9999999f));
      const float pdf = pdf_specular_brdf(m, o, i);
      const double value = pdf > 0 && i.z() > 0 ? eval_specular_brdf(m, o, i).x() * i.z() / pdf : 0;
      sum += value;
      square += value * value;
    }
    const double mean = sum / samples;
    const double error = std::sqrt((square / samples - mean * mean) / samples);
    // Four standard errors, and the grid's own 1e-3.
    EXPECT_NEAR(mean, quadrature, 4 * error + 1e-3 * quadrature)
        << "view " << view << " seed " << kSeed;
  }
}

TEST(Ashikhmin, KeepsTheWhiteFurnaceBelowOne) {
  // ashikhmin2000phong promises it for F0 = 1; 1e-3 is the estimate's own error.
  Material m = make(SpecularModel::ashikhmin_shirley, 0.3f, 0.03f);
  m.fresnel.normal_reflectance = Rgb::Ones();
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const double view : {0.0, 30.0, 60.0, 85.0}) {
    const Vector3f o = from_angles(view, 70);
    double sum = 0;
    for (int s = 0; s < 100000; ++s) {
      const Vector3f i = sample_specular_brdf(m, o, unit(random), unit(random) * 0.9999999f);
      const float pdf = pdf_specular_brdf(m, o, i);
      if (pdf > 0 && i.z() > 0) sum += eval_specular_brdf(m, o, i).x() * i.z() / pdf;
    }
    EXPECT_LE(sum / 100000, 1.003) << view;
    EXPECT_GT(sum / 100000, 0.5) << view;
  }
}

TEST(Ward, PeakValueIsTheClosedForm) {
  const Material m = make(SpecularModel::ward, 0.3f, 0.1f);
  const Vector3f o = from_angles(40, 0), i = from_angles(40, 180);  // h is the normal
  const double expected = 0.9 / (4 * kPi<double> * 0.3 * 0.1 * std::cos(40 * kPi<double> / 180));
  EXPECT_NEAR(eval_specular_brdf(m, o, i).x() / expected, 1, 1e-4);
}

TEST(Ashikhmin, PeakValueIsTheClosedForm) {
  const Material m = make(SpecularModel::ashikhmin_shirley, 0.1f, 0.5f);
  const Vector3f o = from_angles(0, 0);
  // n_u = 200, n_v = 8, F = F0 at normal incidence.
  const double expected = 0.9 * std::sqrt(201.0 * 9.0) / (8 * kPi<double>);
  EXPECT_NEAR(eval_specular_brdf(m, o, o).x() / expected, 1, 1e-4);
}

TEST(Material, DiffuseIsAlbedoOverPi) {
  Material m;
  m.diffuse = Rgb(0.2f, 0.4f, 0.6f);
  const Rgb f = eval_brdf(m, from_angles(10, 0), from_angles(70, 90));
  EXPECT_NEAR(f.y(), 0.4 / kPi<double>, 1e-6);
  EXPECT_FALSE(m.has_specular());
}

}  // namespace
}  // namespace burnish
