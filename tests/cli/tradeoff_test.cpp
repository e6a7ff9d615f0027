// The trade-off sweep and the report, as programs, on a small mesh.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "sample_files.h"

namespace burnish::tools {
namespace {

using nlohmann::json;

class TradeoffProgram : public testing::Test {
 protected:
  TradeoffProgram() {
    test::write_whole_file(folder_.file("box.obj"), test::box_over_floor_obj());
    test::write_small_environment(folder_.file("env.exr"));
    setenv("BURNISH_CACHE", folder_.file("cache").c_str(), 1);
  }
  ~TradeoffProgram() override { unsetenv("BURNISH_CACHE"); }

  test::RunResult sweep(const std::vector<std::string>& more) const {
    return test::burnish_bench(test::joined(test::joined({"tradeoff",   folder_.file("box.obj"),
                                                          "--env",      folder_.file("env.exr"),
                                                          "--out",      folder_.file("out"),
                                                          "--vertices", "20",
                                                          "--views",    "1",
                                                          "--noise",    ".1",
                                                          "--samples",  "64",
                                                          "--frames",   "1",
                                                          "--size",     "24x16",
                                                          "--bases",    "1"},
                                                         test::quick_bake_options()),
                                            more));
  }
  /// Of a station on the same mesh.
  test::RunResult measure(const std::string& station, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = test::joined(
        {station, folder_.file("box.obj"), "--env", folder_.file("env.exr"), "--vertices", "20",
         "--views", "1", "--noise", ".1", "--json", folder_.file("rows.json")},
        {"--directions", "64", "--resolution", "32", "--bases", "1"});
    return test::burnish_bench(test::joined(arguments, more));
  }
  json measured_rows() const {
    return json::parse(test::read_whole_file(folder_.file("rows.json")))["rows"];
  }
  json rows() const {
    return json::parse(test::read_whole_file(folder_.file("out/tradeoff.json")))["rows"];
  }
  const test::ScratchFolder folder_;
};

TEST_F(TradeoffProgram, SweepsResumesAndReports) {
  const test::RunResult first = sweep({"--only", "^(balanced|SG, 1)$"});
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.err, "");
  EXPECT_NE(first.out.find("2 rows, 2 of them new"), std::string::npos) << first.out;
  const json known = rows();
  ASSERT_EQ(known.size(), 2u);
  for (const json& row : known) {
    EXPECT_GT(row["frame_ms"].get<double>(), 0);
    EXPECT_GT(row["absolute_999"].get<double>(), 0);
  }
  // One more; those that are known stay as they are.
  const test::RunResult second = sweep({"--only", "^unshadowed$"});
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_NE(second.out.find("3 rows, 1 of them new"), std::string::npos) << second.out;
  EXPECT_EQ(rows()[0], known[0]);
  EXPECT_EQ(rows()[1], known[1]);
  for (const char* name : {"out/tradeoff.csv", "out/error-time.svg", "out/error-bytes.svg",
                           "out/error-bake.svg", "out/picture-balanced.png"})
    EXPECT_GT(std::filesystem::file_size(folder_.file(name)), 100u) << name;

  const test::RunResult page =
      test::burnish_bench({"report", folder_.file("out"), "-o", folder_.file("r.html")});
  ASSERT_EQ(page.exit_code, 0) << page.err;
  const std::string html = test::read_whole_file(folder_.file("r.html"));
  EXPECT_NE(html.find("data:image/png;base64,iVBOR"), std::string::npos);
  EXPECT_NE(html.find("unshadowed"), std::string::npos);
}

TEST_F(TradeoffProgram, PresetsChoosesAmongWhatItMeasured) {
  const test::RunResult result = measure("presets", {"--frames", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::map<std::string, json> chosen;
  std::vector<json> all;
  for (const json& row : measured_rows()) {
    if (row["what"] == "all")
      all.push_back(row);
    else if (row["what"] != "front")
      chosen[row["what"]] = row;
  }
  EXPECT_EQ(all.size(), 60u);
  ASSERT_EQ(chosen.size(), 3u);
  // A larger budget buys no larger an error, but for the tolerance of 3 %.
  const auto error = [&](const char* name) { return chosen[name]["error"].get<double>(); };
  EXPECT_LE(error("balanced"), 1.03 * error("fast"));
  EXPECT_LE(error("accurate"), 1.03 * error("balanced"));
  for (const auto& entry : chosen) {
    const json& row = entry.second;
    EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const json& other) {
      return other["settings"] == row["settings"] && other["error"] == row["error"];
    })) << entry.first;
  }
}

TEST_F(TradeoffProgram, PromiseTellsWhatHeldAndWhatWasRefused) {
  const test::RunResult result =
      measure("promise", {"--errors", ".6,.0001", "--ms", "10000", "--whole-noise", ".02"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json rows = measured_rows();
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0]["verdict"], "kept");
  EXPECT_GT(rows[0]["whole_standard_error"].get<double>(), 0);
  EXPECT_LE(rows[0]["whole_error"].get<double>(), 0.6);
  EXPECT_EQ(rows[1]["verdict"], "refused");
  EXPECT_GT(rows[1]["expected_error"].get<double>(), 0.0001);
  EXPECT_EQ(rows[2]["verdict"], "kept");
  EXPECT_GT(rows[2]["whole_ms"].get<double>(), 0);
}

TEST_F(TradeoffProgram, RefusesAFolderOfAnotherSweep) {
  ASSERT_EQ(sweep({"--only", "^unshadowed$"}).exit_code, 0);
  const std::string before = test::read_whole_file(folder_.file("out/tradeoff.json"));
  const test::RunResult other = sweep({"--only", "^unshadowed$", "--material", "satin"});
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_TRUE(test::is_one_clean_line(other.err)) << other.err;
  EXPECT_NE(other.err.find("tradeoff.json: found a sweep of box.obj under"), std::string::npos)
      << other.err;
  EXPECT_EQ(test::read_whole_file(folder_.file("out/tradeoff.json")), before);
}

TEST_F(TradeoffProgram, RefusesADamagedSweepByName) {
  std::filesystem::create_directory(folder_.file("out"));
  test::write_whole_file(folder_.file("out/tradeoff.json"), "{\"format\": \"burnish trade");
  const test::RunResult result = sweep({"--only", "^unshadowed$"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(test::is_one_clean_line(result.err)) << result.err;
  EXPECT_NE(result.err.find("out/tradeoff.json: byte "), std::string::npos) << result.err;
}

TEST_F(TradeoffProgram, RefusesWhatItCannotUnderstand) {
  EXPECT_EQ(sweep({"--only", "("}).exit_code, 1);
  EXPECT_EQ(sweep({"--only", "no such row"}).exit_code, 1);
  EXPECT_EQ(sweep({"--material", "unobtainium"}).exit_code, 1);
  EXPECT_EQ(
      test::burnish_bench({"report", folder_.file("none"), "-o", folder_.file("r.html")}).exit_code,
      2);
}

}  // namespace
}  // namespace burnish::tools
