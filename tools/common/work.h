#pragma once

#include <chrono>
#include <memory>

#include <nlohmann/json.hpp>

#include "common/command.h"
#include "common/progress_bar.h"

namespace burnish::tools {

/// What a command holds while it works: the number of threads, the progress bar, Ctrl-C and a
/// clock.
class Work {
 public:
  explicit Work(const CommonOptions& options);
  ~Work();

  /// For the libraries' long calls; refers to this object.
  Progress progress() { return bar_.callback(); }
  /// Prints a line of the summary on stdout, unless quiet.
  void print(const std::string& line);
  /// Worker threads in use.
  int threads() const { return threads_; }

 private:
  struct ThreadLimit;
  bool quiet_;
  int threads_;
  std::unique_ptr<ThreadLimit> limit_;
  ProgressBar bar_;
};

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Writes `document` as indented JSON, whole or not at all. Does nothing for an empty path.
void write_json(const std::string& path, const nlohmann::ordered_json& document);

/// Writes text, whole or not at all.
void write_text(const std::string& path, const std::string& text);

/// "1.5 M": a count for people, to three digits, in powers of 1000.
std::string count_text(double count);
/// "1.5 MB".
std::string bytes_text(double bytes);

}  // namespace burnish::tools
