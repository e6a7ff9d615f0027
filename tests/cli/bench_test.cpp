// The frame of the benchmarks, and its program on a small mesh.

#include "bench/bench.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "bench/sphere_truth.h"
#include "burnish/sphere/batch.h"
#include "sample_files.h"
#include "support/csv.h"

namespace burnish::tools {
namespace {

using nlohmann::json;

TEST(BenchFrame, MedianIsTheMiddleOrTheMeanOfTheMiddleTwo) {
  EXPECT_EQ(summarise({3, 1, 2}).median_s, 2);
  EXPECT_EQ(summarise({4, 1, 3, 2}).median_s, 2.5);
  EXPECT_EQ(summarise({5}).median_s, 5);
  EXPECT_EQ(summarise({3, 1, 2}).min_s, 1);
  EXPECT_EQ(summarise({3, 1, 2}).max_s, 3);
}

TEST(BenchFrame, MeasureRunsWarmUpAndTimedRuns) {
  BenchOptions options;
  options.warmup = 2;
  options.repeat = 3;
  int runs = 0;
  const Timing timing = measure(options, [&] { ++runs; });
  EXPECT_EQ(runs, 5);
  EXPECT_LE(timing.min_s, timing.median_s);
  EXPECT_LE(timing.median_s, timing.max_s);
}

TEST(BenchFrame, TableListsWhatIsTheSameAndAlignsWhatDiffers) {
  const std::vector<BenchRow> rows = {
      {{"name", "a"}, {"scene", "dish"}, {"ms", 1.23456}, {"n", 7}},
      {{"name", "long"}, {"scene", "dish"}, {"ms", 1234.5}, {"more", "x"}}};
  EXPECT_EQ(format_table(rows),
            "scene                     dish\n"
            "\n"
            "name     ms  n  more\n"
            "a     1.235  7      \n"
            "long   1234        x");
  EXPECT_EQ(format_table({rows[0]}),
            "name                      a\n"
            "scene                     dish\n"
            "ms                        1.235\n"
            "n                         7\n");
}

TEST(BenchFrame, WhatIsMeasuredHasATableOfItsOwn) {
  const std::vector<BenchRow> rows = {
      {{"what", "a"}, {"ms", 1}}, {{"what", "b"}, {"rms", 0.5}}, {{"what", "a"}, {"ms", 2}}};
  EXPECT_EQ(format_tables(rows),
            format_table({rows[0], rows[2]}) + "\n\n" + format_table({rows[1]}));
}

TEST(BenchFrame, CsvQuotesAndKeepsAllDigits) {
  const std::vector<BenchRow> rows = {{{"name", "a,b"}, {"value", 0.1}},
                                      {{"name", "say \"x\""}, {"other", 18446744073709551615u}}};
  EXPECT_EQ(format_csv(rows),
            "name,value,other\r\n"
            "\"a,b\",0.1,\r\n"
            "\"say \"\"x\"\"\",,18446744073709551615\r\n");
}

/// A station that measures error and time of a scene, and what it takes.
struct SceneStation {
  std::string name;
  std::vector<std::string> options;
};

class BenchProgram : public testing::TestWithParam<SceneStation> {};

TEST_P(BenchProgram, WritesTheSameFiguresAsTableJsonAndCsv) {
  const test::ScratchFolder folder;
  test::write_whole_file(folder.file("box.obj"), test::box_over_floor_obj());
  const auto& [station, options] = GetParam();
  const test::RunResult result = test::burnish_bench(test::joined(
      {station, folder.file("box.obj"), "--repeat", "3", "--warmup", "1", "--reference", "8",
       "--json", folder.file("b.json"), "--csv", folder.file("b.csv"), "--threads", "1"},
      test::joined(options, test::quick_bake_options())));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_NE(result.out.find("median_ms"), std::string::npos) << result.out;

  const json document = json::parse(test::read_whole_file(folder.file("b.json")));
  EXPECT_EQ(document["station"], station);
  const json& machine = document["machine"];
  for (const char* key : {"cpu", "cores", "isa", "compiler", "commit", "command_line"})
    EXPECT_TRUE(machine.contains(key)) << key;
  EXPECT_EQ(machine["threads"], 1);
  ASSERT_FALSE(document["rows"].empty());
  for (const json& row : document["rows"]) {
    EXPECT_EQ(row["vertices"], 24);
    EXPECT_EQ(row["runs"], 3);
    EXPECT_GT(row["min_ms"].get<double>(), 0);
    EXPECT_LE(row["min_ms"].get<double>(), row["median_ms"].get<double>());
    EXPECT_LE(row["median_ms"].get<double>(), row["max_ms"].get<double>());
    EXPECT_GT(row["relative_l2"].get<double>(), 0);
    EXPECT_EQ(row["compared"], 24);
  }
  const std::string csv = test::read_whole_file(folder.file("b.csv"));
  EXPECT_EQ(static_cast<size_t>(std::count(csv.begin(), csv.end(), '\n')),
            document["rows"].size() + 1);
  EXPECT_NE(csv.find("command_line"), std::string::npos);
  EXPECT_NE(csv.find(document["rows"][0]["median_ms"].dump()), std::string::npos) << csv;
}

INSTANTIATE_TEST_SUITE_P(Stations, BenchProgram,
                         testing::Values(SceneStation{"bake", {}},
                                         SceneStation{"shade", {"--only", "frame"}}),
                         [](const auto& station) { return station.param.name; });

/// The rows of one table of the shade station, of a baked box over a floor.
class ShadeTable : public testing::Test {
 protected:
  void SetUp() override {
    const test::RunResult baked = test::make_quick_bake(folder_);
    ASSERT_EQ(baked.exit_code, 0) << baked.err;
  }
  json rows(const std::string& table) const {
    const test::RunResult result = test::burnish_bench(
        {"shade", "--transfer", folder_.file("box.h5"), "--only", table, "--repeat", "1",
         "--warmup", "0", "--reference", "16", "--json", folder_.file("b.json")});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const json rows = json::parse(test::read_whole_file(folder_.file("b.json")))["rows"];
    EXPECT_FALSE(rows.empty());
    return rows;
  }
  const test::ScratchFolder folder_;
};

TEST_F(ShadeTable, BoundIsTheLargerOfBytesAndMultiplyAdds) {
  int bounds = 0, parts = 0;
  for (const json& row : rows("bound")) {
    EXPECT_GT(row["median_ms"].get<double>(), 0);
    if (row["what"] == "parts") ++parts;
    if (row["what"] != "bound") continue;
    ++bounds;
    const double bytes_ms = row["bytes_ms"], sums_ms = row["multiply_adds_ms"];
    EXPECT_EQ(row["bound_ms"].get<double>(), std::max(bytes_ms, sums_ms));
    // 24 vertices of at least 8 half coefficients, position, normal, tangent, basis and radiance:
    // 1.5 kB; the eigenimages of 32^2 texels, more.
    EXPECT_GT(row["megabytes"].get<double>(), 0.0015);
    EXPECT_GT(row["copy_gb_per_s"].get<double>(), 0);
    EXPECT_GT(row["peak_gmadd_per_s"].get<double>(), 0);
  }
  EXPECT_EQ(bounds, 8);  // four qualities, each with highlights of lobes and of the map
  EXPECT_EQ(parts, 5);
}

TEST_F(ShadeTable, Table1HasTheEightScenesOfThePaper) {
  const int vertices[] = {25000, 54000, 29000, 46000, 25000, 6000, 17000, 16000};
  const json table = rows("table1");
  ASSERT_EQ(table.size(), 16u);
  for (size_t i = 0; i < table.size(); ++i) {
    // The knot comes in whole rings.
    EXPECT_NEAR(table[i]["vertices"].get<double>(), vertices[i / 2], 0.05 * vertices[i / 2]);
    EXPECT_EQ(table[i]["settings"], i % 2 == 0 ? "paper" : "balanced");
    EXPECT_GT(table[i]["fps"].get<double>(), 0);
    EXPECT_GT(table[i]["paper_fps"].get<double>(), 80);
  }
}

TEST_F(ShadeTable, TargetsHasARowForEachInstructionSet) {
  const size_t sets = batch::instruction_sets().size();
  const json table = rows("targets");
  ASSERT_EQ(table.size(), 2 * sets);
  for (size_t i = 0; i < table.size(); ++i) {
    EXPECT_EQ(table[i]["instruction_set"], std::string(batch::instruction_sets()[i % sets]));
    EXPECT_EQ(table[i].contains("over_the_next"), i % sets + 1 < sets);
  }
}

TEST_F(ShadeTable, MemoryIsThatOfTheRows) {
  const json table = rows("memory");
  ASSERT_EQ(table.size(), 4u);
  for (const json& row : table) {
    const int coefficient = row["row"] == "float16" ? 2 : 4;
    const int terms = row["terms"].get<int>() + row["ladder_terms"].get<int>();
    // Position, normal and tangent of three floats, and the basis.
    EXPECT_EQ(row["bytes_per_vertex"], 36 + 1 + coefficient * terms);
    EXPECT_EQ(row["held_per_vertex"], row["bytes_per_vertex"]);
  }
  EXPECT_EQ(table[0]["ladder_terms"], 0);
  EXPECT_GT(table[2]["ladder_terms"], 0);
}

TEST_F(ShadeTable, ShortHasARowForEachShortPath) {
  std::map<std::string, json> by_name;
  for (const json& row : rows("short")) by_name[row["row"].get<std::string>()] = row;
  EXPECT_EQ(by_name.size(), 6u);
  EXPECT_EQ(by_name["unoccluded"]["terms"], 0);
  EXPECT_EQ(by_name["zero lights"]["lobes"], 0);
  EXPECT_EQ(by_name["whole"]["lobes"], 10);
}

TEST_F(ShadeTable, PixelsAndMonteCarloTellWhatTheyCompare) {
  for (const json& row : rows("pixels")) {
    EXPECT_EQ(row["pixels"], 720 * 480);
    EXPECT_GT(row["pixels_met"].get<int>(), 720 * 480 / 10);
    EXPECT_LT(row["pixels_met"].get<int>(), 720 * 480);
  }
  int told = 0;
  for (const json& row : rows("monte-carlo")) {
    EXPECT_GT(row["reference_l2"].get<double>(), 0);
    if (!row.contains("samples_at_equal_error")) continue;  // below the truth's noise
    ++told;
    const double more =
        std::pow(row["reference_l2"].get<double>() / row["relative_l2"].get<double>(), 2);
    const double seconds = row["reference_s"].get<double>() * more;
    EXPECT_NEAR(row["samples_at_equal_error"].get<double>(), 16 * more, 1e-9 * 16 * more);
    EXPECT_NEAR(row["reference_s_at_equal_error"].get<double>(), seconds, 1e-9 * seconds);
  }
  EXPECT_GT(told, 0);
}

TEST(BenchProgram, LightTellsErrorAndTimeOfFitsAndLookups) {
  const test::ScratchFolder folder;
  const test::RunResult result = test::burnish_bench(
      {"light", "--lobes", "2", "--match", "2", "--directions", "4", "--taps", "1,64", "--repeat",
       "1", "--warmup", "0", "--json", folder.file("b.json")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json rows = json::parse(test::read_whole_file(folder.file("b.json")))["rows"];
  std::map<std::string, int> count;
  for (const json& row : rows) {
    EXPECT_EQ(row["map"], "studio");
    ++count[row["what"].get<std::string>()];
    if (row["what"] == "fit") {
      EXPECT_GT(row["relative_l2"].get<double>(), 0);
      EXPECT_LT(row["relative_l2"].get<double>(), 1);
    } else if (row["what"] == "filter") {
      // A lookup of another lobe, or in another frame, is off by the mean and more.
      EXPECT_LT(row["rms"].get<double>(), 0.2) << row;
      EXPECT_LE(row["rms"].get<double>(), row["worst"].get<double>() + 1e-12);
      if (row["anisotropy"] == 16 && row["bandwidth"] >= 16) {
        EXPECT_LT(row["rms_64_taps"], row["rms_1_taps"]) << row;
      }
    }
  }
  EXPECT_EQ(count["fit"], 2);  // ASGs and SGs
  EXPECT_EQ(count["prefilter"], 1);
  EXPECT_EQ(count["filter"], 8 * 4);
}

TEST(BenchProgram, SphereTellsErrorAndTimeOfEveryLevelInBothForms) {
  const test::ScratchFolder folder;
  const test::RunResult result =
      test::burnish_bench({"sphere", "--repeat", "1", "--run-ms", "1", "--json",
                           folder.file("b.json"), "--csv", folder.file("b.csv")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json rows = json::parse(test::read_whole_file(folder.file("b.json")))["rows"];
  std::map<std::string, json> by_name;
  for (const json& row : rows) {
    EXPECT_GT(row["ns"].get<double>(), 0) << row;
    const auto text = [&](const char* key) { return row[key].get<std::string>(); };
    const std::string name = text("operator") + "/" + text("level") + "/" + text("form");
    EXPECT_TRUE(by_name.emplace(name, row).second) << name << " twice";
  }
  // The errors that the headers state for these levels, over a domain that holds the station's.
  const std::pair<const char*, double> stated[] = {{"ASG integral/exact/scalar", 1e-6},
                                                   {"ASG integral/exact/batch", 2e-6},
                                                   {"ASG integral/4 midpoints/scalar", 7.2e-5},
                                                   {"SG in a half-space/fast/scalar", 5e-4},
                                                   {"SG in a half-space/fast/batch", 5e-4},
                                                   {"SG in a half-space/exact/scalar", 1e-6},
                                                   {"ASG in a half-space/directional/scalar", .04}};
  for (const auto& [name, bound] : stated) {
    ASSERT_TRUE(by_name.contains(name)) << name;
    EXPECT_LE(by_name[name]["worst_error"].get<double>(), bound) << name;
    EXPECT_LE(by_name[name]["mean_error"], by_name[name]["worst_error"]) << name;
  }
}

TEST(SphereTruth, MatchesGoldenValues) {
  // Its own statements: 1e-6, and 1e-9.
  for (const auto& row : test::read_golden("asg_halfplane_visibility.csv"))
    EXPECT_NEAR(asg_half_space_fraction(row.at("lambda"), row.at("mu"), row.at("theta_d"),
                                        row.at("boundary_azimuth")),
                row.at("fraction"), 1e-6);
  for (const auto& row : test::read_golden("fh_hemisphere.csv"))
    EXPECT_NEAR(sg_half_space_fraction(row.at("sharpness"), row.at("theta_d")), row.at("fraction"),
                1e-9);
}

}  // namespace
}  // namespace burnish::tools
