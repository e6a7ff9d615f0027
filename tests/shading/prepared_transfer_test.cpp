// What points see of a transfer: rows of any length, in either precision, of any bases.

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "burnish/shading/shade.h"
#include "shading/random_transfer.h"
#include "shading/small_transfer.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 72;

Material glossy() {
  return {.diffuse = Rgb(0.5f, 0.4f, 0.3f),
          .specular = Rgb::Constant(0.5f),
          .model = SpecularModel::ward,
          .alpha_x = 0.3f,
          .alpha_y = 0.15f};
}

/// Radiance of points seen from 30 degrees off their normals.
std::vector<Rgb> shade(const PreparedTransfer& transfer, const std::vector<ShadingPoint>& points,
                       const LightRig& rig, const ShadingOptions& options = {}) {
  const PreparedLights lights = prepare_lights(rig, transfer, options);
  const PreparedMaterial material = prepare_material(glossy(), options.specular);
  std::vector<Vector3f> outgoing;
  for (const ShadingPoint& point : points)
    outgoing.push_back(point.frame.to_world(Vector3f(0.3f, 0.4f, 0.866f).normalized()));
  std::vector<Rgb> radiance(points.size());
  shade_points(transfer, points, outgoing, material, {&lights, nullptr}, options, radiance);
  return radiance;
}

std::vector<ShadingPoint> vertex_points(const PreparedTransfer& transfer) {
  std::vector<ShadingPoint> points;
  for (size_t i = 0; i < transfer.vertex_count(); ++i)
    points.push_back(vertex_shading_point(transfer, i));
  return points;
}

std::vector<Rgb> shade_vertices(const Transfer& transfer, const LightRig& rig,
                                const ShadingOptions& options = {}) {
  const PreparedTransfer prepared = prepare_exactly(transfer);
  return shade(prepared, vertex_points(prepared), rig, options);
}

double mean_of(const std::vector<Rgb>& radiance) {
  double sum = 0;
  for (const Rgb& rgb : radiance) sum += double(rgb.sum()) / 3;
  return sum / double(radiance.size());
}

/// One vertex whose bases have no terms to speak of: what a point sees is their mean, summed up in
/// double.
struct Seen {
  std::vector<double> ssdf, harmonics;

  void add(const Transfer& transfer, size_t vertex, double weight) {
    const SsdfBasis& basis = transfer.bases[transfer.basis_id[vertex]];
    add_row(basis.mean, basis.eigen, basis.terms, transfer.vertex_coefficients(vertex), weight,
            ssdf);
    if (const LadderBasis* ladder = transfer.vertex_ladder_basis(vertex))
      add_row(ladder->mean, ladder->eigen, ladder->terms,
              transfer.vertex_ladder_coefficients(vertex), weight, harmonics);
  }

  PreparedTransfer transfer(const Transfer& like) const {
    const int resolution = like.bases[0].resolution;
    const SsdfBasis basis{resolution,
                          1,
                          like.bases[0].amplitude_rad,
                          {ssdf.begin(), ssdf.end()},
                          std::vector<float>(ssdf.size(), 0.0f)};
    if (harmonics.empty()) return prepare_exactly(vertex_that_sees(basis));
    const LadderBasis ladder{like.ladder_bases[0].bands,
                             1,
                             {harmonics.begin(), harmonics.end()},
                             std::vector<float>(harmonics.size(), 0.0f)};
    return prepare_exactly(vertex_that_sees(basis, ladder, like.ladder_crossover));
  }

 private:
  static void add_row(const std::vector<float>& mean, const std::vector<float>& eigen, int terms,
                      const float* coefficients, double weight, std::vector<double>& sum) {
    const size_t count = static_cast<size_t>(terms);
    sum.resize(mean.size());
    for (size_t i = 0; i < mean.size(); ++i) {
      double value = double(mean[i]);
      for (size_t k = 0; k < count; ++k)
        value += double(eigen[i * count + k]) * double(coefficients[k]);
      sum[i] += weight * value;
    }
  }
};

/// An SSDF of order 1, of rounded coefficients and sums, is off by some 2e-7 rad, and reciprocals
/// by as much of themselves; what is seen of all lights together changes by less than a few times
/// their mean per radian.
constexpr double kRounding = 2e-6;

TEST(PreparedTransfer, APointSeesTheMeanAndItsTermsOfAnyNumber) {
  SCOPED_TRACE(kSeed);
  for (const int terms : {1, 2, 5, 15, 16, 17, 31, 33, 48, 1024})
    for (const int ladders : {0, 1, 2}) {
      std::mt19937 random(kSeed);
      const int ladder_terms = ladders == 0 ? 0 : terms == 1024 ? 1024 : terms / 2 + 1;
      const Transfer transfer = random_transfer({.vertices = terms > 100 ? 3u : 9u,
                                                 .terms = terms,
                                                 .bases = 2,
                                                 .ladder_terms = ladder_terms,
                                                 .ladders = ladders},
                                                random);
      const LightRig rig = random_rig(random);
      const PreparedTransfer prepared = prepare_exactly(transfer);
      const std::vector<ShadingPoint> points = vertex_points(prepared);
      const std::vector<Rgb> found = shade(prepared, points, rig);
      double error = 0;
      for (size_t i = 0; i < points.size(); ++i) {
        Seen seen;
        seen.add(transfer, i, 1);
        ShadingPoint alone = points[i];
        alone.vertices = {};
        const Rgb expected = shade(seen.transfer(transfer), {alone}, rig)[0];
        error += double((found[i] - expected).abs().maxCoeff());
      }
      EXPECT_GT(mean_of(found), 0.05);
      EXPECT_LT(error / double(points.size()), kRounding * mean_of(found))
          << terms << " terms, " << ladders << " ladders";
    }
}

TEST(PreparedTransfer, APointBetweenVerticesSeesTheirWeightedMean) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  for (const float amplitude_rad : {0.0f, 0.7f})
    for (const int ladders : {0, 1, 3}) {
      const Transfer transfer = random_transfer({.vertices = 12,
                                                 .terms = 9,
                                                 .bases = 3,
                                                 .ladder_terms = 5,
                                                 .ladders = ladders,
                                                 .amplitude_rad = amplitude_rad},
                                                random);
      const LightRig rig = random_rig(random);
      const PreparedTransfer prepared = prepare_exactly(transfer);
      std::vector<ShadingPoint> points;
      for (size_t i = 0; i < 60; ++i) {
        ShadingPoint point = vertex_shading_point(prepared, i % 12);
        for (std::uint32_t& vertex : point.vertices) vertex = random() % 12;
        const float a = float(random() % 5) / 4, b = float(random() % 5) / 4;  // corners, too
        point.weight = {a * b, a * (1 - b), 1 - a};
        points.push_back(point);
      }
      const std::vector<Rgb> found = shade(prepared, points, rig);
      double error = 0;
      for (size_t i = 0; i < points.size(); ++i) {
        Seen seen;
        for (size_t j = 0; j < 3; ++j)
          seen.add(transfer, points[i].vertices[j], double(points[i].weight[j]));
        ShadingPoint alone = points[i];
        alone.vertices = {};
        alone.weight = {1, 0, 0};
        error +=
            double((found[i] - shade(seen.transfer(transfer), {alone}, rig)[0]).abs().maxCoeff());
      }
      EXPECT_LT(error / double(points.size()), kRounding * mean_of(found))
          << ladders << " ladders, amplitude " << amplitude_rad;
    }
}

/// Only the first terms of a transfer's bases and rows.
Transfer truncated(const Transfer& transfer, int terms) {
  const auto keep = [terms](const std::vector<float>& values, int stride) {
    std::vector<float> kept;
    for (size_t i = 0; i < values.size(); ++i)
      if (i % static_cast<size_t>(stride) < static_cast<size_t>(terms)) kept.push_back(values[i]);
    return kept;
  };
  Transfer result = transfer;
  for (SsdfBasis& basis : result.bases) {
    basis.eigen = keep(basis.eigen, basis.terms);
    basis.terms = terms;
  }
  result.coefficients = keep(transfer.coefficients, transfer.terms());
  return result;
}

TEST(PreparedTransfer, FewerTermsAreThoseOfAShorterTransfer) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const Transfer transfer = random_transfer(
      {.vertices = 40, .terms = 37, .bases = 2, .ladder_terms = 6, .ladders = 1}, random);
  const LightRig rig = random_rig(random);
  const std::vector<Rgb> all = shade_vertices(transfer, rig);
  for (const int terms : {1, 15, 16, 23, 36, 37}) {
    const std::vector<Rgb> found = shade_vertices(transfer, rig, {.terms = terms});
    const std::vector<Rgb> expected = shade_vertices(truncated(transfer, terms), rig);
    double change = 0;
    for (size_t i = 0; i < found.size(); ++i) {
      EXPECT_TRUE((found[i] == expected[i]).all()) << terms << " terms, vertex " << i;
      change += double((found[i] - all[i]).abs().maxCoeff());
    }
    EXPECT_EQ(change > 0.01 * mean_of(all), terms < 37) << terms << ": " << change;
  }
}

TEST(PreparedTransfer, HalfPrecisionIsExactForItsOwnNumbers) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  Transfer transfer = random_transfer(
      {.vertices = 50, .terms = 21, .bases = 2, .ladder_terms = 6, .ladders = 2}, random);
  const auto round = [](float& value) { value = std::round(256 * value) / 256; };
  std::for_each(transfer.coefficients.begin(), transfer.coefficients.end(), round);
  std::for_each(transfer.ladder_coefficients.begin(), transfer.ladder_coefficients.end(), round);
  for (SsdfBasis& basis : transfer.bases)
    std::for_each(basis.eigen.begin(), basis.eigen.end(), round);
  transfer.coefficients[0] = 65504;  // the largest, the smallest and a subnormal
  transfer.coefficients[1] = std::ldexp(1.0f, -14);
  transfer.coefficients[2] = -3 * std::ldexp(1.0f, -24);
  const LightRig rig = random_rig(random);
  const PreparedTransfer half = prepare_transfer(transfer), single = prepare_exactly(transfer);
  ASSERT_EQ(half.format, RowFormat::float16);
  ASSERT_EQ(single.format, RowFormat::float32);
  EXPECT_TRUE(half.rows32.empty() && single.rows16.empty());
  EXPECT_TRUE(half.bases[0].eigen32.empty() && single.bases[0].eigen16.empty());
  const std::vector<Rgb> a = shade(half, vertex_points(half), rig);
  const std::vector<Rgb> b = shade(single, vertex_points(single), rig);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_TRUE((a[i] == b[i]).all()) << i;
}

TEST(PreparedTransfer, HalfPrecisionIsCloseForOthers) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const Transfer transfer = random_transfer(
      {.vertices = 400, .terms = 24, .bases = 2, .ladder_terms = 6, .ladders = 2}, random);
  const LightRig rig = random_rig(random);
  const PreparedTransfer half = prepare_transfer(transfer), single = prepare_exactly(transfer);
  const std::vector<Rgb> found = shade(half, vertex_points(half), rig);
  const std::vector<Rgb> truth = shade(single, vertex_points(single), rig);
  double error = 0, norm = 0;
  for (size_t i = 0; i < found.size(); ++i) {
    error += double((found[i] - truth[i]).square().sum());
    norm += double(truth[i].square().sum());
  }
  // A coefficient is rounded by at most 2^-11 of it: SSDFs that the terms move by .5 are off by
  // .5 / 2048 at most. What is seen of all lights together changes by less than 1 per radian.
  const double relative = std::sqrt(error / norm);
  EXPECT_LT(relative, 0.5 / 2048);
  EXPECT_GT(relative, 1e-6);
}

TEST(PreparedTransfer, WhatHalfPrecisionCannotHoldStaysSingle) {
  std::mt19937 random(kSeed);
  Transfer transfer =
      random_transfer({.vertices = 4, .terms = 5, .ladder_terms = 3, .ladders = 1}, random);
  EXPECT_EQ(prepare_transfer(transfer).format, RowFormat::float16);
  // Position, normal and tangent, the basis and the coefficients.
  EXPECT_EQ(prepare_transfer(transfer).bytes_per_vertex(), 36u + 1 + 2 * 8);
  EXPECT_EQ(prepare_exactly(transfer).bytes_per_vertex(), 36u + 1 + 4 * 8);
  transfer.ladder_coefficients.back() = 65505;
  EXPECT_EQ(prepare_transfer(transfer).format, RowFormat::float32);
  EXPECT_EQ(kOpen.bytes_per_vertex(), 36u);
}

}  // namespace
}  // namespace burnish::test
