#include "common/progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "common/interrupt.h"

namespace burnish::tools {
namespace {

int terminal_columns() {
  winsize size = {};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

std::string duration_text(double seconds) {
  const auto whole = static_cast<long long>(std::min(std::ceil(seconds), 359999.0));
  if (whole < 3600) return fmt::format("{}:{:02}", whole / 60, whole % 60);
  return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

std::string progress_line(std::string_view stage, std::uint64_t done, std::uint64_t total,
                          double elapsed_s, int columns) {
  const double fraction =
      total > 0 ? std::min(static_cast<double>(done) / static_cast<double>(total), 1.0) : 0.0;
  std::string figures = fmt::format(" {:3.0f} %", std::floor(100 * fraction));
  if (fraction > 0)
    figures += fmt::format(", {} left", duration_text(elapsed_s * (1 - fraction) / fraction));
  // The last column stays free: some terminals wrap when it is written.
  const int width = columns - 1;
  const int bar_width = std::min(width - static_cast<int>(stage.size() + figures.size()) - 3, 40);
  std::string line(stage);
  if (bar_width >= 5) {
    const int filled = static_cast<int>(fraction * bar_width);
    line += " [" + std::string(filled, '#') + std::string(bar_width - filled, '-') + "]";
  }
  line += figures;
  if (static_cast<int>(line.size()) > width) line.resize(std::max(width, 0));
  return line;
}

ProgressBar::ProgressBar(bool quiet) : enabled_(!quiet && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { clear(); }

Progress ProgressBar::callback() {
  return [this](std::string_view stage, std::uint64_t done, std::uint64_t total) {
    if (enabled_) update(stage, done, total);
    return interrupted() == 0;
  };
}

void ProgressBar::clear() {
  if (!drawn_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  drawn_ = false;
}

void ProgressBar::update(std::string_view stage, std::uint64_t done, std::uint64_t total) {
  using std::chrono::duration;
  using std::chrono::duration_cast;
  const auto now = Clock::now();
  if (stage != stage_) {
    stage_ = stage;
    stage_start_ = now;
    next_draw_ = now + std::chrono::milliseconds(300);
  }
  if (now < next_draw_) return;
  const double elapsed_s = duration<double>(now - stage_start_).count();
  const duration<double> pause(std::clamp(elapsed_s / 50, 0.1, 1.0));
  next_draw_ = now + duration_cast<Clock::duration>(pause);
  const std::string line = progress_line(stage, done, total, elapsed_s, terminal_columns());
  fmt::print(stderr, "\r\x1b[K{}", line);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace burnish::tools
