#include <memory>

#include "bench.h"
#include "common/machine.h"
#include "common/options.h"
#include "stations.h"
#include "tradeoff/report_page.h"

namespace burnish::tools {
namespace {

struct Options {
  std::vector<std::string> folders;
  std::string output;
  FrameClock clock = FrameClock::wall;
  bool quiet = false;
};

void run(const Options& options) {
  require_writable(std::vector{options.output});
  Work work({options.quiet, 0, {}});
  Report report = read_report(options.folders);
  report.machine = machine_record(work.threads());
  report.clock = options.clock;
  const std::string page = report_page(report);
  write_text(options.output, page);
  work.print(fmt::format("{}: {} sweeps and {} figures, {}", options.output, report.sweeps.size(),
                         report.figures.size(), bytes_text(static_cast<double>(page.size()))));
}

}  // namespace

std::function<void()> declare_report_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option("DIR", options->folders,
                 "folders that tradeoff and reproduce wrote (--out), one or more (required)")
      ->required();
  add_file(app, "-o,--output", "FILE.html", options->output, "page to write (required)", ".html")
      ->required();
  add_choice(app, "--time", options->clock, {{"wall", FrameClock::wall}, {"cpu", FrameClock::cpu}},
             "clock of the plots and fronts: cpu where the machine did other things, too");
  app.add_flag("-q,--quiet", options->quiet, "print errors only");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
