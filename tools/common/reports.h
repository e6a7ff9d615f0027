#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "burnish/precompute/bake.h"
#include "harness/error_metrics.h"
#include "harness/render.h"

/// Figures as the commands give them: for --report, and in a line or two for people.
namespace burnish::tools {

/// `bytes` is the size of the transfer file.
nlohmann::ordered_json bake_report(const Transfer& transfer, const BakeOptions& options,
                                   const BakeTimings& timings, std::uint64_t bytes);
std::string bake_summary(const Transfer& transfer, const BakeTimings& timings);

nlohmann::ordered_json frame_report(const PrimaryHits& hits, const RenderTimings& timings);
std::string frame_summary(const std::string& file, const PrimaryHits& hits,
                          const RenderTimings& timings);

nlohmann::ordered_json error_report(const RelativeL2& error);
std::string error_summary(const RelativeL2& error);

}  // namespace burnish::tools
