#include "common/command.h"

#include <filesystem>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "burnish/formats/output_file.h"
#include "common/options.h"
#include "common/program.h"
#include "version.h"

namespace burnish::tools {
namespace {

std::string command_line_of_this_process;

/// Breaks lines between words, at most `width` columns each where words allow.
std::string wrapped(const std::string& text, size_t width) {
  std::string result, line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!line.empty() && line.size() + 1 + word.size() > width) {
      result += line + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return result + line;
}

/// CLI11's help with wrapped descriptions, and each positional named once.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kTextColumn); }
  std::string make_option_opts(const CLI::Option* option) const override {
    return option->get_positional() ? "" : Formatter::make_option_opts(option);
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(Formatter::make_option_desc(option), kColumns - kTextColumn);
  }

 private:
  static constexpr size_t kTextColumn = 34;
  static constexpr size_t kColumns = 100;
};

const Command* find_command(const Program& program, std::string_view name) {
  for (const Command& command : program.commands)
    if (name == command.name) return &command;
  return nullptr;
}

const Command& require_command(const Program& program, std::string_view name) {
  const Command* command = find_command(program, name);
  if (command != nullptr) return *command;
  std::string names;
  for (const Command& known : program.commands) names += fmt::format(" {}", known.name);
  throw UsageError(fmt::format("unknown command '{}', expected one of{}", name, names));
}

std::string version_text(const Program& program) {
  return fmt::format("{} {} (commit {}, {} {} build, Embree {})", program.name, kVersion, kCommit,
                     kCompiler, kBuildType, kEmbreeVersion);
}

std::string overview(const Program& program) {
  std::string text = fmt::format("{}\n\nUsage: {} COMMAND [OPTIONS]\n\nCommands:\n",
                                 program.summary, program.name);
  for (const Command& command : program.commands)
    text += fmt::format("  {:<12}{}\n", command.name, command.summary);
  text += fmt::format(
      "  {:<12}{}\n\n{} help COMMAND lists its options with their defaults, units and ranges; "
      "--version says what this build is.\n",
      "help", "this text, or a command's options", program.name);
  return text;
}

std::unique_ptr<CLI::App> make_app(const Program& program, const Command& command) {
  auto app =
      std::make_unique<CLI::App>(command.summary, fmt::format("{} {}", program.name, command.name));
  app->set_help_flag("-h,--help", "print this text and exit");
  app->set_version_flag("--version", version_text(program), "print what this build is and exit");
  app->formatter(std::make_shared<HelpFormatter>());
  app->footer(
      "Exit codes: 0 done, 1 usage, 2 input cannot be used, 3 not built in, 4 output cannot be\n"
      "written, 5 a check failed, 130 interrupted.");
  return app;
}

void run_command(const Program& program, const Command& command, int argc, char** argv) {
  const auto app = make_app(program, command);
  const std::function<void()> run = command.declare(*app);
  try {
    app->parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    fmt::print("{}", app->help());
    return;
  } catch (const CLI::CallForVersion&) {
    fmt::print("{}\n", version_text(program));
    return;
  } catch (const CLI::ParseError& error) {
    throw UsageError(
        fmt::format("{} (see {} help {})", one_line(error.what()), program.name, command.name));
  }
  run();
}

void print_help(const Program& program, int argc, char** argv) {
  if (argc < 3) {
    fmt::print("{}", overview(program));
    return;
  }
  const Command& command = require_command(program, argv[2]);
  const auto app = make_app(program, command);
  const auto run = command.declare(*app);
  fmt::print("{}", app->help());
}

void dispatch(const Program& program, int argc, char** argv) {
  if (argc < 2) {
    fmt::print("{}", overview(program));
    throw UsageError("no command given, expected one of those above");
  }
  const std::string_view first = argv[1];
  if (first == "help" || first == "--help" || first == "-h") {
    print_help(program, argc, argv);
  } else if (first == "--version") {
    fmt::print("{}\n", version_text(program));
  } else {
    run_command(program, require_command(program, first), argc - 1, argv + 1);
  }
}

}  // namespace

int run_program(const Program& program, int argc, char** argv) {
  command_line_of_this_process = command_line(argc, argv);
  const bool has_command = argc >= 2 && find_command(program, argv[1]) != nullptr;
  const std::string name =
      has_command ? fmt::format("{} {}", program.name, argv[1]) : std::string(program.name);
  return run_guarded(name, [&] { dispatch(program, argc, argv); });
}

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.add_flag("--quiet,-q", options.quiet, "print errors only: no progress, no summary");
  add_number(app, "--threads", "N", options.threads, {0, 1024},
             "worker threads, 0 for all of the machine");
  add_file(app, "--report", "FILE.json", options.report,
           "also write figures, options and timings as JSON", ".json");
}

void require_writable(std::span<const std::string> paths) {
  namespace fs = std::filesystem;
  std::set<fs::path> seen;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    std::error_code error;
    if (!seen.insert(fs::weakly_canonical(path, error)).second)
      throw UsageError(fmt::format("{}: named for two outputs, expected different files", path));
    const OutputFile probe(path);
  }
}

std::string command_line(int argc, char** argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                            "0123456789_-+=./,:@%") == std::string_view::npos;
    if (i > 0) line += ' ';
    if (plain) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word)
      if (c == '\'')
        line += "'\\''";
      else
        line += c;
    line += '\'';
  }
  return line;
}

const std::string& this_command_line() { return command_line_of_this_process; }

}  // namespace burnish::tools
