// Kills, full disks and little memory: a bake loses nothing, and goes on to the same bytes.

#include <chrono>
#include <filesystem>
#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sample_files.h"

// Clang tells by a feature, GCC by a macro.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define BURNISH_ADDRESS_SANITIZER
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define BURNISH_ADDRESS_SANITIZER
#endif

namespace burnish::test {
namespace {

#ifdef BURNISH_ADDRESS_SANITIZER
constexpr bool kAddressSanitizer = true;
#else
constexpr bool kAddressSanitizer = false;
#endif

/// Two blocks of vertices see each other's body: a sphere over a ground.
std::vector<std::string> bake_of(const ScratchFolder& folder, const std::string& output) {
  return {"bake",     folder.file("sphere.obj"),
          "-o",       folder.file(output),
          "--ground", "--directions",
          "64",       "--resolution",
          "32",       "--training-vertices",
          "600",      "--terms",
          "8",        "--ladder-terms",
          "8"};
}

bool holds_work(const ScratchFolder& folder, const std::string& output) {
  return std::filesystem::exists(folder.file(output + ".journal"));
}

TEST(BakeResume, KilledAtRandomMomentsItEndsInTheSameBytes) {
  const unsigned seed = 7;
  SCOPED_TRACE(fmt::format("seed {}", seed));
  std::mt19937 random(seed);
  const ScratchFolder folder;
  write_whole_file(folder.file("sphere.obj"), sphere_obj(40, 80));
  const auto start = std::chrono::steady_clock::now();
  const RunResult whole = burnish(bake_of(folder, "whole.h5"));
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string expected = read_whole_file(folder.file("whole.h5"));

  write_whole_file(folder.file("killed.h5"), "old");
  int kills = 0, finished = 0, resumed = 0;
  while (kills < 10) {
    ASSERT_LT(finished, 100) << "no bake is ever caught";
    const double after = seconds * (0.02 + 0.98 * static_cast<double>(random()) * 0x1p-32);
    std::vector<std::string> command =
        joined({"timeout", "-s", "KILL", fmt::format("{:.4f}", after), BURNISH_PROGRAM},
               bake_of(folder, "killed.h5"));
    if (holds_work(folder, "killed.h5")) {
      command.push_back("--resume");
      ++resumed;
    }
    const RunResult result = run_program("/usr/bin/env", command);
    if (result.exit_code == 0) {
      ++finished;
      ASSERT_EQ(read_whole_file(folder.file("killed.h5")), expected);
      EXPECT_FALSE(holds_work(folder, "killed.h5"));
      write_whole_file(folder.file("killed.h5"), "old");
      continue;
    }
    ++kills;
    ASSERT_EQ(result.err, "") << "it ended by itself";
    // Killed after the file took its name, the bake is done but for its journal.
    const std::string left = read_whole_file(folder.file("killed.h5"));
    ASSERT_TRUE(left == "old" || left == expected);
    write_whole_file(folder.file("killed.h5"), "old");
  }
  EXPECT_GT(resumed, 2);
  std::vector<std::string> last = bake_of(folder, "killed.h5");
  if (holds_work(folder, "killed.h5")) last.push_back("--resume");
  ASSERT_EQ(burnish(last).exit_code, 0);
  EXPECT_EQ(read_whole_file(folder.file("killed.h5")), expected);
}

/// Runs under a `limit` of the shell's ulimit. Files of limited size stand in for a full disk.
RunResult run_limited(const std::string& limit, const std::vector<std::string>& arguments) {
  return run_program(
      "/bin/sh",
      joined({"-c", fmt::format(R"(trap '' XFSZ; ulimit {}; "$0" "$@")", limit), BURNISH_PROGRAM},
             arguments));
}

TEST(BakeResume, AFullDiskLeavesTheOldFileAndWhatIsFinished) {
  const ScratchFolder folder;
  write_whole_file(folder.file("sphere.obj"), sphere_obj(12, 24));
  ASSERT_EQ(burnish(bake_of(folder, "whole.h5")).exit_code, 0);
  write_whole_file(folder.file("full.h5"), "old");
  const RunResult full = run_limited("-f 256", bake_of(folder, "full.h5"));
  EXPECT_EQ(full.exit_code, 4);
  EXPECT_TRUE(is_one_clean_line(full.err)) << full.err;
  EXPECT_NE(full.err.find("full.h5.journal: cannot be written: "), std::string::npos) << full.err;
  EXPECT_EQ(read_whole_file(folder.file("full.h5")), "old");

  // Without a word about it, neither is thrown away.
  const RunResult unasked = burnish(bake_of(folder, "full.h5"));
  EXPECT_EQ(unasked.exit_code, 1);
  EXPECT_NE(unasked.err.find("--resume"), std::string::npos) << unasked.err;
  const RunResult resumed = burnish(joined(bake_of(folder, "full.h5"), {"--resume"}));
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(read_whole_file(folder.file("full.h5")), read_whole_file(folder.file("whole.h5")));
}

TEST(BakeResume, RefusesOtherInputsAndStartsWhereNothingIs) {
  const ScratchFolder folder;
  write_whole_file(folder.file("sphere.obj"), sphere_obj(12, 24));
  const RunResult nothing = burnish(joined(bake_of(folder, "a.h5"), {"--resume"}));
  EXPECT_EQ(nothing.exit_code, 0) << nothing.err;
  EXPECT_NE(nothing.out.find("nothing to resume"), std::string::npos) << nothing.out;
  EXPECT_FALSE(holds_work(folder, "a.h5"));

  ASSERT_EQ(run_limited("-f 256", bake_of(folder, "a.h5")).exit_code, 4);
  const RunResult other =
      burnish(joined(bake_of(folder, "a.h5"), {"--resume", "--coarsest", "32"}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_NE(other.err.find("coarsest level: found 64, expected 32"), std::string::npos)
      << other.err;
  EXPECT_TRUE(holds_work(folder, "a.h5"));
  EXPECT_EQ(burnish(joined(bake_of(folder, "a.h5"), {"--restart", "--coarsest", "32"})).exit_code,
            0);
}

TEST(BakeMemory, IsBoundedByTheTrainingSet) {
  if (kAddressSanitizer)
    GTEST_SKIP() << "AddressSanitizer holds far more memory than the program asks for";
  const ScratchFolder folder;
  write_whole_file(folder.file("sphere.obj"), sphere_obj(80, 120));
  // The SSDFs of all 13,700 vertices would be 900 MB, those of the training set are 17 MB.
  const RunResult result = run_limited(
      "-v 700000", {"bake", folder.file("sphere.obj"), "-o", folder.file("a.h5"), "--ground",
                    "--directions", "128", "--resolution", "128", "--training-vertices", "256",
                    "--threads", "2", "--report", folder.file("a.json")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto report = nlohmann::json::parse(read_whole_file(folder.file("a.json")));
  EXPECT_GT(report["bake"]["vertices"], 13000);
  EXPECT_LT(report["peak_memory_bytes"], 300e6);
}

}  // namespace
}  // namespace burnish::test
