#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/bake_journal.h"
#include "mask_code.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

const BakeJournal::Facts kFacts = {{"mesh", "0123"}, {"terms", "48"}};

std::vector<std::byte> payload_of(std::uint32_t index) {
  std::mt19937 random(index);
  std::vector<std::byte> bytes(random() % 100);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
  return bytes;
}

class Journal : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("burnish-journal-" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string path() const { return (folder_ / "bake.journal").string(); }

  // Records by index, each with the payload that payload_of gives.
  void write(std::uint32_t records) const {
    BakeJournal journal(path());
    journal.start(kFacts);
    for (std::uint32_t i = 0; i < records; ++i) journal.append(1 + i % 3, i, payload_of(i));
  }

  // Checks each record and returns how many there are.
  std::uint32_t read_back() const {
    BakeJournal journal(path());
    std::uint32_t count = 0;
    journal.resume(kFacts, [&](BakeJournal::Record&& record) {
      EXPECT_EQ(record.index, count);
      EXPECT_EQ(record.kind, 1 + count % 3);
      EXPECT_EQ(record.payload, payload_of(count));
      ++count;
    });
    return count;
  }

  std::string error_of_resume(const BakeJournal::Facts& facts) const {
    BakeJournal journal(path());
    try {
      journal.resume(facts, [](BakeJournal::Record&&) {});
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(Journal, GivesBackWhatWasAppended) {
  write(50);
  EXPECT_EQ(read_back(), 50u);
}

TEST_F(Journal, CutAnywhereItKeepsEveryWholeRecord) {
  write(7);
  std::vector<std::uint64_t> ends;  // of record i
  {
    BakeJournal journal(path());
    journal.start(kFacts);
    for (std::uint32_t i = 0; i < 7; ++i) {
      ends.push_back(fs::file_size(path()));
      journal.append(1 + i % 3, i, payload_of(i));
    }
  }
  std::ifstream file(path(), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), {});
  for (std::uint64_t size = ends[0]; size <= whole.size(); ++size) {
    std::ofstream(path(), std::ios::binary) << whole.substr(0, size);
    std::uint32_t expected = 0;
    while (expected < 7 && (expected + 1 < 7 ? ends[expected + 1] : whole.size()) <= size)
      ++expected;
    ASSERT_EQ(read_back(), expected) << "cut at byte " << size;
    // What was cut off is gone, and new records follow the good ones.
    ASSERT_EQ(fs::file_size(path()), expected < 7 ? ends[expected] : whole.size());
  }
}

TEST_F(Journal, StopsAtARecordThatIsDamaged) {
  write(5);
  std::ifstream file(path(), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), {});
  file.close();
  std::uint32_t at_most = 0;
  for (std::size_t byte = whole.size(); byte-- > 0;) {
    std::string damaged = whole;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 0x10);
    std::ofstream(path(), std::ios::binary) << damaged;
    try {
      const std::uint32_t count = read_back();
      ASSERT_LT(count, 5u) << "byte " << byte;
      at_most = std::max(at_most, count);
    } catch (const Error& error) {
      ASSERT_NE(std::string(error.what()).find("expected "), std::string::npos);
    }
  }
  EXPECT_EQ(at_most, 4u);
}

TEST_F(Journal, GoesOnAfterTheGoodRecords) {
  write(3);
  fs::resize_file(path(), fs::file_size(path()) - 1);
  {
    BakeJournal journal(path());
    journal.resume(kFacts, [](BakeJournal::Record&&) {});
    for (std::uint32_t i = 2; i < 6; ++i) journal.append(1 + i % 3, i, payload_of(i));
  }
  EXPECT_EQ(read_back(), 6u);
}

TEST_F(Journal, RefusesOtherFactsByName) {
  write(1);
  EXPECT_EQ(error_of_resume(kFacts), "");
  EXPECT_EQ(error_of_resume({{"mesh", "0123"}, {"terms", "32"}}),
            path() + ": was begun with another terms: found 48, expected 32");
  EXPECT_EQ(error_of_resume({{"mesh", "0123"}, {"terms", "48"}, {"bases", "8"}}),
            path() + ": was begun with another bases: found nothing, expected 8");
  EXPECT_EQ(error_of_resume({{"mesh", "0123"}}),
            path() + ": holds facts that this version of burnish does not know, expected its own");
}

TEST_F(Journal, KnowsWhetherItHoldsWork) {
  {
    const BakeJournal journal(path());
    EXPECT_FALSE(journal.holds_work());
  }
  EXPECT_FALSE(fs::exists(path())) << "a journal that was never started leaves no file";
  write(0);
  BakeJournal journal(path());
  EXPECT_TRUE(journal.holds_work());
  journal.remove();
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(Journal, IsLockedWhileOpen) {
  const BakeJournal journal(path());
  EXPECT_THROW(BakeJournal second(path()), Error);
}

TEST_F(Journal, LeavesOtherFilesAlone) {
  std::ofstream(path()) << "a diary";
  EXPECT_THROW(BakeJournal{path()}, Error);
  std::ifstream file(path());
  EXPECT_EQ(std::string((std::istreambuf_iterator<char>(file)), {}), "a diary");
}

TEST_F(Journal, RefusesAFolder) { EXPECT_THROW(BakeJournal(folder_.string()), Error); }

TEST_F(Journal, TakesRecordsFromSeveralThreads) {
  {
    BakeJournal journal(path());
    journal.start(kFacts);
    std::vector<std::jthread> threads;
    for (std::uint32_t t = 0; t < 4; ++t)
      threads.emplace_back([&journal, t] {
        for (std::uint32_t i = t; i < 400; i += 4) journal.append(1, i, payload_of(i));
      });
  }
  BakeJournal journal(path());
  std::map<std::uint32_t, std::vector<std::byte>> found;
  journal.resume(kFacts, [&](BakeJournal::Record&& record) {
    found[record.index] = std::move(record.payload);
  });
  ASSERT_EQ(found.size(), 400u);
  for (const auto& [index, payload] : found) EXPECT_EQ(payload, payload_of(index));
}

TEST(MaskCode, GivesBackEveryMask) {
  constexpr unsigned kSeed = 11;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937_64 random(kSeed);
  for (const int resolution : {64, 128, 512, 1024}) {
    for (const double share : {0.0, 0.002, 0.3, 1.0}) {
      VisibilityMask mask(resolution);
      // Stretches of equal texels, as visibility has, down to single texels.
      bool visible = share == 1;
      for (int y = 0; y < resolution; ++y)
        for (int x = 0; x < resolution; ++x) {
          if (static_cast<double>(random() >> 11) * 0x1p-53 < share && share < 1)
            visible = !visible;
          if (visible) mask.set_visible(x, y);
        }
      ByteWriter writer;
      encode_mask(mask, writer);
      VisibilityMask decoded(resolution);
      decoded.bits.assign(decoded.bits.size(), random());
      ByteReader reader(writer.bytes());
      decode_mask(reader, decoded);
      EXPECT_TRUE(reader.complete());
      EXPECT_EQ(decoded.bits, mask.bits) << resolution << ", " << share;
    }
  }
}

TEST(MaskCode, AShortCodeIsNoticed) {
  VisibilityMask mask(64);
  mask.set_visible(3, 5);
  ByteWriter writer;
  encode_mask(mask, writer);
  for (std::size_t size = 0; size < writer.bytes().size(); ++size) {
    ByteReader reader(writer.bytes().first(size));
    decode_mask(reader, mask);
    EXPECT_FALSE(reader.complete()) << size;
  }
}

}  // namespace
}  // namespace burnish
