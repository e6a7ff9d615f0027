#include "material_info.h"

#include <fmt/format.h>

#include "burnish/formats/image_file.h"
#include "burnish/formats/material_names.h"
#include "burnish/material/presets.h"
#include "harness/material_picture.h"

namespace burnish::tools {
namespace {

using Json = nlohmann::ordered_json;

/// A float in its shortest form, not as the double that it is widened to.
Json number(float value) { return Json::parse(fmt::format("{}", value)); }

Json color_json(const Rgb& color) {
  return Json::array({number(color.x()), number(color.y()), number(color.z())});
}

void add_fresnel(const Fresnel& fresnel, Json& info) {
  if (fresnel.model != FresnelModel::schlick) info["eta"] = color_json(fresnel.eta);
  if (fresnel.model == FresnelModel::conductor) info["k"] = color_json(fresnel.k);
  info["normal_reflectance"] = color_json(eval_fresnel(fresnel, 1));
}

/// The fields that the model uses.
void add_parameters(const Material& material, Json& info) {
  info["model"] = name_of(kSpecularModelNames, material.model);
  info["diffuse"] = color_json(material.diffuse);
  if (material.model == SpecularModel::none) return;
  info["specular"] = color_json(material.specular);
  if (has_alpha(material.model)) {
    info["alpha_x"] = number(material.alpha_x);
    info["alpha_y"] = number(material.alpha_y);
  }
  if (material.model == SpecularModel::cook_torrance) {
    info["distribution"] = name_of(kDistributionNames, material.distribution);
    info["shadowing"] = name_of(kShadowingNames, material.shadowing);
  }
  if (has_fresnel(material.model)) add_fresnel(material.fresnel, info);
  if (material.fitted) info["lobes"] = material.fitted->lobes.size();
}

/// The fields that are textures, and their files.
Json textures_json(const MaterialTextures& textures) {
  Json list = Json::object();
  const auto add = [&](const char* name, const std::optional<TextureFile>& texture) {
    if (texture) list[name] = texture->file;
  };
  add("diffuse", textures.diffuse);
  add("specular", textures.specular);
  add("alpha_x", textures.alpha_x);
  add("alpha_y", textures.alpha_y);
  add("roughness", textures.roughness);
  add("tangent_rotation_rad", textures.tangent_rotation_rad);
  add("normal", textures.normal);
  return list;
}

/// As seen from so far that textures are one colour.
Material mean_material(const MaterialFile& file, const std::string& path) {
  if (file.textures.empty()) return file.material;
  const MaterialMaps maps =
      make_material_maps(file.material, read_material_pictures(file, path), file.textures.wrap);
  return material_at(file.material, maps, {.width = 1e6f}, {}).material;
}

Json views_json(const Material& material) {
  Json views = Json::array();
  if (!material.has_specular()) return views;
  for (const SliceError& error : slice_errors(material, {}))
    views.push_back({{"view_deg", error.view_deg},
                     {"albedo", error.albedo},
                     {"lobes_albedo", error.lobes_albedo},
                     {"relative_l2", error.relative_l2}});
  return views;
}

}  // namespace

Json material_info(const std::string& name, const MaterialFile& file, const std::string& png) {
  Json info = {{"kind", "material"}, {"file", name}, {"format", "JSON"}};
  info["name"] = file.name;
  info["source"] = file.source;
  info["fit_relative_l2"] = file.fit_relative_l2 ? Json(*file.fit_relative_l2) : Json();
  const Material material = mean_material(file, name);
  add_parameters(material, info);
  if (!file.textures.empty()) info["textures"] = textures_json(file.textures);
  info["views"] = views_json(material);
  if (!png.empty()) write_png(draw_material_lobes(material, {}), png);
  return info;
}

Json presets_info() {
  Json presets = Json::array();
  for (const MaterialPreset& preset : material_presets()) {
    Json info = {{"name", preset.name}};
    add_parameters(preset.material, info);
    info["source"] = preset.source;
    presets.push_back(info);
  }
  return {{"kind", "presets"}, {"materials", presets}};
}

}  // namespace burnish::tools
