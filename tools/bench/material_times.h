#pragma once

#include <vector>

#include "bench.h"

namespace burnish::tools {

/// Rows of the ns on one core: of a warped lobe, in batches for one material, on the best
/// instruction set and on AVX2; of a lobe of a slice; of preparing a material. Medians over the
/// repetitions, of 20 ms each. May be called once in a process, as it calls time_benchmarks.
std::vector<BenchRow> measure_material_times(int repetitions);

}  // namespace burnish::tools
