#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/visibility_sampler.h"
#include "burnish/sphere/octahedral_map.h"
#include "precompute/test_meshes.h"

namespace burnish {
namespace {

constexpr unsigned kSeed = 20131104;
constexpr int kDirections = 256;

const DirectionTable& table() {
  static const DirectionTable directions(kDirections);
  return directions;
}

RayScene scene_of(const TriangleMesh& mesh, float scale = 1) {
  std::vector<Vector3f> positions = mesh.positions;
  for (Vector3f& p : positions) p *= scale;
  RayScene scene;
  scene.add_mesh(positions, mesh.triangles);
  scene.commit();
  return scene;
}

Vector3f random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return Vector3f(normal(random), normal(random), normal(random)).normalized();
}

// A floor under a sphere, a box's side and a few thin slats: straight, round and thin silhouettes.
TriangleMesh clutter() {
  TriangleMesh mesh = test::make_sphere({0.4f, 0.3f, 0.5f}, 0.3f, 24);
  test::add_quad(mesh, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  test::add_quad(mesh, {-0.8f, -0.5f, 0}, {0, 1.1f, 0.1f}, {0.1f, 0, 0.9f});
  for (int i = 0; i < 5; ++i)
    test::add_quad(mesh, {-0.5f + 0.2f * static_cast<float>(i), -0.9f, 0.1f}, {0.07f, 0, 0},
                   {0.1f, 0.05f, 0.8f});
  return mesh;
}

struct Sampled {
  VisibilityMask mask{kDirections};
  std::uint64_t rays = 0;
};

Sampled sample(const RayScene& scene, const Vector3f& origin, const Vector3f& normal,
               int coarsest = VisibilitySampler::kDefaultCoarsest) {
  const VisibilitySampler sampler(scene, table(), coarsest);
  VisibilitySampler::Scratch scratch;
  Sampled result;
  result.rays = sampler.sample(origin, normal, result.mask, scratch);
  return result;
}

Sampled cast_all(const RayScene& scene, const Vector3f& origin, const Vector3f& normal) {
  Sampled result;
  result.rays = sample_visibility_from(scene, table(), origin, normal, result.mask);
  return result;
}

int occluded_above(const VisibilityMask& mask, const Vector3f& normal) {
  int count = 0;
  for (int y = 0; y < mask.resolution; ++y)
    for (int x = 0; x < mask.resolution; ++x)
      count += table().direction(x, y).dot(normal) > 0 && !mask.visible(x, y);
  return count;
}

// All silhouettes are closed curves or end at the horizon, and all are wider than the coarsest cell
// (0.055 rad) but for their tips: what differs is whole features or cracks at single texels.
TEST(VisibilitySampler, AgreesWithCastingEverything) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> place(-1.2f, 1.2f);
  const TriangleMesh mesh = clutter();
  const RayScene scene = scene_of(mesh);
  const VisibilitySampler sampler(scene, table(), 64);
  VisibilitySampler::Scratch scratch;
  VisibilityMask sampled(kDirections), truth(kDirections);
  VisibilityCheck sum;
  int occluded = 0;
  for (int i = 0; i < 60; ++i) {
    // Upright normals on the floor, tilted ones in the air, so that the map's seams and poles are
    // above the horizon as often as below.
    const bool floor = i % 2 == 0;
    const Vector3f normal = floor ? Vector3f::UnitZ() : random_direction(random);
    const Vector3f origin(place(random), place(random), floor ? 1e-3f : 0.1f);
    sum += check_visibility(scene, table(), sampler, origin, normal, sampled, truth, scratch);
    occluded += occluded_above(truth, normal);
  }
  EXPECT_EQ(sum.directions, 60u * kDirections * kDirections);
  EXPECT_GT(occluded, 60 * 1000) << "the scene occludes too little to test anything";
  // The bound, 0.01 %, on shapes with few features below the coarsest cell.
  EXPECT_LE(static_cast<double>(sum.differing), 1e-4 * static_cast<double>(sum.directions));
  // 32k directions are above the horizon; the coarsest samples are 2k.
  EXPECT_LT(sum.sampler_rays, sum.all_rays / 2);
  EXPECT_GT(sum.sampler_rays, sum.all_rays / 20);
}

TEST(VisibilitySampler, FullCoarsestLevelGivesTheSameMask) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const RayScene scene = scene_of(clutter());
  for (int i = 0; i < 6; ++i) {
    const Vector3f normal = random_direction(random);
    const Vector3f origin(0.1f, -0.2f, 0.15f);
    const Sampled truth = cast_all(scene, origin, normal);
    for (const int coarsest : {kDirections, kDirections / 2}) {
      const Sampled sampled = sample(scene, origin, normal, coarsest);
      EXPECT_EQ(sampled.mask.bits, truth.mask.bits);
      EXPECT_EQ(sampled.rays, truth.rays);
    }
  }
}

// A disc just wider than the coarsest cells' diagonal spacing always covers one of their samples,
// wherever it stands: over the poles, the folds and the seams of the map, too.
TEST(VisibilitySampler, FindsWhatIsWiderThanTheCoarsestCell) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::vector<Vector3f> places = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}};
  for (int i = 0; i < 12; ++i) {
    const float angle = 0.5236f * static_cast<float>(i) + 0.01f;
    places.push_back({std::cos(angle), std::sin(angle), 0});  // the fold
    places.push_back(Vector3f(std::cos(angle), std::sin(angle), -4).normalized());
    places.push_back(random_direction(random));
  }
  // Seams: the meridians through the map's edges, below the equator.
  for (const float z : {-0.2f, -0.6f, -0.95f})
    for (const Vector3f& side :
         {Vector3f(1, 0, 0), Vector3f(0, 1, 0), Vector3f(-1, 0, 0), Vector3f(0, -1, 0)})
      places.push_back(side * std::sqrt(1 - z * z) + Vector3f(0, 0, z));
  for (const int coarsest : {16, 32, 64}) {
    // Cells are up to 1.6 times longer than wide (the map keeps areas, not shapes), and at the
    // seams samples are 9/8 of a cell apart.
    const float radius = 1.3f * std::sqrt(4 * kPi<float>) / static_cast<float>(coarsest);
    for (const Vector3f& place : places) {
      TriangleMesh disc = test::make_disc({0, 0, 1}, std::tan(radius), 48);
      const Eigen::Matrix3f turn =
          Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitZ(), place).toRotationMatrix();
      for (Vector3f& p : disc.positions) p = turn * p;
      const RayScene scene = scene_of(disc);
      const Vector3f normal = (place + 0.8f * random_direction(random)).normalized();
      const Sampled truth = cast_all(scene, Vector3f::Zero(), normal);
      ASSERT_EQ(sample(scene, Vector3f::Zero(), normal, coarsest).mask.bits, truth.mask.bits)
          << "coarsest " << coarsest << " at " << place.transpose();
    }
  }
}

// A band half a degree wide, far thinner than a coarsest cell of 3 degrees, that ends in a post
// which is wide enough to be met: the edge is followed along the band to its end.
TEST(VisibilitySampler, FollowsAHairThinOccluderOverSeamsAndPoles) {
  TriangleMesh ring;
  const int pieces = 90;
  const auto corner = [&](double angle, double half_width) {
    // A great circle through both poles.
    const Vector3d p(std::sin(angle) + 0.3 * half_width, half_width + 0.02, std::cos(angle));
    return Vector3f(p.cast<float>());
  };
  for (int i = 0; i < pieces; ++i) {
    const double a0 = 2 * kPi<double> * i / pieces, a1 = 2 * kPi<double> * (i + 1) / pieces;
    const double width = i == 7 ? 0.12 : 0.007;
    const Vector3f p = corner(a0, -width), q = corner(a1, -width);
    test::add_quad(ring, p, q - p, corner(a0, width) - p);
  }
  const RayScene scene = scene_of(ring);
  for (const Vector3f& normal :
       {Vector3f(0, 0, 1), Vector3f(0, 0, -1), Vector3f(1, 0, 0), Vector3f(0.6f, 0, -0.8f)}) {
    const Vector3f origin(0, 0, 0);
    const Sampled truth = cast_all(scene, origin, normal);
    const Sampled sampled = sample(scene, origin, normal);
    // Half a circle is 227 texels long.
    ASSERT_GT(occluded_above(truth.mask, normal), 200);
    EXPECT_EQ(sampled.mask.bits, truth.mask.bits) << normal.transpose();
  }
}

TEST(VisibilitySampler, HorizonCostsNoRefinement) {
  // A panel of 9 degrees straight above keeps the hemisphere from being empty.
  TriangleMesh mesh;
  test::add_quad(mesh, {-50, -50, 0}, {100, 0, 0}, {0, 100, 0});
  test::add_quad(mesh, {-1.5f, -1.5f, 20}, {3, 0, 0}, {0, 3, 0});
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(0.7f, Vector3f(0.3f, -0.9f, 0.2f).normalized()).toRotationMatrix();
  for (Vector3f& p : mesh.positions) p = turn * p;
  const RayScene scene = scene_of(mesh);
  const Vector3f normal = turn.col(2);
  const Sampled sampled = sample(scene, scene.origin_offset() * normal, normal);
  EXPECT_EQ(sampled.mask.bits, cast_all(scene, scene.origin_offset() * normal, normal).mask.bits);
  // Half of 64^2 samples; a ray for each cell that touches the horizon (113 cells long, of which a
  // slanted line touches two a cell's length, or three); some 30 tiles about the panel's rim, and
  // the cells before them.
  EXPECT_LT(sampled.rays, 64u * 64 / 2 + 340 + 40 * 16);
}

// A lid that leaves a slit half a degree high all around, a texel at this resolution, over floors
// whose horizon runs along rows of texels and along the map's seams, or across.
TEST(VisibilitySampler, SeesAThinSlitOverTheHorizon) {
  TriangleMesh lid;
  test::add_quad(lid, {-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
  const int sides = 64;
  for (int i = 0; i < sides; ++i) {
    const auto on_rim = [&](int k) {
      const double phi = 2 * kPi<double> * k / sides;
      return Vector3f(Vector3d(std::cos(phi), std::sin(phi), 0.018).cast<float>());
    };
    test::add_quad(lid, on_rim(i), on_rim(i + 1) - on_rim(i), {0, 0, 1});
    const auto first = static_cast<std::uint32_t>(lid.positions.size());
    for (const Vector3f& p : {Vector3f(on_rim(i) + Vector3f::UnitZ()),
                              Vector3f(on_rim(i + 1) + Vector3f::UnitZ()), Vector3f(0, 0, 1.018f)})
      lid.positions.push_back(p);
    lid.triangles.push_back({first, first + 1, first + 2});
  }
  for (const Vector3f& normal :
       {Vector3f(0, 0, 1), Vector3f(0, 1, 0), Vector3f(-1, 0, 0), Vector3f(0.48f, -0.6f, 0.64f)}) {
    TriangleMesh turned = lid;
    for (Vector3f& p : turned.positions)
      p = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitZ(), normal) * p;
    const RayScene scene = scene_of(turned);
    const Vector3f origin = scene.origin_offset() * normal;
    const Sampled truth = cast_all(scene, origin, normal);
    int visible = 0;
    for (const std::uint64_t word : truth.mask.bits) visible += __builtin_popcountll(word);
    ASSERT_GT(visible, 100) << "a slit to be seen";
    EXPECT_EQ(sample(scene, origin, normal).mask.bits, truth.mask.bits) << normal.transpose();
  }
}

TEST(VisibilitySampler, ConvexBodyAndOpenPlaneCostNoRays) {
  const TriangleMesh sphere = test::make_sphere({0.2f, -0.1f, 0.3f}, 0.7f, 40);
  TriangleMesh plane;
  test::add_quad(plane, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
  for (const TriangleMesh* mesh : {&sphere, static_cast<const TriangleMesh*>(&plane)}) {
    const RayScene scene = scene_of(*mesh);
    for (std::size_t i = 0; i < mesh->positions.size(); i += 37) {
      const Vector3f normal = mesh->normals[i];
      const Vector3f origin = mesh->positions[i] + scene.origin_offset() * normal;
      const Sampled sampled = sample(scene, origin, normal);
      ASSERT_EQ(sampled.rays, 0u) << mesh->name << " vertex " << i;
      ASSERT_EQ(sampled.mask.bits, cast_all(scene, origin, normal).mask.bits);
    }
  }
}

TEST(VisibilitySampler, RepeatsBitForBitOnAnyThread) {
  const RayScene scene = scene_of(clutter());
  const VisibilitySampler sampler(scene, table(), 32);
  constexpr std::size_t kVertices = 24;
  const auto run = [&](std::size_t i, VisibilitySampler::Scratch& scratch) {
    const float t = static_cast<float>(i) / kVertices;
    Sampled result;
    result.rays = sampler.sample({2 * t - 1, 0.3f - t, 0.05f}, Vector3f(t, 0.2f, 1).normalized(),
                                 result.mask, scratch);
    return result;
  };
  std::vector<Sampled> serial(kVertices), parallel(kVertices);
  VisibilitySampler::Scratch scratch;
  for (std::size_t i = 0; i < kVertices; ++i) serial[i] = run(i, scratch);
  tbb::parallel_for(std::size_t{0}, kVertices, [&](std::size_t i) {
    VisibilitySampler::Scratch own;
    parallel[i] = run(i, own);
  });
  for (std::size_t i = kVertices; i-- > 0;) {  // backwards: what a scratch saw before is no matter
    const Sampled again = run(i, scratch);
    ASSERT_EQ(serial[i].mask.bits, parallel[i].mask.bits);
    ASSERT_EQ(serial[i].mask.bits, again.mask.bits);
    ASSERT_EQ(serial[i].rays, parallel[i].rays);
  }
}

TEST(VisibilitySampler, ScratchServesSamplersOfOtherSizes) {
  const RayScene scene = scene_of(clutter());
  const DirectionTable small(64);
  const Vector3f origin(0.1f, 0.1f, 0.01f), normal(0, 0, 1);
  VisibilitySampler::Scratch scratch;
  for (const int coarsest : {64, 16}) {
    const VisibilitySampler sampler(scene, table(), coarsest), tiny(scene, small, coarsest);
    VisibilityMask mask(kDirections), tiny_mask(64), tiny_truth(64);
    sampler.sample(origin, normal, mask, scratch);
    EXPECT_EQ(mask.bits, sample(scene, origin, normal, coarsest).mask.bits);
    tiny.sample(origin, normal, tiny_mask, scratch);
    sample_visibility_from(scene, small, origin, normal, tiny_truth);
    int differing = 0;
    for (std::size_t i = 0; i < tiny_mask.bits.size(); ++i)
      differing += __builtin_popcountll(tiny_mask.bits[i] ^ tiny_truth.bits[i]);
    // Everything is cast, or cells of 13 degrees miss a slat.
    EXPECT_LE(differing, coarsest == 64 ? 0 : 64 * 64 / 50);
  }
}

TEST(VisibilitySampler, ScaleDoesNotChangeTheMask) {
  const TriangleMesh mesh = clutter();
  const Vector3f origin(0.1f, 0.1f, 0.01f), normal(0, 0, 1);
  const Sampled unit = sample(scene_of(mesh), origin, normal);
  // Powers of two change exponents only; decimal scales round each coordinate once, which may flip
  // a texel whose ray passes within 1e-7 of an edge.
  for (const float scale : {0x1p-20f, 0x1p20f, 1e-6f, 1e6f}) {
    const bool exact = scale == 0x1p-20f || scale == 0x1p20f;
    const Sampled scaled = sample(scene_of(mesh, scale), scale * origin, normal);
    int differing = 0;
    for (std::size_t i = 0; i < unit.mask.bits.size(); ++i)
      differing += __builtin_popcountll(unit.mask.bits[i] ^ scaled.mask.bits[i]);
    EXPECT_LE(differing, exact ? 0 : 3) << "scale " << scale;
  }
}

TEST(VisibilitySampler, NonFiniteInputIsHarmless) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const RayScene scene = scene_of(clutter());
  const Vector3f origin(0, 0, 0.1f), up(0, 0, 1);
  for (const Vector3f& normal : {Vector3f(0, 0, 0), Vector3f(nan, 0, 1)}) {
    const Sampled sampled = sample(scene, origin, normal);
    EXPECT_EQ(sampled.rays, 0u);
    EXPECT_EQ(sampled.mask.bits, VisibilityMask(kDirections).bits) << "nothing is above it";
  }
  // A ray from nowhere hits nothing.
  const Sampled nowhere = sample(scene, {nan, 0, 0}, up);
  EXPECT_EQ(nowhere.mask.bits, cast_all(scene, {nan, 0, 0}, up).mask.bits);
  EXPECT_EQ(nowhere.rays, 0u);
  RayScene empty;
  empty.commit();
  EXPECT_EQ(sample(empty, origin, up).rays, 0u);
}

TEST(VisibilitySampler, RejectsOtherSizes) {
  const RayScene scene = scene_of(clutter());
  EXPECT_THROW(VisibilitySampler(scene, table(), 48), Error);
  EXPECT_THROW(VisibilitySampler(scene, table(), 8), Error);
  EXPECT_THROW(VisibilitySampler(scene, table(), 0), Error);
  EXPECT_THROW(VisibilitySampler(scene, table(), 2 * kDirections), Error);
  EXPECT_THROW(VisibilitySampler(scene, DirectionTable(192), 64), Error);
  EXPECT_THROW(VisibilitySampler(scene, DirectionTable(32), 16), Error);
}

}  // namespace
}  // namespace burnish
