#include "common/program.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/progress.h"
#include "common/interrupt.h"

namespace burnish::tools {
namespace {

int exit_code(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::input:
      return kExitInput;
    case ErrorKind::unsupported:
      return kExitUnsupported;
    case ErrorKind::output:
      return kExitOutput;
  }
  return kExitInternal;
}

int fail(const std::string& name, std::string_view what, int code) {
  fmt::print(stderr, "{}: {}\n", name, one_line(what));
  return code;
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string line(text);
  while (!line.empty() && line.back() == '\n') line.pop_back();
  for (char& c : line)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = c == '\n' ? ' ' : '?';
  return line;
}

int run_guarded(const std::string& name, const std::function<void()>& work) {
  try {
    work();
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw Error(ErrorKind::output, "standard output",
                  fmt::format("cannot be written ({})", std::strerror(errno)));
    return kExitOk;
  } catch (const UsageError& error) {
    return fail(name, error.what(), kExitUsage);
  } catch (const CheckFailed& error) {
    return fail(name, error.what(), kExitCheck);
  } catch (const Cancelled& cancelled) {
    const int signal_number = interrupted();
    return fail(name, cancelled.what(), 128 + signal_number);
  } catch (const Error& error) {
    return fail(name, error.what(), exit_code(error.kind()));
  } catch (const std::bad_alloc&) {
    return fail(name, "out of memory", kExitInput);
  } catch (const std::exception& error) {
    return fail(name, fmt::format("internal error: {}", error.what()), kExitInternal);
  }
}

}  // namespace burnish::tools
