#include "harness/rivals/sh_rival.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "harness/error_metrics.h"
#include "harness/reference_integrator.h"
#include "rival_scenes.h"
#include "support/quadrature.h"

namespace burnish {
namespace {

using test::SmallScene;

/// Of three bands of harmonics.
Rgb smooth_radiance(const Vector3d& d) {
  return Rgb(1 + 0.5 * d.y(), 1 + 0.8 * d.x() * d.z(), 1.5 + d.y() * d.y() - 0.4 * d.z());
}

Image smooth_map() {
  Image map(256, 128);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      map.at(x, y) = smooth_radiance(direction_from_latlong((x + 0.5) / 256, (y + 0.5) / 128));
  return map;
}

/// What vertices in the open reflect, by quadrature, and what a rival makes of them. Those seen at
/// a slant are left out: the quadrature does not follow their highlights.
struct OpenVertices {
  std::vector<size_t> vertex;
  std::vector<Rgb> truth;

  OpenVertices(const SmallScene& small, const Eigen::Matrix3f& turn) {
    for (size_t v = 0; v < small.transfer.vertex_count(); v += 3) {
      const VertexView view = view_vertex(small.transfer, v, small.eye);
      if (view.outgoing.z() < 0.3f) continue;
      vertex.push_back(v);
      Rgb radiance;
      for (int c = 0; c < 3; ++c)
        radiance[c] = static_cast<float>(test::integrate_sphere(
            [&](const Vector3d& d) {
              const Vector3f local = view.frame.to_local(d.cast<float>());
              if (local.z() <= 0) return 0.0;
              return double(eval_brdf(small.materials[0], view.outgoing, local)[c] * local.z() *
                            smooth_radiance(turn.transpose().cast<double>() * d)[c]);
            },
            view.frame.z.cast<double>(), 24));
      truth.push_back(radiance);
    }
  }

  double error(const std::vector<Rgb>& all) const {
    std::vector<Rgb> values;
    for (const size_t v : vertex) values.push_back(all[v]);
    return relative_l2(values, truth).value;
  }
};

TEST(ShRival, DiffuseInTheOpenUnderASmoothMapIsTheQuadrature) {
  const SmallScene small(test::ball_mesh(), test::matte(), smooth_map());
  const Eigen::Matrix3f turn = test::some_turn();
  const OpenVertices open(small, turn);
  ASSERT_GT(open.truth.size(), 20u);
  const auto error_of = [&](int order) {
    return open.error(test::shaded(sh_rival(small.scene, {.order = order}), small, turn));
  };
  // The light has three bands: nothing is cut. Texels at the horizon, where the cosine is 0, are
  // seen or not as wholes: 128^2 of them.
  EXPECT_LT(error_of(3), 2e-3);
  EXPECT_LT(error_of(6), 2e-3);
  EXPECT_GT(error_of(2), 2e-2);
}

TEST(ShRival, GlossyInTheOpenUnderASmoothMapIsTheQuadrature) {
  const SmallScene small(test::ball_mesh(), test::shiny(0.6f, 0.3f), smooth_map());
  const Eigen::Matrix3f turn = test::some_turn();
  const OpenVertices open(small, turn);
  ASSERT_GT(open.truth.size(), 20u);
  const auto error_of = [&](int order) {
    return open.error(test::shaded(sh_rival(small.scene, {.order = order}), small, turn));
  };
  // Again nothing is cut. 1024 samples a view, linear in between, and the quadrature: .1 % each.
  EXPECT_LT(error_of(3), 5e-3);
  EXPECT_GT(error_of(1), 0.1);
}

TEST(ShRival, ShadowsAreThoseOfTheReference) {
  const SmallScene small(test::floor_mesh(), test::matte(), smooth_map());
  const VertexReference truth = shade_reference_vertices(small.scene.subject, small.rays, small.eye,
                                                         {{&small.map}}, {.samples = 256});
  const std::vector<Rgb> values = test::shaded(sh_rival(small.scene, {.order = 3}), small);
  // No light is cut: the errors are those of the visibility's directions, 128^2.
  const RelativeL2 error = relative_l2(values, truth.radiance, truth.variance);
  EXPECT_LT(error.value, 2 * error.truth_noise + 5e-3);
  EXPECT_LT(error.truth_noise, 0.012);
}

TEST(ShRival, ARangeOfVerticesIsAPartOfAll) {
  const SmallScene small(test::ball_mesh(), test::shiny(0.5f, 0.2f), smooth_map());
  const Rival rival = sh_rival(small.scene, {.order = 4});
  const std::vector<Rgb> all = test::shaded(rival, small);
  std::vector<Rgb> part(7);
  rival.shade(small.eye, 30, part);
  for (size_t i = 0; i < part.size(); ++i) EXPECT_TRUE((part[i] == all[30 + i]).all());
}

TEST(ShRival, RefusesWhatItCannotDo) {
  SmallScene small(test::ball_mesh(), test::matte(), smooth_map());
  EXPECT_THROW(sh_rival(small.scene, {.order = 0}), std::invalid_argument);
  EXPECT_THROW(sh_rival(small.scene, {.order = 7}), std::invalid_argument);
  small.scene.rig.spheres.push_back({Vector3f(0, 3, 0), 0.5f, Rgb::Ones()});
  EXPECT_THROW(sh_rival(small.scene, {.order = 3}), std::invalid_argument);
  const Progress stop = [](std::string_view, std::uint64_t, std::uint64_t) { return false; };
  small.scene.rig.spheres.clear();
  EXPECT_THROW(sh_rival(small.scene, {.order = 3}, stop), Cancelled);
}

}  // namespace
}  // namespace burnish
