#pragma once

#include <CLI/CLI.hpp>

#include "burnish/formats/transfer_file.h"
#include "burnish/precompute/bake.h"
#include "burnish/shading/shade.h"

namespace burnish::tools {

/// Declares the dials of a bake.
void add_bake_options(CLI::App& app, BakeOptions& options);

/// Declares --coefficients.
void add_coefficient_option(CLI::App& app, WriteTransferOptions& options);

/// Throws UsageError where they contradict each other. For before anything is read.
void check_bake_options(const BakeOptions& options);

/// Declares the dials of shading but for `terms`: --quality, which sets them all, and one by one
/// --visibility, --cosine, --integral, --ladder, --split-bandwidth and others. Those given override
/// --quality, whatever the order on the command line; so do those of `options` declared later.
void add_shading_options(CLI::App& app, ShadingOptions& options);

}  // namespace burnish::tools
