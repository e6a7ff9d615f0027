#pragma once

#include "common/command.h"

/// The commands of the program, one source file each. What each does is in its help text.
namespace burnish::tools {

std::function<void()> declare_bake(CLI::App& app);
std::function<void()> declare_info(CLI::App& app);
std::function<void()> declare_fit_light(CLI::App& app);
std::function<void()> declare_fit_brdf(CLI::App& app);
std::function<void()> declare_render(CLI::App& app);
std::function<void()> declare_shade(CLI::App& app);
std::function<void()> declare_tune(CLI::App& app);
std::function<void()> declare_demo(CLI::App& app);

}  // namespace burnish::tools
