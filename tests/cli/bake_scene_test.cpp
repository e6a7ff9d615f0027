// Scenes of several meshes, and what the bake says and does about their vertices.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/transfer_file.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

using nlohmann::json;

class BakeScene : public testing::Test {
 protected:
  void SetUp() override {
    write_whole_file(folder_.file("sphere.obj"), sphere_obj(8, 12));
    write_whole_file(folder_.file("box.obj"), box_over_floor_obj());
  }

  /// Bakes, and reads the report.
  json bake(const std::vector<std::string>& inputs, const std::vector<std::string>& options = {}) {
    const RunResult result =
        burnish(joined(joined(joined({"bake"}, inputs), {"-o", folder_.file("out.h5"), "--report",
                                                         folder_.file("out.json"), "--quiet"}),
                       joined(quick_bake_options(), options)));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return json::parse(read_whole_file(folder_.file("out.json")));
  }

  Transfer transfer() const { return read_transfer(folder_.file("out.h5")); }

  const ScratchFolder folder_;
};

TEST_F(BakeScene, SeveralMeshesBecomePartsOfOneTransfer) {
  bake({folder_.file("sphere.obj"), folder_.file("box.obj")}, {"--ground"});
  const Transfer baked = transfer();
  ASSERT_EQ(baked.parts.size(), 3u);
  EXPECT_EQ(baked.parts[0].name, "sphere.obj");
  EXPECT_EQ(baked.parts[0].vertices, 86u);
  EXPECT_EQ(baked.parts[1].name, "box.obj");
  EXPECT_EQ(baked.parts[1].first_vertex, 86u);
  EXPECT_EQ(baked.parts[1].vertices, 24u);
  EXPECT_EQ(baked.parts[2].first_vertex, 110u);
  EXPECT_EQ(baked.parts[2].first_vertex + baked.parts[2].vertices, baked.vertex_count());
  // The ground sees what stands on it, and nothing above it does not: the file has coefficients.
  EXPECT_FALSE(baked.bases.empty());
}

TEST_F(BakeScene, ASceneFilePlacesItsMeshes) {
  write_whole_file(folder_.file("two.scene.json"), R"({
    "format": "burnish scene", "format_version": 1,
    "meshes": [
      {"file": "sphere.obj", "instances": [{}, {"name": "small", "translation": [3, 0, 0],
                                                 "scale": 0.5}]},
      {"file": "box.obj", "role": "occluder"}
    ]})");
  bake({folder_.file("two.scene.json")});
  const Transfer baked = transfer();
  ASSERT_EQ(baked.parts.size(), 2u);
  EXPECT_EQ(baked.parts[1].name, "small");
  EXPECT_EQ(baked.vertex_count(), 172u);
  EXPECT_EQ(baked.occluder_triangles.size(), 30u);
  for (std::size_t v = 86; v < 172; ++v)
    EXPECT_NEAR((baked.positions[v] - Vector3f(3, 0, 0)).norm(), 0.5, 1e-5);
}

TEST_F(BakeScene, ASphereAloneStoresNothing) {
  const json report = bake({folder_.file("sphere.obj")});
  EXPECT_EQ(report["bake"]["bases"], 0);
  EXPECT_EQ(report["bake"]["rays"], 0);
  EXPECT_TRUE(transfer().coefficients.empty());
}

TEST_F(BakeScene, LongEdgesAreHalved) {
  bake({folder_.file("box.obj")}, {"--max-edge", "0.3"});
  const Transfer baked = transfer();
  EXPECT_GT(baked.vertex_count(), 100u);
  for (const Triangle& t : baked.triangles)
    for (int i = 0; i < 3; ++i)
      EXPECT_LE((baked.positions[t[static_cast<std::size_t>(i)]] -
                 baked.positions[t[static_cast<std::size_t>((i + 1) % 3)]])
                    .norm(),
                0.3f * 1.0001f);
}

TEST_F(BakeScene, RefinementAddsVerticesWhereVisibilityChanges) {
  const json plain = bake({folder_.file("box.obj")});
  EXPECT_GT(plain["checks"]["uneven_triangles"], 0);
  const json refined = bake({folder_.file("box.obj")}, {"--refine-error", "0.1"});
  EXPECT_GT(refined["refine_error"]["added_vertices"], 20);
  EXPECT_LT(refined["checks"]["uneven_area"], 0.5 * plain["checks"]["uneven_area"].get<double>());
}

// The small sphere is wholly within the unit sphere.
TEST_F(BakeScene, VerticesInsideOtherGeometryAreCounted) {
  write_whole_file(folder_.file("in.scene.json"), R"({
    "format": "burnish scene", "format_version": 1,
    "meshes": [{"file": "sphere.obj", "instances": [{}, {"scale": 0.3}]}]})");
  const json report = bake({folder_.file("in.scene.json")});
  EXPECT_EQ(report["checks"]["inside_vertices"], 86);
}

TEST_F(BakeScene, VerificationCastsAllRays) {
  const json report = bake({folder_.file("box.obj")}, {"--verify", "24"});
  EXPECT_EQ(report["verification"]["vertices"], 24);
  EXPECT_EQ(report["verification"]["directions"], 24 * 64 * 64);
  // Of so few directions every one is cast.
  EXPECT_EQ(report["verification"]["differing"], 0);
  const json coarse = bake({folder_.file("box.obj")}, {"--verify", "24", "--coarsest", "16"});
  EXPECT_EQ(coarse["verification"]["directions"], 24 * 64 * 64);
  EXPECT_LT(coarse["bake"]["rays"], report["bake"]["rays"]);
}

TEST_F(BakeScene, ATargetErrorIsMetWithFewerTerms) {
  const json full = bake({folder_.file("box.obj"), folder_.file("sphere.obj")}, {"--ground"});
  const double error = full["bake"]["ssdf_errors"][2]["relative_rms"];
  EXPECT_EQ(full["bake"]["ssdf_errors"][2]["bandwidth"], 128);
  const json cheap =
      bake({folder_.file("box.obj"), folder_.file("sphere.obj")},
           {"--ground", "--target-error", fmt::format("{}", std::min(1.0, 1.5 * error))});
  EXPECT_LT(cheap["bake"]["terms"], full["bake"]["terms"]);
  EXPECT_LE(cheap["bake"]["ssdf_errors"][2]["relative_rms"].get<double>(), 1.5 * error);
}

TEST_F(BakeScene, ContradictionsAreRefused) {
  write_whole_file(folder_.file("a.scene.json"), "{}");
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{
           {folder_.file("a.scene.json"), folder_.file("box.obj")},
           {folder_.file("box.obj"), "--resume", "--restart"}}) {
    const RunResult result =
        burnish(joined(joined({"bake"}, options), {"-o", folder_.file("x.h5")}));
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  }
}

}  // namespace
}  // namespace burnish::test
