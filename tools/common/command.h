#pragma once

#include <functional>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

#include "burnish/precompute/progress.h"

namespace burnish::tools {

/// One command of a program. `declare` adds its options to an app and returns what runs once they
/// are parsed. What it returns owns the options' values.
struct Command {
  const char* name;
  const char* summary;  ///< one line
  std::function<void()> (*declare)(CLI::App& app);
};

/// A program made of commands. One table serves the dispatch, `help` and `help COMMAND`.
struct Program {
  const char* name;
  const char* summary;  ///< one line
  std::span<const Command> commands;
};

/// Parses the command line, runs the command and returns the exit code.
int run_program(const Program& program, int argc, char** argv);

/// What every command that works for long has in common.
struct CommonOptions {
  bool quiet = false;
  int threads = 0;     ///< 0: as many as the machine has
  std::string report;  ///< JSON file to write, or empty
};

/// Declares --quiet, --threads and --report.
void add_common_options(CLI::App& app, CommonOptions& options);

/// Throws the Error of a file that cannot be written unless each of `paths` can be: its folder
/// exists and takes new files, and the path itself is no folder. Leaves nothing behind and touches
/// no existing file. Empty paths are skipped; two equal paths are a UsageError.
void require_writable(std::span<const std::string> paths);

/// The command line as the shell would read it back.
std::string command_line(int argc, char** argv);

/// That of this process, as run_program got it.
const std::string& this_command_line();

}  // namespace burnish::tools
