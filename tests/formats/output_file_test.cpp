#include "burnish/formats/output_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "files.h"

namespace burnish::test {
namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AppearsOnCommitOnly) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  write_bytes(path, "old");
  {
    OutputFile file(path);
    file.write("new ");
    EXPECT_EQ(read_bytes(path), "old");
    EXPECT_EQ(fs::path(file.temporary_path()).parent_path(), fs::path(path).parent_path());
    EXPECT_EQ(fs::path(file.temporary_path()).extension(), ".txt");
    file.write("contents");
    file.commit();
  }
  EXPECT_EQ(read_bytes(path), "new contents");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(OutputFile, IsForgottenWithoutCommit) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.txt");
  {
    OutputFile file(path);
    file.write("new");
  }
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(OutputFile, FullDiskIsAnError) {
  expect_output_survives_failure("a.txt", [](const std::string& path) {
    OutputFile file(path);
    file.write("longer than the limit of sixteen bytes");
    file.commit();
  });
}

TEST(OutputFile, FollowsALinkToAFile) {
  const TemporaryFolder folder;
  const std::string path = folder.file("real.txt"), link = folder.file("link.txt");
  write_bytes(path, "old");
  fs::create_symlink("real.txt", link);
  OutputFile file(link);
  file.write("new");
  file.commit();
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_bytes(path), "new");
}

TEST(OutputFile, KeepsPermissionsAndHonoursTheUmask) {
  const TemporaryFolder folder;
  const std::string old_path = folder.file("old.txt"), new_path = folder.file("new.txt");
  write_bytes(old_path, "old");
  fs::permissions(old_path, fs::perms(0640));
  const mode_t before = ::umask(027);
  for (const std::string& path : {old_path, new_path}) {
    OutputFile file(path);
    file.write("x");
    file.commit();
  }
  ::umask(before);
  EXPECT_EQ(fs::status(old_path).permissions(), fs::perms(0640));
  EXPECT_EQ(fs::status(new_path).permissions(), fs::perms(0640));  // 0666 without 027
}

TEST(OutputFile, RefusesWhatIsNoFile) {
  const TemporaryFolder folder;
  const std::string sub = folder.file("sub");
  fs::create_directory(sub);
  for (const std::string& path : {sub, std::string("/dev/null"), folder.file("missing/a.txt")})
    EXPECT_NE(error_of(
                  path, [&] { OutputFile file(path); }, ErrorKind::output),
              "");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(OutputFile(""), Error);
}

TEST(OutputFile, LongNamesWork) {
  const TemporaryFolder folder;
  const std::string path = folder.file(std::string(200, 'n') + "." + std::string(50, 'e'));
  OutputFile file(path);
  file.write("x");
  file.commit();
  EXPECT_EQ(read_bytes(path), "x");
}

}  // namespace
}  // namespace burnish::test
