#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/material_file.h"
#include "burnish/formats/material_names.h"
#include "burnish/formats/output_file.h"
#include "material_format.h"

namespace burnish {
namespace {

std::string format_fresnel(const Fresnel& fresnel) {
  switch (fresnel.model) {
    case FresnelModel::schlick:
      return fmt::format("{{\"normal_reflectance\": {}}}",
                         format_vector(fresnel.normal_reflectance));
    case FresnelModel::dielectric:
      return fmt::format("{{\"eta\": {}}}", format_vector(fresnel.eta));
    case FresnelModel::conductor:
      break;
  }
  return fmt::format("{{\"eta\": {}, \"k\": {}}}", format_vector(fresnel.eta),
                     format_vector(fresnel.k));
}

std::string format_lobe(const AnisotropicGaussian<float>& lobe) {
  return fmt::format(
      "{{\"axis\": {}, \"tangent\": {}, \"bandwidth_x\": {}, \"bandwidth_y\": {}, "
      "\"amplitude\": {}}}",
      format_vector(lobe.frame.z), format_vector(lobe.frame.x), lobe.bandwidth_x, lobe.bandwidth_y,
      lobe.amplitude);
}

std::string format_fitted(const FittedSpecular& fitted) {
  const auto color = [](const Rgb& rgb) { return format_vector(rgb); };
  const auto number = [](float value) { return fmt::format("{}", value); };
  return "{\n" + format_list("lobes", fitted.lobes, format_lobe, "    ") + ",\n" +
         format_list("color_by_difference", fitted.color_by_difference, color, "    ") + ",\n" +
         format_list("masking", fitted.masking, number, "    ") + "\n  }";
}

std::string format_texture(const TextureFile& texture) {
  std::string text = fmt::format("{{\"texture\": {}", json_string(texture.file));
  if (texture.scale != 1) text += fmt::format(", \"scale\": {}", texture.scale);
  if (texture.offset != 0) text += fmt::format(", \"offset\": {}", texture.offset);
  return text + "}";
}

/// The fields of the model, as "name": text.
std::vector<std::string> format_fields(const MaterialFile& file) {
  const Material& material = file.material;
  std::vector<std::string> fields;
  const auto add = [&](const char* name, const std::string& text) {
    fields.push_back(fmt::format("\"{}\": {}", name, text));
  };
  const auto add_name = [&](const char* name, const char* value) { add(name, json_string(value)); };
  add_name("format", kMaterialFormat.name);
  add("format_version", std::to_string(kMaterialFormatVersion));
  add("name", json_string(file.name));
  add("source", json_string(file.source));
  if (file.fit_relative_l2) add("fit_relative_l2", fmt::format("{}", *file.fit_relative_l2));
  add_name("model", name_of(kSpecularModelNames, material.model));
  const MaterialTextures& textures = file.textures;
  const auto add_value = [&](const char* name, const std::optional<TextureFile>& texture,
                             const std::string& value) {
    add(name, texture ? format_texture(*texture) : value);
  };
  const auto add_texture = [&](const char* name, const std::optional<TextureFile>& texture) {
    if (texture) add(name, format_texture(*texture));
  };
  add_value("diffuse", textures.diffuse, format_vector(material.diffuse));
  if (material.model != SpecularModel::none)
    add_value("specular", textures.specular, format_vector(material.specular));
  if (has_alpha(material.model) && !textures.roughness) {
    add_value("alpha_x", textures.alpha_x, fmt::format("{}", material.alpha_x));
    add_value("alpha_y", textures.alpha_y, fmt::format("{}", material.alpha_y));
  }
  add_texture("roughness", textures.roughness);
  add_texture("tangent_rotation_rad", textures.tangent_rotation_rad);
  add_texture("normal", textures.normal);
  if (!textures.empty()) add_name("wrap", name_of(kTextureWrapNames, textures.wrap));
  if (material.model == SpecularModel::cook_torrance) {
    add_name("distribution", name_of(kDistributionNames, material.distribution));
    add_name("shadowing", name_of(kShadowingNames, material.shadowing));
  }
  if (has_fresnel(material.model)) add("fresnel", format_fresnel(material.fresnel));
  if (material.model == SpecularModel::fitted && material.fitted)
    add("fitted", format_fitted(*material.fitted));
  return fields;
}

}  // namespace

std::string format_material(const MaterialFile& file, const std::string& subject) {
  std::string text;
  for (const std::string& field : format_fields(file))
    text += (text.empty() ? "{\n  " : ",\n  ") + field;
  text += "\n}\n";
  require_readable(subject, "this material", [&] { parse_material(text, subject); });
  return text;
}

void write_material_file(const MaterialFile& material, const std::string& path) {
  const std::string text = format_material(material, path);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

void write_material(const Material& material, const std::string& path) {
  MaterialFile file;
  file.material = material;
  write_material_file(file, path);
}

}  // namespace burnish
