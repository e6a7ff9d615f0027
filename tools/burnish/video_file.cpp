#include "video_file.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "burnish/formats/error.h"
#include "burnish/formats/image_file.h"
#include "common/interrupt.h"
#include "common/options.h"

namespace burnish::tools {
namespace {

constexpr int kPollMs = 50;  ///< between two looks at Ctrl-C

/// The last line of a file that is not empty.
std::string last_line(std::FILE* file) {
  std::string line, last;
  std::rewind(file);
  for (int c = 0; (c = std::fgetc(file)) != EOF;) {
    if (c != '\n') line += static_cast<char>(c);
    if (c == '\n' && !line.empty()) last = std::exchange(line, {});
  }
  return line.empty() ? last : line;
}

/// What posix_spawnp is given, released at the end.
struct SpawnSetup {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;

  SpawnSetup(int input, int messages) {
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&files, messages, STDERR_FILENO);
    posix_spawnattr_init(&attributes);
    sigset_t defaults;
    sigemptyset(&defaults);
    sigaddset(&defaults, SIGPIPE);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;
};

}  // namespace

std::vector<std::string> ffmpeg_arguments(const std::string& extension, int width, int height,
                                          const std::string& output) {
  std::vector<std::string> words = {"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error"};
  const auto add = [&](std::initializer_list<std::string> more) {
    words.insert(words.end(), more);
  };
  add({"-y", "-f", "rawvideo", "-pixel_format", "rgb24"});
  add({"-video_size", fmt::format("{}x{}", width, height)});
  add({"-framerate", std::to_string(kFramesPerSecond), "-i", "pipe:0"});
  if (extension == ".gif") {
    add({"-filter_complex", "split[a][b];[a]palettegen[palette];[b][palette]paletteuse"});
    add({"-loop", "0", "-f", "gif"});
  } else {
    // Players expect chroma of half the size, and colours as in BT.709.
    add({"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv"});
    add({"-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p"});
    add({"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "iec61966-2-1"});
    add({"-movflags", "+faststart", "-f", "mp4"});
  }
  add({"file:" + output});  // else a colon in the name would be a protocol's
  return words;
}

EncoderProcess::EncoderProcess(const std::vector<std::string>& arguments,
                               const std::string& subject)
    : subject_(subject), messages_(std::tmpfile(), &std::fclose) {
  if (!messages_)
    throw Error(ErrorKind::output, subject,
                fmt::format("cannot create a temporary file: {}", std::strerror(errno)));
  fcntl(fileno(messages_.get()), F_SETFD, FD_CLOEXEC);
  start(arguments);
  // A child that ends early shows as EPIPE.
  struct sigaction ignore = {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &old_pipe_action_);
}

EncoderProcess::~EncoderProcess() {
  end();
  sigaction(SIGPIPE, &old_pipe_action_, nullptr);
}

void EncoderProcess::start(const std::vector<std::string>& arguments) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.data()));
  words.push_back(nullptr);
  std::array<int, 2> ends;
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Error(ErrorKind::output, subject_,
                fmt::format("cannot create a pipe: {}", std::strerror(errno)));
  const SpawnSetup setup(ends[0], fileno(messages_.get()));
  const int error =
      posix_spawnp(&child_, words[0], &setup.files, &setup.attributes, words.data(), environ);
  ::close(ends[0]);
  input_ = ends[1];
  if (error == 0) {
    fcntl(input_, F_SETFL, O_NONBLOCK);
    return;
  }
  ::close(input_);
  child_ = -1;
  if (error == ENOENT)
    throw Error(ErrorKind::unsupported, subject_,
                fmt::format("needs the program {}, found none on PATH; install it, or write "
                            "numbered pictures with -o FILE.png",
                            arguments[0]));
  throw Error(ErrorKind::output, subject_,
              fmt::format("cannot start {}: {}", arguments[0], std::strerror(error)));
}

void EncoderProcess::end() {
  if (input_ >= 0) ::close(input_);
  input_ = -1;
  if (child_ < 0) return;
  kill(child_, SIGKILL);
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) continue;
  child_ = -1;
}

void EncoderProcess::fail(const std::string& otherwise) {
  end();
  const std::string reason = last_line(messages_.get());
  throw Error(ErrorKind::output, subject_, "ffmpeg: " + (reason.empty() ? otherwise : reason));
}

void EncoderProcess::write(std::span<const unsigned char> bytes) {
  while (!bytes.empty()) {
    throw_if_interrupted();
    pollfd ready = {input_, POLLOUT, 0};
    if (poll(&ready, 1, kPollMs) <= 0) continue;
    const ssize_t written = ::write(input_, bytes.data(), bytes.size());
    if (written < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (written < 0) fail("ended before the last frame");
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
}

void EncoderProcess::finish() {
  ::close(input_);
  input_ = -1;
  int status = 0;
  while (waitpid(child_, &status, WNOHANG) == 0) {
    throw_if_interrupted();
    std::this_thread::sleep_for(std::chrono::milliseconds(kPollMs));
  }
  child_ = -1;
  if (WIFSIGNALED(status)) fail(fmt::format("ended by signal {}", WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) fail(fmt::format("ended with code {}", WEXITSTATUS(status)));
}

VideoFile::VideoFile(const std::string& target, int width, int height, float exposure_stops)
    : target_(target),
      exposure_stops_(exposure_stops),
      file_(target),
      encoder_(ffmpeg_arguments(lower_extension(target), width, height, file_.temporary_path()),
               target) {}

void VideoFile::add(const Image& image) { encoder_.write(srgb_bytes(image, exposure_stops_)); }

void VideoFile::commit() {
  encoder_.finish();
  std::error_code error;
  if (std::filesystem::file_size(file_.temporary_path(), error) == 0 || error)
    throw Error(ErrorKind::output, target_, "ffmpeg: wrote nothing");
  file_.commit();
}

}  // namespace burnish::tools
