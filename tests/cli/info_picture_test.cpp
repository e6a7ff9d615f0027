// What `burnish info` says of a transfer, and its picture, through the real program.

#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/transfer_file.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

TEST(TransferInfo, SaysWhatTheFileHolds) {
  const ScratchFolder folder;
  ASSERT_EQ(make_quick_bake(folder).exit_code, 0);
  Transfer transfer = read_transfer(folder.file("box.h5"));
  const auto vertices = static_cast<std::uint32_t>(transfer.vertex_count());
  const auto triangles = static_cast<std::uint32_t>(transfer.triangles.size());
  transfer.parts = {{"box_and_floor", 0, vertices, 0, triangles}};
  transfer.provenance.coarsest = 64;
  transfer.provenance.residual_held_out = true;
  transfer.provenance.ssdf_errors = {{8, 0.25}, {32, 0.125}};
  const std::string path = folder.file("parts.h5");
  write_transfer(transfer, path);

  const nlohmann::json info = nlohmann::json::parse(burnish({"info", path, "--json"}).out);
  ASSERT_EQ(info["parts"].size(), 1u);
  EXPECT_EQ(info["parts"][0]["name"], "box_and_floor");
  EXPECT_EQ(info["parts"][0]["vertices"], vertices);
  EXPECT_EQ(info["basis_vertices"], nlohmann::json::array({vertices}));
  EXPECT_EQ(info["coarsest"], 64);
  EXPECT_EQ(info["residual_held_out"], true);
  ASSERT_EQ(info["ssdf_errors"].size(), 2u);
  EXPECT_EQ(info["ssdf_errors"][1]["bandwidth"], 32);
  EXPECT_EQ(info["ssdf_errors"][1]["relative_rms"], 0.125);

  const std::string text = burnish({"info", path}).out;
  EXPECT_NE(text.find("name box_and_floor, vertices "), std::string::npos) << text;
  EXPECT_NE(text.find("bandwidth 32, relative rms 0.125\n"), std::string::npos) << text;
}

TEST(InfoPicture, IsDrawnBesideTheText) {
  const ScratchFolder folder;
  ASSERT_EQ(make_quick_bake(folder).exit_code, 0);
  const std::string picture = folder.file("box.png");
  const RunResult plain = burnish({"info", folder.file("box.h5"), "--json"});
  const RunResult drawn = burnish({"info", folder.file("box.h5"), "--json", "--png", picture});
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_EQ(drawn.err, "");
  EXPECT_EQ(drawn.out, plain.out);
  EXPECT_TRUE(read_whole_file(picture).starts_with("\x89PNG\r\n\x1a\n"));
}

TEST(InfoPicture, IsRefusedForOtherFiles) {
  const ScratchFolder folder;
  write_whole_file(folder.file("box.obj"), box_over_floor_obj());
  write_small_environment(folder.file("env.exr"));
  for (const std::string name : {"box.obj", "env.exr"}) {
    const RunResult result =
        burnish({"info", folder.file(name), "--png", folder.file("picture.png")});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
    EXPECT_NE(result.err.find("expected a transfer"), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder.file("picture.png")));
  }
}

TEST(InfoPicture, IsNotLeftInPartWhenItsFolderIsMissing) {
  const ScratchFolder folder;
  ASSERT_EQ(make_quick_bake(folder).exit_code, 0);
  const RunResult result =
      burnish({"info", folder.file("box.h5"), "--png", folder.file("none/box.png")});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
}

}  // namespace
}  // namespace burnish::test
