#include "burnish/formats/polygon_triangulation.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace burnish::test {
namespace {

using Polygon2 = std::vector<Vector2<double>>;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;

double shoelace(const Polygon2& polygon) {
  double twice = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

/// Places the polygon in space, triangulates it and returns the triangles.
Triangles triangulate(const Polygon2& polygon, const Eigen::Affine3d& place) {
  std::vector<Vector3f> corners;
  for (const auto& p : polygon)
    corners.push_back((place * Vector3d(p.x(), p.y(), 0)).cast<float>());
  Triangles triangles = {{9, 9, 9}};
  triangulate_polygon(corners, triangles);
  return triangles;
}

/// n - 2 triangles, none turned over, whose areas add up to the polygon's: then they cover it
/// without overlap.
void expect_covers(const Polygon2& polygon, const Triangles& triangles, const std::string& name) {
  SCOPED_TRACE(name);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  const double area = shoelace(polygon);
  double sum = 0;
  for (const auto& t : triangles) {
    for (const std::uint32_t i : t) ASSERT_LT(i, polygon.size());
    const double part = shoelace({polygon[t[0]], polygon[t[1]], polygon[t[2]]});
    // 1e-6: the triangles were chosen from corners rounded to float.
    ASSERT_GE(part, -1e-6 * area);
    sum += part;
  }
  EXPECT_NEAR(sum, area, 1e-9 * area);
}

Eigen::Affine3d random_place(std::mt19937& random, double scale) {
  std::normal_distribution<double> gauss;
  Eigen::Quaterniond turn(gauss(random), gauss(random), gauss(random), gauss(random));
  turn.normalize();
  return Eigen::Translation3d(Vector3d(gauss(random), gauss(random), gauss(random)) * scale) *
         turn * Eigen::Scaling(scale);
}

TEST(TriangulatePolygon, CoversStarsOfAnyShapePlaceAndSize) {
  constexpr unsigned kSeed = 3;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> radius(.2, 1);
  for (const double scale : {1e-6, 1.0, 1e6})
    for (size_t n = 4; n < 40; ++n)
      for (int round = 0; round < 5; ++round) {
        Polygon2 star;
        for (size_t i = 0; i < n; ++i) {
          const double angle = 2 * kPi<double> * static_cast<double>(i) / static_cast<double>(n);
          star.push_back(radius(random) * Vector2<double>(std::cos(angle), std::sin(angle)));
        }
        expect_covers(star, triangulate(star, random_place(random, scale)),
                      "star of " + std::to_string(n));
      }
}

TEST(TriangulatePolygon, CoversWhatAFanDoesNot) {
  const std::vector<std::pair<std::string, Polygon2>> polygons = {
      {"dart", {{0, 0}, {2, -1}, {.5, 0}, {2, 1}}},
      {"dart from its other corners", {{2, -1}, {.5, 0}, {2, 1}, {0, 0}}},
      {"L", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}},
      {"corners on edges", {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 3}, {2, 3}, {0, 3}, {0, 1}}},
      {"U", {{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}},
      {"bridge to a hole",
       {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}}},
      {"two bridges from one corner",
       {{0, 0},
        {9, 0},
        {9, 9},
        {0, 9},
        {0, 0},
        {1, 2},
        {1, 3},
        {2, 3},
        {1, 2},
        {0, 0},
        {2, 1},
        {3, 2},
        {3, 1},
        {2, 1}}}};
  std::mt19937 random(5);
  for (const auto& [name, polygon] : polygons) {
    expect_covers(polygon, triangulate(polygon, Eigen::Affine3d::Identity()), name);
    expect_covers(polygon, triangulate(polygon, random_place(random, 1)), name + ", turned");
  }
}

TEST(TriangulatePolygon, CoversCombsAndSpirals) {
  Polygon2 comb;
  for (int i = 0; i < 100; ++i) {
    comb.emplace_back(i, 0);
    comb.emplace_back(i + .5, 10);
  }
  comb.emplace_back(100, 0);
  comb.emplace_back(100, -1);
  comb.emplace_back(0, -1);
  // Counter-clockwise, as the others.
  std::reverse(comb.begin(), comb.end());
  expect_covers(comb, triangulate(comb, Eigen::Affine3d::Identity()), "comb");

  Polygon2 spiral;
  const auto arm = [](int i, double radius) -> Vector2<double> {
    const double angle = .2 * i;
    return (radius + .3 * angle) * Vector2<double>(std::cos(angle), std::sin(angle));
  };
  for (int i = 0; i < 150; ++i) spiral.push_back(arm(i, 1.8));
  for (int i = 149; i >= 0; --i) spiral.push_back(arm(i, 1));
  expect_covers(spiral, triangulate(spiral, Eigen::Affine3d::Identity()), "spiral");
}

TEST(TriangulatePolygon, CornerOnAnEdgeGetsNoFlatTriangle) {
  const Polygon2 square = {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}};
  for (const auto& t : triangulate(square, Eigen::Affine3d::Identity()))
    EXPECT_GT(shoelace({square[t[0]], square[t[1]], square[t[2]]}), .5);
}

TEST(TriangulatePolygon, WarpedQuadSplitsAlongItsShorterDiagonal) {
  Triangles triangles;
  triangulate_polygon(std::vector<Vector3f>{{0, 0, 0}, {3, 0, .1f}, {4, 1, 0}, {1, 1, .1f}},
                      triangles);
  EXPECT_EQ(triangles, (Triangles{{1, 2, 3}, {1, 3, 0}}));
}

TEST(TriangulatePolygon, BrokenPolygonsStillGiveAllTriangles) {
  const std::vector<std::vector<Vector3f>> polygons = {
      {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {2, .5f, 0}},   // crosses itself
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}},     // on a line
      std::vector<Vector3f>(6, Vector3f(1, 2, 3)),                 // a point
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}},     // its own start again
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 9}, {0, 1, 0}, {-1, .5f, -9}}  // far from a plane
  };
  for (const auto& polygon : polygons) {
    Triangles triangles;
    triangulate_polygon(polygon, triangles);
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
    std::vector<bool> used(polygon.size(), false);
    for (const auto& t : triangles)
      for (const std::uint32_t i : t) used.at(i) = true;
    EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  }
}

TEST(TriangulatePolygon, FewerThanThreeCornersGiveNothing) {
  Triangles triangles = {{1, 2, 3}};
  triangulate_polygon(std::vector<Vector3f>{{0, 0, 0}, {1, 0, 0}}, triangles);
  EXPECT_TRUE(triangles.empty());
  triangulate_polygon({}, triangles);
  EXPECT_TRUE(triangles.empty());
}

TEST(TriangulatePolygon, LargestPolygonsAllowed) {
  Polygon2 circle;
  for (size_t i = 0; i < kMaxPolygonCorners; ++i) {
    const double angle =
        2 * kPi<double> * static_cast<double>(i) / static_cast<double>(kMaxPolygonCorners);
    circle.emplace_back(std::cos(angle), std::sin(angle));
  }
  EXPECT_EQ(triangulate(circle, Eigen::Affine3d::Identity()).size(), kMaxPolygonCorners - 2);
  for (size_t i = 1; i < circle.size(); i += 2) circle[i] *= .5;
  EXPECT_EQ(triangulate(circle, Eigen::Affine3d::Identity()).size(), kMaxPolygonCorners - 2);
}

}  // namespace
}  // namespace burnish::test
