#include "common/work.h"

#include <algorithm>
#include <array>
#include <thread>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "burnish/formats/output_file.h"
#include "common/interrupt.h"

namespace burnish::tools {

struct Work::ThreadLimit {
  tbb::global_control control;
};

Work::Work(const CommonOptions& options)
    : quiet_(options.quiet),
      threads_(options.threads > 0
                   ? options.threads
                   : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))),
      limit_(new ThreadLimit{
          {tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads_)}}),
      bar_(options.quiet) {
  install_interrupt_handler();
}

Work::~Work() = default;

void Work::print(const std::string& line) {
  if (quiet_) return;
  bar_.clear();
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

void write_json(const std::string& path, const nlohmann::ordered_json& document) {
  if (path.empty()) return;
  // A file name need not be UTF-8; JSON must be.
  write_text(path,
             document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

void write_text(const std::string& path, const std::string& text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

std::string count_text(double count) {
  constexpr std::array<const char*, 5> kPrefixes = {"", " k", " M", " G", " T"};
  size_t power = 0;
  while (count >= 999.5 && power + 1 < kPrefixes.size()) {
    count /= 1000;
    ++power;
  }
  return fmt::format("{:.3g}{}", count, kPrefixes[power]);
}

std::string bytes_text(double bytes) {
  return bytes < 999.5 ? fmt::format("{:.0f} bytes", bytes) : count_text(bytes) + "B";
}

}  // namespace burnish::tools
