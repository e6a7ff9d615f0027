#include "burnish/formats/mesh_frames.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace burnish::test {
namespace {

using Eigen::Vector2f;

/// A sphere of 2n by n quads around `center`, split along one diagonal; a vertex column is repeated
/// at the seam, and a vertex row at each pole.
struct SphereMesh {
  std::vector<Vector3f> positions;
  std::vector<Vector3f> directions;
  std::vector<Vector3f> eastward;
  std::vector<Vector2f> uvs;
  std::vector<std::uint32_t> point;
  std::vector<Triangle> triangles;
};

SphereMesh make_sphere(int n, float radius = 1) {
  SphereMesh sphere;
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * (2 * n + 1) + i); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= 2 * n; ++i) {
      const double theta = kPi<double> * j / n;
      const double phi = kPi<double> * (i % (2 * n)) / n;
      const Vector3d direction(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                               std::cos(theta));
      const bool pole = j == 0 || j == n;
      sphere.directions.push_back(pole ? Vector3f(0, 0, j == 0 ? 1 : -1) : direction.cast<float>());
      sphere.positions.push_back(radius * sphere.directions.back());
      sphere.eastward.push_back(Vector3d(-std::sin(phi), std::cos(phi), 0).cast<float>());
      sphere.uvs.emplace_back(static_cast<float>(i) / (2 * n), static_cast<float>(j) / n);
      sphere.point.push_back(pole ? index(0, j) : index(i % (2 * n), j));
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < 2 * n; ++i) {
      sphere.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
      sphere.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
    }
  return sphere;
}

double largest_angle(const std::vector<Vector3f>& a, const std::vector<Vector3f>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, angle_between<double>(a[i].cast<double>(), b[i].cast<double>()));
  return largest;
}

TEST(ComputeNormals, ConvergeToTheSphereWithTheSquareOfTheEdge) {
  double previous = 0;
  for (const int n : {16, 32, 64}) {
    const SphereMesh sphere = make_sphere(n);
    std::uint64_t fallbacks = 1;
    const auto normals = compute_normals(sphere.positions, sphere.triangles, sphere.point,
                                         Vector3f::UnitY(), &fallbacks);
    EXPECT_EQ(fallbacks, 0u);
    const double error = largest_angle(normals, sphere.directions);
    const double edge = kPi<double> / n;
    EXPECT_LT(error, edge * edge) << n;  // the curvature's second-order term, of coefficient 1
    if (previous > 0) {
      EXPECT_LT(error, previous / 3) << n;  // 4 for pure second order
    }
    previous = error;
  }
}

TEST(ComputeNormals, WeighByAreaAndAngle) {
  // At the origin: an angle of 90 degrees and area 2 facing z, 45 degrees and area 3/2 facing x.
  const std::vector<Vector3f> positions = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0},
                                           {0, 0, 0}, {0, 1, 0}, {0, 3, 3}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {3, 4, 5}};
  const std::vector<std::uint32_t> shared = {0, 1, 2, 0, 3, 4};
  const auto normals = compute_normals(positions, triangles, shared);
  const Vector3d expected = Vector3d(45 * 1.5, 0, 90 * 2).normalized();
  EXPECT_LT((normals[0].cast<double>() - expected).norm(), 1e-7);
  EXPECT_EQ(normals[0], normals[3]);
  EXPECT_EQ(normals[1], Vector3f(0, 0, 1));
  EXPECT_EQ(normals[5], Vector3f(1, 0, 0));
  EXPECT_EQ(compute_normals(positions, triangles)[0], Vector3f(0, 0, 1));
}

TEST(ComputeNormals, DegenerateTrianglesAndLonelyVertices) {
  const float nan = std::nanf("");
  const std::vector<Vector3f> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                                           {2, 0, 0}, {5, 5, 5}, {nan, 0, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 1, 3}, {0, 0, 1}, {0, 1, 5}};
  std::uint64_t fallbacks = 0;
  const auto normals = compute_normals(positions, triangles, {}, Vector3f::UnitX(), &fallbacks);
  EXPECT_EQ(fallbacks, 3u);
  for (const size_t v : {0, 1, 2}) EXPECT_EQ(normals[v], Vector3f(0, 0, 1)) << v;
  for (const size_t v : {3, 4, 5}) EXPECT_EQ(normals[v], Vector3f(1, 0, 0)) << v;
}

TEST(ComputeNormals, TwoSidedSheetTakesItsLargestTriangle) {
  const std::vector<Vector3f> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {2, 1, 0}};
  for (const Vector3f& normal : compute_normals(positions, triangles))
    EXPECT_EQ(normal, Vector3f(0, 0, 1));  // of two alike the first
}

TEST(ComputeNormals, DoNotDependOnTheSizeOfTheMesh) {
  const SphereMesh sphere = make_sphere(16);
  const auto expected = compute_normals(sphere.positions, sphere.triangles, sphere.point);
  for (const float size : {1e-18f, 1e-6f, 1e6f, 1e18f}) {
    const SphereMesh scaled = make_sphere(16, size);
    // 1e-5: positions round anew, by 6e-8 of the radius over edges of 0.2 / 16 of it at the poles.
    EXPECT_LT(
        largest_angle(compute_normals(scaled.positions, scaled.triangles, scaled.point), expected),
        1e-5)
        << size;
  }
}

TEST(TangentFromUp, IsTheReferenceCarriedByTheSmallestRotation) {
  std::mt19937 random(7);
  std::normal_distribution<double> gauss;
  for (const UpAxis up : {UpAxis::x, UpAxis::y, UpAxis::z}) {
    const Vector3d u = up_direction(up).cast<double>();
    const Vector3d reference = tangent_from_up(u.cast<float>(), up).cast<double>();
    EXPECT_EQ(reference.dot(u), 0);
    for (int i = 0; i < 2000; ++i) {
      const Vector3f normal =
          Vector3d(gauss(random), gauss(random), gauss(random)).normalized().cast<float>();
      const Vector3d n = normal.cast<double>().normalized();
      if (u.dot(n) < -0.9999) continue;  // where Eigen's own formula loses its digits
      const Vector3d expected = Eigen::Quaterniond::FromTwoVectors(u, n) * reference;
      // 1e-6: rounding to float.
      EXPECT_LT((tangent_from_up(normal, up).cast<double>() - expected).norm(), 1e-6)
          << "seed 7, " << i;
    }
  }
}

TEST(TangentFromUp, ChangesNoFasterThanParallelTransport) {
  // Along a meridian the tangent turns with the normal; across, it turns by tan(theta / 2) per
  // radian more (the holonomy of a cap). So |dt| <= |dn| sqrt(1 + tan^2), but for second order.
  constexpr double kStep = 1e-3;
  std::mt19937 random(11);
  std::normal_distribution<double> gauss;
  const Vector3d up = Vector3d::UnitY();
  int tested = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3d n = Vector3d(gauss(random), gauss(random), gauss(random)).normalized();
    const Vector3d side =
        n.cross(Vector3d(gauss(random), gauss(random), gauss(random))).normalized();
    const Vector3d m = (n + kStep * side).normalized();
    const double theta = angle_between<double>(up, n);
    if (theta > 3.0) continue;
    ++tested;
    const double change =
        (tangent_from_up(n.cast<float>(), UpAxis::y) - tangent_from_up(m.cast<float>(), UpAxis::y))
            .norm();
    const double tangent = std::tan(theta / 2);
    // 2 %: curvature over a step of 1e-3 (theta < 3); 1e-6: rounding.
    EXPECT_LT(change, 1.02 * kStep * std::sqrt(1 + tangent * tangent) + 1e-6)
        << "seed 11, " << i << ", theta " << theta;
  }
  EXPECT_GT(tested, 15000);
}

TEST(TangentFromUp, IsTheReferenceAtItsSingularPoint) {
  EXPECT_EQ(tangent_from_up({0, -1, 0}, UpAxis::y), Vector3f(1, 0, 0));
  EXPECT_EQ(tangent_from_up({0, 0, -1}, UpAxis::z), Vector3f(1, 0, 0));
  EXPECT_EQ(tangent_from_up({-1, 0, 0}, UpAxis::x), Vector3f(0, 1, 0));
  for (const float tilt : {1e-7f, 1e-6f, 1e-5f, 1e-4f}) {  // around it: unit and orthogonal
    const Vector3f normal = Vector3f(tilt, -1, -tilt / 2).normalized();
    const Vector3f tangent = tangent_from_up(normal, UpAxis::y);
    EXPECT_NEAR(tangent.norm(), 1, 1e-6);
    EXPECT_NEAR(tangent.dot(normal), 0, 2e-6) << tilt;
  }
}

TEST(ComputeTangents, FollowUOnAPlane) {
  // u grows along (3, 4, 0) / 5 in the plane z = 0, v across: stretched, mirrored.
  const std::vector<Vector3f> positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<Vector3f> normals(4, Vector3f::UnitZ());
  for (const float stretch : {1.f, 100.f, -1.f, -.01f}) {
    std::vector<Vector2f> uvs;
    for (const Vector3f& p : positions)
      uvs.emplace_back(.6f * p.x() + .8f * p.y(), stretch * (-.8f * p.x() + .6f * p.y()));
    std::uint64_t fallbacks = 1;
    const auto tangents =
        compute_tangents(positions, normals, uvs, triangles, UpAxis::y, &fallbacks);
    EXPECT_EQ(fallbacks, 0u);
    for (const Vector3f& tangent : tangents)
      EXPECT_LT((tangent - Vector3f(.6f, .8f, 0)).norm(), 1e-6) << stretch;
  }
}

TEST(ComputeTangents, FollowTheParallelsOfASphere) {
  for (const int n : {16, 32}) {
    const SphereMesh sphere = make_sphere(n);
    const auto tangents = compute_tangents(sphere.positions, sphere.directions, sphere.uvs,
                                           sphere.triangles, UpAxis::y);
    const double edge = kPi<double> / n;
    for (size_t v = 0; v < tangents.size(); ++v) {
      if (std::abs(sphere.directions[v].z()) > .9f) continue;  // parallels shrink to a point
      // First order at the seam, where only one side's triangles count: half an edge's turn.
      EXPECT_LT((tangents[v] - sphere.eastward[v]).norm(), edge) << n << ", vertex " << v;
    }
  }
}

TEST(ComputeTangents, MirroredUvsDoNotCancel) {
  const std::vector<Vector3f> positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1, 0, 0}};
  const std::vector<Vector2f> uvs = {{0, 0}, {0, 1}, {1, 0}, {1, 0}};
  const std::vector<Triangle> triangles = {{0, 1, 2}, {0, 3, 1}};
  const std::vector<Vector3f> normals(4, Vector3f::UnitZ());
  std::uint64_t fallbacks = 1;
  const auto tangents = compute_tangents(positions, normals, uvs, triangles, UpAxis::y, &fallbacks);
  EXPECT_EQ(fallbacks, 0u);
  for (const Vector3f& tangent : tangents) EXPECT_NEAR(std::abs(tangent.x()), 1, 1e-6);
}

TEST(ComputeTangents, FallBackWhereUvsSayNothing) {
  const float nan = std::nanf("");
  const std::vector<Vector3f> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}};
  const std::vector<Triangle> triangles = {{0, 1, 2}};
  const Vector3f normal = Vector3f(1, 2, 3).normalized();
  const std::vector<Vector3f> normals(4, normal);
  const std::vector<std::vector<Vector2f>> useless = {{},
                                                      std::vector<Vector2f>(4, Vector2f(.5f, .5f)),
                                                      {{0, 0}, {1, 1}, {2, 2}, {0, 0}},
                                                      {{0, 0}, {1, nan}, {0, 1}, {0, 0}}};
  for (const auto& uvs : useless) {
    std::uint64_t fallbacks = 0;
    const auto tangents =
        compute_tangents(positions, normals, uvs, triangles, UpAxis::z, &fallbacks);
    EXPECT_EQ(fallbacks, 4u);
    for (const Vector3f& tangent : tangents) EXPECT_EQ(tangent, tangent_from_up(normal, UpAxis::z));
  }
}

TEST(IsDegenerate, IsAMatterOfShapeNotOfSize) {
  for (const float size : {1e-30f, 1e-6f, 1.f, 1e6f, 1e30f}) {
    EXPECT_FALSE(is_degenerate({0, 0, 0}, {size, 0, 0}, {0, size, 0})) << size;
    EXPECT_FALSE(is_degenerate({0, 0, 0}, {size, 0, 0}, {size / 2, 1e-6f * size, 0})) << size;
    EXPECT_TRUE(is_degenerate({0, 0, 0}, {size, 2 * size, -size}, {3 * size, 6 * size, -3 * size}))
        << size;
    EXPECT_TRUE(is_degenerate({0, size, 0}, {0, size, 0}, {size, 0, 0})) << size;
  }
  EXPECT_TRUE(is_degenerate({0, 0, 0}, {0, 0, 0}, {0, 0, 0}));
  EXPECT_TRUE(is_degenerate({0, 0, 0}, {1, 0, 0}, {0, std::nanf(""), 0}));
}

}  // namespace
}  // namespace burnish::test
