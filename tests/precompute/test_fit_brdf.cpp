// Fits to data made of known materials, which are the truth.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/fit_brdf.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 20131106;

MeasuredBrdf measurement_of(const Material& material, bool isotropic = false) {
  MeasuredBrdf measured;
  measured.isotropic = isotropic;
  measured.eval = [material](const Vector3f& outgoing, const Vector3f& incoming) {
    return eval_brdf(material, outgoing, incoming);
  };
  return measured;
}

/// A quarter of the default's cells: the tests' lobes are wide enough.
BrdfFitOptions quick(int lobes) {
  BrdfFitOptions options;
  options.lobes = lobes;
  options.resolution = 128;
  return options;
}

AnisotropicGaussian<float> tilted_lobe(float tilt, float azimuth, float turn, float bandwidth_x,
                                       float bandwidth_y, float amplitude) {
  const Vector3f axis(std::sin(tilt) * std::cos(azimuth), std::sin(tilt) * std::sin(azimuth),
                      std::cos(tilt));
  const Vector3f tangent(std::cos(turn), std::sin(turn), 0);
  return {frame_from_normal_tangent(axis, tangent), bandwidth_x, bandwidth_y, amplitude};
}

/// Two crossed off-specular lobes, as cloth of two threads has.
Material two_threads() {
  auto fitted = std::make_shared<FittedSpecular>();
  fitted->lobes = {tilted_lobe(0.2f, 0.5f, 0.3f, 200, 15, 3),
                   tilted_lobe(0.15f, 3.4f, 1.2f, 300, 40, 2)};
  for (int i = 0; i < 31; ++i) {
    const float cosine = std::cos(kPi<float> / 2 * float(i) / 30);
    const Rgb normal(0.5f, 0.4f, 0.3f);
    fitted->color_by_difference.push_back(normal + (1 - normal) * std::pow(1 - cosine, 5.0f));
    fitted->masking.push_back(1 / std::sqrt(std::max(cosine, 0.05f)));
  }
  Material material;
  material.model = SpecularModel::fitted;
  material.diffuse = Rgb(0.2f, 0.1f, 0.05f);
  material.fitted = fitted;
  return material;
}

Material brushed_metal(float alpha_x, float alpha_y) {
  Material material;
  material.model = SpecularModel::cook_torrance;
  material.alpha_x = alpha_x;
  material.alpha_y = alpha_y;
  material.diffuse = Rgb::Constant(0.1f);
  material.fresnel.normal_reflectance = Rgb(0.9f, 0.8f, 0.5f);
  return material;
}

/// Sorts by bandwidth and checks against a lobe of the truth, whose x and y may be exchanged.
void expect_lobe(const AnisotropicGaussian<float>& found, const AnisotropicGaussian<float>& truth) {
  const bool exchanged =
      (found.bandwidth_x > found.bandwidth_y) != (truth.bandwidth_x > truth.bandwidth_y);
  const float x = exchanged ? found.bandwidth_y : found.bandwidth_x;
  const float y = exchanged ? found.bandwidth_x : found.bandwidth_y;
  // F and S are interpolated between other nodes than the truth's: a part in a thousand.
  EXPECT_NEAR(x / truth.bandwidth_x, 1, 0.03);
  EXPECT_NEAR(y / truth.bandwidth_y, 1, 0.03);
  EXPECT_LT(angle_between(found.frame.z, truth.frame.z), 0.005f);
  const Vector3f& axis = exchanged ? found.frame.y : found.frame.x;
  EXPECT_GT(std::abs(axis.dot(truth.frame.x)), 0.9999f);
}

void expect_two_threads(const Material& found, const Material& truth) {
  ASSERT_EQ(found.fitted->lobes.size(), 2u);
  const auto& lobes = truth.fitted->lobes;
  const bool swapped = found.fitted->lobes[0].frame.z.dot(lobes[0].frame.z) <
                       found.fitted->lobes[1].frame.z.dot(lobes[0].frame.z);
  expect_lobe(found.fitted->lobes[swapped ? 1 : 0], lobes[0]);
  expect_lobe(found.fitted->lobes[swapped ? 0 : 1], lobes[1]);
  const float ratio = found.fitted->lobes[swapped ? 1 : 0].amplitude /
                      found.fitted->lobes[swapped ? 0 : 1].amplitude;
  EXPECT_NEAR(ratio / (lobes[0].amplitude / lobes[1].amplitude), 1, 0.02);
  EXPECT_LT((found.diffuse - truth.diffuse).abs().maxCoeff(), 0.003f);
}

TEST(FitBrdf, FindsOffSpecularLobesAgain) {
  const Material truth = two_threads();
  const MeasuredBrdf measured = measurement_of(truth);
  const BrdfFit fit = fit_brdf(measured, quick(2));
  EXPECT_LT(fit.error.relative_l2, 0.005);
  EXPECT_LT(fit.error.cube_root, 0.005);
  expect_two_threads(fit.material, truth);
  EXPECT_EQ(domain_error(fit.material), "");
  // What two lobes make, one or a model about the normal cannot.
  EXPECT_GT(fit_brdf(measured, quick(1)).error.relative_l2, 0.3);
  for (const SpecularModel model : {SpecularModel::ward, SpecularModel::ashikhmin_shirley})
    EXPECT_GT(measure_brdf_fit(measured, fit_parametric_brdf(measured, model, quick(2)), quick(2))
                  .relative_l2,
              0.5);
}

TEST(FitBrdf, FindsThemInIrregularSamples) {
  const Material truth = two_threads();
  std::mt19937 random(kSeed);
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::uniform_real_distribution<float> uniform;
  const auto direction = [&] {
    const float z = 0.18f + 0.82f * uniform(random), azimuth = 2 * kPi<float> * uniform(random);
    const float r = std::sqrt(1 - z * z);
    return Vector3f(r * std::cos(azimuth), r * std::sin(azimuth), z);
  };
  MeasuredBrdf measured;
  for (int i = 0; i < 10000; ++i) {
    BrdfSample sample;
    sample.outgoing = direction();
    sample.incoming = direction();
    sample.value = eval_brdf(truth, sample.outgoing, sample.incoming);
    measured.samples.push_back(sample);
  }
  const BrdfFit fit = fit_brdf(measured, quick(2));
  EXPECT_LT(fit.error.relative_l2, 0.01);
  expect_two_threads(fit.material, truth);
  // At pairs that it has not seen.
  EXPECT_LT(measure_brdf_fit(measurement_of(truth), fit.material, quick(2)).relative_l2, 0.02);
}

/// Grey samples value(half vector's cosine) at random directions to 75 degrees from the normal.
template <class Value>
MeasuredBrdf sparse_samples(int count, const Value& value) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform;
  const auto direction = [&] {
    const float z = 0.26f + 0.74f * uniform(random), azimuth = 2 * kPi<float> * uniform(random);
    const float r = std::sqrt(1 - z * z);
    return Vector3f(r * std::cos(azimuth), r * std::sin(azimuth), z);
  };
  MeasuredBrdf measured;
  for (int i = 0; i < count; ++i) {
    const Vector3f outgoing = direction(), incoming = direction();
    const Rgb grey = Rgb::Constant(value((outgoing + incoming).normalized().z()));
    measured.samples.push_back({outgoing, incoming, grey});
  }
  return measured;
}

double error_of_ward(const MeasuredBrdf& measured) {
  return measure_brdf_fit(measured, fit_parametric_brdf(measured, SpecularModel::ward)).relative_l2;
}

// Some tens of samples see the widest peak, hardly any the narrowest.
TEST(FitBrdf, SparseSamplesOfANarrowPeakAreFollowedAsWellAsWardDoes) {
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  for (const float bandwidth : {100.0f, 1e3f, 1e4f, 1e5f}) {
    SCOPED_TRACE(bandwidth);
    const MeasuredBrdf peak = sparse_samples(
        3000, [&](float z) { return 0.1f + 10 * std::exp(-bandwidth * (1 - z * z)); });
    const BrdfFit fit = fit_brdf(peak);
    // 1 %: where no sample sees the peak, either fits the rest to less than that.
    EXPECT_LT(fit.error.relative_l2, error_of_ward(peak) + 0.01);
    EXPECT_LT(fit.error.relative_l2, 0.05);
    for (const AnisotropicGaussian<float>& lobe : fit.material.fitted->lobes)
      EXPECT_LT(std::max(lobe.bandwidth_x, lobe.bandwidth_y),
                2e4f);  // the samples' spacing allows 7e3
  }
  // No lobe suits a disc; Ward's is the best of those about the normal.
  const MeasuredBrdf disc =
      sparse_samples(3000, [](float z) { return z > std::cos(0.05f) ? 10.1f : 0.1f; });
  EXPECT_LT(fit_brdf(disc).error.relative_l2, error_of_ward(disc) + 0.01);
}

TEST(FitBrdf, ValuesOfAnySizeAreFittedAlike) {
  const auto peak = [](float z) { return 0.1f + 10 * std::exp(-100 * (1 - z * z)); };
  for (const float scale : {1e-24f, 1e-6f, 1.0f, 1e6f}) {
    SCOPED_TRACE(scale);
    const MeasuredBrdf measured = sparse_samples(3000, [&](float z) { return scale * peak(z); });
    const BrdfFit fit = fit_brdf(measured);
    // The truth is a lobe and a constant; beyond 1, a wide lobe stands for the constant.
    EXPECT_LT(fit.error.relative_l2, 0.01);
    EXPECT_EQ(domain_error(fit.material), "");
    EXPECT_LE(fit.material.diffuse.maxCoeff(), 1);
    const Material ward = fit_parametric_brdf(measured, SpecularModel::ward);
    EXPECT_EQ(domain_error(ward), "");
  }
  // No material is as bright.
  EXPECT_THROW(fit_brdf(sparse_samples(3000, [&](float z) { return 1e20f * peak(z); })), Error);
}

// Diffuse cannot be above 1: lobes take the rest, which a cut would lose.
TEST(FitBrdf, LobesTakeWhatIsBeyondAWhiteDiffusePart) {
  for (const float albedo : {3.0f, 10.0f}) {
    SCOPED_TRACE(albedo);
    const BrdfFit fit = fit_brdf(sparse_samples(3000, [&](float) { return albedo / kPi<float>; }));
    EXPECT_LT(fit.error.relative_l2, 0.05);  // a lobe ends at the horizon: 1 to 2 %
    EXPECT_LE(fit.material.diffuse.maxCoeff(), 1);
  }
}

TEST(FitBrdf, LobesThatGainNothingAreLeftOut) {
  const BrdfFit fit = fit_brdf(measurement_of(two_threads()), quick(4));
  EXPECT_EQ(fit.material.fitted->lobes.size(), 2u);
}

// GGX has a longer tail than a lobe: each one more takes part of it.
TEST(FitBrdf, MoreLobesFollowTheTailOfBrushedMetal) {
  const MeasuredBrdf measured = measurement_of(brushed_metal(0.05f, 0.2f));
  double errors[4] = {1, 0, 0, 0}, tails[4] = {1, 0, 0, 0};
  for (int lobes = 1; lobes <= 3; ++lobes) {
    const BrdfFit fit = fit_brdf(measured, quick(lobes));
    errors[lobes] = fit.error.relative_l2;
    tails[lobes] = fit.error.cube_root;
    EXPECT_LT(errors[lobes], errors[lobes - 1]);
    EXPECT_LT(tails[lobes], tails[lobes - 1]);
  }
  EXPECT_LT(errors[1], 0.15);
  EXPECT_LT(errors[3], 0.05);  // its masking depends on the azimuth, S does not: 4 %
  EXPECT_LT(tails[3], 0.05);
  for (const SpecularModel model : {SpecularModel::ward, SpecularModel::ashikhmin_shirley}) {
    const Material best = fit_parametric_brdf(measured, model, quick(1));
    EXPECT_NEAR(best.alpha_y / best.alpha_x, 4, 1);
    EXPECT_GT(measure_brdf_fit(measured, best, quick(1)).relative_l2, 2 * errors[3]);
  }
}

TEST(FitBrdf, IsotropicDataGetRoundLobesAboutTheNormal) {
  // The second is narrower than a degree: the table adapts to it.
  for (const float alpha : {0.2f, 0.004f}) {
    SCOPED_TRACE(alpha);
    const BrdfFit fit = fit_brdf(measurement_of(brushed_metal(alpha, alpha), true), quick(3));
    EXPECT_LT(fit.error.relative_l2, 0.05);
    for (const AnisotropicGaussian<float>& lobe : fit.material.fitted->lobes) {
      EXPECT_EQ(lobe.bandwidth_x, lobe.bandwidth_y);
      EXPECT_EQ(lobe.frame.z, Vector3f::UnitZ());
    }
  }
}

TEST(FitBrdf, DiffuseDataStayDiffuse) {
  Material truth;
  truth.diffuse = Rgb(0.8f, 0.4f, 0.1f);
  const BrdfFit fit = fit_brdf(measurement_of(truth, true), quick(2));
  EXPECT_LT(fit.error.relative_l2, 1e-3);
  EXPECT_EQ(domain_error(fit.material), "");
}

TEST(FitBrdf, WhatWasNotMeasuredDoesNotCount) {
  const Material truth = brushed_metal(0.2f, 0.2f);
  MeasuredBrdf holes = measurement_of(truth, true);
  holes.eval = [truth](const Vector3f& outgoing, const Vector3f& incoming) -> Rgb {
    if (outgoing.dot(incoming) > 0.95f) return Rgb::Constant(NAN);  // in the lamp's shadow
    return eval_brdf(truth, outgoing, incoming);
  };
  const BrdfFit fit = fit_brdf(holes, quick(3));
  EXPECT_LT(measure_brdf_fit(measurement_of(truth, true), fit.material, quick(3)).relative_l2,
            0.06);
}

TEST(FitParametricBrdf, FindsItsOwnModelsAgain) {
  Material truth;
  truth.model = SpecularModel::ward;
  truth.alpha_x = 0.08f;
  truth.alpha_y = 0.23f;
  truth.diffuse = Rgb(0.3f, 0.2f, 0.1f);
  truth.specular = Rgb(0.5f, 0.6f, 0.7f);
  for (const SpecularModel model : {SpecularModel::ward, SpecularModel::ashikhmin_shirley}) {
    truth.model = model;
    truth.fresnel.normal_reflectance = Rgb(0.2f, 0.4f, 0.6f);
    const MeasuredBrdf measured = measurement_of(truth);
    const Material found = fit_parametric_brdf(measured, model, quick(1));
    // The models are float.
    EXPECT_NEAR(found.alpha_x / truth.alpha_x, 1, 1e-3);
    EXPECT_NEAR(found.alpha_y / truth.alpha_y, 1, 1e-3);
    EXPECT_TRUE(found.diffuse.isApprox(truth.diffuse, 2e-3f));
    EXPECT_TRUE(found.specular.isApprox(truth.specular, 2e-3f));
    if (model == SpecularModel::ashikhmin_shirley) {
      EXPECT_TRUE(
          found.fresnel.normal_reflectance.isApprox(truth.fresnel.normal_reflectance, 0.01f));
    }
    EXPECT_LT(measure_brdf_fit(measured, found, quick(1)).relative_l2, 2e-3);
  }
}

TEST(MeasureBrdfFit, IsTheRelativeDistance) {
  Material white, half;
  white.diffuse = Rgb::Constant(0.8f);
  half.diffuse = Rgb::Constant(0.4f);
  const BrdfError same = measure_brdf_fit(measurement_of(white), white);
  EXPECT_EQ(same.relative_l2, 0);
  EXPECT_EQ(same.cube_root, 0);
  const BrdfError error = measure_brdf_fit(measurement_of(white), half);
  EXPECT_NEAR(error.relative_l2, 0.5, 1e-6);
  EXPECT_NEAR(error.cube_root, 1 - std::cbrt(0.5), 1e-6);
}

// f = 1 and 3, whichever direction is the more grazing. In polar angles, a = outgoing and b =
// incoming cosine, the pairs weigh (da db) b^2; of (a, b) and (b, a) the best common value leaves
// 2^2 a^2 b^2 / (a^2 + b^2), integrated here by a midpoint rule.
TEST(ReciprocityBound, IsWhatTheBestCommonValuesLeave) {
  MeasuredBrdf measured;
  measured.isotropic = true;
  measured.eval = [](const Vector3f& outgoing, const Vector3f& incoming) -> Rgb {
    return Rgb::Constant(outgoing.z() > incoming.z() ? 3.0f : 1.0f);
  };
  BrdfFitOptions options;
  options.max_angle_rad = kPi<double> / 3;
  double left = 0, all = 0;
  constexpr int kSteps = 500;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double a = 0.5 + 0.5 * (i + 0.5) / kSteps, b = 0.5 + 0.5 * (j + 0.5) / kSteps;
      const double value = a > b ? 3 : 1, other = 4 - value;
      left += a * a * b * b / (a * a + b * b) * 4 / 2;  // each couple is met twice
      all += (b * b * value * value + a * a * other * other) / 2;
    }
  EXPECT_NEAR(reciprocity_bound(measured, options), std::sqrt(left / all), 0.003);
  EXPECT_LT(reciprocity_bound(measurement_of(brushed_metal(0.1f, 0.3f)), options), 1e-4);
}

TEST(FitBrdf, IsTheSameAtAnyNumberOfThreads) {
  const MeasuredBrdf measured = measurement_of(brushed_metal(0.1f, 0.3f));
  BrdfFitOptions options = quick(2);
  options.resolution = 64;
  const auto fit_with = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return fit_brdf(measured, options);
  };
  const BrdfFit one = fit_with(1), two = fit_with(2);
  ASSERT_EQ(one.material.fitted->lobes.size(), two.material.fitted->lobes.size());
  for (size_t k = 0; k < one.material.fitted->lobes.size(); ++k) {
    const auto &a = one.material.fitted->lobes[k], &b = two.material.fitted->lobes[k];
    EXPECT_EQ(a.bandwidth_x, b.bandwidth_x);
    EXPECT_EQ(a.bandwidth_y, b.bandwidth_y);
    EXPECT_EQ(a.amplitude, b.amplitude);
    EXPECT_EQ(a.frame.z, b.frame.z);
  }
  EXPECT_EQ(one.material.fitted->masking, two.material.fitted->masking);
  EXPECT_EQ(one.error.relative_l2, two.error.relative_l2);
}

TEST(FitBrdf, BadInputIsRefusedAndWorkCanBeStopped) {
  const MeasuredBrdf metal = measurement_of(brushed_metal(0.2f, 0.2f), true);
  MeasuredBrdf black;
  black.eval = [](const Vector3f&, const Vector3f&) -> Rgb { return Rgb::Zero(); };
  EXPECT_THROW(fit_brdf(black, quick(1)), Error);
  BrdfFitOptions narrow = quick(1);
  narrow.max_angle_rad = 0.1;
  narrow.subject = "plate.csv";
  MeasuredBrdf grazing;
  grazing.samples.push_back({Vector3f(0.6f, 0, 0.8f), Vector3f(-0.6f, 0, 0.8f), Rgb::Ones()});
  try {
    fit_brdf(grazing, narrow);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "plate.csv: no samples within 5.73 degrees of the normal; see --max-angle");
  }
  EXPECT_THROW(fit_parametric_brdf(grazing, SpecularModel::ward, narrow), Error);
  for (const int lobes : {0, kMaxFittedLobes + 1})
    EXPECT_THROW(fit_brdf(metal, quick(lobes)), Error) << lobes;
  for (const int resolution : {31, 513}) {
    BrdfFitOptions options;
    options.resolution = resolution;
    EXPECT_THROW(fit_brdf(metal, options), Error) << resolution;
  }
  for (const double angle : {0.0, 2.0, double(NAN)}) {
    BrdfFitOptions options;
    options.max_angle_rad = angle;
    EXPECT_THROW(measure_brdf_fit(metal, {}, options), Error) << angle;
  }
  EXPECT_THROW(fit_parametric_brdf(metal, SpecularModel::cook_torrance), Error);
  int asked = 0;
  const Progress stop = [&](std::string_view stage, std::uint64_t, std::uint64_t) {
    EXPECT_EQ(stage, "fit BRDF");
    return ++asked < 3;
  };
  EXPECT_THROW(fit_brdf(metal, quick(1), stop), Cancelled);
  EXPECT_EQ(asked, 3);
}

/// Relative L2 errors of three lobes to 80 degrees, from docs/materials.md.
const std::map<std::string, double> kErrorOfFile = {
    {"cc_ibiza_sunset_rgb", 0.261}, {"chm_mint_rgb", 0.444},     {"ilm_solo_m_68_rgb", 0.311},
    {"paper_blue_rgb", 0.062},      {"satin_purple_rgb", 0.229}, {"satin_rosaline_rgb", 0.270}};

// Of each file the fit is closer than either model.
TEST(FitBrdf, BeatsWardAndAshikhminOnMeasuredFiles) {
  const char* shared = std::getenv("BURNISH_SHARED_DATA");
  const std::filesystem::path folder =
      std::filesystem::path(shared ? shared : BURNISH_SOURCE_DIR "/../shared/data") / "brdf";
  if (!std::filesystem::exists(folder))
    GTEST_SKIP() << "no folder " << folder << "; set BURNISH_SHARED_DATA";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".bsdf") continue;
    SCOPED_TRACE(entry.path().filename().string());
    ++files;
    const MeasuredBrdf measured = read_measured_brdf(entry.path().string());
    const double found = fit_brdf(measured).error.relative_l2;
    EXPECT_GE(found, 0.99 * reciprocity_bound(measured));  // of other pairs: by chance
    const auto known = kErrorOfFile.find(entry.path().stem().string());
    if (known != kErrorOfFile.end()) {
      EXPECT_LT(found, known->second + 0.005);  // the figures have three digits
    }
    for (const SpecularModel model : {SpecularModel::ward, SpecularModel::ashikhmin_shirley})
      EXPECT_LT(found,
                measure_brdf_fit(measured, fit_parametric_brdf(measured, model)).relative_l2);
  }
  EXPECT_GE(files, 1);
}

}  // namespace
}  // namespace burnish::test
