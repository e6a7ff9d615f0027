#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace burnish::tools {

/// Exit codes of all programs.
enum ExitCode {
  kExitOk = 0,
  kExitUsage = 1,        ///< the command line cannot be understood
  kExitInput = 2,        ///< a file or its contents cannot be used
  kExitUnsupported = 3,  ///< something this build does not have
  kExitOutput = 4,       ///< a result could not be written
  kExitCheck = 5,        ///< a check that was asked for failed
  kExitInternal = 70,    ///< a fault of the program itself
};                       // and 128 + the signal's number after SIGINT or SIGTERM

/// The command line asks for something that does not make sense.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A check that was asked for failed.
class CheckFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Text on one line: control characters (a file name may hold any) become '?'.
std::string one_line(std::string_view text);

/// Runs `work` and flushes stdout. An exception becomes one line "name: what" on stderr and its
/// exit code.
int run_guarded(const std::string& name, const std::function<void()>& work);

}  // namespace burnish::tools
