#include "common/machine.h"

#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <sys/resource.h>

#include "common/command.h"
#include "version.h"

namespace burnish::tools {

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) {
      const size_t start = line.find_first_not_of(": \t", line.find(':'));
      if (start != std::string::npos) return line.substr(start);
    }
  return "unknown";
}

std::string cpu_isa() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f")) return "avx512";
  if (__builtin_cpu_supports("avx2")) return "avx2";
  if (__builtin_cpu_supports("sse4.2")) return "sse4.2";
#elif defined(__aarch64__)
  return "neon";
#endif
  return "baseline";
}

std::uint64_t peak_memory_bytes() {
  struct rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

nlohmann::ordered_json machine_record(int threads) {
  nlohmann::ordered_json record;
  record["cpu"] = cpu_model();
  record["cores"] = std::thread::hardware_concurrency();
  record["isa"] = cpu_isa();
  record["threads"] = threads;
  record["compiler"] = fmt::format("{} {}", kCompiler, kBuildType);
  record["embree"] = kEmbreeVersion;
  record["version"] = kVersion;
  record["commit"] = kCommit;
  record["command_line"] = this_command_line();
  return record;
}

}  // namespace burnish::tools
