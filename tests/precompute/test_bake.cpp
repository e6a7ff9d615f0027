#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/bake.h"
#include "burnish/precompute/lobe_visibility_error.h"
#include "burnish/precompute/spherical_distance_transform.h"
#include "burnish/visibility/visibility_ladder.h"
#include "precompute/test_meshes.h"

namespace burnish {
namespace {

// Every ray is cast, so that the truth is simple; errors are measured on all vertices that are
// left.
constexpr BakeOptions kSmall{.directions = 64,
                             .coarsest = 64,
                             .resolution = 16,
                             .terms = 12,
                             .amplitude_rad = 0,
                             .bases = 1,
                             .ladder_terms = 10,
                             .residual_vertices = 4096};

// A wavy floor with a sphere over it, turned so that nothing is aligned with anything.
TriangleMesh make_scene(float scale = 1) {
  TriangleMesh mesh = test::make_sphere({0.2f, -0.1f, 0.75f}, 0.4f, 7);
  mesh.name = "wavy floor and sphere";
  const int cells = 13;
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i <= cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const double x = 2.0 * j / cells - 1, y = 2.0 * i / cells - 1;
      mesh.positions.push_back(
          Vector3d(x, y, 0.1 * std::sin(6 * x + 1) * std::cos(5 * y)).cast<float>());
      mesh.normals.push_back(Vector3d(-0.6 * std::cos(6 * x + 1) * std::cos(5 * y),
                                      0.5 * std::sin(6 * x + 1) * std::sin(5 * y), 1)
                                 .normalized()
                                 .cast<float>());
    }
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      const auto a = first + static_cast<std::uint32_t>(i * (cells + 1) + j), b = a + cells + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(0.7f, Vector3f(0.3f, 0.5f, -0.8f).normalized()).toRotationMatrix();
  for (Vector3f& p : mesh.positions) p = scale * (turn * p + Vector3f(0.13f, 0.27f, -0.31f));
  for (Vector3f& n : mesh.normals) n = (turn * n).normalized();
  test::complete(mesh);
  return mesh;
}

// Mean + eigen-SSDFs * coefficients, in double.
std::vector<double> reconstruct(const Transfer& transfer, std::size_t vertex) {
  const SsdfBasis& basis = transfer.bases.at(transfer.basis_id.at(vertex));
  const auto terms = static_cast<std::size_t>(basis.terms);
  std::vector<double> ssdf(basis.mean.begin(), basis.mean.end());
  for (std::size_t i = 0; i < ssdf.size(); ++i)
    for (std::size_t k = 0; k < terms; ++k)
      ssdf[i] += double(basis.eigen[i * terms + k]) * transfer.vertex_coefficients(vertex)[k];
  return ssdf;
}

// The same chain without compression.
std::vector<std::vector<float>> direct_ssdfs(const TriangleMesh& mesh, const BakeOptions& options) {
  RayScene scene;
  scene.add_mesh(mesh.positions, mesh.triangles);
  scene.commit();
  const DirectionTable directions(options.directions);
  const SphericalDistanceTransform transform(directions, options.resolution);
  SphericalDistanceTransform::Scratch scratch;
  VisibilityMask mask(options.directions);
  std::vector<std::vector<float>> ssdfs;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    sample_visibility(scene, directions, mesh.positions[i], mesh.normals[i], mask);
    ssdfs.emplace_back(static_cast<std::size_t>(options.resolution * options.resolution));
    transform.transform(mask, ssdfs.back(), scratch);
  }
  return ssdfs;
}

// The vertices that a bake of all `count` vertices trains on: one of each of equal stretches.
std::set<std::size_t> trained(std::size_t count, std::size_t training) {
  std::mt19937_64 random(20031027);
  std::set<std::size_t> vertices;
  for (std::size_t i = 0; i < training; ++i) {
    const std::size_t first = i * count / training, end = (i + 1) * count / training;
    vertices.insert(first + random() % (end - first));
  }
  return vertices;
}

void expect_equal(const Transfer& a, const Transfer& b) {
  ASSERT_EQ(a.bases.size(), b.bases.size());
  for (std::size_t i = 0; i < a.bases.size(); ++i) {
    EXPECT_EQ(a.bases[i].terms, b.bases[i].terms);
    EXPECT_EQ(a.bases[i].mean, b.bases[i].mean);
    EXPECT_EQ(a.bases[i].eigen, b.bases[i].eigen);
  }
  EXPECT_EQ(a.basis_id, b.basis_id);
  EXPECT_EQ(a.coefficients, b.coefficients);
  ASSERT_EQ(a.ladder_bases.size(), b.ladder_bases.size());
  for (std::size_t i = 0; i < a.ladder_bases.size(); ++i) {
    EXPECT_EQ(a.ladder_bases[i].mean, b.ladder_bases[i].mean);
    EXPECT_EQ(a.ladder_bases[i].eigen, b.ladder_bases[i].eigen);
  }
  EXPECT_EQ(a.ladder_coefficients, b.ladder_coefficients);
  EXPECT_EQ(a.provenance.rays, b.provenance.rays);
  EXPECT_EQ(a.provenance.residual_rms_rad, b.provenance.residual_rms_rad);
  EXPECT_EQ(a.provenance.wrong_sign_fraction, b.provenance.wrong_sign_fraction);
}

void expect_only_horizon(const Transfer& transfer) {
  EXPECT_TRUE(transfer.bases.empty());
  EXPECT_TRUE(transfer.basis_id.empty());
  EXPECT_TRUE(transfer.coefficients.empty());
  EXPECT_TRUE(transfer.ladder_bases.empty());
  EXPECT_TRUE(transfer.ladder_coefficients.empty());
  EXPECT_EQ(transfer.ladder_crossover, 0);
}

TEST(Bake, WhereNothingOccludesThereIsNothingToStore) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1}};
  mesh.normals.assign(3, Vector3f(0, -1, 1).normalized());
  mesh.triangles = {{0, 1, 2}};
  test::complete(mesh);
  const Transfer triangle = bake(mesh, {}, kSmall);
  expect_only_horizon(triangle);
  EXPECT_EQ(triangle.provenance.rays, 0u);

  const Transfer sphere = bake(test::make_sphere({1, 2, 3}, 0.5f, 8), {}, kSmall);
  expect_only_horizon(sphere);
  EXPECT_EQ(sphere.provenance.rays, 0u);
}

// A speck high above is nothing that a proof by bounds can rule out, and no ray meets it.
TEST(Bake, WhatNoRayMeetsDoesNotOcclude) {
  TriangleMesh mesh = test::make_disc({0, 0, 0}, 1, 9);
  TriangleMesh speck = test::make_disc({0.3f, 0.2f, 40}, 1e-3f, 3);
  const Transfer transfer = bake(mesh, std::span(&speck, 1), kSmall);
  expect_only_horizon(transfer);
  EXPECT_GT(transfer.provenance.rays, 0u);
}

TEST(Bake, AllTermsReproduceEverySsdf) {
  const TriangleMesh mesh = make_scene();
  BakeOptions options = kSmall;
  options.terms = 256;
  options.training_vertices = 0;
  const Transfer transfer = bake(mesh, {}, options);
  const std::vector<std::vector<float>> truth = direct_ssdfs(mesh, options);
  for (std::size_t v = 0; v < truth.size(); ++v) {
    const std::vector<double> ssdf = reconstruct(transfer, v);
    for (std::size_t i = 0; i < ssdf.size(); ++i)
      ASSERT_NEAR(ssdf[i], truth[v][i], 1e-4);  // float sums over 256 terms of size 1
  }
}

// Lobes see no difference between distances beyond a right angle; nor does the residual.
double within_right_angle(double distance) {
  return std::clamp(distance, -kPi<double> / 2, kPi<double> / 2);
}

TEST(Bake, ResidualIsThatOfHeldOutVertices) {
  const TriangleMesh mesh = make_scene();
  const std::vector<std::vector<float>> truth = direct_ssdfs(mesh, kSmall);
  for (const int training : {0, 100}) {
    BakeOptions options = kSmall;
    options.training_vertices = training;
    const Transfer transfer = bake(mesh, {}, options);
    ASSERT_EQ(transfer.terms(), 12);
    EXPECT_EQ(transfer.provenance.training_vertices,
              training ? training : static_cast<int>(mesh.positions.size()));
    EXPECT_EQ(transfer.provenance.residual_held_out, training > 0);
    EXPECT_EQ(transfer.provenance.residual_vertices,
              static_cast<int>(mesh.positions.size()) - training);
    const std::set<std::size_t> skipped = trained(truth.size(), static_cast<std::size_t>(training));
    double squared = 0, wrong = 0, texels = 0;
    for (std::size_t v = 0; v < truth.size(); ++v) {
      if (skipped.contains(v)) continue;
      const std::vector<double> ssdf = reconstruct(transfer, v);
      for (std::size_t i = 0; i < ssdf.size(); ++i, ++texels) {
        const double error = within_right_angle(ssdf[i]) - within_right_angle(truth[v][i]);
        squared += error * error;
        wrong += ssdf[i] * truth[v][i] < 0;
      }
    }
    const double rms = std::sqrt(squared / texels);
    EXPECT_NEAR(transfer.provenance.residual_rms_rad / rms, 1, 1e-4);  // float sums
    EXPECT_NEAR(transfer.provenance.wrong_sign_fraction, wrong / texels, 3 / texels);
    // Compression to 12 terms has to earn its keep: SSDFs are about 0.8 rad rms.
    EXPECT_LT(rms, training ? 0.12 : 0.1);
    EXPECT_LT(wrong / texels, 0.1);
  }
}

// With as many terms as harmonics, what is left is the harmonics that a ladder does not have, of
// which these lobes see less than 1e-3, and the 64^2 quadrature of those that it has.
TEST(Bake, LadderGivesTheVisibleShareOfWideLobes) {
  const TriangleMesh mesh = make_scene();
  BakeOptions options = kSmall;
  options.ladder_terms = 400;
  options.training_vertices = 0;
  const Transfer transfer = bake(mesh, {}, options);
  ASSERT_EQ(transfer.ladder_bases.size(), 1u);
  const LadderBasis& basis = transfer.ladder_bases[0];
  const RayScene scene = make_ray_scene(mesh, {});
  const DirectionTable directions(64);
  VisibilityMask mask(64);
  for (const std::size_t v : {0u, 60u, 150u, 300u}) {
    sample_visibility(scene, directions, mesh.positions[v], mesh.normals[v], mask);
    const VisibilityHarmonics visibility =
        reconstruct_harmonics(basis, transfer.vertex_ladder_coefficients(v));
    for (const float bandwidth : {0.5f, 1.0f, 3.0f, 8.0f})
      for (const int texel : {70, 1000, 2080, 3333}) {
        const Vector3f axis = directions.direction(texel % 64, texel / 64);
        EXPECT_NEAR(visible_fraction(visibility, axis, lobe_bands(bandwidth)),
                    exact_visible_fraction(mask, axis, static_cast<double>(bandwidth)), 3e-3)
            << "vertex " << v << ", bandwidth " << bandwidth << ", texel " << texel;
      }
  }
}

TEST(Bake, SeveralBasesReconstructBetter) {
  const TriangleMesh mesh = make_scene();
  BakeOptions options = kSmall;
  options.terms = 6;
  const Transfer one = bake(mesh, {}, options);
  options.bases = 4;
  const Transfer four = bake(mesh, {}, options);
  ASSERT_EQ(four.bases.size(), 4u);
  std::array<int, 4> used = {};
  for (const std::uint8_t id : four.basis_id) ++used.at(id);
  for (const int count : used) EXPECT_GT(count, 0);
  EXPECT_LT(four.provenance.residual_rms_rad, 0.8 * one.provenance.residual_rms_rad);
}

TEST(Bake, SameBytesOnAnyNumberOfThreads) {
  const TriangleMesh mesh = make_scene();
  BakeOptions options = kSmall;
  options.training_vertices = 90;
  std::vector<Transfer> transfers;
  for (const std::size_t threads : {1, 2, 5}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    transfers.push_back(bake(mesh, {}, options));
  }
  expect_equal(transfers[0], transfers[1]);
  expect_equal(transfers[0], transfers[2]);
}

TEST(Bake, SizeOfTheMeshDoesNotMatter) {
  BakeOptions options = kSmall;
  options.directions = 128;
  options.training_vertices = 90;
  const Transfer unit = bake(make_scene(), {}, options);
  double largest = 0;
  for (const float c : unit.coefficients) largest = std::max(largest, std::abs(double(c)));
  for (const float scale : {1e-6f, 1e6f, 0x1p-20f}) {
    SCOPED_TRACE(testing::Message() << "scale " << scale);
    const Transfer scaled = bake(make_scene(scale), {}, options);
    EXPECT_EQ(scaled.provenance.rays, unit.provenance.rays);
    ASSERT_EQ(scaled.coefficients.size(), unit.coefficients.size());
    double squared = 0, all = 0, worst = 0;
    for (std::size_t i = 0; i < unit.coefficients.size(); ++i) {
      const double difference = double(scaled.coefficients[i]) - unit.coefficients[i];
      squared += difference * difference;
      all += double(unit.coefficients[i]) * unit.coefficients[i];
      worst = std::max(worst, std::abs(difference));
    }
    // A power of two changes no bit. Else a coordinate rounds differently, and of 8000 rays a
    // vertex a few that graze an edge come out differently: a boundary point that moves by a texel
    // (0.04 rad) changes few of the 256 texels by that.
    if (scale == 0x1p-20f) {
      EXPECT_EQ(worst, 0);
    }
    EXPECT_LT(std::sqrt(squared / all), 1e-3);
    EXPECT_LT(worst, 0.02 * largest);
  }
}

TEST(Bake, OccludersShadowAndAreKept) {
  TriangleMesh floor;
  test::add_quad(floor, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  test::complete(floor);
  // Two half lids over the whole floor, given with vertices of their own.
  TriangleMesh lids[2];
  test::add_quad(lids[0], {-100, -100, 0.5f}, {100, 0, 0}, {0, 200, 0});
  test::add_quad(lids[1], {0, -100, 0.5f}, {100, 0, 0}, {0, 200, 0});
  for (TriangleMesh& lid : lids) test::complete(lid);
  const Transfer open = bake(floor, {}, kSmall), covered = bake(floor, lids, kSmall);
  EXPECT_TRUE(open.bases.empty());
  // Light still comes in under the rim of the lids, 0.5 above and 99 away.
  EXPECT_LT(*std::max_element(covered.bases[0].mean.begin(), covered.bases[0].mean.end()), 0.06f);
  EXPECT_EQ(covered.positions.size(), 4u);
  ASSERT_EQ(covered.occluder_positions.size(), 8u);
  EXPECT_EQ(covered.occluder_positions[4], lids[1].positions[0]);
  ASSERT_EQ(covered.occluder_triangles.size(), 4u);
  EXPECT_EQ(covered.occluder_triangles[3], (Triangle{4, 6, 7}));
  EXPECT_EQ(open.provenance.occluder_hash, "");
  EXPECT_EQ(covered.provenance.occluder_hash.size(), 16u);
  EXPECT_EQ(covered.provenance.mesh_hash, open.provenance.mesh_hash);
}

TEST(Bake, ProvenanceTellsWhatWasBaked) {
  TriangleMesh mesh = make_scene();
  const Transfer transfer = bake(mesh, {}, kSmall);
  const Provenance& provenance = transfer.provenance;
  EXPECT_FALSE(provenance.version.empty());
  EXPECT_EQ(provenance.mesh_name, mesh.name);
  EXPECT_EQ(provenance.directions, 64);

  // FNV-1a from its definition, byte by byte.
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](const auto& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(values[0]); ++i)
      hash = (hash ^ bytes[i]) * 0x100000001b3u;
  };
  add(mesh.positions);
  add(mesh.normals);
  add(mesh.tangents);
  add(mesh.triangles);
  EXPECT_EQ(std::stoull(provenance.mesh_hash, nullptr, 16), hash);
  EXPECT_EQ(provenance.mesh_hash.size(), 16u);

  // Every direction strictly above a vertex's horizon, and no other, is one ray; none where the
  // whole mesh lies below the horizon.
  std::uint64_t rays = 0;
  const DirectionTable directions(64);
  const RayScene scene = make_ray_scene(mesh, {});
  EXPECT_EQ(provenance.origin_offset, double(scene.origin_offset()));
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    const Vector3f& n = mesh.normals[v];
    const float height = n.dot(mesh.positions[v] + scene.origin_offset() * n);
    if (std::all_of(mesh.positions.begin(), mesh.positions.end(),
                    [&](const Vector3f& p) { return n.dot(p) < height; }))
      continue;
    for (int i = 0; i < 64 * 64; ++i) rays += n.dot(directions.direction(i % 64, i / 64)) > 0;
  }
  // Directions within rounding of a horizon may go either way.
  EXPECT_NEAR(double(provenance.rays), double(rays), 5);

  mesh.positions[3].x() += 0.01f;
  EXPECT_NE(bake(mesh, {}, kSmall).provenance.mesh_hash, provenance.mesh_hash);
}

TEST(Bake, TextureCoordinatesComeAlong) {
  TriangleMesh mesh = test::make_disc({0, 0, 0}, 1, 5);
  EXPECT_TRUE(bake(mesh, {}, kSmall).texcoords.empty());
  for (const Vector3f& position : mesh.positions)
    mesh.uvs.emplace_back(position.x(), 1 - position.y());
  EXPECT_EQ(bake(mesh, {}, kSmall).texcoords, mesh.uvs);
  std::vector<Eigen::Vector2f> expected = mesh.uvs;
  expected[2].setZero();
  mesh.uvs[2].x() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(bake(mesh, {}, kSmall).texcoords, expected);
}

TEST(Bake, UnusableVerticesAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const TriangleMesh mesh = make_scene();
  const Transfer plain = bake(mesh, {}, kSmall);
  TriangleMesh messy = mesh;
  const std::size_t count = mesh.positions.size();
  const Vector3f up = Vector3f::UnitZ();
  messy.positions.insert(messy.positions.end(),
                         {{0, 0, 0}, {nan, 0, 0}, {0, 0, 0}, mesh.positions[40]});
  messy.normals.insert(messy.normals.end(), {{0, 0, 0}, up, {nan, 0, 1}, 7 * mesh.normals[40]});
  messy.tangents.insert(messy.tangents.end(),
                        {Vector3f::UnitX(), {nan, 0, 0}, {0, 0, 0}, mesh.normals[40]});
  messy.file_vertex.insert(messy.file_vertex.end(), 4, 0);
  messy.triangles.push_back({static_cast<std::uint32_t>(count + 1), 0, 1});  // a corner not finite
  const Transfer transfer = bake(messy, {}, kSmall);
  ASSERT_EQ(transfer.coefficients.size(), 12 * (count + 4));
  const std::string path = testing::TempDir() + "burnish_unusable_vertices.h5";
  EXPECT_NO_THROW(write_transfer(transfer, path));
  std::remove(path.c_str());
  EXPECT_EQ(transfer.positions[count - 1], mesh.positions[count - 1]);
  EXPECT_EQ(transfer.tangents[count - 1], mesh.tangents[count - 1]);
  for (std::size_t v = count; v < count + 3; ++v)
    for (int k = 0; k < 12; ++k) EXPECT_EQ(transfer.vertex_coefficients(v)[k], 0);
  // The copy of vertex 40, referenced by no triangle and with a longer normal, is as vertex 40.
  for (int k = 0; k < 12; ++k)
    EXPECT_NEAR(transfer.vertex_coefficients(count + 3)[k], transfer.vertex_coefficients(40)[k],
                1e-4);
  EXPECT_EQ(transfer.provenance.training_vertices, static_cast<int>(count + 1));
  EXPECT_NEAR(transfer.provenance.residual_rms_rad, plain.provenance.residual_rms_rad,
              0.02 * plain.provenance.residual_rms_rad);  // one vertex more among 300
}

TEST(Bake, ProgressCountsEveryStageFromOneThreadAtATime) {
  const TriangleMesh mesh = make_scene();
  BakeOptions options = kSmall;
  options.training_vertices = 50;
  std::atomic<int> inside = 0;
  std::vector<std::string> stages;
  std::vector<std::uint64_t> last, totals;
  const Progress progress = [&](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    EXPECT_EQ(inside.fetch_add(1), 0);
    if (stages.empty() || stages.back() != stage) {
      stages.emplace_back(stage);
      last.push_back(0);
      totals.push_back(total);
    }
    EXPECT_GE(done, last.back());
    EXPECT_EQ(total, totals.back());
    last.back() = done;
    inside.fetch_sub(1);
    return true;
  };
  bake(mesh, {}, options, {.progress = progress});
  EXPECT_EQ(stages, (std::vector<std::string>{"horizon", "train", "measure", "basis", "bake"}));
  ASSERT_EQ(totals.size(), 5u);
  EXPECT_EQ(totals[1], 50u);
  EXPECT_EQ(totals[2], mesh.positions.size() - 50);
  EXPECT_EQ(totals[4], mesh.positions.size());
  // The first stage ends with the first vertex that something occludes.
  for (std::size_t i = 1; i < last.size(); ++i) EXPECT_EQ(last[i], totals[i]) << stages[i];
}

TEST(Bake, StopsPromptlyWhenAskedTo) {
  const TriangleMesh mesh = make_scene();
  BakeOptions options = kSmall;
  options.training_vertices = 50;
  for (const std::string stop : {"horizon", "train", "measure", "basis", "bake"})
    for (const std::uint64_t at : {0, 3}) {
      if (stop == "horizon" && at > 0) continue;  // it ends with the first occluded vertex
      int calls_after = 0;
      bool stopped = false;
      const Progress progress = [&](std::string_view stage, std::uint64_t done, std::uint64_t) {
        calls_after += stopped;
        stopped = stopped || (stage == stop && done >= at);
        return !stopped;
      };
      EXPECT_THROW(bake(mesh, {}, options, {.progress = progress}), Cancelled)
          << stop << " at " << at;
      EXPECT_TRUE(stopped);
      EXPECT_EQ(calls_after, 0);
    }
}

TEST(Bake, RejectsOptionsOutOfRange) {
  const TriangleMesh mesh = test::make_disc({0, 0, 0}, 1, 5);
  EXPECT_NO_THROW(bake(mesh, {}, {.directions = 64, .resolution = 64, .terms = 1}));
  for (const BakeOptions& options : std::vector<BakeOptions>{
           {.directions = 32, .resolution = 16},
           {.directions = 2048, .resolution = 16},
           {.directions = 96, .resolution = 16},
           {.directions = -64, .resolution = 16},
           {.directions = 64, .resolution = 128},
           {.directions = 64, .resolution = 8},
           {.directions = 64, .resolution = 24},
           {.directions = 64, .resolution = 16, .terms = 0},
           {.directions = 64, .resolution = 16, .terms = 257},
           {.directions = 64, .coarsest = 8, .resolution = 16},
           {.directions = 64, .coarsest = 48, .resolution = 16},
           {.directions = 64, .origin_offset = -1, .resolution = 16},
           {.directions = 64, .resolution = 16, .terms = 12, .bases = 257},
           {.directions = 64, .resolution = 16, .terms = 12, .bases = -1},
           {.directions = 64, .resolution = 16, .terms = 12, .target_error = -0.1},
           {.directions = 64, .resolution = 16, .terms = 12, .ladder_terms = -1},
           {.directions = 64, .resolution = 16, .terms = 12, .residual_vertices = 0},
           {.directions = 64, .resolution = 16, .terms = 12, .residual_vertices = 4097},
           {.directions = 64, .resolution = 64, .terms = 1025},
           {.directions = 64, .resolution = 16, .terms = 12, .amplitude_rad = -1},
           {.directions = 64, .resolution = 16, .terms = 12, .ladder_terms = 1025},
           {.directions = 64, .resolution = 16, .terms = 12, .training_vertices = -1}})
    EXPECT_THROW(bake(mesh, {}, options), Error)
        << options.directions << " " << options.resolution << " " << options.terms << " "
        << options.training_vertices;
}

TEST(Bake, RejectsMeshesItCannotUse) {
  const TriangleMesh good = test::make_disc({0, 0, 0}, 1, 5);
  const auto expect_rejected = [&](const std::function<void(TriangleMesh&)>& spoil) {
    TriangleMesh mesh = good;
    spoil(mesh);
    EXPECT_THROW(bake(mesh, {}, kSmall), Error);
  };
  expect_rejected([](TriangleMesh& m) { m.triangles.clear(); });
  expect_rejected([](TriangleMesh& m) { m.normals.pop_back(); });
  expect_rejected([](TriangleMesh& m) { m.tangents.pop_back(); });
  expect_rejected([](TriangleMesh& m) { m.file_vertex.pop_back(); });
  expect_rejected([](TriangleMesh& m) { m.uvs.resize(3); });
  expect_rejected([](TriangleMesh& m) { m.triangles[0][1] = 6; });
  expect_rejected([](TriangleMesh& m) {
    for (Vector3f& n : m.normals) n.setZero();
  });
  TriangleMesh occluder = good;
  occluder.triangles[2][0] = 1000;
  EXPECT_THROW(bake(good, std::span(&occluder, 1), kSmall), Error);
}

}  // namespace
}  // namespace burnish
