#pragma once

#include "common/command.h"

/// The stations, one source file each. What each measures is in its help text.
namespace burnish::tools {

std::function<void()> declare_bake_bench(CLI::App& app);
std::function<void()> declare_guard_bench(CLI::App& app);
std::function<void()> declare_light_bench(CLI::App& app);
std::function<void()> declare_material_bench(CLI::App& app);
std::function<void()> declare_presets_bench(CLI::App& app);
std::function<void()> declare_promise_bench(CLI::App& app);
std::function<void()> declare_report_bench(CLI::App& app);
std::function<void()> declare_reproduce_bench(CLI::App& app);
std::function<void()> declare_rivals_bench(CLI::App& app);
std::function<void()> declare_shade_bench(CLI::App& app);
std::function<void()> declare_sphere_bench(CLI::App& app);
std::function<void()> declare_tradeoff_bench(CLI::App& app);

}  // namespace burnish::tools
