#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "burnish/material/material.h"

namespace burnish {

/// Version of the material format that this build writes, and the newest that it reads.
inline constexpr int kMaterialFormatVersion = 1;

/// A material as it is stored.
struct MaterialFile {
  std::string name;                       ///< for people; may be empty
  std::string source;                     ///< where its numbers come from; may be empty
  std::optional<double> fit_relative_l2;  ///< of a fit to a measurement: its error, >= 0
  Material material;
};

/// Reads a JSON material file (formats/FORMAT.md). Unknown fields, fields that the material's model
/// does not use and bad values are refused with their JSON path and line.
MaterialFile read_material_file(const std::string& path);

/// Writes a material file; float values are exact (shortest form that reads back equal). What the
/// material's model does not use is left out. Throws Error(ErrorKind::output), also for values that
/// read_material_file would refuse.
void write_material_file(const MaterialFile& material, const std::string& path);

/// The same, of the material alone.
/// @{
Material read_material(const std::string& path);
void write_material(const Material& material, const std::string& path);
/// @}

/// The same without a file: `subject` stands for the file's name in errors.
/// @{
MaterialFile parse_material(std::string_view json, const std::string& subject);
std::string format_material(const MaterialFile& material, const std::string& subject);
/// @}

}  // namespace burnish
