#include "subprocess.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace burnish::test {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// Two ends of a pipe, or of a pseudo-terminal.
struct Channel {
  int ours = -1;
  int theirs = -1;
  ~Channel() {
    if (ours >= 0) close(ours);
    if (theirs >= 0) close(theirs);
  }
  void open_pipe() {
    std::array<int, 2> ends;
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
    ours = ends[0];
    theirs = ends[1];
  }
  void open_terminal() {
    winsize size = {};
    size.ws_col = 80;
    size.ws_row = 24;
    if (openpty(&ours, &theirs, nullptr, nullptr, &size) != 0) fail("openpty");
    fcntl(ours, F_SETFD, FD_CLOEXEC);
    fcntl(theirs, F_SETFD, FD_CLOEXEC);
  }
  void close_theirs() {
    close(theirs);
    theirs = -1;
  }
};

pid_t start(const std::string& program, const std::vector<std::string>& arguments,
            const RunOptions& options, const Channel& out, const Channel& err) {
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const std::string folder = options.folder.string();
  const pid_t child = fork();
  if (child < 0) fail("fork");
  if (child > 0) return child;
  // Only async-signal-safe calls from here on.
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(out.theirs, STDOUT_FILENO) < 0 ||
      dup2(err.theirs, STDERR_FILENO) < 0 || (!folder.empty() && chdir(folder.c_str()) != 0))
    _exit(127);
  // A test runner may ignore SIGINT, which a child would inherit.
  signal(SIGINT, SIG_DFL);
  signal(SIGTERM, SIG_DFL);
  execv(program.c_str(), words.data());
  _exit(127);
}

/// Reads what has come. Returns false at the end.
bool drain(int file, std::string& text) {
  std::array<char, 4096> buffer;
  const ssize_t count = read(file, buffer.data(), buffer.size());
  if (count > 0) text.append(buffer.data(), static_cast<size_t>(count));
  // A pseudo-terminal whose other end is closed gives EIO.
  return count > 0 || (count < 0 && errno == EINTR);
}

}  // namespace

RunResult run_program(const std::string& program, const std::vector<std::string>& arguments,
                      const RunOptions& options) {
  Channel out, err;
  out.open_pipe();
  if (options.terminal_stderr)
    err.open_terminal();
  else
    err.open_pipe();
  const pid_t child = start(program, arguments, options, out, err);
  out.close_theirs();
  err.close_theirs();

  RunResult result;
  bool signalled = false;
  const auto deadline =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(options.timeout_s);
  std::array<pollfd, 2> files = {{{out.ours, POLLIN, 0}, {err.ours, POLLIN, 0}}};
  while (files[0].fd >= 0 || files[1].fd >= 0) {
    if (std::chrono::steady_clock::now() > deadline) {
      result.timed_out = true;
      kill(child, SIGKILL);
      break;
    }
    if (poll(files.data(), files.size(), 100) <= 0) continue;
    if (files[0].revents != 0 && !drain(out.ours, result.out)) files[0].fd = -1;
    if (files[1].revents != 0 && !drain(err.ours, result.err)) files[1].fd = -1;
    if (options.send_signal && !signalled) {
      const int number = options.send_signal(result);
      signalled = number != 0;
      if (signalled) kill(child, number);
    }
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) fail("waitpid");
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (result.exit_code == 127) throw std::runtime_error("cannot start " + program);
  return result;
}

ScratchFolder::ScratchFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "burnish-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) fail("mkdtemp");
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> ScratchFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path_))
    names.push_back(std::filesystem::relative(entry.path(), path_).string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string read_whole_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("cannot read " + path);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

void write_whole_file(const std::string& path, const std::string& content) {
  std::ofstream file(path, std::ios::binary);
  file << content;
  if (!file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace burnish::test
