#include "harness/camera.h"

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace burnish {
namespace {

std::string parse_failure(const char* text) {
  try {
    parse_camera(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// Where a point appears, in pixels: the inverse of PrimaryRays by solving for the three edges.
Vector3d project(const PrimaryRays& rays, const Vector3f& point) {
  Eigen::Matrix3d edges;
  edges << rays.pixel_right, rays.pixel_down, rays.top_left;
  const Vector3d s = edges.inverse() * (point - rays.origin).cast<double>();
  return {s.x() / s.z(), s.y() / s.z(), s.z()};
}

TEST(Camera, ParsesSevenNumbers) {
  const Camera camera = parse_camera("1,-2.5,3e2, 4,5,+6,35.5", Vector3f::UnitZ());
  EXPECT_EQ(camera.origin, Vector3f(1, -2.5f, 300));
  EXPECT_EQ(camera.target, Vector3f(4, 5, 6));
  EXPECT_EQ(camera.up, Vector3f::UnitZ());
  EXPECT_EQ(camera.vertical_fov_deg, 35.5f);
}

TEST(Camera, FormatThenParseGivesTheSameFloats) {
  const unsigned seed = 11;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> exponent(-20, 20), sign(-1, 1), fov(0.01f, 179.9f);
  const auto value = [&] { return std::copysign(std::exp2(exponent(random)), sign(random)); };
  for (int i = 0; i < 200; ++i) {
    Camera camera;
    camera.origin = {value(), value(), value()};
    camera.target = {value(), value(), value()};
    camera.vertical_fov_deg = fov(random);
    const Camera back = parse_camera(format_camera(camera));
    EXPECT_EQ(back.origin, camera.origin) << "seed " << seed;
    EXPECT_EQ(back.target, camera.target) << "seed " << seed;
    EXPECT_EQ(back.vertical_fov_deg, camera.vertical_fov_deg) << "seed " << seed;
  }
}

TEST(Camera, RejectsWithTheReason) {
  EXPECT_NE(parse_failure("1,2,3,4,5,6").find("6 values, not 7"), std::string::npos);
  EXPECT_NE(parse_failure("1,2,3,4,5,6,7,8").find("8 values, not 7"), std::string::npos);
  EXPECT_NE(parse_failure("").find("1 values, not 7"), std::string::npos);
  EXPECT_NE(parse_failure("1,2,x3,4,5,6,40").find("\"x3\" is not a finite number"),
            std::string::npos);
  EXPECT_NE(parse_failure("1,2,3 4,4,5,6,40").find("\"3 4\" is not"), std::string::npos);
  EXPECT_NE(parse_failure("1,,3,4,5,6,40").find("\"\" is not"), std::string::npos);
  EXPECT_NE(parse_failure("1,+-2,3,4,5,6,40").find("\"+-2\" is not"), std::string::npos);
  EXPECT_NE(parse_failure("nan,2,3,4,5,6,40").find("\"nan\" is not"), std::string::npos);
  EXPECT_NE(parse_failure("1,2,3,4,5,1e40,40").find("\"1e40\" is not"), std::string::npos);
  EXPECT_NE(parse_failure("1,2,3,1,2,3,40").find("same point"), std::string::npos);
  for (const char* fov : {"0", "-1", "180"})
    EXPECT_NE(parse_failure((std::string("1,2,3,4,5,6,") + fov).c_str()).find("fov"),
              std::string::npos);
}

TEST(PrimaryRays, MeetTheFieldOfViewAndTheTarget) {
  Camera camera;
  camera.origin = {1, 2, 3};
  camera.target = {1, 2, -7};
  camera.vertical_fov_deg = 60;
  const PrimaryRays rays = primary_rays(camera, 200, 100);
  // Unit float directions: a few ulp.
  EXPECT_LT((rays.direction(100, 50) - Vector3f(0, 0, -1)).norm(), 1e-6f);
  EXPECT_LT((rays.direction(100, 0) - Vector3f(0, 0.5f, -std::sqrt(0.75f))).norm(), 1e-6f);
  EXPECT_LT((rays.direction(100, 100) - Vector3f(0, -0.5f, -std::sqrt(0.75f))).norm(), 1e-6f);
  // Twice as wide as high: square pixels, x = 2 tan(30 degrees) at unit depth.
  const Vector3f right = rays.direction(200, 50);
  EXPECT_NEAR(right.x() / -right.z(), 2 * std::tan(kPi<double> / 6), 1e-6);
  EXPECT_NEAR(right.y(), 0, 1e-6);
}

TEST(PrimaryRays, AViewAlongUpIsStillACamera) {
  Camera camera;
  camera.origin = {0, 5, 0};
  const PrimaryRays rays = primary_rays(camera, 64, 64);
  EXPECT_LT((rays.direction(32, 32) - Vector3f(0, -1, 0)).norm(), 1e-6f);
  EXPECT_NEAR(rays.pixel_right.norm(), rays.pixel_down.norm(), 1e-12);
  EXPECT_NEAR(rays.pixel_right.dot(rays.pixel_down), 0, 1e-12);
  EXPECT_TRUE(rays.top_left.allFinite());
}

TEST(FrameBounds, TouchesTheMarginAndCutsNothing) {
  const unsigned seed = 5;
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const Vector3f& up : {Vector3f(0, 1, 0), Vector3f(0, 0, 1), Vector3f(1, 0, 0)})
    for (const float scale : {1e-6f, 1.0f, 1e6f})
      for (const float aspect : {0.5f, 1.0f, 2.0f}) {
        const Vector3f lower = scale * Vector3f(unit(random), unit(random), unit(random));
        const Vector3f size = scale * Vector3f(unit(random), unit(random), 0.1f + unit(random));
        const Camera camera = frame_bounds(lower, lower + size, aspect, up);
        const int height = 1000, width = static_cast<int>(height * aspect);
        const PrimaryRays rays = primary_rays(camera, width, height);
        double reach = 0;  // of the half picture, the farthest corner
        for (int corner = 0; corner < 8; ++corner) {
          const Vector3f p =
              lower + size.cwiseProduct(Vector3f(float(corner & 1), float((corner >> 1) & 1),
                                                 float((corner >> 2) & 1)));
          const Vector3d pixel = project(rays, p);
          EXPECT_GT(pixel.z(), 0) << "seed " << seed;
          reach = std::max(
              {reach, std::abs(pixel.x() / width * 2 - 1), std::abs(pixel.y() / height * 2 - 1)});
        }
        // The margin is 8 percent; 1e-3 covers the rounding of float coordinates.
        EXPECT_NEAR(reach, 1 / 1.08, 1e-3)
            << "seed " << seed << " scale " << scale << " aspect " << aspect;
      }
}

TEST(FrameBounds, ASinglePointGivesAFiniteCamera) {
  const Camera camera = frame_bounds(Vector3f(1, 2, 3), Vector3f(1, 2, 3), 1);
  EXPECT_TRUE(camera.origin.allFinite());
  EXPECT_EQ(camera.target, Vector3f(1, 2, 3));
  EXPECT_GT((camera.origin - camera.target).norm(), 0.5f);
}

}  // namespace
}  // namespace burnish
