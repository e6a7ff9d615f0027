#pragma once

/// What the machine can do, to hold a frame's time against.
namespace burnish::tools {

struct MachineLimits {
  double copy_bytes_per_s = 0;     ///< read and written, arrays far beyond the caches
  double multiply_adds_per_s = 0;  ///< of floats, in registers, by the widest instructions
};

/// Measured on as many threads as work runs on; half a second.
MachineLimits measure_limits();

}  // namespace burnish::tools
