// No change makes pictures worse unseen.

#include "tradeoff/guard.h"

#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "formats/files.h"

namespace burnish::tools {
namespace {

std::string all(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n" + line;
  return text;
}

TEST(Guard, ErrorsAreNoWorseThanThoseWrittenDown) {
  const GuardFile expected = read_guard(BURNISH_TEST_DATA "/guard.csv");
  const std::vector<GuardError> found = measure_guard();
  const GuardVerdict verdict = compare_guard(expected.errors, found);
  EXPECT_TRUE(verdict.worse.empty()) << all(verdict.worse);
  EXPECT_TRUE(verdict.unmatched.empty()) << all(verdict.unmatched);
  EXPECT_TRUE(verdict.better.empty())
      << "so much better that `burnish-bench guard update` is due:" << all(verdict.better);
}

TEST(Guard, TellsWorseFromBetterAndMissing) {
  const std::vector<GuardError> expected = {
      {"a", "fast", 0.1}, {"a", "paper", 0.2}, {"b", "fast", 0.3}, {"c", "fast", 0.1}};
  const GuardVerdict verdict = compare_guard(
      expected,
      {{"a", "fast", 0.1029}, {"a", "paper", 0.207}, {"b", "fast", 0.2}, {"d", "fast", 0}});
  ASSERT_EQ(verdict.worse.size(), 1u);
  EXPECT_NE(verdict.worse[0].find("a, paper: found 0.20700, expected 0.20000"), std::string::npos)
      << verdict.worse[0];
  ASSERT_EQ(verdict.better.size(), 1u);
  EXPECT_EQ(verdict.better[0].rfind("b, fast", 0), 0u) << verdict.better[0];
  EXPECT_EQ(verdict.unmatched.size(), 2u) << all(verdict.unmatched);
  EXPECT_FALSE(verdict.holds());
  EXPECT_TRUE(compare_guard(expected, expected).holds());
  EXPECT_FALSE(compare_guard({{"a", "fast", 0.1}}, {{"a", "fast", std::nan("")}}).holds());
}

TEST(Guard, FileIsReadAsItWasWritten) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("guard.csv");
  write_guard({"by hand", {{"a", "fast", 0.12345}, {"b", "paper, cap", 1}}}, path);
  EXPECT_THROW(read_guard(path), Error);  // a comma in a name
  write_guard({"by hand", {{"a", "fast", 0.12345}, {"b", "paper", 1}}}, path);
  const GuardFile read = read_guard(path);
  EXPECT_EQ(read.origin, "by hand");
  ASSERT_EQ(read.errors.size(), 2u);
  EXPECT_EQ(read.errors[1].settings, "paper");
  EXPECT_NEAR(read.errors[0].relative_l2, 0.12345, 1e-9);
}

TEST(Guard, BadFilesAreRefusedByLine) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("guard.csv");
  const auto message = [&](const std::string& text) -> std::string {
    std::ofstream(path) << text;
    try {
      read_guard(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message("scene,error\n").find("guard.csv: line 1"), std::string::npos);
  EXPECT_NE(message("scene,settings,relative_l2\na,fast,x\n").find("line 2"), std::string::npos);
  EXPECT_NE(message("scene,settings,relative_l2\na,fast\n").find("line 2"), std::string::npos);
  EXPECT_NE(message("").find("is empty"), std::string::npos);
  EXPECT_THROW(read_guard(folder.file("missing.csv")), Error);
}

}  // namespace
}  // namespace burnish::tools
