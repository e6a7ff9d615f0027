#include "burnish/formats/output_file.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <random>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "burnish/formats/error.h"

namespace burnish {
namespace {

constexpr int kMaxNameAttempts = 100;
constexpr size_t kMaxExtension = 32;  // far below NAME_MAX (255) with the rest of the name

std::string temporary_name(const std::filesystem::path& target, std::random_device& random) {
  std::string extension = target.extension().string();
  if (extension.size() > kMaxExtension) extension.clear();
  const auto tag = std::uint64_t{random()} << 32 | random();
  const auto folder = target.parent_path();
  return (folder / fmt::format(".burnish-{:016x}{}", tag, extension)).string();
}

}  // namespace

OutputFile::OutputFile(const std::string& target) : target_(target), resolved_(target) {
  namespace fs = std::filesystem;
  if (target.empty()) throw Error(ErrorKind::output, "''", "expected the name of a file");
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  const bool exists = fs::exists(status);
  if (exists && !fs::is_regular_file(status))
    throw Error(ErrorKind::output, target, "exists and is not a regular file");
  if (fs::is_symlink(fs::symlink_status(target, error)) && exists) {
    resolved_ = fs::canonical(target, error).string();
    if (error) fail("follow the link", error.value());
  }

  std::random_device random;
  for (int attempt = 0; attempt < kMaxNameAttempts && descriptor_ < 0; ++attempt) {
    temporary_ = temporary_name(resolved_, random);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
  }
  if (descriptor_ < 0) {
    const int number = errno;
    temporary_.clear();
    fail("create a file in its folder", number);
  }
  // Where the file system has no permissions this fails, and the file is as good as any there.
  if (exists) (void)!::fchmod(descriptor_, static_cast<mode_t>(status.permissions()));
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::fail(const char* action, int error_number) const {
  throw Error(ErrorKind::output, target_,
              fmt::format("cannot {}: {}", action, std::strerror(error_number)));
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write", errno);
    bytes.remove_prefix(static_cast<size_t>(written));
  }
}

void OutputFile::write(std::span<const unsigned char> bytes) {
  write(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void OutputFile::commit() {
  // Some file systems (pipes of FUSE, for one) know no fsync; a real failure shows as EIO or
  // ENOSPC.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP) fail("write", errno);
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) fail("write", errno);
  if (::rename(temporary_.c_str(), resolved_.c_str()) != 0) fail("take its name", errno);
  temporary_.clear();
}

}  // namespace burnish
