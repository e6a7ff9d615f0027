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

std::string bytes_text(double bytes) {
  constexpr std::array<const char*, 5> kUnits = {"bytes", "kB", "MB", "GB", "TB"};
  size_t unit = 0;
  while (bytes >= 999.5 && unit + 1 < kUnits.size()) {
    bytes /= 1000;
    ++unit;
  }
  return unit == 0 ? fmt::format("{:.0f} bytes", bytes)
                   : fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

}  // namespace burnish::tools
