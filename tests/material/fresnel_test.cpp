#include "burnish/material/fresnel.h"

#include <complex>

#include <gtest/gtest.h>

namespace burnish {
namespace {

/// Snell's and Fresnel's equations in complex numbers.
double complex_fresnel(std::complex<double> index, double cosine) {
  const double sine2 = 1 - cosine * cosine;
  const std::complex<double> transmitted = std::sqrt(1.0 - sine2 / (index * index));
  const auto r_s = (cosine - index * transmitted) / (cosine + index * transmitted);
  const auto r_p = (index * cosine - transmitted) / (index * cosine + transmitted);
  return (std::norm(r_s) + std::norm(r_p)) / 2;
}

Fresnel with_index(FresnelModel model, float eta, float k) {
  Fresnel fresnel;
  fresnel.model = model;
  fresnel.eta = Rgb(eta, 1.5f, 1.5f);
  fresnel.k = Rgb(k, 0, 0);
  return fresnel;
}

constexpr float kCosines[] = {0, 1e-4f, 0.01f, 0.1f, 0.3f, 0.5f, 0.7f, 0.9f, 0.999f, 1};

TEST(Fresnel, OfADielectricIsThatOfComplexArithmetic) {
  for (const float eta : {kMinEta, 0.4f, 0.66f, 0.999f, 1.001f, 1.33f, 1.5f, 2.4f, kMaxEta})
    for (const float c : kCosines) {
      const double truth = complex_fresnel(double(eta), double(c));
      const float found = eval_fresnel(with_index(FresnelModel::dielectric, eta, 0), c).x();
      // Rounding; near the critical angle it has the slope of a square root.
      EXPECT_NEAR(found, truth, 2e-6 + 1e-5 * truth) << eta << " " << c;
    }
}

TEST(Fresnel, OfAConductorIsThatOfComplexArithmetic) {
  for (const float eta : {0.04f, 0.2f, 1.0f, 1.5f, 3.0f, kMaxEta})
    for (const float k : {0.0f, 1e-3f, 0.5f, 2.0f, 7.0f, kMaxEta})
      for (const float c : kCosines) {
        if (eta == 1 && k == 0 && c == 0) continue;  // 0 / 0 in the truth
        const double truth = complex_fresnel({eta, k}, double(c));
        const float found = eval_fresnel(with_index(FresnelModel::conductor, eta, k), c).x();
        EXPECT_NEAR(found, truth, 2e-6 + 1e-5 * truth) << eta << " " << k << " " << c;
      }
}

TEST(Fresnel, AtNormalIncidenceIsTheTextbookForm) {
  EXPECT_NEAR(eval_fresnel(with_index(FresnelModel::dielectric, 1.5f, 0), 1).x(), 0.04, 1e-7);
  // ((eta - 1)^2 + k^2) / ((eta + 1)^2 + k^2), aluminium-like
  EXPECT_NEAR(eval_fresnel(with_index(FresnelModel::conductor, 1.2f, 7), 1).x(),
              (0.04 + 49) / (4.84 + 49), 1e-6);
}

TEST(Fresnel, ReflectsAllBeyondTheCriticalAngleAndAtTheHorizon) {
  const float critical = std::sqrt(1 - 0.66f * 0.66f);  // its cosine
  const Fresnel inside = with_index(FresnelModel::dielectric, 0.66f, 0);
  EXPECT_EQ(eval_fresnel(inside, critical - 1e-3f).x(), 1);
  EXPECT_LT(eval_fresnel(inside, critical + 1e-2f).x(), 0.9f);
  for (const FresnelModel model :
       {FresnelModel::schlick, FresnelModel::dielectric, FresnelModel::conductor})
    EXPECT_NEAR(eval_fresnel(with_index(model, 1.5f, 0), 0).x(), 1, 1e-6);
}

TEST(Fresnel, OfNoInterfaceIsZero) {
  for (const FresnelModel model : {FresnelModel::dielectric, FresnelModel::conductor})
    for (const float c : kCosines)
      EXPECT_NEAR(eval_fresnel(with_index(model, 1, 0), c).x(), 0, 1e-8) << c;
}

TEST(Fresnel, OfBrewstersAngleLosesOnePolarisation) {
  // tan = eta; what is left is half of ((1 - eta^2) / (1 + eta^2))^2
  const double eta = 1.5, cosine = 1 / std::hypot(1.0, eta);
  const double left = std::pow((1 - eta * eta) / (1 + eta * eta), 2) / 2;
  EXPECT_NEAR(eval_fresnel(with_index(FresnelModel::dielectric, 1.5f, 0), float(cosine)).x(), left,
              1e-6);
}

TEST(Fresnel, StaysWithinZeroAndOne) {
  for (const FresnelModel model :
       {FresnelModel::schlick, FresnelModel::dielectric, FresnelModel::conductor})
    for (const float eta : {kMinEta, 0.5f, 1.0f, 1.5f, kMaxEta})
      for (const float k : {0.0f, 1.0f, kMaxEta})
        for (const float c : {-1.0f, 0.0f, 1e-7f, 0.5f, 1.0f, 1.0000002f}) {
          const Rgb f = eval_fresnel(with_index(model, eta, k), c);
          EXPECT_TRUE((f >= 0).all() && (f <= 1).all()) << eta << " " << k << " " << c;
        }
}

TEST(Fresnel, OfSchlickIsNearThatOfADielectric) {
  // schlick1994: within .02 for eta 1.5.
  Fresnel schlick;
  for (const float c : kCosines)
    EXPECT_NEAR(eval_fresnel(schlick, c).x(),
                eval_fresnel(with_index(FresnelModel::dielectric, 1.5f, 0), c).x(), 0.04f)
        << c;
}

TEST(Fresnel, IsPerChannel) {
  Fresnel fresnel;
  fresnel.normal_reflectance = Rgb(0.1f, 0.5f, 1);
  const Rgb f = eval_fresnel(fresnel, 1);
  EXPECT_FLOAT_EQ(f.x(), 0.1f);
  EXPECT_FLOAT_EQ(f.y(), 0.5f);
  EXPECT_FLOAT_EQ(f.z(), 1);
}

TEST(FresnelDomain, NamesTheFieldThatItsModelUses) {
  Fresnel fresnel;
  EXPECT_EQ(domain_error(fresnel), "");
  fresnel.normal_reflectance.y() = 1.5f;
  EXPECT_EQ(domain_error(fresnel), "normal_reflectance is 1.500000, expected 0 to 1");
  fresnel.model = FresnelModel::dielectric;
  EXPECT_EQ(domain_error(fresnel), "");
  fresnel.eta.z() = 0;
  EXPECT_EQ(domain_error(fresnel), "eta is 0.000000, expected 0.01 to 100");
  fresnel.eta.z() = std::nanf("");
  EXPECT_NE(domain_error(fresnel), "");
  fresnel = with_index(FresnelModel::conductor, 1, -1);
  EXPECT_EQ(domain_error(fresnel), "k is -1.000000, expected 0 to 100");
}

}  // namespace
}  // namespace burnish
