// runtime <- formats <- precompute <- tools: nothing points back, and each layer sees only the
// third-party libraries that are meant for it.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <stdlib.h>

#include "package/include_rules.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

TEST(DependencyDirection, HoldsInEveryLayer) {
  for (size_t layer = 0; layer < layers().size(); ++layer) {
    const IncludeReport report = check_includes(BURNISH_SOURCE_DIR, layer);
    EXPECT_GT(report.files, 0) << layers()[layer].folder;
    for (const std::string& violation : report.violations) ADD_FAILURE() << violation;
  }
}

// burnish/sphere/ can be taken alone: it includes nothing else of burnish.
TEST(DependencyDirection, TheSphereStandsAlone) {
  const fs::path folder = fs::path(BURNISH_SOURCE_DIR) / "runtime/include/burnish/sphere";
  int files = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    std::ifstream in(entry.path());
    ++files;
    for (std::string line; std::getline(in, line);) {
      if (!line.starts_with("#include \"")) continue;
      EXPECT_TRUE(line.starts_with("#include \"burnish/sphere/"))
          << entry.path().filename() << ": " << line;
    }
  }
  EXPECT_GT(files, 10);
}

/// The rules applied to a small tree, in which one file includes one header.
class IncludeRules : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "burnish_includes_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
    write("runtime/include/burnish/sphere.h", "#include <Eigen/Core>");
    write("runtime/src/detail.h", "");
    write("formats/include/burnish/formats/mesh.h", "#include \"burnish/sphere.h\"");
    write("precompute/include/burnish/precompute/bake.h", "#include <vector>");
    write("tools/common/report.h", "");
  }
  void TearDown() override { fs::remove_all(root_); }

  void write(const std::string& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text << "\n";
  }

  /// Number of objections to `file` including `header`, spelt with its brackets.
  size_t objections(const std::string& file, const std::string& header) {
    write(file, "#include " + header);
    size_t count = 0;
    for (size_t layer = 0; layer < layers().size(); ++layer) {
      count += check_includes(root_, layer).violations.size();
    }
    fs::remove(root_ / file);
    return count;
  }

  fs::path root_;
};

TEST_F(IncludeRules, AcceptWhatALayerMayUse) {
  EXPECT_EQ(objections("runtime/src/a.cpp", "<Eigen/Dense>"), 0u);
  EXPECT_EQ(objections("runtime/src/a.cpp", "\"detail.h\""), 0u);
  EXPECT_EQ(objections("formats/src/a.cpp", "<OpenMesh/Core/IO/IOManager.hh>"), 0u);
  EXPECT_EQ(objections("formats/src/a.cpp", "\"burnish/sphere.h\""), 0u);
  EXPECT_EQ(objections("precompute/src/a.cpp", "<embree3/rtcore.h>"), 0u);
  EXPECT_EQ(objections("tools/common/a.cpp", "\"common/report.h\""), 0u);
  EXPECT_EQ(objections("tools/common/a.cpp", "\"burnish/precompute/bake.h\""), 0u);
}

TEST_F(IncludeRules, RejectWhatPointsBack) {
  EXPECT_EQ(objections("runtime/src/a.cpp", "\"burnish/formats/mesh.h\""), 1u);
  EXPECT_EQ(objections("runtime/include/burnish/a.h", "\"burnish/precompute/bake.h\""), 1u);
  EXPECT_EQ(objections("formats/src/a.cpp", "\"burnish/precompute/bake.h\""), 1u);
  EXPECT_EQ(objections("precompute/src/a.cpp", "\"common/report.h\""), 1u);
}

TEST_F(IncludeRules, RejectLibrariesOfAnotherLayer) {
  EXPECT_EQ(objections("runtime/src/a.cpp", "<embree3/rtcore.h>"), 1u);
  EXPECT_EQ(objections("runtime/src/a.cpp", "<hdf5.h>"), 1u);
  EXPECT_EQ(objections("runtime/src/a.cpp", "<tbb/parallel_for.h>"), 1u);
  EXPECT_EQ(objections("formats/src/a.cpp", "<embree3/rtcore.h>"), 1u);
  EXPECT_EQ(objections("precompute/src/a.cpp", "<H5Cpp.h>"), 1u);
  EXPECT_EQ(objections("tools/common/a.cpp", "<embree3/rtcore.h>"), 1u);
}

TEST_F(IncludeRules, RejectPrivateHeadersOutsideTheirPlace) {
  EXPECT_EQ(objections("formats/src/a.cpp", "\"detail.h\""), 1u);
  EXPECT_EQ(objections("runtime/include/burnish/a.h", "\"detail.h\""), 1u);
  EXPECT_EQ(objections("formats/include/burnish/formats/a.h", "<hdf5.h>"), 1u);
  EXPECT_EQ(objections("precompute/include/burnish/precompute/a.h", "<tbb/parallel_for.h>"), 1u);
  EXPECT_EQ(objections("runtime/src/a.cpp", "BURNISH_SOME_HEADER"), 1u);
  EXPECT_EQ(objections("runtime/src/a.cpp", "<iostream>\n  #  include <hdf5.h>  // storage"), 1u);
}

// Vectors stay inside the library: who uses it needs no Highway.
TEST_F(IncludeRules, RejectHighwayInPublicHeadersOfTheRuntime) {
  EXPECT_EQ(objections("runtime/src/a.cpp", "<hwy/highway.h>"), 0u);
  EXPECT_EQ(objections("runtime/src/sphere/a-inl.h", "\"hwy/highway.h\""), 0u);
  EXPECT_EQ(objections("runtime/include/burnish/a.h", "<hwy/highway.h>"), 1u);
  EXPECT_EQ(objections("runtime/include/burnish/shading/a.h", "\"hwy/foreach_target.h\""), 1u);
}

TEST_F(IncludeRules, CountsNoFilesWhereThereAreNone) {
  EXPECT_EQ(check_includes(root_ / "elsewhere", 0).files, 0);
}

}  // namespace
}  // namespace burnish
