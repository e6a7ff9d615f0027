// Frames of a turn, as numbered pictures and through a stand-in for the program ffmpeg.

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/texture_file.h"
#include "sample_files.h"

namespace burnish::test {
namespace {

namespace fs = std::filesystem;

/// Arguments go to words, one a line, the input to input.rgb, and the output gets some bytes.
constexpr const char* kRecorder = R"(#!/bin/sh
PATH=/usr/bin:/bin
here=$(dirname "$0")
printf '%s\n' "$@" > "$here/words"
cat > "$here/input.rgb"
for last; do :; done
printf animation > "${last#file:}"
)";

class Animation : public testing::Test {
 protected:
  void SetUp() override {
    const RunResult baked = make_quick_bake(folder_);
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
    const RunResult fitted = burnish(
        {"fit-light", folder_.file("env.exr"), "-o", folder_.file("lights.json"), "--lobes", "4"});
    ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
    fs::create_directory(folder_.file("bin"));
    fs::create_directory(folder_.file("out"));
  }

  /// What `burnish` finds on PATH: nothing but this script.
  void install_ffmpeg(const std::string& script) {
    const std::string path = folder_.file("bin/ffmpeg");
    write_whole_file(path, script);
    fs::permissions(path, fs::perms::owner_all);
  }

  RunResult render(const std::vector<std::string>& arguments, RunOptions options = {}) {
    const std::vector<std::string> command = {"PATH=" + folder_.file("bin"),
                                              BURNISH_PROGRAM,
                                              "render",
                                              folder_.file("box.h5"),
                                              "--env",
                                              folder_.file("env.exr"),
                                              "--lights",
                                              folder_.file("lights.json"),
                                              "--size",
                                              "49x32"};
    return run_program("/usr/bin/env", joined(command, arguments), options);
  }

  void expect_success(const std::vector<std::string>& arguments) {
    const RunResult result = render(arguments);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(arguments);
    EXPECT_EQ(result.err, "");
  }

  void expect_failure(const RunResult& result, int exit_code, const std::string& named) {
    EXPECT_FALSE(result.timed_out);
    EXPECT_EQ(result.exit_code, exit_code);
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
    EXPECT_NE(result.err.find(named), std::string::npos) << result.err;
  }

  std::string out(const std::string& name) const { return folder_.file("out/" + name); }
  std::vector<std::string> outputs() const {
    std::vector<std::string> names;
    for (const std::string& name : folder_.names())
      if (name.starts_with("out/")) names.push_back(name.substr(4));
    return names;
  }

  const ScratchFolder folder_;
};

TEST_F(Animation, StartsAtTheStillPictureToTheBitAndNumbersItsFrames) {
  for (const std::string turn : {"eye", "light", "both"}) {
    SCOPED_TRACE(turn);
    expect_success({"-o", out("still.exr"), "--png", out("still.png")});
    expect_success(
        {"--frames", "3", "--turn", turn, "-o", out("turn.exr"), "--png", out("turn.png")});
    EXPECT_EQ(outputs(), (std::vector<std::string>{
                             "still.exr", "still.png", "turn-0000.exr", "turn-0000.png",
                             "turn-0001.exr", "turn-0001.png", "turn-0002.exr", "turn-0002.png"}));
    for (const std::string extension : {".exr", ".png"}) {
      const std::string still = read_whole_file(out("still" + extension));
      EXPECT_TRUE(read_whole_file(out("turn-0000" + extension)) == still);
      for (const std::string name : {"turn-0001", "turn-0002"})
        EXPECT_FALSE(read_whole_file(out(name + extension)) == still) << name;
    }
  }
}

// Eye and environment turn together: the corner of the picture, which misses the mesh, stays.
TEST_F(Animation, TurningBothKeepsTheBackground) {
  Image sky(64, 32);
  for (int y = 0; y < sky.height; ++y)
    for (int x = 0; x < sky.width; ++x)
      sky.at(x, y) = Rgb::Constant(1 + 0.5f * std::sin(2 * kPi<float> * float(x) / 64));
  write_exr(sky, folder_.file("env.exr"), ExrPixelType::single_float, true);
  const auto corners = [&](const std::string& turn) {
    expect_success(
        {"--frames", "3", "--turn", turn, "-o", out("turn.exr"), "--camera", "0,1,9,0,0,0,40"});
    std::vector<Rgb> found;
    for (const char* name : {"turn-0000.exr", "turn-0001.exr", "turn-0002.exr"})
      found.push_back(read_image(out(name)).at(0, 0));
    return found;
  };
  const std::vector<Rgb> both = corners("both"), eye = corners("eye");
  // Halves are of 5e-4; a turn is rounded to less.
  for (const Rgb& color : both)
    EXPECT_LT((color - both[0]).abs().maxCoeff(), 2e-3 * both[0].maxCoeff());
  EXPECT_GT((eye[1] - eye[0]).abs().maxCoeff() + (eye[2] - eye[0]).abs().maxCoeff(),
            0.1 * eye[0].maxCoeff());
}

TEST_F(Animation, FfmpegReadsTheFramesOfThePngPictures) {
  install_ffmpeg(kRecorder);
  expect_success({"--frames", "3", "-o", out("turn.gif"), "--png", out("turn.png")});
  EXPECT_EQ(read_whole_file(out("turn.gif")), "animation");
  std::string expected;
  for (const char* name : {"turn-0000.png", "turn-0001.png", "turn-0002.png"}) {
    const std::vector<unsigned char> bytes =
        srgb_bytes(read_texture(out(name), TextureContent::color));
    expected.append(bytes.begin(), bytes.end());
  }
  EXPECT_EQ(expected.size(), 3u * 49 * 32 * 3);
  EXPECT_TRUE(read_whole_file(folder_.file("bin/input.rgb")) == expected);
}

TEST_F(Animation, FfmpegIsToldSizeRateAndKind) {
  install_ffmpeg(kRecorder);
  const auto words = [&](const std::string& name) {
    expect_success({"--frames", "2", "-o", out(name)});
    return "\n" + read_whole_file(folder_.file("bin/words"));
  };
  const std::string gif = words("a b;$(touch c).gif");  // no shell reads the name
  for (const char* part : {"\nrawvideo\n", "\nrgb24\n", "\n49x32\n", "\n25\n", "\n-f\ngif\n"})
    EXPECT_NE(gif.find(part), std::string::npos) << gif;
  const std::string mp4 = words("turn.MP4");
  for (const char* part : {"\n49x32\n", "\nlibx264\n", "\nyuv420p\n", "\n-f\nmp4\n"})
    EXPECT_NE(mp4.find(part), std::string::npos) << mp4;
  EXPECT_EQ(outputs(), (std::vector<std::string>{"a b;$(touch c).gif", "turn.MP4"}));
}

TEST_F(Animation, MissingFfmpegIsExitThreeAndNamesTheWayOut) {
  write_whole_file(out("turn.mp4"), "old");
  const RunResult result = render({"--frames", "2", "-o", out("turn.mp4")});
  expect_failure(result, 3, "ffmpeg");
  EXPECT_NE(result.err.find("-o FILE.png"), std::string::npos) << result.err;
  EXPECT_EQ(outputs(), std::vector<std::string>{"turn.mp4"});
  EXPECT_EQ(read_whole_file(out("turn.mp4")), "old");
}

TEST_F(Animation, FailingFfmpegIsExitFourAndLeavesTheOldFiles) {
  write_whole_file(out("turn.gif"), "old");
  write_whole_file(out("turn-0000.png"), "old");
  const std::vector<std::pair<std::string, std::string>> scripts = {
      {"#!/bin/sh\necho first >&2\necho no such codec >&2\nexit 1\n", "no such codec"},
      {"#!/bin/sh\n/bin/cat > /dev/null\nexit 3\n", "code 3"},
      {"#!/bin/sh\n/bin/cat > /dev/null\nkill -9 $$\n", "signal 9"},
      {"#!/bin/sh\nexec /bin/cat > /dev/null\n", "wrote nothing"}};
  for (const auto& [script, named] : scripts) {
    install_ffmpeg(script);
    // More than a pipe holds, so that a child that has ended shows in the middle, too.
    expect_failure(render({"--frames", "40", "-o", out("turn.gif"), "--png", out("turn.png")}), 4,
                   named);
    EXPECT_EQ(outputs(), (std::vector<std::string>{"turn-0000.png", "turn.gif"}));
    EXPECT_EQ(read_whole_file(out("turn.gif")), "old");
    EXPECT_EQ(read_whole_file(out("turn-0000.png")), "old");
  }
}

// An ffmpeg that reads nothing and never ends; and frames that never end.
TEST_F(Animation, CtrlCLeavesTheOldFilesAndNoTemporary) {
  install_ffmpeg("#!/bin/sh\nexec /bin/sleep 3600\n");
  write_whole_file(out("turn.mp4"), "old");
  write_whole_file(out("turn-0001.exr"), "old");
  for (const std::string name : {"turn.mp4", "turn.exr"}) {
    RunOptions options;
    options.send_signal = [](const RunResult& so_far) {
      return so_far.out.find("primary rays") != std::string::npos ? SIGINT : 0;
    };
    const RunResult result = render({"--frames", "10000", "-o", out(name)}, options);
    expect_failure(result, 128 + SIGINT, "");
    EXPECT_EQ(outputs(), (std::vector<std::string>{"turn-0001.exr", "turn.mp4"}));
    EXPECT_EQ(read_whole_file(out("turn.mp4")), "old");
    EXPECT_EQ(read_whole_file(out("turn-0001.exr")), "old");
  }
}

TEST_F(Animation, RefusesWhatMakesNoSense) {
  const std::vector<std::vector<std::string>> refused = {
      {"-o", out("turn.gif")},                                       // no --frames
      {"-o", out("turn.avi"), "--frames", "2"},                      // unknown kind
      {"-o", out("turn.png"), "--frames", "2", "--reference", "4"},  // either of them
      {"-o", out("turn.png"), "--frames", "2", "--png", out("turn.png")},
      {"-o", out("turn.png"), "--turn", "eye"}};  // no --frames
  for (const auto& options : refused) {
    const RunResult result = render(options);
    EXPECT_EQ(result.exit_code, 1) << testing::PrintToString(options);
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  }
  EXPECT_TRUE(outputs().empty());
}

}  // namespace
}  // namespace burnish::test
