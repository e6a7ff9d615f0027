#pragma once

#include <vector>

#include "bench.h"
#include "shade_subjects.h"

/// The tables of the shade station. Each returns its rows, whose "what" is its name.
namespace burnish::tools {

struct ShadeBench {
  ShadeScene& scene;
  const SubjectOptions& subject;
  const BenchOptions& options;
  Work& work;
};

/// Times and errors of the frame by quality; errors where the subject's reference_samples > 0.
std::vector<BenchRow> frame_table(const ShadeBench& bench);
/// The frame against what the machine can do, and with one part switched off each.
std::vector<BenchRow> bound_table(const ShadeBench& bench);
/// The frame on each instruction set that this processor has.
std::vector<BenchRow> targets_table(const ShadeBench& bench);
/// What a scene that needs less costs.
std::vector<BenchRow> short_table(const ShadeBench& bench);
/// Bytes that grow with the vertices.
std::vector<BenchRow> memory_table(const ShadeBench& bench);

/// Stand-ins for the scenes of xu2013asg, Table 1, beside its frames per second.
std::vector<BenchRow> table1(const ShadeBench& bench);
/// Cost of a vertex from 10k to 1M vertices.
std::vector<BenchRow> growth_table(const ShadeBench& bench);

/// A 720 x 480 picture shaded by pixel, apart from its primary rays.
std::vector<BenchRow> pixels_table(const ShadeBench& bench);
/// Time of the reference integrator over the frame's, at equal error.
std::vector<BenchRow> monte_carlo_table(const ShadeBench& bench);

}  // namespace burnish::tools
