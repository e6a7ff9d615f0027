#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace burnish::test {

/// How a program ended and what it printed.
struct RunResult {
  int exit_code = -1;  ///< of a normal end
  int signal = 0;      ///< that ended it, or 0
  bool timed_out = false;
  std::string out;
  std::string err;
};

struct RunOptions {
  double timeout_s = 600;        ///< then it is killed: ends hangs, far beyond any test
  bool terminal_stderr = false;  ///< stderr is a pseudo-terminal of 80 columns, not a pipe
  std::filesystem::path folder;  ///< working directory; empty: that of the test
  /// Asked whenever new output has come; the signal it returns, if not 0, is sent (once).
  std::function<int(const RunResult& so_far)> send_signal;
};

/// Runs a program with arguments and waits for it. Throws std::runtime_error if it cannot start.
RunResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                      const RunOptions& options = {});

/// A folder of its own for a test, removed with everything in it at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }
  /// Names of all that is in it, sorted.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

std::string read_whole_file(const std::string& path);
void write_whole_file(const std::string& path, const std::string& content);

}  // namespace burnish::test
