#include "harness/rivals/sg_rival.h"

#include <cmath>

#include <gtest/gtest.h>

#include "burnish/visibility/ssdf.h"
#include "harness/environment_truth.h"
#include "harness/error_metrics.h"
#include "harness/reference_integrator.h"
#include "harness/round_lobe_fit.h"
#include "rival_scenes.h"

namespace burnish {
namespace {

using test::SmallScene;

double distance_at(const Transfer& transfer, size_t vertex, const Vector3d& axis) {
  return double(lookup_ssdf(transfer.bases[transfer.basis_id[vertex]],
                            transfer.vertex_coefficients(vertex), transfer.terms(),
                            axis.cast<float>())
                    .distance);
}

/// f_h over the lobe's integral. The published quotient, by f_h of a boundary at pi/2, differs for
/// lobes that no sphere has room for: the runtime has the fraction itself.
double visible(double sharpness, double distance) {
  return visible_fraction_hemisphere(sharpness, distance, HemisphereLevel::exact);
}

/// A highlight as wang2009svbrdf have it, in double, with SGs alone and the map by quadrature.
Rgb specular_truth(const SmallScene& small, size_t vertex,
                   std::span<const SphericalGaussian<float>> lobes) {
  const VertexView view = view_vertex(small.transfer, vertex, small.eye);
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (const SphericalGaussian<float>& lobe : lobes) {
    const Vector3d half = lobe.axis.cast<double>(), out = view.outgoing.cast<double>();
    const double cosine = half.dot(out);
    if (cosine <= 0) continue;
    const Vector3d axis = 2 * cosine * half - out;
    if (axis.z() <= 0) continue;
    const SphericalGaussian<double> warped{view.frame.cast<double>().to_world(axis),
                                           lobe.sharpness / (4 * std::max(cosine, kMinWarpCosine)),
                                           lobe.amplitude};
    AnisotropicGaussian<double> round;
    round.frame = frame_from_axis(warped.axis);
    round.bandwidth_x = round.bandwidth_y = warped.sharpness / 2;
    const Rgb factor =
        specular_smooth_factor(small.materials[0], view.outgoing, axis.cast<float>());
    sum += factor.cast<double>() * axis.z() * integral(warped) *
           visible(warped.sharpness, distance_at(small.transfer, vertex, warped.axis)) *
           integrate_environment(small.map, round);
  }
  return sum.cast<float>();
}

TEST(SgRival, HighlightsAreThoseOfThePublishedPipeline) {
  const SmallScene small(test::floor_mesh(), test::shiny(0.4f, 0.1f), studio_environment(128));
  for (const int count : {1, 5}) {
    const std::vector<Rgb> values = test::shaded(sg_rival(small.scene, {.lobes = count}), small);
    const auto lobes = fit_round_lobes(distribution_of(small.materials[0]), count).lobes;
    std::vector<Rgb> truth, some;
    for (size_t v = 0; v < values.size(); v += 5) {
      truth.push_back(specular_truth(small, v, lobes));
      some.push_back(values[v]);
    }
    // The filtered map is off by up to 1 %, the ASG of a wide SG by as much.
    EXPECT_LT(relative_l2(some, truth).value, 0.02) << count;
  }
}

TEST(SgRival, DiffuseIsASumOfSgLights) {
  const SmallScene small(test::floor_mesh(), test::matte(), studio_environment(128));
  constexpr int kLights = 6;
  const std::vector<Rgb> values =
      test::shaded(sg_rival(small.scene, {.light_lobes = kLights}), small);
  const LightRig rig = fit_light(small.map, {.lobes = kLights, .isotropic = true}).rig;
  std::vector<Rgb> truth;
  for (size_t v = 0; v < values.size(); ++v) {
    Rgb irradiance = Rgb::Zero();
    for (const EnvironmentLobe& light : rig.lobes) {
      const Vector3f& axis = light.lobe.frame.z;
      EXPECT_EQ(light.lobe.bandwidth_x, light.lobe.bandwidth_y);
      const double sharpness = effective_sharpness(light.lobe);
      irradiance +=
          light.color *
          float(integral(light.lobe) * std::max(axis.dot(small.transfer.normals[v]), 0.0f) *
                visible(sharpness, distance_at(small.transfer, v, axis.cast<double>())));
    }
    truth.push_back(small.materials[0].diffuse / kPi<float> * irradiance);
  }
  // The fast level of the fraction: 4e-4, of a sum in which no lobe is small.
  EXPECT_LT(relative_l2(values, truth).value, 5e-3);
}

TEST(SgRival, ManyLobesApproachTheTruthAndPassOneAsg) {
  const SmallScene small(test::ball_mesh(), test::shiny(0.5f, 0.05f), studio_environment(256));
  const VertexReference truth = shade_reference_vertices(small.scene.subject, small.rays, small.eye,
                                                         {{&small.map}}, {.samples = 256});
  const auto error_of = [&](const Rival& rival) {
    return relative_l2(test::shaded(rival, small), truth.radiance, truth.variance).value;
  };
  const double one = error_of(sg_rival(small.scene, {.lobes = 1}));
  const double seven = error_of(sg_rival(small.scene, {.lobes = 7}));
  const double nineteen = error_of(sg_rival(small.scene, {.lobes = 19}));
  const double asg = error_of(runtime_rival(small.scene, "paper", {paper_shading_options()}));
  RecordProperty("errors", std::to_string(one) + " " + std::to_string(seven) + " " +
                               std::to_string(nineteen) + " " + std::to_string(asg));
  EXPECT_LT(seven, one);
  EXPECT_LT(nineteen, seven);
  EXPECT_LT(nineteen, asg);
}

TEST(SgRival, LightsTurnWithTheMap) {
  const SmallScene small(test::ball_mesh(), test::shiny(0.3f, 0.3f), studio_environment(128));
  const Rival rival = sg_rival(small.scene, {.lobes = 3});
  const std::vector<Rgb> still = test::shaded(rival, small);
  const std::vector<Rgb> turned = test::shaded(rival, small, test::some_turn());
  EXPECT_GT(relative_l2(turned, still).value, 0.1);
  const std::vector<Rgb> again = test::shaded(rival, small);
  for (size_t v = 0; v < still.size(); ++v) EXPECT_TRUE((again[v] == still[v]).all());
}

TEST(SgMaterial, HasTheFittedLobes) {
  const Material material = test::shiny(0.5f, 0.05f);
  const PreparedMaterial prepared = sg_material(material, 5);
  ASSERT_EQ(prepared.count, 5);
  for (const SphericalGaussian<float>& sg : fit_round_lobes(distribution_of(material), 5).lobes) {
    double nearest = 1;
    for (int k = 0; k < prepared.count; ++k) {
      const AnisotropicGaussian<float>& lobe = prepared.tooth[static_cast<size_t>(k)].lobe;
      EXPECT_EQ(lobe.bandwidth_x, lobe.bandwidth_y);
      if (std::abs(2 * lobe.bandwidth_x - sg.sharpness) < 1e-3f * sg.sharpness)
        nearest = std::min(nearest, double((lobe.frame.z - sg.axis).norm()));
    }
    EXPECT_LT(nearest, 1e-5);
  }
  EXPECT_EQ(sg_material(test::matte(), 5).count, 0);
}

}  // namespace
}  // namespace burnish
