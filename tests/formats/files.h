#pragma once

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "burnish/formats/error.h"

namespace burnish::test {

/// A folder that is empty at first and gone at last.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "burnish-test-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  size_t file_count() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream) << path;
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::filesystem::remove(path);  // to truncate a file makes ext4 flush it: slow in a loop
  std::ofstream stream(path, std::ios::binary);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  ASSERT_TRUE(stream) << path;
}

/// The folder of shared trial data, which may be absent: the environment variable
/// BURNISH_SHARED_DATA, or ../shared/data beside the sources.
inline std::filesystem::path shared_data() {
  const char* variable = std::getenv("BURNISH_SHARED_DATA");
  return variable ? variable : BURNISH_SOURCE_DIR "/../shared/data";
}

/// What the call throws as Error::what(), or "" when it throws none; a failure if it is not one
/// line that names `subject` first.
template <class Call>
std::string error_of(const std::string& subject, Call call, ErrorKind kind = ErrorKind::input) {
  try {
    call();
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.rfind(subject + ": ", 0), 0u) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_EQ(error.kind(), kind) << what;
    return what;
  }
  return "";
}

/// While it lives, files cannot grow beyond a size: writing ends in EFBIG, as on a full disk in
/// ENOSPC. (Permissions would not stop a test that runs as root.)
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileSizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_ = {};
  void (*handler_)(int);
};

/// A writer's duties toward its target: `write(path)` must fail cleanly where the folder is
/// missing and where the disk is full, leave an old file as it was, and leave nothing else.
template <class Write>
void expect_output_survives_failure(const std::string& name, Write write) {
  const TemporaryFolder folder;
  const std::string path = folder.file(name), missing = folder.file("missing/" + name);
  EXPECT_NE(error_of(
                missing, [&] { write(missing); }, ErrorKind::output),
            "");
  write_bytes(path, "old contents");
  {
    const FileSizeLimit limit(16);  // bytes: every format is longer
    EXPECT_NE(error_of(
                  path, [&] { write(path); }, ErrorKind::output),
              "");
  }
  EXPECT_EQ(read_bytes(path), "old contents");
  EXPECT_EQ(folder.file_count(), 1u);
  write(path);
  EXPECT_NE(read_bytes(path), "old contents");
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace burnish::test
