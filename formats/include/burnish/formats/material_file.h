#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "burnish/material/varying_material.h"

namespace burnish {

/// Version of the material format that this build writes, and the newest that it reads.
inline constexpr int kMaterialFormatVersion = 1;

/// A picture that gives a field of a material its values, over UV.
struct TextureFile {
  std::string file;  ///< as the material file has it, relative to its folder
  float scale = 1;   ///< the value is offset + scale * texel
  float offset = 0;
};

/// The fields that are textures.
struct MaterialTextures {
  std::optional<TextureFile> diffuse, specular;
  std::optional<TextureFile> alpha_x, alpha_y;
  std::optional<TextureFile> roughness;  ///< in place of both alphas
  std::optional<TextureFile> tangent_rotation_rad;
  std::optional<TextureFile> normal;  ///< scale 1, offset 0
  TextureWrap wrap = TextureWrap::repeat;

  bool empty() const {
    return !diffuse && !specular && !alpha_x && !alpha_y && !roughness && !tangent_rotation_rad &&
           !normal;
  }
};

/// A material as it is stored.
struct MaterialFile {
  std::string name;                       ///< for people; may be empty
  std::string source;                     ///< where its numbers come from; may be empty
  std::optional<double> fit_relative_l2;  ///< of a fit to a measurement: its error, >= 0
  Material material;                      ///< what has a texture is as in Material{}
  MaterialTextures textures;
};

/// Reads a JSON material file (formats/FORMAT.md). Unknown fields, fields that the material's model
/// does not use and bad values are refused with their JSON path and line.
MaterialFile read_material_file(const std::string& path);

/// Writes a material file; float values are exact (shortest form that reads back equal). What the
/// material's model does not use is left out. Throws Error(ErrorKind::output), also for values that
/// read_material_file would refuse.
void write_material_file(const MaterialFile& material, const std::string& path);

/// Reads the textures of a material file. `path` is the file's own, for relative paths.
MaterialPictures read_material_pictures(const MaterialFile& material, const std::string& path);

/// The same as read_material_file and write_material_file, of the material alone: a file with
/// textures is refused.
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
