#include "harness/reference_integrator.h"

#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "harness/procedural_scenes.h"
#include "harness/shapes.h"
#include "harness/studio_environment.h"
#include "statistics.h"

namespace burnish {
namespace {

constexpr std::array kTechniques = {SamplingTechnique::combined, SamplingTechnique::lights_only,
                                    SamplingTechnique::brdf_only};
constexpr const char* kTechniqueNames[] = {"combined", "lights only", "BRDF only"};

Material white_diffuse() { return {.diffuse = Rgb::Ones(), .specular = Rgb::Zero()}; }

ReferenceOptions many_samples(SamplingTechnique technique, int samples = 1 << 15) {
  return {.samples = samples, .replicates = 64, .seed = 1, .technique = technique};
}

RayScene scene_of(std::span<const TriangleMesh> meshes) {
  RayScene scene;
  for (const TriangleMesh& mesh : meshes) scene.add_mesh(mesh.positions, mesh.triangles);
  scene.commit();
  return scene;
}

Image constant_map(const Rgb& radiance) { return Image(32, 16, radiance); }

/// Radiance of a point of a given frame toward `outgoing`.
ReferenceEstimate radiance_at(const RayScene& scene, const ReferenceLights& lights,
                              const Vector3f& position, const Frame<float>& frame,
                              const Vector3f& outgoing, const Material& material,
                              const ReferenceOptions& options) {
  const ReferenceIntegrator integrator(scene, lights);
  const ReferenceIntegrator::Point point = integrator.prepare(position, frame, outgoing, material);
  return estimate_radiance(integrator, {&point, 1}, 7, options);
}

/// The same of a white diffuse point, seen along its normal: irradiance / pi.
ReferenceEstimate diffuse_radiance(const RayScene& scene, const ReferenceLights& lights,
                                   const Vector3f& position, const Vector3f& normal,
                                   SamplingTechnique technique) {
  return radiance_at(scene, lights, position, frame_from_axis(normal), normal, white_diffuse(),
                     many_samples(technique));
}

/// Form factor from a surface element to a polygon that is all above its horizon: Lambert's
/// formula.
double polygon_form_factor(const Vector3d& position, const Vector3d& normal,
                           const std::vector<Vector3d>& corners) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector3d a = (corners[i] - position).normalized();
    const Vector3d b = (corners[(i + 1) % corners.size()] - position).normalized();
    sum += angle_between(a, b) * a.cross(b).normalized().dot(normal);
  }
  return std::abs(sum) / (2 * kPi<double>);
}

TEST(ReferenceIntegrator, WhiteFurnaceReturnsTheRadianceOfTheEnvironment) {
  const RayScene empty = scene_of({});
  const Rgb radiance(1.0f, 2.0f, 0.5f);
  const Image map = constant_map(radiance);
  const ReferenceLights lights{{&map}, {}};
  for (const Vector3f& normal : {Vector3f(0, 1, 0), Vector3f(0.6f, 0, -0.8f)}) {
    // A cosine-distributed direction makes every sample equal to the radiance: no variance.
    const ReferenceEstimate exact =
        diffuse_radiance(empty, lights, Vector3f::Zero(), normal, SamplingTechnique::brdf_only);
    EXPECT_LT((exact.mean - radiance.cast<double>()).abs().maxCoeff(), 1e-6);
    EXPECT_LT(exact.variance.maxCoeff(), 1e-12);
    for (const SamplingTechnique technique : kTechniques)
      expect_estimate(diffuse_radiance(empty, lights, Vector3f::Zero(), normal, technique), 1, 1e-6,
                      2e-3, kTechniqueNames[int(technique)]);
  }
}

TEST(ReferenceIntegrator, SphereOccluderHidesItsFormFactor) {
  // A sphere of radius R at distance D, all above the horizon, fills (R/D)^2 cos(theta) of the
  // cosine-weighted hemisphere.
  const Vector3f center(0, 1.5f, 0);
  const float radius = 0.8f;
  TriangleMesh sphere;
  append_sphere(sphere, center, radius, 256, 128);
  const RayScene scene = scene_of({&sphere, 1});
  const Image map = constant_map(Rgb::Ones());
  for (const Vector3f& position :
       {Vector3f(0, 0, 0), Vector3f(0.7f, 0, 0.2f), Vector3f(0, 0, -2.5f)}) {
    const Vector3d to_center = (center - position).cast<double>();
    const double cosine = to_center.normalized().y();
    const double sine = radius / to_center.norm();
    ASSERT_GT(cosine, sine) << "the sphere is above the horizon";
    const double truth = 1 - sine * sine * cosine;
    for (const SamplingTechnique technique : kTechniques)
      // The inscribed mesh lacks (pi / 256)^2 of the outline's area at most, and the ray's origin
      // is 2.4e-5 of the scene nearer: together less than 1e-4.
      expect_estimate(diffuse_radiance(scene, {{&map}, {}}, position, Vector3f::UnitY(), technique),
                      truth, 1e-4, 3e-3, kTechniqueNames[int(technique)]);
  }
}

TEST(ReferenceIntegrator, WallHidesItsFormFactor) {
  const Vector3f corner(-4, 0, -1), along(8, 0, 0), up(0, 2, 0);
  TriangleMesh wall;
  append_rectangle(wall, corner, along, up, 3, 2);
  const RayScene scene = scene_of({&wall, 1});
  const Image map = constant_map(Rgb::Ones());
  for (const float distance : {0.05f, 0.5f, 3.0f}) {
    const Vector3f position(0, 0, -1 + distance);
    // Rays start at the offset, and the wall's foot is on the horizon: seen from there.
    const Vector3d seen_from =
        (position + scene.origin_offset() * Vector3f::UnitY()).cast<double>();
    const double hidden =
        polygon_form_factor(seen_from, Vector3d::UnitY(),
                            {corner.cast<double>() + Vector3d(0, seen_from.y(), 0),
                             (corner + along).cast<double>() + Vector3d(0, seen_from.y(), 0),
                             (corner + along + up).cast<double>(), (corner + up).cast<double>()});
    // Close to the wall it is as good as endless: (1 - cos(elevation of its top)) / 2.
    if (distance < 0.1f) {
      EXPECT_NEAR(hidden, (1 - std::cos(std::atan(2 / double(distance)))) / 2, 1e-3);
    }
    for (const SamplingTechnique technique : kTechniques)
      expect_estimate(diffuse_radiance(scene, {{&map}, {}}, position, Vector3f::UnitY(), technique),
                      1 - hidden, 1e-6, 3e-3, kTechniqueNames[int(technique)]);
  }
}

TEST(ReferenceIntegrator, SphereLightGivesItsIrradiance) {
  const RayScene empty = scene_of({});
  for (const float radius : {1e-3f, 0.3f, 1.4f}) {
    const SphereLight light{Vector3f(0.4f, 2.0f, -0.3f), radius, Rgb(3.0f, 0.0f, 0.0f)};
    const Vector3d to_center = light.center.cast<double>();
    const double sine = radius / to_center.norm(), cosine = to_center.normalized().y();
    ASSERT_GT(cosine, sine) << "the sphere is above the horizon";
    // pi L (R/D)^2 cos(theta) / pi
    const double truth = 3 * sine * sine * cosine;
    for (const SamplingTechnique technique : kTechniques) {
      if (technique == SamplingTechnique::brdf_only && radius < 0.1f) continue;  // hardly ever hits
      expect_estimate(diffuse_radiance(empty, {{}, {&light, 1}}, Vector3f::Zero(),
                                       Vector3f::UnitY(), technique),
                      truth, 1e-6 * truth, 0.02 * truth, kTechniqueNames[int(technique)]);
    }
  }
}

TEST(ReferenceIntegrator, InsideASphereLightIsAFurnace) {
  const RayScene empty = scene_of({});
  const SphereLight light{Vector3f(0.2f, 0.3f, 0.1f), 1.5f, Rgb::Constant(2.0f)};
  for (const Vector3f& position : {Vector3f(0, 0, 0), Vector3f(0.2f, 0.3f, 0.1f)})
    for (const SamplingTechnique technique : kTechniques)
      expect_estimate(
          diffuse_radiance(empty, {{}, {&light, 1}}, position, Vector3f::UnitY(), technique), 2,
          1e-6, 0.01, kTechniqueNames[int(technique)]);
}

TEST(ReferenceIntegrator, SphereLightPartlyBelowTheHorizonAgreesBetweenTechniques) {
  const RayScene empty = scene_of({});
  const SphereLight light{Vector3f(1.0f, 0.1f, 0), 0.7f, Rgb::Ones()};
  ReferenceEstimate estimates[3];
  for (const SamplingTechnique technique : kTechniques)
    estimates[int(technique)] =
        diffuse_radiance(empty, {{}, {&light, 1}}, Vector3f::Zero(), Vector3f::UnitY(), technique);
  for (int i = 1; i < 3; ++i)
    expect_estimate(estimates[i], estimates[0].mean.x(),
                    kSigmas * std::sqrt(estimates[0].variance.x()), 3e-3, kTechniqueNames[i]);
}

TEST(ReferenceIntegrator, OnlyWhatIsNearerThanASphereLightShadowsIt) {
  const SphereLight light{Vector3f(0, 2, 0), 0.5f, Rgb::Ones()};
  const auto scene_with_ceiling = [](float height) {
    TriangleMesh ceiling;
    append_rectangle(ceiling, Vector3f(-9, height, -9), Vector3f(0, 0, 18), Vector3f(18, 0, 0), 1,
                     1);
    return scene_of({&ceiling, 1});
  };
  const double truth = 0.25 / 4;
  for (const SamplingTechnique technique : kTechniques) {
    const auto lit = [&](float ceiling) {
      return diffuse_radiance(scene_with_ceiling(ceiling), {{}, {&light, 1}}, Vector3f::Zero(),
                              Vector3f::UnitY(), technique);
    };
    EXPECT_EQ(lit(1.0f).mean.x(), 0) << "a ceiling before the light";
    expect_estimate(lit(3.0f), truth, 1e-6, 3e-3, "a ceiling behind the light");
    // The light's near side is lower than the ceiling through its middle.
    expect_estimate(lit(2.0f), truth, 1e-6, 3e-3, "a ceiling through the light");
  }
}

TEST(ReferenceIntegrator, DirectionalLightGivesItsIrradiance) {
  const RayScene empty = scene_of({});
  for (const float radius : {0.0f, 0.00465f, 0.5f}) {
    const DirectionalLight light{Vector3f(0.6f, 0.8f, 0), radius, Rgb(3, 0, 0)};
    for (const SamplingTechnique technique : kTechniques) {
      if (technique == SamplingTechnique::brdf_only && radius < 0.1f) continue;  // hardly ever hits
      expect_estimate(diffuse_radiance(empty, {.directionals = {&light, 1}}, Vector3f(5, 6, 7),
                                       Vector3f::UnitY(), technique),
                      3 * 0.8 / kPi<double>, 1e-6, 0.02, kTechniqueNames[int(technique)]);
    }
  }
}

TEST(ReferenceIntegrator, RectangleLightGivesItsFormFactor) {
  const RayScene empty = scene_of({});
  RectangleLight light{Vector3f(0.3f, 1.5f, -0.2f), Vector3f(1.2f, 0.3f, 0), Vector3f(0, 0, -0.8f),
                       Rgb(2, 0, 0), false};
  const Vector3d center = light.center.cast<double>();
  const Vector3d x = light.edge_x.cast<double>() / 2, y = light.edge_y.cast<double>() / 2;
  const std::vector<Vector3d> corners = {center - x - y, center + x - y, center + x + y,
                                         center - x + y};
  for (const Vector3f& position : {Vector3f(0, 0, 0), Vector3f(0.3f, 1.2f, -0.2f)}) {
    const double truth =
        2 * polygon_form_factor(position.cast<double>(), Vector3d::UnitY(), corners);
    for (const bool two_sided : {false, true}) {
      // edge_x x edge_y points up: turned round, its back is to the point.
      for (const float turn : {1.0f, -1.0f}) {
        light.two_sided = two_sided;
        light.edge_y.z() = turn * 0.8f;
        for (const SamplingTechnique technique : kTechniques)
          expect_estimate(diffuse_radiance(empty, {.rectangles = {&light, 1}}, position,
                                           Vector3f::UnitY(), technique),
                          two_sided || turn > 0 ? truth : 0, 1e-6, 0.02,
                          kTechniqueNames[int(technique)]);
      }
    }
  }
}

TEST(ReferenceIntegrator, OnlyWhatIsBeforeARectangleLightShadowsIt) {
  const RectangleLight light{Vector3f(0, 2, 0), Vector3f(0.5f, 0, 0), Vector3f(0, 0, 0.5f),
                             Rgb::Constant(4), true};
  const auto scene_with_ceiling = [](float height) {
    TriangleMesh ceiling;
    append_rectangle(ceiling, Vector3f(-9, height, -9), Vector3f(0, 0, 18), Vector3f(18, 0, 0), 1,
                     1);
    return scene_of({&ceiling, 1});
  };
  for (const SamplingTechnique technique : kTechniques) {
    const auto lit = [&](float ceiling) {
      return diffuse_radiance(scene_with_ceiling(ceiling), {.rectangles = {&light, 1}},
                              Vector3f::Zero(), Vector3f::UnitY(), technique);
    };
    EXPECT_EQ(lit(1.0f).mean.x(), 0) << "a ceiling before the light";
    const double truth =
        4 * polygon_form_factor(
                Vector3d::Zero(), Vector3d::UnitY(),
                {{-0.25, 2, -0.25}, {0.25, 2, -0.25}, {0.25, 2, 0.25}, {-0.25, 2, 0.25}});
    expect_estimate(lit(3.0f), truth, 1e-6, 3e-3, "a ceiling behind the light");
    expect_estimate(lit(2.0f), truth, 1e-6, 3e-3, "a light on the ceiling");
  }
}

/// Integral of the specular BRDF times the cosine over the hemisphere, by the midpoint rule over
/// incoming directions.
double specular_albedo(const Material& material, const Vector3f& outgoing) {
  constexpr int kHeights = 1500, kAngles = 3000;
  double sum = 0;
  for (int i = 0; i < kHeights; ++i) {
    // sin^2 evenly: the cosine is in the measure.
    const double sine = std::sqrt((i + 0.5) / kHeights), cosine = std::sqrt(1 - sine * sine);
    for (int j = 0; j < kAngles; ++j) {
      const double angle = 2 * kPi<double> * (j + 0.5) / kAngles;
      const Vector3f incoming =
          Vector3d(sine * std::cos(angle), sine * std::sin(angle), cosine).cast<float>();
      sum += double(eval_specular_brdf(material, outgoing, incoming).x());
    }
  }
  return sum * kPi<double> / (double(kHeights) * kAngles);
}

TEST(ReferenceIntegrator, SpecularFurnaceReturnsTheAlbedoOfTheBrdf) {
  const RayScene empty = scene_of({});
  const Image map = constant_map(Rgb::Ones());
  const Frame<float> frame =
      frame_from_normal_tangent<float>(Vector3f(1, 2, 2) / 3, Vector3f(0.3f, -1, 0.7f));
  for (const SpecularModel model : {SpecularModel::ward, SpecularModel::ashikhmin_shirley})
    for (const double view : {0.0, 0.6, 1.2}) {
      const Material material{.diffuse = Rgb::Zero(),
                              .specular = Rgb::Constant(0.7f),
                              .model = model,
                              .alpha_x = 0.3f,
                              .alpha_y = 0.12f,
                              .fresnel = {.normal_reflectance = Rgb::Constant(0.7f)}};
      const Vector3f outgoing =
          Vector3d(std::sin(view) * std::cos(0.4), std::sin(view) * std::sin(0.4), std::cos(view))
              .cast<float>();
      const double truth = specular_albedo(material, outgoing);
      EXPECT_GT(truth, 0.1);
      for (const SamplingTechnique technique : kTechniques)
        // The quadrature's own error: halving its steps changes it by less than 2e-4.
        expect_estimate(
            radiance_at(empty, {{&map}, {}}, Vector3f::Zero(), frame, frame.to_world(outgoing),
                        material, many_samples(technique)),
            truth, 2e-4, 0.02,
            std::string(kTechniqueNames[int(technique)]) + ", view " + std::to_string(view));
    }
}

TEST(ReferenceIntegrator, TechniquesAgreeOnARealScene) {
  constexpr int kSamples = 1 << 14;
  const ProceduralScene scene = make_scene("dish");
  const RayScene rays = scene_of({&scene.mesh, 1});
  const Image studio = studio_environment(128);
  const SphereLight lamp{Vector3f(0.5f, 0.9f, 0.4f), 0.2f, Rgb::Constant(5.0f)};
  const DirectionalLight sun{Vector3f(0.6f, 0.8f, 0), 0.1f, Rgb::Constant(2)};
  const RectangleLight panel{Vector3f(-0.3f, 1, 0), Vector3f(0, 0, 0.7f), Vector3f(0.4f, 0, 0),
                             Rgb::Constant(3), true};
  const ReferenceLights lights{
      {&studio, world_from_environment(Vector3f::UnitY(), 40)}, {&lamp, 1}, {&sun, 1}, {&panel, 1}};
  const Material material{.diffuse = Rgb::Constant(0.3f),
                          .specular = Rgb::Constant(0.4f),
                          .model = SpecularModel::ward,
                          .alpha_x = 0.4f,
                          .alpha_y = 0.2f};
  for (size_t vertex = 3000; vertex < scene.mesh.positions.size(); vertex += 5003) {
    const Frame<float> frame =
        frame_from_normal_tangent(scene.mesh.normals[vertex], scene.mesh.tangents[vertex]);
    const Vector3f outgoing = (frame.z + 0.7f * frame.x).normalized();
    ReferenceEstimate estimates[3];
    for (const SamplingTechnique technique : kTechniques)
      estimates[int(technique)] =
          radiance_at(rays, lights, scene.mesh.positions[vertex], frame, outgoing, material,
                      many_samples(technique, kSamples));
    for (int i = 1; i < 3; ++i)
      expect_estimate(estimates[i], estimates[0].mean.x(),
                      kSigmas * std::sqrt(estimates[0].variance.x()),
                      0.05 * estimates[0].mean.x() + 1e-3,
                      std::string(kTechniqueNames[i]) + ", vertex " + std::to_string(vertex));
    // Veach's Theorem 9.2, n samples of each technique: the balance heuristic's variance is at most
    // mean^2 / (2 n) above that of the better one.
    const double mean = estimates[0].mean.x();
    EXPECT_LE(estimates[0].variance.x(),
              std::min(estimates[1].variance.x(), estimates[2].variance.x()) +
                  mean * mean / (2 * kSamples));
  }
}

TEST(ReferenceIntegrator, ReportedVarianceIsThatOfTheMean) {
  const RayScene empty = scene_of({});
  const Image studio = studio_environment(64);
  const ReferenceLights lights{{&studio}, {}};
  const ReferenceIntegrator integrator(empty, lights);
  const Material material = white_diffuse();
  const ReferenceIntegrator::Point point = integrator.prepare(
      Vector3f::Zero(), frame_from_axis<float>(Vector3f::UnitY()), Vector3f::UnitY(), material);
  constexpr int kRuns = 400;
  double sum = 0, sum2 = 0, reported = 0;
  for (int run = 0; run < kRuns; ++run) {
    const ReferenceEstimate e = estimate_radiance(
        integrator, {&point, 1}, static_cast<std::uint64_t>(run), {.samples = 64, .replicates = 8});
    sum += e.mean.x();
    sum2 += e.mean.x() * e.mean.x();
    reported += e.variance.x() / kRuns;
  }
  const double actual = (sum2 - sum * sum / kRuns) / (kRuns - 1);
  // Relative deviations: sqrt(2 / 399) of `actual`, sqrt(2 / (7 x 400)) of `reported` for normal
  // values, together 7.6 %; four of them, doubled because the values have heavier tails.
  EXPECT_NEAR(reported / actual, 1, 0.6);
}

TEST(ReferenceIntegrator, AViewBelowTheHorizonIsBlack) {
  const RayScene empty = scene_of({});
  const Image map = constant_map(Rgb::Ones());
  const ReferenceEstimate estimate = radiance_at(
      empty, {{&map}, {}}, Vector3f::Zero(), frame_from_axis<float>(Vector3f::UnitY()),
      Vector3f(0.6f, -0.8f, 0), white_diffuse(), many_samples(SamplingTechnique::combined, 64));
  EXPECT_EQ(estimate.mean.maxCoeff(), 0);
  EXPECT_EQ(estimate.variance.maxCoeff(), 0);
}

TEST(ReferenceIntegrator, TheEnvironmentTurnsWithItsRotation) {
  // One lit pixel row pair overhead of the map; turned by 90 degrees about x it stands at the side.
  const RayScene empty = scene_of({});
  Image map(64, 32);
  for (int x = 0; x < 64; ++x) map.at(x, 0) = map.at(x, 1) = Rgb::Constant(10.0f);
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(kPi<float> / 2, Vector3f::UnitX()).toRotationMatrix();  // +y to +z
  // A cap of half angle a on the normal's axis: sin^2 a of the hemisphere.
  const double truth = 10 * std::pow(std::sin(2 * kPi<double> / 32), 2);
  for (const SamplingTechnique technique : kTechniques) {
    expect_estimate(
        diffuse_radiance(empty, {{&map, turn}, {}}, Vector3f::Zero(), Vector3f::UnitZ(), technique),
        truth, 1e-6, 0.03, kTechniqueNames[int(technique)]);
    EXPECT_EQ(
        diffuse_radiance(empty, {{&map, turn}, {}}, Vector3f::Zero(), -Vector3f::UnitZ(), technique)
            .mean.x(),
        0);
  }
}

}  // namespace
}  // namespace burnish
