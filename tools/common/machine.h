#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

namespace burnish::tools {

/// The processor's name as the system gives it, or "unknown".
std::string cpu_model();

/// The widest SIMD extension of the processor that this program may dispatch to: "avx512", "avx2",
/// "sse4.2", "neon" or "baseline".
std::string cpu_isa();

/// The most memory that this process has held so far.
std::uint64_t peak_memory_bytes();

/// What every figure must be read with: machine, ISA, threads, compiler, version, commit and
/// command line.
nlohmann::ordered_json machine_record(int threads);

}  // namespace burnish::tools
