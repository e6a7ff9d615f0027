#include "harness/render.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/sphere/octahedral_map.h"
#include "harness/procedural_scenes.h"
#include "harness/reference_integrator.h"
#include "harness/shapes.h"
#include "harness/studio_environment.h"

namespace burnish {
namespace {

Transfer transfer_of(const TriangleMesh& mesh) {
  Transfer transfer;
  transfer.positions = mesh.positions;
  transfer.normals = mesh.normals;
  transfer.tangents = mesh.tangents;
  transfer.file_vertex = mesh.file_vertex;
  transfer.triangles = mesh.triangles;
  return transfer;
}

/// A basis of one component whose mean is the horizon of +y and whose component lowers it.
void add_basis(Transfer& transfer, int copies) {
  SsdfBasis basis;
  basis.resolution = 16;
  basis.terms = 1;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const Vector3f d = octahedral_texel_direction<float>(x, y, 16);
      basis.mean.push_back(std::asin(d.y()));
      basis.eigen.push_back(d.x());
    }
  transfer.bases.assign(static_cast<size_t>(copies), basis);
  transfer.basis_id.assign(transfer.vertex_count(), 0);
  for (const Vector3f& p : transfer.positions) transfer.coefficients.push_back(0.3f * p.x());
}

/// The square floor of the scene "plane", lit by a lobe from above and a lamp.
struct PlaneScene {
  ProceduralScene scene = make_scene("plane");
  Transfer transfer = transfer_of(scene.mesh);
  PreparedTransfer prepared;
  Subject subject{&transfer, scene.materials, scene.material_id, nullptr, &prepared};
  ShadingOptions options;
  PreparedLights lights;
  Lighting lighting{&lights, nullptr};
  Image map = studio_environment(64);
  EnvironmentLight background{&map, world_from_environment(Vector3f::UnitY(), 70)};
  View view{scene.camera, 48, 32, 1};
  LightRig rig;

  PlaneScene() {
    EnvironmentLobe lobe;
    lobe.lobe.frame = frame_from_axis<float>(Vector3f(0.6f, 0.8f, 0));
    lobe.lobe.bandwidth_x = 4;
    lobe.lobe.bandwidth_y = 2;
    lobe.color = Rgb(1, 2, 3);
    rig.lobes.push_back(lobe);
    rig.spheres.push_back({Vector3f(0.5f, 0.6f, 0.1f), 0.1f, Rgb::Constant(8)});
    prepare();
  }

  /// After a change of the transfer.
  void prepare() {
    prepared = prepare_transfer(transfer, RowFormat::float32);
    lights = prepare_lights(rig, prepared, options);
  }

  PrimaryHits trace() const { return trace_primary_rays(SceneRays(transfer), view); }
};

TEST(Render, HitsAndBackgroundAreThoseOfAPlane) {
  const PlaneScene s;
  const Picture picture =
      render(s.subject, s.trace(), s.lighting, s.background, ShadePer::pixel, s.options);
  const PrimaryRays rays = primary_rays(s.view.camera, s.view.width, s.view.height);
  int hits = 0, misses = 0;
  for (int y = 0; y < s.view.height; ++y)
    for (int x = 0; x < s.view.width; ++x) {
      const size_t pixel = static_cast<size_t>(y * s.view.width + x);
      const Vector3f direction = rays.direction(x + 0.5, y + 0.5);
      const Vector3f on_plane = rays.origin - rays.origin.y() / direction.y() * direction;
      const float edge = std::max(std::abs(on_plane.x()), std::abs(on_plane.z()));
      if (std::abs(edge - 1) < 1e-4f) continue;  // rounding decides
      const bool hit = direction.y() < 0 && edge < 1;
      ASSERT_EQ(picture.hit[pixel], hit) << x << "," << y;
      ++(hit ? hits : misses);
      if (hit) continue;
      const Vector3d local =
          (s.background.world_from_environment.transpose() * direction).cast<double>();
      EXPECT_TRUE((picture.radiance.at(x, y) == eval_environment(s.map, local)).all());
    }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 100);
}

TEST(Render, PerPixelIsShadePointAtTheHit) {
  PlaneScene s;
  add_basis(s.transfer, 1);
  s.prepare();
  const Picture picture =
      render(s.subject, s.trace(), s.lighting, s.background, ShadePer::pixel, s.options);
  const PrimaryRays rays = primary_rays(s.view.camera, s.view.width, s.view.height);
  PreparedTransfer alone = s.prepared;  // of which the first vertex becomes the point's own
  for (int y = 0; y < s.view.height; y += 3)
    for (int x = 0; x < s.view.width; x += 3) {
      if (!picture.hit[static_cast<size_t>(y * s.view.width + x)]) continue;
      const Vector3f direction = rays.direction(x + 0.5, y + 0.5);
      ShadingPoint point;
      point.position = rays.origin - rays.origin.y() / direction.y() * direction;
      point.frame = frame_from_normal_tangent<float>(Vector3f::UnitY(), Vector3f::UnitX());
      alone.rows32[0] = 0.3f * point.position.x();  // linear, so interpolation is exact
      const Rgb expected = shade_point(alone, point, -direction,
                                       prepare_material(s.scene.materials[0], s.options.specular),
                                       s.lighting, s.options);
      // Float positions and coefficients, through a lobe whose slope is of order 10.
      EXPECT_LT((picture.radiance.at(x, y) - expected).abs().maxCoeff(),
                1e-4f * (1 + expected.maxCoeff()))
          << x << "," << y;
    }
}

TEST(Render, PerVertexInterpolatesVertexRadiance) {
  PlaneScene s;
  add_basis(s.transfer, 1);
  s.prepare();
  const PrimaryHits hits = s.trace();
  const Picture picture =
      render(s.subject, hits, s.lighting, s.background, ShadePer::vertex, s.options);
  const std::vector<Rgb> radiance =
      shade_all_vertices(s.subject, s.lighting, s.view.camera.origin, s.options);
  ASSERT_EQ(radiance.size(), s.transfer.vertex_count());
  for (size_t pixel = 0; pixel < picture.hit.size(); pixel += 5) {
    if (!picture.hit[pixel]) continue;
    const PrimaryHit& hit = hits.hits[pixel];
    const Triangle& t = s.transfer.triangles[hit.triangle];
    const Rgb expected =
        (1 - hit.u - hit.v) * radiance[t[0]] + hit.u * radiance[t[1]] + hit.v * radiance[t[2]];
    EXPECT_LT((picture.radiance.pixels[pixel] - expected).abs().maxCoeff(),
              1e-5f * (1 + expected.maxCoeff()));
  }
  for (size_t vertex = 0; vertex < radiance.size(); vertex += 97) {
    const Rgb expected = shade_point(
        s.prepared, vertex_shading_point(s.prepared, vertex),
        outgoing_toward(s.view.camera.origin, s.transfer.positions[vertex], Vector3f::UnitY()),
        prepare_material(s.scene.materials[0], s.options.specular), s.lighting, s.options);
    EXPECT_LT((radiance[vertex] - expected).abs().maxCoeff(), 1e-5f * (1 + expected.maxCoeff()));
  }
}

TEST(Render, TrianglesAcrossBasesBlendWhatEachSees) {
  // Two equal bases and equal coefficients: however vertices are assigned, the picture is the same.
  PlaneScene s;
  add_basis(s.transfer, 2);
  std::fill(s.transfer.coefficients.begin(), s.transfer.coefficients.end(), 0.2f);
  s.prepare();
  const PrimaryHits hits = s.trace();
  const Picture one = render(s.subject, hits, s.lighting, s.background, ShadePer::pixel, s.options);
  for (size_t i = 0; i < s.transfer.basis_id.size(); ++i)
    s.transfer.basis_id[i] = static_cast<std::uint8_t>(i % 2);
  s.prepare();
  const Picture two = render(s.subject, hits, s.lighting, s.background, ShadePer::pixel, s.options);
  for (size_t i = 0; i < one.radiance.pixels.size(); ++i)
    EXPECT_LT((one.radiance.pixels[i] - two.radiance.pixels[i]).abs().maxCoeff(),
              1e-5f * (1 + one.radiance.pixels[i].maxCoeff()));  // sums of three weights
}

TEST(Render, APixelIsTheMeanOfItsSamples) {
  PlaneScene s;
  s.view.samples_per_axis = 3;
  const Picture coarse =
      render(s.subject, s.trace(), s.lighting, s.background, ShadePer::pixel, s.options);
  s.view.width *= 3;
  s.view.height *= 3;
  s.view.samples_per_axis = 1;
  const Picture fine =
      render(s.subject, s.trace(), s.lighting, s.background, ShadePer::pixel, s.options);
  size_t partly = 0;
  for (int y = 0; y < coarse.radiance.height; ++y)
    for (int x = 0; x < coarse.radiance.width; ++x) {
      Rgb sum = Rgb::Zero();
      int hits = 0;
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
          sum += fine.radiance.at(3 * x + i, 3 * y + j);
          hits += fine.hit[static_cast<size_t>((3 * y + j) * s.view.width + 3 * x + i)];
        }
      partly += hits > 0 && hits < 9;
      EXPECT_EQ(coarse.hit[static_cast<size_t>(y * coarse.radiance.width + x)], hits == 9);
      // Ray directions of the two grids differ by roundings.
      EXPECT_LT((coarse.radiance.at(x, y) - sum / 9).abs().maxCoeff(),
                1e-4f * (1 + sum.maxCoeff()));
    }
  EXPECT_GT(partly, 10u);
}

TEST(Render, ABackSideIsBlackInEveryPicture) {
  PlaneScene s;
  s.view.camera.origin.y() *= -1;
  const PrimaryHits hits = s.trace();
  const ReferenceLights lights{s.background, {}};
  const SceneRays rays(s.transfer);
  for (const Picture& picture :
       {render(s.subject, hits, s.lighting, s.background, ShadePer::vertex, s.options),
        render(s.subject, hits, s.lighting, s.background, ShadePer::pixel, s.options),
        render_reference(s.subject, rays, hits, lights, {.samples = 8})}) {
    int black = 0;
    for (size_t i = 0; i < picture.hit.size(); ++i) {
      if (!picture.hit[i]) continue;
      EXPECT_EQ(picture.radiance.pixels[i].maxCoeff(), 0);
      ++black;
    }
    EXPECT_GT(black, 100);
  }
}

TEST(Render, OccludersCastShadowsAndAreNotSeen) {
  PlaneScene s;
  TriangleMesh roof;
  append_rectangle(roof, Vector3f(-5, 0.5f, -5), Vector3f(0, 0, 10), Vector3f(10, 0, 0), 1, 1);
  const PrimaryHits open = s.trace();
  s.transfer.occluder_positions = roof.positions;
  s.transfer.occluder_triangles = roof.triangles;
  const PrimaryHits roofed = s.trace();
  ASSERT_EQ(open.hits.size(), roofed.hits.size());
  for (size_t i = 0; i < open.hits.size(); ++i)
    ASSERT_EQ(open.hits[i].triangle, roofed.hits[i].triangle);
  // Under a roof that is ten times as wide as it is high, light comes from near the horizon only:
  // 1 - form factor is below 4 h^2 / w^2 = 0.01 at the middle, below 0.03 at the floor's edge.
  const Image white(8, 4, Rgb::Ones());
  const Material diffuse{.diffuse = Rgb::Ones(), .specular = Rgb::Zero()};
  const Subject subject{&s.transfer, {&diffuse, 1}, {}};
  const Picture picture =
      render_reference(subject, SceneRays(s.transfer), roofed, {{&white}, {}}, {.samples = 256});
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < picture.hit.size(); ++i) {
    if (!picture.hit[i]) continue;
    sum += double(picture.radiance.pixels[i].x());
    ++count;
  }
  ASSERT_GT(count, 100u);
  EXPECT_LT(sum / double(count), 0.03);
}

TEST(RenderReference, FurnaceIsOneWithinItsReportedError) {
  PlaneScene s;
  s.view.samples_per_axis = 2;
  const Image white(8, 4, Rgb::Ones());
  const Material diffuse{.diffuse = Rgb::Ones(), .specular = Rgb::Zero()};
  const Subject subject{&s.transfer, {&diffuse, 1}, {}};
  const Picture picture = render_reference(subject, SceneRays(s.transfer), s.trace(),
                                           {{&white}, {}}, {.samples = 256, .replicates = 16});
  double chi2 = 0, mean = 0, variance = 0;
  size_t count = 0;
  for (size_t i = 0; i < picture.hit.size(); ++i) {
    const double value = double(picture.radiance.pixels[i].x());
    if (!picture.hit[i]) {
      ASSERT_NEAR(value, 1, 0.1);
      continue;
    }
    chi2 += (value - 1) * (value - 1) / double(picture.variance.pixels[i].x());
    mean += value;
    variance += double(picture.variance.pixels[i].x());
    ++count;
  }
  ASSERT_GT(count, 100u);
  EXPECT_NEAR(mean / double(count), 1, 4 * std::sqrt(variance) / double(count));
  // Student's t of 15 degrees has variance 15 / 13; the mean of a few hundred squares lies within
  // 50 % of it.
  EXPECT_NEAR(chi2 / double(count), 15.0 / 13.0, 0.5);
}

TEST(RenderReference, IsTheSameAtAnyNumberOfThreads) {
  const ProceduralScene scene = make_scene("sphere");
  const Transfer transfer = transfer_of(scene.mesh);
  const Subject subject{&transfer, scene.materials, scene.material_id};
  const SceneRays rays(transfer);
  const Image studio = studio_environment(64);
  const SphereLight lamp{Vector3f(1, 3, 1), 0.3f, Rgb::Constant(4)};
  const ReferenceLights lights{{&studio}, {&lamp, 1}};
  const PrimaryHits hits = trace_primary_rays(rays, {scene.camera, 40, 30, 2});
  std::vector<Picture> pictures;
  std::vector<VertexReference> vertices;
  for (const size_t threads : {1u, 4u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    pictures.push_back(render_reference(subject, rays, hits, lights, {.samples = 32}));
    vertices.push_back(
        shade_reference_vertices(subject, rays, scene.camera.origin, lights, {.samples = 8}));
  }
  for (size_t i = 0; i < pictures[0].hit.size(); ++i) {
    ASSERT_TRUE((pictures[0].radiance.pixels[i] == pictures[1].radiance.pixels[i]).all()) << i;
    ASSERT_TRUE((pictures[0].variance.pixels[i] == pictures[1].variance.pixels[i]).all()) << i;
  }
  for (size_t i = 0; i < transfer.vertex_count(); ++i)
    ASSERT_TRUE((vertices[0].radiance[i] == vertices[1].radiance[i]).all()) << i;
}

TEST(RenderReference, StopsWhenAskedTo) {
  const PlaneScene s;
  const Progress stop = [](std::string_view, std::uint64_t, std::uint64_t) { return false; };
  EXPECT_THROW(render_reference(s.subject, SceneRays(s.transfer), s.trace(), {s.background, {}},
                                {.samples = 8}, stop),
               Cancelled);
  std::uint64_t last = 0, total = 0;
  const Progress watch = [&](std::string_view stage, std::uint64_t done, std::uint64_t count) {
    EXPECT_EQ(stage, "reference");
    EXPECT_GE(done, last);
    last = done;
    total = count;
    return true;
  };
  render_reference(s.subject, SceneRays(s.transfer), s.trace(), {s.background, {}}, {.samples = 8},
                   watch);
  EXPECT_EQ(last, total);
  EXPECT_EQ(total, static_cast<std::uint64_t>(s.view.width * s.view.height));
}

TEST(SurfacePoint, OppositeTangentsDoNotCancelAndSilhouettesAreLifted) {
  Transfer transfer;
  transfer.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  transfer.tangents = {{1, 0, 0}, {-1, 0, 0}, {1, 0, 0}};
  transfer.normals.assign(3, Vector3f(-0.8f, 0, 0.6f));
  transfer.triangles = {{0, 1, 2}};
  // From a grazing eye on the +x side: the face is seen from its front, the normals face away.
  const Vector3f eye(3, 0.2f, 1);
  const SurfacePoint point = surface_point(transfer, {0, 0.5f, 0.2f}, eye);
  EXPECT_TRUE(point.front);
  EXPECT_NEAR(std::abs(point.frame.x.dot(Vector3f(0.6f, 0, 0.8f))), 1, 1e-6);
  EXPECT_LT((eye - point.position).dot(point.frame.z), 0);
  const Vector3f outgoing = outgoing_toward(eye, point.position, point.frame.z);
  EXPECT_NEAR(outgoing.norm(), 1, 1e-6);
  EXPECT_GT(outgoing.dot(point.frame.z), 0);
  EXPECT_LT(outgoing.dot(point.frame.z), 0.05);
  // Normals on the other side of the winding decide which side is the front.
  for (Vector3f& normal : transfer.normals) normal = -normal;
  EXPECT_FALSE(surface_point(transfer, {0, 0.5f, 0.2f}, eye).front);
}

}  // namespace
}  // namespace burnish
