// A bake that is stopped, at any moment and in any way, goes on to the bytes of one that was not.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "burnish/formats/error.h"
#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/bake.h"
#include "precompute/test_meshes.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

constexpr BakeOptions kOptions{.directions = 64,
                               .coarsest = 32,
                               .resolution = 16,
                               .terms = 6,
                               .bases = 2,
                               .ladder_terms = 5,
                               .training_vertices = 150,
                               .residual_vertices = 20};

// Two spheres beside each other: 264 + 312 vertices.
TriangleMesh make_scene() {
  TriangleMesh mesh = test::make_sphere({0, 0, 0}, 0.5f, 11);
  const TriangleMesh other = test::make_sphere({1.1f, 0.2f, 0.1f}, 0.5f, 12);
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  for (Triangle triangle : other.triangles) {
    for (std::uint32_t& v : triangle) v += first;
    mesh.triangles.push_back(triangle);
  }
  test::complete(mesh);
  return mesh;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class BakeResume : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("burnish-resume-" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directory(folder_);
    expected_ = file_bytes(bake(mesh_, {}, kOptions));
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string journal_path() const { return (folder_ / "journal").string(); }

  std::string file_bytes(const Transfer& transfer) const {
    const std::string path = (folder_ / "transfer.h5").string();
    write_transfer(transfer, path);
    return bytes_of(path);
  }

  // Begins or goes on, until `steps` calls of the progress. Whether it came to its end.
  bool run(bool resume, std::uint64_t steps, Transfer* transfer, BakeTimings* timings = nullptr) {
    BakeJournal journal(journal_path());
    std::uint64_t calls = 0;
    try {
      Transfer result = bake(mesh_, {}, kOptions,
                             {.progress = [&](auto, auto, auto) { return ++calls <= steps; },
                              .timings = timings,
                              .journal = &journal,
                              .resume = resume});
      if (transfer) *transfer = std::move(result);
      return true;
    } catch (const Cancelled&) {
      return false;
    }
  }

  const TriangleMesh mesh_ = make_scene();
  std::string expected_;
  fs::path folder_;
};

constexpr std::uint64_t kForever = ~std::uint64_t{0};

TEST_F(BakeResume, StoppedAtEveryStepItEndsInTheSameBytes) {
  int stops = 0;
  for (std::uint64_t steps = 1;; ++steps) {
    Transfer transfer;
    if (run(false, steps, &transfer)) break;
    ++stops;
    ASSERT_TRUE(run(true, kForever, &transfer));
    ASSERT_EQ(file_bytes(transfer), expected_) << "stopped after " << steps << " steps";
  }
  EXPECT_GE(stops, 20);
}

TEST_F(BakeResume, StoppedAgainAndAgainItComesToItsEnd) {
  // Three steps a run: a stage's first is its beginning.
  Transfer transfer;
  int runs = 1;
  for (bool done = run(false, 3, &transfer); !done; ++runs) {
    ASSERT_LT(runs, 100) << "no progress";
    done = run(true, static_cast<std::uint64_t>(3 + runs), &transfer);
  }
  EXPECT_GT(runs, 5);
  EXPECT_EQ(file_bytes(transfer), expected_);
}

TEST_F(BakeResume, CutAtAnyByteItEndsInTheSameBytes) {
  constexpr unsigned kSeed = 4;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  ASSERT_TRUE(run(false, kForever, nullptr));
  const std::string whole = bytes_of(journal_path());
  for (int i = 0; i < 30; ++i) {
    // Not into the facts, which come in one piece before any work.
    const std::size_t size = 1000 + random() % (whole.size() - 1000);
    std::ofstream(journal_path(), std::ios::binary) << whole.substr(0, size);
    Transfer transfer;
    ASSERT_TRUE(run(true, kForever, &transfer));
    ASSERT_EQ(file_bytes(transfer), expected_) << "cut at byte " << size;
  }
}

TEST_F(BakeResume, OtherThreadsGoOnToTheSameBytes) {
  for (const std::size_t threads : {1, 3}) {
    ASSERT_FALSE(run(false, 25, nullptr));
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Transfer transfer;
    ASSERT_TRUE(run(true, kForever, &transfer));
    EXPECT_EQ(file_bytes(transfer), expected_);
  }
}

TEST_F(BakeResume, CastsNoRayOfAFinishedBlockAgain) {
  BakeTimings whole, none;
  Transfer transfer;
  ASSERT_TRUE(run(false, kForever, &transfer, &whole));
  ASSERT_TRUE(run(true, kForever, &transfer, &none));
  EXPECT_GE(whole.rays_cast, transfer.provenance.rays);
  // But for the vertices that errors are measured on.
  EXPECT_LT(none.rays_cast, whole.rays_cast / 10);
  EXPECT_EQ(none.vertices_resumed, mesh_.positions.size());
  EXPECT_EQ(whole.vertices_resumed, 0u);
}

// As if another processor had trained them: the journal's facts agree, its coefficients do not.
TEST_F(BakeResume, CoefficientsOfOtherBasesAreNotTaken) {
  ASSERT_TRUE(run(false, kForever, nullptr));
  const BakeJournal::Facts facts = [&] {
    BakeJournal::Facts found;
    std::istringstream lines(bytes_of(journal_path()).substr(32));  // after the record's header
    for (std::string line; std::getline(lines, line) && line.find('=') < line.size();)
      if (found.size() < 14)
        found.emplace_back(line.substr(0, line.find('=')), line.substr(line.find('=') + 1));
    return found;
  }();
  std::vector<BakeJournal::Record> records;
  std::size_t results = 0;
  {
    BakeJournal journal(journal_path());
    journal.resume(facts, [&](BakeJournal::Record&& record) {
      constexpr std::uint32_t kResults = 2;
      if (record.kind == kResults) {
        ++results;
        for (std::byte& byte : record.payload) byte ^= std::byte{0x11};
      }
      records.push_back(std::move(record));
    });
    journal.start(facts);
    for (const BakeJournal::Record& record : records)
      journal.append(record.kind, record.index, record.payload);
  }
  ASSERT_EQ(results, 7u);  // 150 vertices in 2 blocks of at most 96, the other 426 in 5
  Transfer transfer;
  BakeTimings timings;
  ASSERT_TRUE(run(true, kForever, &transfer, &timings));
  EXPECT_EQ(timings.vertices_resumed, 0u);
  EXPECT_EQ(file_bytes(transfer), expected_);
}

TEST_F(BakeResume, OtherInputsAreRefusedByName) {
  ASSERT_FALSE(run(false, 10, nullptr));
  BakeJournal journal(journal_path());
  const auto error_of = [&](const TriangleMesh& mesh, const BakeOptions& options) {
    try {
      bake(mesh, {}, options, {.journal = &journal, .resume = true});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  BakeOptions options = kOptions;
  options.terms = 7;
  EXPECT_EQ(error_of(mesh_, options),
            journal_path() + ": was begun with another number of terms: found 6, expected 7");
  using Change = void (*)(BakeOptions&);
  for (const Change change : std::initializer_list<Change>{
           [](BakeOptions& o) { o.directions = 128; }, [](BakeOptions& o) { o.coarsest = 64; },
           [](BakeOptions& o) { o.origin_offset = 0.1; }, [](BakeOptions& o) { o.resolution = 32; },
           [](BakeOptions& o) { o.amplitude_rad = 0.5; }, [](BakeOptions& o) { o.bases = 1; },
           [](BakeOptions& o) { o.target_error = 0.5; }, [](BakeOptions& o) { o.ladder_terms = 6; },
           [](BakeOptions& o) { o.training_vertices = 151; },
           [](BakeOptions& o) { o.residual_vertices = 21; }}) {
    options = kOptions;
    change(options);
    EXPECT_NE(error_of(mesh_, options).find("was begun with another"), std::string::npos);
  }
  const TriangleMesh convex = test::make_sphere({0, 0, 0}, 0.5f, 8);
  EXPECT_NE(error_of(convex, kOptions).find("another mesh"), std::string::npos)
      << "though nothing occludes it";
  TriangleMesh mesh = mesh_;
  mesh.positions[5].x() += 1e-3f;
  EXPECT_NE(error_of(mesh, kOptions).find("another mesh"), std::string::npos);
}

}  // namespace
}  // namespace burnish
