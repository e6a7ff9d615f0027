// What is left behind when something goes wrong: one line, the right exit code, the old file.

#include <csignal>

#include <gtest/gtest.h>

#include "sample_files.h"

namespace burnish::test {
namespace {

/// A bake that no machine finishes within a test's timeout: 80,000 vertices over a ground, with
/// half a million rays each, on one thread.
void write_endless_mesh(const std::string& path) { write_whole_file(path, sphere_obj(200, 400)); }
const std::vector<std::string> kEndlessOptions = {
    "--directions", "1024", "--coarsest", "all", "--ground", "--checks", "off", "--threads", "1"};

void expect_failure(const RunResult& result, int exit_code, const std::string& named) {
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.signal, 0);
  EXPECT_EQ(result.exit_code, exit_code);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  EXPECT_NE(result.err.find(named), std::string::npos) << result.err;
}

TEST(Failure, MissingInputIsExitTwoAndNamesTheFile) {
  const ScratchFolder folder;
  const std::vector<std::vector<std::string>> commands = {
      {"bake", "gone.obj", "-o", "a.h5"},
      {"info", "gone.obj"},
      {"info", "gone.h5"},
      {"info", "gone.exr"},
      {"info", "gone.json"},
      {"fit-light", "gone.exr", "-o", "a.json"},
      {"fit-brdf", "gone.bsdf", "-o", "a.json"},
      {"render", "gone.h5", "--env", "studio", "--png", "a.png"},
      {"shade", "gone.h5", "--env", "studio", "-o", "a.ply"},
  };
  RunOptions options;
  options.folder = folder.path();
  for (const auto& arguments : commands) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const RunResult result = burnish(arguments, options);
    expect_failure(result, 2, "gone.");
    EXPECT_TRUE(result.err.starts_with("burnish " + arguments[0] + ": gone.")) << result.err;
  }
  expect_failure(burnish_bench({"bake", "gone.obj"}, options), 2, "gone.obj");
  EXPECT_TRUE(folder.names().empty());
}

TEST(Failure, MissingLightsOrEnvironmentIsExitTwo) {
  const ScratchFolder folder;
  ASSERT_EQ(make_quick_bake(folder).exit_code, 0);
  const auto before = folder.names();
  expect_failure(burnish({"render", folder.file("box.h5"), "--env", folder.file("gone.exr"),
                          "--png", folder.file("a.png")}),
                 2, "gone.exr");
  expect_failure(burnish({"render", folder.file("box.h5"), "--lights", folder.file("gone.json"),
                          "--png", folder.file("a.png")}),
                 2, "gone.json");
  EXPECT_EQ(folder.names(), before);
}

TEST(Failure, BrokenMeshIsExitTwoAndLeavesTheOldOutput) {
  const ScratchFolder folder;
  write_whole_file(folder.file("broken.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  write_whole_file(folder.file("old.h5"), "old");
  expect_failure(burnish({"bake", folder.file("broken.obj"), "-o", folder.file("old.h5")}), 2,
                 "broken.obj");
  EXPECT_EQ(read_whole_file(folder.file("old.h5")), "old");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"broken.obj", "old.h5"}));
}

TEST(Failure, BrokenTransferIsExitTwo) {
  const ScratchFolder folder;
  write_whole_file(folder.file("broken.h5"), "\x89HDF\r\n\x1a\n and nothing else");
  expect_failure(burnish({"info", folder.file("broken.h5")}), 2, "broken.h5");
  expect_failure(burnish({"render", folder.file("broken.h5"), "--env", "studio", "--png",
                          folder.file("a.png")}),
                 2, "broken.h5");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"broken.h5"});
}

TEST(Failure, UnknownMeshFormatIsExitThree) {
  const ScratchFolder folder;
  write_whole_file(folder.file("mesh.xyz"), "0 0 0\n");
  expect_failure(burnish({"bake", folder.file("mesh.xyz"), "-o", folder.file("a.h5")}), 3,
                 "mesh.xyz");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"mesh.xyz"});
}

TEST(Failure, MeshWithoutTrianglesIsExitTwo) {
  const ScratchFolder folder;
  write_whole_file(folder.file("points.obj"), "v 0 0 0\nv 1 0 0\n");
  expect_failure(burnish({"bake", folder.file("points.obj"), "-o", folder.file("a.h5")}), 2,
                 "points.obj");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"points.obj"});
}

// The bake itself would run into the timeout.
TEST(Failure, UnwritableOutputIsFoundBeforeTheBake) {
  const ScratchFolder folder;
  write_endless_mesh(folder.file("sphere.obj"));
  const std::string mesh = folder.file("sphere.obj");
  const auto bake = [&](const std::vector<std::string>& outputs) {
    return burnish(joined(joined({"bake", mesh}, outputs), kEndlessOptions));
  };
  expect_failure(bake({"-o", folder.file("missing/a.h5")}), 4, "missing/a.h5");
  expect_failure(bake({"-o", folder.file("a.h5"), "--report", folder.file("missing/r.json")}), 4,
                 "missing/r.json");
  std::filesystem::create_directory(folder.file("folder.h5"));
  expect_failure(bake({"-o", folder.file("folder.h5")}), 4, "folder.h5");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"folder.h5", "sphere.obj"}));
}

TEST(Failure, OutputsOfOtherCommandsAreCheckedFirst) {
  const ScratchFolder folder;
  const std::string missing = folder.file("missing/a.");
  // The inputs do not exist either: the output comes first.
  expect_failure(burnish({"fit-light", "gone.exr", "-o", missing + "json"}), 4, missing);
  expect_failure(burnish({"render", "gone.h5", "--env", "studio", "--png", missing + "png"}), 4,
                 missing);
  expect_failure(burnish({"shade", "gone.h5", "--env", "studio", "-o", missing + "ply"}), 4,
                 missing);
  expect_failure(burnish_bench({"bake", "gone.obj", "--csv", missing + "csv"}), 4, missing);
}

TEST(Failure, FullStandardOutputIsExitFour) {
  const ScratchFolder folder;
  write_whole_file(folder.file("box.obj"), box_over_floor_obj());
  const RunResult result = run_program(
      "/bin/sh", {"-c", R"("$0" info "$1" > /dev/full)", BURNISH_PROGRAM, folder.file("box.obj")});
  expect_failure(result, 4, "standard output");
}

/// Sends a signal once the progress bar of the rays shows, i.e. in the middle of the bake.
RunResult interrupt_bake(const ScratchFolder& folder, int signal_number) {
  write_endless_mesh(folder.file("sphere.obj"));
  RunOptions options;
  options.terminal_stderr = true;
  options.send_signal = [=](const RunResult& so_far) {
    return so_far.err.find('%') != std::string::npos ? signal_number : 0;
  };
  return burnish(
      joined({"bake", folder.file("sphere.obj"), "-o", folder.file("old.h5")}, kEndlessOptions),
      options);
}

TEST(Interrupt, LeavesTheOldFileAndNoTemporary) {
  for (const int signal_number : {SIGINT, SIGTERM}) {
    const ScratchFolder folder;
    write_whole_file(folder.file("old.h5"), "old");
    const RunResult result = interrupt_bake(folder, signal_number);
    EXPECT_FALSE(result.timed_out);
    EXPECT_EQ(result.signal, 0);
    EXPECT_EQ(result.exit_code, 128 + signal_number);
    // The bar is erased, then the line; a terminal turns \n into \r\n.
    EXPECT_TRUE(
        result.err.ends_with("\x1b[Kburnish bake: interrupted; the same command with "
                             "--resume goes on\r\n"))
        << result.err;
    EXPECT_EQ(read_whole_file(folder.file("old.h5")), "old");
    EXPECT_EQ(folder.names(), (std::vector<std::string>{"old.h5", "old.h5.journal", "sphere.obj"}));
  }
}

// A signal that is ignored at the start (nohup, a shell's background job) stays ignored.
TEST(Interrupt, IgnoredSignalStaysIgnored) {
  const ScratchFolder folder;
  write_whole_file(folder.file("box.obj"), box_over_floor_obj());
  const RunResult result = run_program(
      "/bin/sh",
      joined({"-c", R"(trap '' INT; "$@" & child=$!
                            while kill -INT $child; do sleep 0.01; done 2>/dev/null
                            wait $child)",
              "sh", BURNISH_PROGRAM, "bake", folder.file("box.obj"), "-o", folder.file("box.h5")},
             quick_bake_options()));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder.file("box.h5")));
}

}  // namespace
}  // namespace burnish::test
