#include "tradeoff/sweep.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/progress.h"
#include "tradeoff/trades.h"

namespace burnish::tools {
namespace {

/// Entries whose figures are their number; `runs` counts what was measured.
std::vector<SweepEntry> some_entries(int count, int& runs, int stop_at = -1) {
  std::vector<SweepEntry> entries;
  for (int i = 0; i < count; ++i) {
    SweepEntry entry;
    entry.row.key = sweep_key({"scene", std::to_string(i)});
    entry.row.name = "row " + std::to_string(i);
    entry.row.settings = settings_json({});
    entry.measure = [i, &runs, stop_at] {
      if (i == stop_at) throw Cancelled();
      ++runs;
      SweepRow row;
      row.frame_ms = i + 0.1;
      row.memory_bytes = 1000.0 * (i + 1);
      row.bake_s = 1.0 / 3;
      row.relative_l2 = 1.0 / (i + 7);
      row.truth_noise = 1e-3;
      row.below_noise = i == 2;
      return row;
    };
    entries.push_back(std::move(entry));
  }
  return entries;
}

Sweep some_sweep(std::vector<SweepRow> rows) {
  Sweep sweep;
  sweep.scene = "dish";
  sweep.environment = "studio";
  sweep.scene_key = "vertices-0";
  sweep.vertices = 24;
  sweep.machine = {{"cpu", "some"}, {"commit", "none"}};
  sweep.rows = std::move(rows);
  return sweep;
}

std::string text_of(const std::vector<SweepRow>& rows) {
  return sweep_json(some_sweep(rows)).dump();
}

class SweepFile : public testing::Test {
 protected:
  SweepFile()
      : path_(testing::TempDir() + "sweep-" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + ".json") {}
  ~SweepFile() override { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_, std::ios::binary) << text; }
  /// What reading the file complains of.
  std::string complaint() const {
    try {
      read_sweep(path_);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      return error.what();
    }
    return "";
  }
  const std::string path_;
};

TEST_F(SweepFile, ReadsBackWhatWasWritten) {
  int runs = 0;
  const std::string text = text_of(run_sweep(some_entries(3, runs), {}, [](const auto&) {}));
  write(text);
  EXPECT_EQ(sweep_json(read_sweep(path_)).dump(), text);
}

TEST_F(SweepFile, AnInterruptedSweepGoesOnToTheSameRows) {
  int runs = 0;
  const std::vector<SweepRow> whole = run_sweep(some_entries(6, runs), {}, [](const auto&) {});
  EXPECT_EQ(runs, 6);
  runs = 0;
  const auto save = [&](const std::vector<SweepRow>& rows) { write(text_of(rows)); };
  EXPECT_THROW(run_sweep(some_entries(6, runs, 4), {}, save), Cancelled);
  EXPECT_EQ(runs, 4);
  const std::vector<SweepRow> known = read_sweep(path_).rows;
  EXPECT_EQ(known.size(), 4u);
  const std::vector<SweepRow> resumed = run_sweep(some_entries(6, runs), known, save);
  EXPECT_EQ(runs, 6);  // two more, none twice
  EXPECT_EQ(text_of(resumed), text_of(whole));
  run_sweep(some_entries(6, runs), read_sweep(path_).rows, save);
  EXPECT_EQ(runs, 6);
}

TEST_F(SweepFile, IsRefusedByNameWhereverItIsCut) {
  int runs = 0;
  const std::string text = text_of(run_sweep(some_entries(2, runs), {}, [](const auto&) {}));
  for (size_t size = 0; size < text.size(); size += 7) {
    write(text.substr(0, size));
    EXPECT_NE(complaint().find(path_), std::string::npos) << size;
  }
}

TEST_F(SweepFile, IsRefusedByFieldWithWhatWasFoundAndExpected) {
  int runs = 0;
  const nlohmann::ordered_json good =
      sweep_json(some_sweep(run_sweep(some_entries(2, runs), {}, [](const auto&) {})));
  const auto complaint_of = [&](const char* pointer, const nlohmann::ordered_json& value) {
    nlohmann::ordered_json bad = good;
    bad[nlohmann::ordered_json::json_pointer(pointer)] = value;
    write(bad.dump());
    return complaint();
  };
  EXPECT_EQ(complaint_of("/format", "else"),
            path_ + ": format: found \"else\", expected \"burnish tradeoff\"");
  EXPECT_EQ(complaint_of("/format_version", 2), path_ + ": format_version: found 2.0, expected 1");
  EXPECT_EQ(complaint_of("/rows/1/frame_ms", "x"),
            path_ + ": rows[1].frame_ms: found \"x\", expected a number >= 0");
  EXPECT_EQ(complaint_of("/rows/0/bake_s", -1),
            path_ + ": rows[0].bake_s: found -1, expected a number >= 0");
  EXPECT_EQ(complaint_of("/rows/0/kind", "odd"),
            path_ + ": rows[0].kind: found \"odd\", expected one of grid, preset, paper, rival");
  EXPECT_EQ(complaint_of("/rows/0/settings", 3),
            path_ + ": rows[0].settings: found 3, expected an object");
  EXPECT_EQ(complaint_of("/rows", "none"), path_ + ": rows: found \"none\", expected an array");
  nlohmann::ordered_json bad = good;
  bad["rows"][0].erase("name");
  write(bad.dump());
  EXPECT_EQ(complaint(), path_ + ": rows[0].name: found nothing");
}

TEST(RunSweep, MeasuresEqualEntriesOnce) {
  int runs = 0;
  std::vector<SweepEntry> entries = some_entries(3, runs);
  entries[2].row.key = entries[0].row.key;
  EXPECT_EQ(run_sweep(entries, {}, [](const auto&) {}).size(), 2u);
  EXPECT_EQ(runs, 2);
}

TEST(RunSweep, KeepsKnownRowsThatAreNotAskedFor) {
  int runs = 0;
  std::vector<SweepEntry> entries = some_entries(4, runs);
  const std::vector<SweepRow> known = run_sweep(entries, {}, [](const auto&) {});
  entries[1].measure = nullptr;
  const std::vector<SweepRow> some = {known[1], known[2]};
  size_t saved = 0;
  const auto rows = run_sweep(entries, some, [&](const auto& so_far) { saved = so_far.size(); });
  EXPECT_EQ(runs, 6);
  EXPECT_EQ(rows.size(), 4u);
  EXPECT_EQ(saved, 4u);
  EXPECT_EQ(run_sweep({entries[1]}, {}, [](const auto&) {}).size(), 0u);
}

TEST(SweepKey, DependsOnEveryPart) {
  EXPECT_NE(sweep_key({"a", "b"}), sweep_key({"a", "c"}));
  EXPECT_NE(sweep_key({"a", "b"}), sweep_key({"ab", ""}));
  EXPECT_EQ(sweep_key({"a", "b"}), sweep_key({"a", "b"}));
}

/// Rows of a name, kind, time and error.
Sweep made_up_sweep() {
  Sweep sweep = some_sweep({});
  const auto add = [&](const char* name, RowKind kind, double ms, double error) {
    SweepRow row;
    row.name = name;
    row.kind = kind;
    row.frame_ms = ms;
    row.relative_l2 = error;
    row.truth_noise = 0.004;
    sweep.rows.push_back(row);
  };
  add("cheap", RowKind::grid, 1, .3);
  add("fast", RowKind::preset, 2, .1);
  add("balanced", RowKind::preset, 4, .2);
  add("accurate", RowKind::preset, 2.05, .099);
  add("paper", RowKind::paper, 2, .4);
  add("quick rival", RowKind::rival, .5, .5);
  add("poor rival", RowKind::rival, 3, .5);
  return sweep;
}

TEST(Trades, TellWhereEachPresetIs) {
  const Sweep sweep = made_up_sweep();
  const Trade time = trades_of(sweep, FrameClock::wall)[0];
  EXPECT_EQ(time.front, (std::vector<size_t>{0, 1, 3}));
  EXPECT_EQ(time.tolerance.error, 0.004);
  EXPECT_TRUE(standing_of(sweep, time, 1).on_front);
  const Standing balanced = standing_of(sweep, time, 2);
  EXPECT_FALSE(balanced.on_front);
  EXPECT_DOUBLE_EQ(balanced.cost_factor, 2);           // fast costs 2 and errs less
  EXPECT_DOUBLE_EQ(balanced.error_factor, .2 / .099);  // accurate costs less
  EXPECT_DOUBLE_EQ(standing_of(sweep, time, 4).error_factor, 4);
  EXPECT_EQ(rivals_before_front(sweep, time), (std::vector<size_t>{5}));
}

TEST(Trades, LeaveOutWhatHasNoSuchCost) {
  const Sweep sweep = made_up_sweep();
  EXPECT_TRUE(trades_of(sweep, FrameClock::cpu)[0].front.empty());
  EXPECT_TRUE(trades_of(sweep, FrameClock::wall)[2].front.empty());
  EXPECT_FALSE(standing_of(sweep, trades_of(sweep, FrameClock::cpu)[0], 1).on_front);
}

}  // namespace
}  // namespace burnish::tools
