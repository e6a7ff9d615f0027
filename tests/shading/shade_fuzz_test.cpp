// The frame's radiance is finite and not negative, whatever finite numbers it is given.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "burnish/light/local_lights.h"
#include "burnish/shading/shade_varying.h"
#include "burnish/sphere/lobe_domain.h"
#include "material/sample_materials.h"
#include "shading/random_transfer.h"
#include "shading/small_transfer.h"

namespace burnish::test {
namespace {

constexpr unsigned kSeed = 74;

template <size_t N>
float one_of(const std::array<float, N>& values, std::mt19937& random) {
  return values[random() % N];
}

constexpr float kMaxHalf = 65504;
constexpr std::array kCoefficients = {0.0f, kMaxHalf, -kMaxHalf, 1.0f, -0.01f, 6e-8f};

/// Rows and bases at their extremes, of one kind a transfer: all alike, or each of its own.
Transfer extreme_transfer(size_t vertices, std::mt19937& random) {
  TransferSize size;
  size.vertices = vertices;
  size.terms = 1 + int(random() % 20);
  size.bases = 1 + int(random() % 3);
  size.ladders = random() % 2 ? size.bases : int(random() % 2);
  size.ladder_terms = size.ladders > 0 ? 1 + int(random() % 9) : 0;
  size.amplitude_rad = random() % 2 ? 0.7f : 0.0f;
  Transfer transfer = random_transfer(size, random);
  const unsigned kind = random() % 4;
  for (auto* coefficients : {&transfer.coefficients, &transfer.ladder_coefficients})
    for (float& c : *coefficients) {
      if (kind == 1) c = kMaxHalf;
      if (kind == 2) c = one_of(kCoefficients, random);
      if (kind == 3) c = 0;
    }
  if (random() % 4 == 0)
    for (SsdfBasis& basis : transfer.bases) {  // flat: no gradient anywhere
      std::fill(basis.mean.begin(), basis.mean.end(), random() % 2 ? 1.0f : -1.0f);
      std::fill(basis.eigen.begin(), basis.eigen.end(), 0.0f);
    }
  transfer.ladder_crossover = size.ladders > 0 ? one_of<4>({0, 1e-3f, 8, 1e6f}, random) : 0.0f;
  return transfer;
}

/// Normals, tangents and places relative to an eye at the origin: along normals and tangents, from
/// below, and at the eye itself.
void place_extremely(Transfer& transfer, std::mt19937& random) {
  for (size_t i = 0; i < transfer.vertex_count(); ++i) {
    Vector3f& normal = transfer.normals[i];
    if (random() % 3 == 0) normal = Vector3f::Unit(random() % 3) * (random() % 2 ? 1.0f : -1.0f);
    Vector3f& tangent = transfer.tangents[i];
    tangent = frame_from_axis(normal).x;
    const float distance = one_of<5>({1, 1e-6f, 1e-30f, 1e6f, 1e18f}, random);
    Vector3f toward_eye = random_unit(random);
    switch (random() % 6) {
      case 0:
        toward_eye = normal;
        break;
      case 1:
        toward_eye = tangent;
        break;
      case 2:
        toward_eye = -normal;
        break;
      case 3:
        toward_eye = (tangent - 0.01f * normal).normalized();
        break;
      case 4:
        toward_eye.setZero();
        break;
    }
    transfer.positions[i] = -distance * toward_eye;
    switch (random() % 8) {
      case 0:
        normal.setZero();
        break;
      case 1:
        tangent.setZero();
        break;
      case 2:
        tangent = normal;
        break;
      case 3:
        normal *= 1e-20f;
        break;
      case 4:
        tangent *= 1e-20f;
        break;
    }
  }
}

/// The domain's extremes; those that it does not accept are left out.
LightRig extreme_lights(float brightness, std::mt19937& random) {
  constexpr std::array kBandwidths = {0.0f, 1e-38f, 1e-8f, 0.1f,  3.0f, 40.0f,
                                      1e3f, 1e8f,   1e18f, 1e30f, 3e38f};
  const auto color = [&]() -> Rgb {
    return brightness * Rgb(one_of<3>({1, 0, 1e-30f}, random), 1, 0.5f);
  };
  LightRig rig;
  for (int i = 0; i < 6; ++i) {
    EnvironmentLobe light;
    light.lobe.frame = random_frame(random_direction(random), random).cast<float>();
    if (random() % 3 == 0) light.lobe.frame = frame_from_axis<float>(Vector3f::Unit(random() % 3));
    light.lobe.bandwidth_x = one_of(kBandwidths, random);
    light.lobe.bandwidth_y = random() % 2 ? light.lobe.bandwidth_x : one_of(kBandwidths, random);
    light.color = color();
    rig.lobes.push_back(light);
  }
  constexpr std::array kSizes = {1e-37f, 1e-12f, 1e-3f, 1.0f, 1e6f, 1e18f, 3e38f};
  for (int i = 0; i < 3; ++i) {
    const Vector3f center = one_of<5>({0, 1e-30f, 1, 1e6f, 1e30f}, random) *
                            (random() % 2 ? random_unit(random) : Vector3f::UnitZ());
    const Frame<float> frame = frame_from_axis(random_unit(random));
    rig.directionals.push_back(
        {random_unit(random), one_of<4>({0, 1e-20f, 0.1f, kPi<float> / 2}, random), color()});
    if (!domain_error(rig.directionals.back()).empty()) rig.directionals.back().irradiance *= 1e-6f;
    rig.spheres.push_back({center, one_of(kSizes, random), color()});
    rig.rectangles.push_back({center, one_of(kSizes, random) * frame.x,
                              one_of(kSizes, random) * frame.y, color(), random() % 2 == 0});
  }
  const auto refused = [](const auto& light) { return !domain_error(light).empty(); };
  std::erase_if(rig.lobes, refused);
  std::erase_if(rig.directionals, refused);
  std::erase_if(rig.spheres, refused);
  std::erase_if(rig.rectangles, refused);
  return rig;
}

/// All models, each with the ends of its ranges.
Material extreme_material(std::mt19937& random) {
  static const std::vector<NamedMaterial> all = all_materials();
  Material material = all[random() % all.size()].material;
  material.diffuse = Rgb::Constant(one_of<3>({0, 0.5f, 1}, random));
  material.specular = Rgb(one_of<3>({0, 1, 1e-30f}, random), 1, 0.5f);
  material.alpha_x = one_of<5>({kMinAlpha, 1e-3f, 0.1f, 0.5f, kMaxAlpha}, random);
  material.alpha_y =
      random() % 2 ? material.alpha_x : one_of<4>({kMinAlpha, 1e-2f, 0.3f, kMaxAlpha}, random);
  Fresnel& fresnel = material.fresnel;
  fresnel.model = std::array{FresnelModel::schlick, FresnelModel::dielectric,
                             FresnelModel::conductor}[random() % 3];
  fresnel.normal_reflectance = Rgb::Constant(one_of<3>({0, 0.04f, 1}, random));
  fresnel.eta = Rgb::Constant(one_of<5>({kMinEta, 0.7f, 1, 1.5f, kMaxEta}, random));
  fresnel.k = Rgb::Constant(one_of<3>({0, 3, kMaxEta}, random));
  return material;
}

ShadingOptions extreme_options(std::mt19937& random) {
  ShadingOptions options;
  options.visibility = std::array{VisibilityModel::cap, VisibilityModel::hemisphere,
                                  VisibilityModel::directional}[random() % 3];
  options.cosine = random() % 3 ? CosineModel::horizon_normalised : CosineModel::constant;
  options.integral = random() % 3 ? AsgIntegral::exact : AsgIntegral::fast;
  options.terms = random() % 2 ? 0 : 1 + int(random() % 30);
  options.specular.form = random() % 2 ? SpecularForm::moments : SpecularForm::peak;
  options.specular.taps = std::array{1, 2, 5, kMaxTaps}[random() % 4];
  options.specular.lobes = 1 + int(random() % kTailLobes);
  options.environment_taps = std::array{1, 3, 64}[random() % 3];
  options.ladder = random() % 4 != 0;
  options.split_bandwidth = random() % 4 == 0 ? 4.0f : 0.0f;
  return options;
}

PrefilteredEnvironment extreme_map(float brightness, std::mt19937& random) {
  Image map(16, 8);
  for (Rgb& pixel : map.pixels)
    pixel = Rgb::Constant(random() % 4 ? 0.0f : brightness * float(random() % 3));
  return prefilter_environment(map);
}

std::string described(const Material& m, const ShadingOptions& o) {
  return "model " + std::to_string(int(m.model)) + " distribution " +
         std::to_string(int(m.distribution)) + " shadowing " + std::to_string(int(m.shadowing)) +
         " fresnel " + std::to_string(int(m.fresnel.model)) + " alpha " +
         std::to_string(m.alpha_x) + " " + std::to_string(m.alpha_y) + " form " +
         std::to_string(int(o.specular.form)) + " taps " + std::to_string(o.specular.taps) +
         " lobes " + std::to_string(o.specular.lobes) + " visibility " +
         std::to_string(int(o.visibility)) + " cosine " + std::to_string(int(o.cosine)) +
         " integral " + std::to_string(int(o.integral)) + " ladder " + std::to_string(o.ladder);
}

/// Whether all is finite and, if asked for, not negative.
testing::AssertionResult is_sound(const std::vector<Rgb>& radiance, bool signed_lights) {
  for (size_t i = 0; i < radiance.size(); ++i)
    if (!radiance[i].allFinite() || (!signed_lights && !(radiance[i] >= 0).all()))
      return testing::AssertionFailure() << "point " << i << ": " << radiance[i].transpose();
  return testing::AssertionSuccess();
}

struct Case {
  Transfer transfer;
  PreparedTransfer prepared;
  LightRig rig;
  ShadingOptions options;
  PreparedLights lights;
  Material material;

  Case(float brightness, std::mt19937& random) {
    transfer = extreme_transfer(40, random);
    place_extremely(transfer, random);
    prepared = prepare_transfer(transfer);
    rig = extreme_lights(brightness, random);
    options = extreme_options(random);
    lights = prepare_lights(rig, prepared, options);
    do {
      material = extreme_material(random);
    } while (!domain_error(material).empty());
  }
};

TEST(ShadeFuzz, VerticesAreFiniteAndNotNegative) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  const PrefilteredEnvironment map = extreme_map(1e4f, random);
  float brightest = 0;
  for (int i = 0; i < 150; ++i) {
    const Case c(one_of<4>({1, 1e-30f, 1e6f, 1e30f}, random), random);
    const std::vector<PreparedMaterial> materials = prepare_materials({&c.material, 1}, c.options);
    std::vector<Rgb> radiance(c.transfer.vertex_count());
    const Lighting lighting = {&c.lights, random() % 2 ? &map : nullptr};
    shade_vertices(c.prepared, lighting, materials, {}, Vector3f::Zero(), c.options, 0, radiance);
    ASSERT_TRUE(is_sound(radiance, false))
        << "case " << i << " " << described(c.material, c.options);
    if (i % 4 == 0) {
      shade_vertices(c.prepared, lighting, c.material, {}, Vector3f::Zero(), c.options, 0,
                     radiance);
      ASSERT_TRUE(is_sound(radiance, false)) << "varying, case " << i;
    }
    for (const Rgb& rgb : radiance) brightest = std::max(brightest, rgb.maxCoeff());
  }
  EXPECT_GT(brightest, 1e20f);
}

TEST(ShadeFuzz, SignedLightsAreFinite) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 1);
  for (int i = 0; i < 60; ++i) {
    Case c(1e6f, random);
    for (EnvironmentLobe& light : c.rig.lobes)
      if (random() % 2) light.color = -light.color;
    c.lights = prepare_lights(c.rig, c.prepared, c.options);
    const std::vector<PreparedMaterial> materials = prepare_materials({&c.material, 1}, c.options);
    std::vector<Rgb> radiance(c.transfer.vertex_count());
    shade_vertices(c.prepared, {&c.lights}, materials, {}, Vector3f::Zero(), c.options, 0,
                   radiance);
    ASSERT_TRUE(is_sound(radiance, true))
        << "case " << i << " " << described(c.material, c.options);
  }
}

TEST(ShadeFuzz, PointsBetweenVerticesAreFiniteAndNotNegative) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 2);
  const PrefilteredEnvironment map = extreme_map(1e20f, random);
  for (int i = 0; i < 100; ++i) {
    const Case c(one_of<3>({1, 1e-30f, 1e20f}, random), random);
    const unsigned count = static_cast<unsigned>(c.transfer.vertex_count());
    std::vector<ShadingPoint> points;
    std::vector<Vector3f> outgoing;
    for (int j = 0; j < 37; ++j) {
      ShadingPoint point = vertex_shading_point(c.prepared, random() % count);
      point.vertices = {std::uint32_t(random() % count), std::uint32_t(random() % count),
                        std::uint32_t(random() % count)};
      point.weight = std::array<std::array<float, 3>, 5>{{{1, 0, 0},
                                                          {1e-30f, 1, 0},
                                                          {1e-42f, 1, 0},
                                                          {0, 0, 1},
                                                          {0.25f, 0.25f, 0.5f}}}[random() % 5];
      points.push_back(point);
      const Frame<float>& f = point.frame;
      // Along the axes, at the horizon, just above it, and below.
      outgoing.push_back(std::array<Vector3f, 7>{
          f.z, f.x, -f.z, f.y, f.to_world(Vector3f(0.6f, 0.8f, 1e-30f)),
          f.to_world(Vector3f(1, 0, 1e-4f)), random_unit(random)}[random() % 7]);
    }
    const PreparedMaterial material = prepare_material(c.material, c.options.specular);
    std::vector<Rgb> radiance(points.size());
    shade_points(c.prepared, points, outgoing, material, {&c.lights, random() % 2 ? &map : nullptr},
                 c.options, radiance);
    ASSERT_TRUE(is_sound(radiance, false))
        << "case " << i << " " << described(c.material, c.options);
    for (size_t j = 0; j < points.size(); ++j) {
      if (outgoing[j].dot(points[j].frame.z) < -1e-5f) {
        EXPECT_EQ(radiance[j].maxCoeff(), 0);
      }
    }
  }
}

/// Of which floating point, even double, leaves no digits.
TEST(ShadeFuzz, NeedlesOfLightAreFiniteAndNotNegative) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 4);
  Material material = white(SpecularModel::ashikhmin_shirley, 0.3f, 0.1f);
  material.diffuse = Rgb::Ones();
  const PreparedMaterial prepared = prepare_material(material, {});
  for (int i = 0; i < 300; ++i) {
    Transfer transfer = random_transfer({.vertices = 32, .terms = 1}, random);
    place_extremely(transfer, random);
    const PreparedTransfer seen = prepare_transfer(transfer);
    const Frame<float> frame = frame_from_axis(random_unit(random));
    LightRig rig;
    rig.rectangles.push_back({one_of<4>({0, 1e-30f, 1, 1e6f}, random) * random_unit(random),
                              one_of<3>({1e-12f, 1e-3f, 1}, random) * frame.x,
                              one_of<4>({1e-3f, 1, 1e6f, 1e18f}, random) * frame.y, Rgb::Ones(),
                              true});
    const PreparedLights lights = prepare_lights(rig, seen, {});
    std::vector<Rgb> radiance(transfer.vertex_count());
    shade_vertices(seen, {&lights}, {&prepared, 1}, {}, Vector3f::Zero(), {}, 0, radiance);
    ASSERT_TRUE(is_sound(radiance, false)) << "case " << i;
  }
}

/// As bright as light and materials may be, one after the other.
TEST(ShadeFuzz, TheBrightestSpecularIsFinite) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed + 3);
  for (int i = 0; i < 60; ++i) {
    Case c(1e20f, random);
    c.material.specular = Rgb::Constant(kMaxSpecular);
    const std::vector<PreparedMaterial> materials = prepare_materials({&c.material, 1}, c.options);
    std::vector<Rgb> radiance(c.transfer.vertex_count());
    shade_vertices(c.prepared, {&c.lights}, materials, {}, Vector3f::Zero(), c.options, 0,
                   radiance);
    ASSERT_TRUE(is_sound(radiance, false))
        << "case " << i << " " << described(c.material, c.options);
  }
}

}  // namespace
}  // namespace burnish::test
