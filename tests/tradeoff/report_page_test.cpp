#include "tradeoff/report_page.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "tradeoff/well_formed.h"

namespace burnish::tools {
namespace {

namespace fs = std::filesystem;

const std::string kPng = std::string("\x89PNG\r\n\x1a\n", 8) + "rest";

/// A folder of results.
class ReportFolder : public testing::Test {
 protected:
  ReportFolder()
      : folder_(fs::path(testing::TempDir()) /
                (std::string("report-") +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ReportFolder() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  std::string complaint() const {
    try {
      read_report({folder_.string()});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  const fs::path folder_;
};

Sweep some_sweep() {
  Sweep sweep;
  sweep.scene = "dish <&> \"balls\"";
  sweep.environment = "studio";
  sweep.vertices = 24;
  sweep.machine = {{"cpu", "some"}, {"threads", 2}, {"command_line", "burnish-bench tradeoff"}};
  for (int i = 0; i < 4; ++i) {
    SweepRow row;
    row.key = std::to_string(i);
    row.name = i == 0 ? "balanced" : "row " + std::to_string(i);
    row.kind = i == 0 ? RowKind::preset : RowKind::grid;
    row.settings = nlohmann::ordered_json::object();
    row.frame_ms = 1 + i;
    row.memory_bytes = 1e6;
    row.bake_s = 1;
    row.relative_l2 = .1 / (1 + i);
    row.truth_noise = .004;
    sweep.rows.push_back(row);
  }
  sweep.pictures = {{{"file", "picture-balanced.png"}, {"name", "balanced"}, {"flip", 0.0123}}};
  return sweep;
}

TEST(Base64, IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(ParseCsv, ReadsQuotesLineEndsAndEmptyCells) {
  using Rows = std::vector<std::vector<std::string>>;
  EXPECT_EQ(parse_csv("x.csv", "a,b\r\n\"1,\"\"2\"\"\n3\",\r\n").rows,
            (Rows{{"a", "b"}, {"1,\"2\"\n3", ""}}));
  EXPECT_EQ(parse_csv("x.csv", "a\nb").rows, (Rows{{"a"}, {"b"}}));
  EXPECT_EQ(parse_csv("x.csv", "").rows, Rows{});
  try {
    parse_csv("x.csv", "a\n\"b\nc");
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "x.csv: line 2: found a quote that is not closed, expected CSV");
  }
}

TEST_F(ReportFolder, OfASweepIsOnePageThatNeedsNothingElse) {
  write("tradeoff.json", sweep_json(some_sweep()).dump());
  write("picture-balanced.png", kPng);
  Report report = read_report({folder_.string()});
  report.machine = {{"commit", "abc"}};
  const std::string page = report_page(report);
  EXPECT_EQ(test::xml_fault(page), "");
  EXPECT_NE(page.find("data:image/png;base64," + base64(kPng)), std::string::npos);
  EXPECT_NE(page.find("FLIP 0.0123"), std::string::npos);
  EXPECT_NE(page.find("burnish-bench tradeoff"), std::string::npos);
  EXPECT_NE(page.find("commit abc"), std::string::npos);
  EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
  size_t plots = 0;
  for (size_t at = 0; (at = page.find("<svg", at)) != std::string::npos; ++at) ++plots;
  EXPECT_EQ(plots, 3u);
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
}

TEST_F(ReportFolder, OfFiguresHasTheirTablesPicturesAndText) {
  write("fig1.csv", "lobes,error\r\n1,<5 %\r\n");
  write("fig1-truth.png", kPng);
  write("fig10.png", kPng);
  write("reproduction.md", "# What & why");
  const Report report = read_report({folder_.string()});
  ASSERT_EQ(report.figures.size(), 2u);
  EXPECT_EQ(report.figures[0].name, "fig1");
  EXPECT_EQ(report.figures[0].pictures.size(), 1u);  // not fig10's
  EXPECT_EQ(report.figures[1].name, "fig10");
  const std::string page = report_page(report);
  EXPECT_EQ(test::xml_fault(page), "");
  EXPECT_NE(page.find("<td>&lt;5 %</td>"), std::string::npos);
  EXPECT_NE(page.find("# What &amp; why"), std::string::npos);
}

TEST_F(ReportFolder, WithoutResultsIsRefused) {
  EXPECT_EQ(complaint(), folder_.string() +
                             ": found no results, expected tradeoff.json, or figures as .csv and "
                             ".png");
  write("fig1.png", "no picture");
  EXPECT_NE(complaint().find("fig1.png: found no PNG signature"), std::string::npos);
}

TEST_F(ReportFolder, APictureOutsideOfItIsRefused) {
  Sweep sweep = some_sweep();
  sweep.pictures[0]["file"] = "../secret.png";
  write("tradeoff.json", sweep_json(sweep).dump());
  EXPECT_NE(complaint().find("tradeoff.json: pictures: found one without"), std::string::npos);
}

}  // namespace
}  // namespace burnish::tools
