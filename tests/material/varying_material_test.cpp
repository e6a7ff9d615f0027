#include "burnish/material/varying_material.h"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace burnish::test {
namespace {

Material base_material() {
  Material material;
  material.model = SpecularModel::ward;
  material.diffuse = {0.1f, 0.2f, 0.3f};
  material.specular = {0.4f, 0.5f, 0.6f};
  material.alpha_x = 0.3f;
  material.alpha_y = 0.1f;
  return material;
}

Image constant(float value) { return Image(4, 4, Rgb::Constant(value)); }

Frame<float> some_frame() {
  return frame_from_normal_tangent<float>(Vector3f(1, 2, 3).normalized(), Vector3f(3, 1, 0));
}

SurfaceMaterial look_up(const Material& base, const MaterialPictures& pictures, float width = 0,
                        const Frame<float>& frame = {}) {
  return material_at(base, make_material_maps(base, pictures), {{0.4f, 0.3f}, width}, frame);
}

void expect_same_axes(const Frame<float>& a, const Frame<float>& b, float tolerance = 1e-5f) {
  EXPECT_LT((a.x - b.x).norm(), tolerance) << a.x.transpose() << " / " << b.x.transpose();
  EXPECT_LT((a.y - b.y).norm(), tolerance);
  EXPECT_LT((a.z - b.z).norm(), tolerance);
}

TEST(MaterialVariation, ReplacesWhatItHasAndKeepsTheRest) {
  const Material base = base_material();
  const Frame<float> frame = some_frame();
  const SurfaceMaterial plain = material_at(base, MaterialVariation{}, 1, frame);
  EXPECT_TRUE((plain.material.diffuse == base.diffuse).all());
  EXPECT_EQ(plain.material.alpha_y, base.alpha_y);
  EXPECT_EQ(plain.frame.x, frame.x);
  const std::vector<Rgb> diffuse = {Rgb::Zero(), {1, 0.5f, 0.25f}};
  const std::vector<float> alpha_x = {0.5f, 0.25f};
  const SurfaceMaterial varied =
      material_at(base, {.diffuse = diffuse, .alpha_x = alpha_x}, 1, frame);
  EXPECT_TRUE((varied.material.diffuse == diffuse[1]).all());
  EXPECT_EQ(varied.material.alpha_x, 0.25f);
  EXPECT_EQ(varied.material.alpha_y, base.alpha_y);
  EXPECT_TRUE((varied.material.specular == base.specular).all());
  EXPECT_EQ(varied.frame.x, frame.x);
}

TEST(MaterialVariation, TurnsTheTangentAndTiltsTheNormal) {
  const Frame<float> frame = some_frame();
  const std::vector<float> quarter = {kPi<float> / 2};
  const SurfaceMaterial turned =
      material_at(base_material(), {.tangent_rotation_rad = quarter}, 0, frame);
  expect_same_axes(turned.frame, {frame.y, -frame.x, frame.z});
  const Vector3f tilt = Vector3f(0.6f, 0, 0.8f);
  const std::vector<Vector3f> normal = {tilt};
  const SurfaceMaterial tilted = material_at(base_material(), {.normal = normal}, 0, frame);
  expect_same_axes(tilted.frame,
                   {0.8f * frame.x - 0.6f * frame.z, frame.y, 0.6f * frame.x + 0.8f * frame.z});
}

TEST(MaterialVariation, NamesWhatIsOutOfItsDomain) {
  const std::vector<Rgb> colors = {Rgb::Zero(), Rgb::Constant(0.5f), Rgb::Constant(2)};
  const std::vector<float> numbers = {0.5f, 1e-5f, NAN};
  const std::vector<Vector3f> normals = {Vector3f::UnitZ(), Vector3f::UnitX(), Vector3f::Zero()};
  EXPECT_EQ(domain_error(MaterialVariation{}, 7), "");
  EXPECT_EQ(domain_error({.specular = colors}, 3), "");
  EXPECT_EQ(domain_error({.diffuse = colors}, 3), "diffuse[2] is out of range, expected 0 to 1");
  EXPECT_EQ(domain_error({.diffuse = colors}, 4), "diffuse has 3 values, expected none or 4");
  EXPECT_EQ(domain_error({.alpha_x = numbers}, 3),
            "alpha_x[1] is out of range, expected 0.0001 to 1");
  EXPECT_EQ(domain_error({.tangent_rotation_rad = numbers}, 3),
            "tangent_rotation_rad[2] is out of range, expected a finite number");
  EXPECT_EQ(domain_error({.normal = normals}, 3),
            "normal[1] is out of range, expected a unit vector with z > 0");
}

TEST(MaterialMaps, ConstantPicturesGiveTheirValues) {
  MaterialPictures pictures;
  pictures.diffuse = Image(3, 2, {0.25f, 0.5f, 0.75f});
  pictures.specular = Image(1, 1, {2, 3, 4});
  pictures.alpha_x = constant(0.05f);
  pictures.alpha_y = constant(0.4f);
  for (const float width : {0.0f, 0.1f, 3.0f}) {
    const SurfaceMaterial at = look_up(base_material(), pictures, width, some_frame());
    EXPECT_LT((at.material.diffuse - Rgb(0.25f, 0.5f, 0.75f)).abs().maxCoeff(), 1e-6f);
    EXPECT_LT((at.material.specular - Rgb(2, 3, 4)).abs().maxCoeff(), 1e-5f);
    EXPECT_NEAR(at.material.alpha_x, 0.05f, 1e-5f);  // a square and a root of a difference
    EXPECT_NEAR(at.material.alpha_y, 0.4f, 1e-6f);
    expect_same_axes(at.frame, some_frame());
  }
}

TEST(MaterialMaps, OneAlphaAloneKeepsTheOther) {
  MaterialPictures pictures;
  pictures.alpha_x = constant(0.05f);
  const SurfaceMaterial at = look_up(base_material(), pictures);
  EXPECT_NEAR(at.material.alpha_x, 0.05f, 1e-6f);
  EXPECT_NEAR(at.material.alpha_y, base_material().alpha_y, 1e-6f);
  EXPECT_TRUE((at.material.diffuse == base_material().diffuse).all());
}

/// Rotation and alphas are one tensor: whichever axis is named x, the ellipse is the one given.
TEST(MaterialMaps, RotationTurnsTheLobe) {
  const Material base = base_material();
  for (const float angle : {-3.0f, -1.2f, -0.3f, 0.0f, 0.7f, 1.0f, 2.5f}) {
    MaterialPictures pictures;
    pictures.tangent_rotation_rad = constant(angle);
    const SurfaceMaterial at = look_up(base, pictures, 0, some_frame());
    const auto tensor = [](const SurfaceMaterial& m) {
      Eigen::Matrix3f t =
          m.material.alpha_x * m.material.alpha_x * m.frame.x * m.frame.x.transpose();
      t += m.material.alpha_y * m.material.alpha_y * m.frame.y * m.frame.y.transpose();
      return t;
    };
    const std::vector<float> rotation = {angle};
    const SurfaceMaterial expected =
        material_at(base, {.tangent_rotation_rad = rotation}, 0, some_frame());
    EXPECT_LT((tensor(at) - tensor(expected)).norm(), 1e-5f) << angle;
    EXPECT_GT(at.frame.x.dot(some_frame().x), std::sqrt(0.5f) - 1e-5f);  // the nearer axis
  }
}

TEST(MaterialMaps, NormalsOfAnyLengthTilt) {
  MaterialPictures pictures;
  pictures.normal = Image(2, 2, {0.3f, -0.6f, 1.2f});
  const SurfaceMaterial at = look_up(base_material(), pictures, 0, some_frame());
  const Vector3f expected = some_frame().to_world(Vector3f(0.3f, -0.6f, 1.2f)).normalized();
  EXPECT_LT((at.frame.z - expected).norm(), 1e-6f);
  EXPECT_NEAR(at.material.alpha_x, 0.3f, 1e-4f);
  EXPECT_NEAR(at.material.alpha_y, 0.1f, 1e-4f);
  // Below the surface, and of no length: nothing that is not finite.
  for (const Rgb& bad : {Rgb(1, 0, -1), Rgb(0, 0, -1), Rgb(0, 0, 0)}) {
    pictures.normal = Image(2, 2, bad);
    const SurfaceMaterial held = look_up(base_material(), pictures, 0, some_frame());
    EXPECT_GT(held.frame.z.dot(some_frame().z), 0.05f);
    EXPECT_NEAR(held.frame.z.norm(), 1, 1e-5f);
    EXPECT_TRUE(std::isfinite(held.material.alpha_x));
  }
}

/// The covariance of samples of Beckmann's slopes on facets drawn from the texture, against what a
/// wide lookup gives (olano2010lean): slopes of a Beckmann distribution are normal, with variance
/// alpha^2 / 2 an axis.
TEST(MaterialMaps, AveragedDetailWidensTheLobeAsItsFacetsSay) {
  constexpr unsigned kSeed = 41;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-1, 1);
  MaterialPictures pictures;
  pictures.normal = Image(16, 16);
  pictures.alpha_x = Image(16, 16);
  pictures.tangent_rotation_rad = Image(16, 16);
  for (size_t i = 0; i < 256; ++i) {
    pictures.normal->pixels[i] = {0.1f + 0.2f * uniform(random), 0.05f * uniform(random), 1};
    pictures.alpha_x->pixels[i] = Rgb::Constant(0.25f + 0.15f * uniform(random));
    pictures.tangent_rotation_rad->pixels[i] = Rgb::Constant(0.4f * uniform(random));
  }
  const Material base = base_material();
  const SurfaceMaterial at = look_up(base, pictures, 2);  // the whole texture

  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  constexpr int kSamples = 400000;
  std::normal_distribution<double> normal;
  for (int i = 0; i < kSamples; ++i) {
    const size_t pixel = random() % 256;
    const double angle = pictures.tangent_rotation_rad->pixels[pixel][0];
    const double x = pictures.alpha_x->pixels[pixel][0] / std::sqrt(2.0) * normal(random);
    const double y = base.alpha_y / std::sqrt(2.0) * normal(random);
    const Eigen::Vector2d slope(
        std::cos(angle) * x - std::sin(angle) * y + pictures.normal->pixels[pixel][0],
        std::sin(angle) * x + std::cos(angle) * y + pictures.normal->pixels[pixel][1]);
    mean += slope / kSamples;
    second += slope * slope.transpose() / kSamples;
  }
  const Eigen::Matrix2d covariance = second - mean * mean.transpose();
  const double c = at.frame.x.x(), s = at.frame.x.y(), length = std::hypot(c, s);
  Eigen::Matrix2d axes;  // of the lobe, in the tangent plane
  axes << c / length, -s / length, s / length, c / length;
  const Eigen::Matrix2d found =
      axes *
      Eigen::Vector2d(std::pow(at.material.alpha_x, 2), std::pow(at.material.alpha_y, 2))
          .asDiagonal() *
      axes.transpose() / 2;
  // Four standard errors of the variances, sqrt(2 / n) each, relative to the largest; and the tilt
  // of the frame turns the axes by less than .01.
  EXPECT_LT((found - covariance).cwiseAbs().maxCoeff(), 0.012 * covariance.norm())
      << found << "\n/\n"
      << covariance;
  const Vector3f expected = Vector3d(mean.x(), mean.y(), 1).normalized().cast<float>();
  EXPECT_LT((at.frame.z - expected).norm(), 2e-3f);
  EXPECT_GT(at.material.alpha_x, 0.28f);  // wider than its pixels' rms of .26
}

TEST(MaterialMaps, ValuesOutOfRangeAreHeld) {
  MaterialPictures pictures;
  pictures.diffuse = Image(1, 1, {-1, 0.5f, 7});
  pictures.alpha_x = constant(0);
  pictures.alpha_y = constant(3);
  const SurfaceMaterial at = look_up(base_material(), pictures);
  EXPECT_TRUE((at.material.diffuse == Rgb(0, 0.5f, 1)).all());
  EXPECT_EQ(domain_error(at.material), "");
  EXPECT_NEAR(at.material.alpha_y, 1, 1e-6f);
  EXPECT_LT(at.material.alpha_x, 2e-3f);  // beside 1, a root of rounding
}

/// A flat square of 2 x 2 cells, UV from 0 to 1 over it.
Transfer square_transfer() {
  Transfer transfer;
  for (int y = 0; y <= 2; ++y)
    for (int x = 0; x <= 2; ++x) {
      transfer.positions.emplace_back(float(x), float(y), 0.0f);
      transfer.normals.push_back(Vector3f::UnitZ());
      transfer.tangents.push_back(Vector3f::UnitX());
      transfer.texcoords.emplace_back(float(x) / 2, float(y) / 2);
    }
  for (std::uint32_t y = 0; y < 2; ++y)
    for (std::uint32_t x = 0; x < 2; ++x) {
      const std::uint32_t v = 3 * y + x;
      transfer.triangles.push_back({v, v + 1, v + 4});
      transfer.triangles.push_back({v, v + 4, v + 3});
    }
  return transfer;
}

TEST(VertexTaps, CoverTheNeighbourhoodOfEachVertex) {
  Transfer transfer = square_transfer();
  transfer.positions.emplace_back(9.0f, 9.0f, 9.0f);  // in no triangle
  transfer.normals.push_back(Vector3f::UnitZ());
  transfer.tangents.push_back(Vector3f::UnitX());
  transfer.texcoords.emplace_back(0.25f, 0.5f);
  const VertexTaps taps = vertex_taps(transfer);
  ASSERT_EQ(taps.first.size(), 11u);
  for (size_t v = 0; v < 10; ++v) {
    float weight = 0, area = 0;
    for (std::uint32_t i = taps.first[v]; i < taps.first[v + 1]; ++i) {
      weight += taps.taps[i].weight;
      area += taps.taps[i].place.width * taps.taps[i].place.width;
    }
    EXPECT_NEAR(weight, 1, 1e-6f) << v;
    if (v == 9) continue;
    // Thirds of triangles of an eighth.
    EXPECT_NEAR(area, float(taps.first[v + 1] - taps.first[v]) / 24, 1e-6f) << v;
  }
  EXPECT_EQ(taps.first[5] - taps.first[4], 6u);  // the middle vertex has six triangles
  EXPECT_EQ(taps.taps[taps.first[9]].place.uv, Vector2<float>(0.25f, 0.5f));
  EXPECT_EQ(taps.taps[taps.first[9]].place.width, 0);
  // The middle's taps are around it.
  Vector2<float> centre = Vector2<float>::Zero();
  for (std::uint32_t i = taps.first[4]; i < taps.first[5]; ++i)
    centre += taps.taps[i].weight * taps.taps[i].place.uv;
  EXPECT_LT((centre - Vector2<float>(0.5f, 0.5f)).norm(), 1e-6f);
}

/// A bump whose normals lean toward +u and +v stays that bump on a mirrored texture and under a
/// tangent of the other sign.
TEST(VertexTaps, FollowMirroredTexturesAndTangents) {
  MaterialPictures pictures;
  pictures.normal = Image(1, 1, {0.3f, 0.2f, 1});
  pictures.tangent_rotation_rad = constant(0.5f);
  for (const float mirror : {1.0f, -1.0f})
    for (const float tangent : {1.0f, -1.0f}) {
      Transfer transfer = square_transfer();
      for (Vector2<float>& uv : transfer.texcoords) uv.x() *= mirror;
      for (Vector3f& t : transfer.tangents) t *= tangent;
      const MaterialMaps maps = make_material_maps(base_material(), pictures);
      MaterialArrays arrays;
      resize(arrays, maps, 9);
      sample_vertices(maps, vertex_taps(transfer), 0, 9, arrays);
      const Frame<float> frame =
          frame_from_normal_tangent(transfer.normals[4], transfer.tangents[4]);
      const SurfaceMaterial at = material_at(base_material(), variation_of(arrays), 4, frame);
      const Vector3f expected = Vector3f(0.3f * mirror, 0.2f, 1).normalized();
      EXPECT_LT((at.frame.z - expected).norm(), 1e-6f) << mirror << " " << tangent;
      const Vector3f axis = at.frame.x * (at.frame.x.x() < 0 ? -1.0f : 1.0f);
      EXPECT_GT(axis.y() * mirror, 0.1f) << mirror << " " << tangent;  // turned toward +v
    }
}

TEST(VertexTaps, NeedTextureCoordinates) {
  Transfer transfer = square_transfer();
  transfer.texcoords.clear();
  EXPECT_THROW(vertex_taps(transfer), std::invalid_argument);
}

TEST(SampleVertices, AverageOverTheirNeighbourhoods) {
  const Transfer transfer = square_transfer();
  // Black left half, white right half, finer stripes than the mesh on top.
  MaterialPictures pictures;
  pictures.diffuse = Image(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      pictures.diffuse->at(x, y) = {x < 32 ? 0.0f : 1.0f, float(x % 2), float(y) / 64};
  const MaterialMaps maps = make_material_maps(base_material(), pictures);
  const VertexTaps taps = vertex_taps(transfer);
  MaterialArrays arrays;
  resize(arrays, maps, transfer.vertex_count());
  EXPECT_TRUE(arrays.alpha_x.empty() && arrays.normal.empty());
  sample_vertices(maps, taps, 0, 4, arrays);
  sample_vertices(maps, taps, 4, 9, arrays);
  const MaterialVariation variation = variation_of(arrays);
  EXPECT_EQ(domain_error(variation, 9), "");
  // The middle column sees both halves; the stripes vanish everywhere.
  EXPECT_NEAR(arrays.diffuse[4][0], 0.5f, 0.02f);
  for (const Rgb& color : arrays.diffuse) EXPECT_NEAR(color[1], 0.5f, 0.05f);
  EXPECT_GT(arrays.diffuse[1][2], arrays.diffuse[7][2]);  // v is up, y down
  const SurfaceMaterial at = material_at(base_material(), variation, 4, {});
  EXPECT_TRUE((at.material.diffuse == arrays.diffuse[4]).all());
}

}  // namespace
}  // namespace burnish::test
