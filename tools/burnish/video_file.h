#pragma once

#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <signal.h>
#include <sys/types.h>

#include "burnish/formats/output_file.h"
#include "frame_output.h"

/// Animations by the program ffmpeg, which reads frames from a pipe.
namespace burnish::tools {

/// What ffmpeg is told: raw frames of 8-bit RGB on its standard input, and `output` as GIF of one
/// palette that repeats for ever, or as MP4 of H.264, whose odd sizes get a black line.
std::vector<std::string> ffmpeg_arguments(const std::string& extension, int width, int height,
                                          const std::string& output);

/// A child process of its own group, so that Ctrl-C reaches this program alone, which ends it.
class EncoderProcess {
 public:
  /// Starts arguments[0], found on PATH. Errors are about `subject`: ErrorKind::unsupported where
  /// there is no such program, else output with the last line that the child wrote on stderr.
  EncoderProcess(const std::vector<std::string>& arguments, const std::string& subject);
  ~EncoderProcess();
  EncoderProcess(const EncoderProcess&) = delete;
  EncoderProcess& operator=(const EncoderProcess&) = delete;

  /// To its standard input. Throws Cancelled after Ctrl-C, as does finish().
  void write(std::span<const unsigned char> bytes);
  /// Ends the input and waits for exit code 0.
  void finish();

 private:
  void start(const std::vector<std::string>& arguments);
  void end();
  [[noreturn]] void fail(const std::string& otherwise);

  std::string subject_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> messages_;  ///< its stderr
  int input_ = -1;
  pid_t child_ = -1;
  struct sigaction old_pipe_action_ = {};  ///< of SIGPIPE, ignored meanwhile
};

class VideoFile : public FrameOutput {
 public:
  /// Starts ffmpeg. The target's extension is .gif or .mp4.
  VideoFile(const std::string& target, int width, int height, float exposure_stops);
  void add(const Image& image) override;
  void commit() override;

 private:
  std::string target_;
  float exposure_stops_;
  OutputFile file_;
  EncoderProcess encoder_;  // ends before its file is removed
};

}  // namespace burnish::tools
