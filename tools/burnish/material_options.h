#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "burnish/formats/material_file.h"

namespace burnish::tools {

/// A material by name, and what the command line changes of it.
struct MaterialOptions {
  std::string name = "ward";  ///< of a model, a preset or a .json file
  std::optional<float> alpha_x;
  std::optional<float> alpha_y;
  std::optional<Rgb> diffuse;
  std::optional<Rgb> specular;
};

/// Declares --material and what overrides it.
void add_material_options(CLI::App& app, MaterialOptions& options);

/// The material that `name` stands for: a preset, or else a file. Throws UsageError, which lists
/// the presets, for what is neither.
MaterialFile load_named_material(const std::string& name);

/// The material of the options. Throws UsageError where they do not fit its model.
MaterialFile load_material(const MaterialOptions& options);

}  // namespace burnish::tools
