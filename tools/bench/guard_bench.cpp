#include <fmt/format.h>

#include "common/machine.h"
#include "common/options.h"
#include "common/program.h"
#include "common/work.h"
#include "stations.h"
#include "tradeoff/guard.h"

namespace burnish::tools {
namespace {

struct Options {
  bool update = false;
  std::string file;
  CommonOptions common;
};

std::string origin(int threads) {
  const nlohmann::ordered_json record = machine_record(threads);
  return fmt::format("by burnish-bench guard update: commit {}, {}, {}, {}",
                     record["commit"].get<std::string>(), record["cpu"].get<std::string>(),
                     record["isa"].get<std::string>(), record["compiler"].get<std::string>());
}

void run(const Options& options) {
  Work work(options.common);
  if (options.update) require_writable(std::array{options.file});
  const GuardFile expected = options.update ? GuardFile{} : read_guard(options.file);
  const std::vector<GuardError> found = measure_guard(work.progress());
  if (options.update) {
    write_guard({origin(work.threads()), found}, options.file);
    work.print(fmt::format("{}: {} errors written", options.file, found.size()));
    return;
  }
  const GuardVerdict verdict = compare_guard(expected.errors, found);
  for (const std::string& line : verdict.better) work.print("better: " + line);
  for (const std::string& line : verdict.worse) work.print("worse: " + line);
  for (const std::string& line : verdict.unmatched) work.print(line);
  if (!verdict.holds())
    throw CheckFailed(
        fmt::format("{}: {} errors are worse than expected and {} have no counterpart; if it is "
                    "meant, run `burnish-bench guard update` and say why in the commit",
                    options.file, verdict.worse.size(), verdict.unmatched.size()));
  work.print(fmt::format("{}: {} errors are as expected ({})", options.file, found.size(),
                         expected.origin));
}

}  // namespace

std::function<void()> declare_guard_bench(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  app.add_option_function<std::string>(
         "ACTION", [options](const std::string& word) { options->update = word == "update"; },
         "compare: fails where an error is above what FILE.csv has; update: writes FILE.csv anew")
      ->required()
      ->option_text("compare|update")
      ->check(CLI::IsMember({"compare", "update"}));
  add_file(app, "FILE", "FILE.csv", options->file,
           "expected errors (required): the project's own are tests/data/guard.csv")
      ->required();
  add_common_options(app, options->common);
  return [options] { run(*options); };
}

}  // namespace burnish::tools
