#pragma once

#include <vector>

#include "bench.h"

namespace burnish::tools {

/// Rows of what one ASG and rows of SGs miss of Ashikhmin's D, and how many SGs match the ASG: Fig.
/// 8 of xu2013asg. In parallel; Ctrl-C ends it by the Cancelled of throw_if_interrupted().
std::vector<BenchRow> measure_distributions();

}  // namespace burnish::tools
