#include "file_bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "burnish/formats/error.h"

namespace burnish {
namespace {

struct InputDescriptor {
  int value = -1;
  ~InputDescriptor() {
    if (value >= 0) ::close(value);
  }
};

[[noreturn]] void fail(const std::string& path, const char* action, int error_number) {
  throw Error(ErrorKind::input, path,
              fmt::format("cannot {}: {}", action, std::strerror(error_number)));
}

}  // namespace

std::string read_file_start(const std::string& path, size_t count) {
  InputDescriptor file;
  // Without O_NONBLOCK, opening a pipe would wait for its writer before it can be refused.
  file.value = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (file.value < 0) fail(path, "open", errno);
  struct stat status = {};
  if (::fstat(file.value, &status) != 0) fail(path, "open", errno);
  if (!S_ISREG(status.st_mode))
    throw Error(ErrorKind::input, path,
                S_ISDIR(status.st_mode) ? "is a folder, expected a file" : "is not a regular file");
  std::string bytes(std::min(count, static_cast<size_t>(status.st_size)), '\0');
  size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(file.value, bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "read", errno);
    if (got == 0) break;
    done += static_cast<size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

std::string read_file_bytes(const std::string& path) {
  return read_file_start(path, std::numeric_limits<size_t>::max());
}

}  // namespace burnish
