#include "material_options.h"

#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "burnish/formats/material_names.h"
#include "burnish/material/presets.h"
#include "common/options.h"
#include "common/program.h"

namespace burnish::tools {
namespace {

/// The models as --material names them, with their distributions.
struct ModelName {
  const char* name;
  SpecularModel model;
  Distribution distribution = Distribution::ggx;
};
constexpr std::array kModels = {
    ModelName{"diffuse", SpecularModel::none},
    ModelName{"ward", SpecularModel::ward},
    ModelName{"ward-balanced", SpecularModel::ward_balanced},
    ModelName{"ashikhmin", SpecularModel::ashikhmin_shirley},
    ModelName{"ggx", SpecularModel::cook_torrance, Distribution::ggx},
    ModelName{"beckmann", SpecularModel::cook_torrance, Distribution::beckmann},
    ModelName{"blinn-phong", SpecularModel::cook_torrance, Distribution::blinn_phong},
    ModelName{"ashikhmin-shirley", SpecularModel::ashikhmin_shirley},
    ModelName{"cook-torrance", SpecularModel::cook_torrance}};

template <class Names, class NameOf>
std::string list_of(const Names& names, const NameOf& name_of) {
  std::string list;
  for (const auto& name : names) list += (list.empty() ? "" : ", ") + std::string(name_of(name));
  return list;
}

std::string model_list() {
  return list_of(kModels, [](const ModelName& model) { return model.name; });
}

std::string preset_list() {
  return list_of(material_presets(), [](const MaterialPreset& preset) { return preset.name; });
}

/// A model as the command line starts with it.
Material plain_material(const ModelName& named) {
  Material material;
  material.model = named.model;
  material.distribution = named.distribution;
  material.alpha_x = 0.3f;
  material.alpha_y = 0.03f;
  if (has_fresnel(named.model))
    material.fresnel.normal_reflectance = Rgb::Constant(0.5f);
  else
    material.specular = Rgb::Constant(0.5f);
  return material;
}

void require_of_model(const char* flag, bool given, bool of_model, SpecularModel model) {
  if (given && !of_model)
    throw UsageError(fmt::format("{}: found with a material of the model '{}', which has none",
                                 flag, name_of(kSpecularModelNames, model)));
}

void require_no_texture(const char* flag, bool given, bool textured) {
  if (given && textured)
    throw UsageError(fmt::format("{}: found with a material that has a texture for it", flag));
}

void check_overrides(const MaterialOptions& options, const MaterialFile& file) {
  const SpecularModel model = file.material.model;
  const MaterialTextures& textures = file.textures;
  const auto check = [&](const char* flag, bool given, bool of_model, bool textured) {
    require_of_model(flag, given, of_model, model);
    require_no_texture(flag, given, textured);
  };
  check("--alpha-x", options.alpha_x.has_value(), has_alpha(model),
        textures.alpha_x || textures.roughness);
  check("--alpha-y", options.alpha_y.has_value(), has_alpha(model),
        textures.alpha_y || textures.roughness);
  check("--diffuse", options.diffuse.has_value(), true, textures.diffuse.has_value());
  check("--specular", options.specular.has_value(), model != SpecularModel::none,
        textures.specular && !has_fresnel(model));
}

void override_material(const MaterialOptions& options, Material& material) {
  if (options.alpha_x) material.alpha_x = *options.alpha_x;
  if (options.alpha_y) material.alpha_y = *options.alpha_y;
  if (options.diffuse) material.diffuse = *options.diffuse;
  if (!options.specular) return;
  if (has_fresnel(material.model)) {
    material.fresnel.model = FresnelModel::schlick;
    material.fresnel.normal_reflectance = *options.specular;
  } else {
    material.specular = *options.specular;
  }
}

const ModelName* find_model(const std::string& name) {
  for (const ModelName& model : kModels)
    if (name == model.name) return &model;
  return nullptr;
}

/// A preset or a file; nothing if it is neither.
std::optional<MaterialFile> find_material(const std::string& name) {
  if (lower_extension(name) == ".json") return read_material_file(name);
  if (const MaterialPreset* preset = find_material_preset(name)) {
    MaterialFile file;
    file.name = preset->name;
    file.source = preset->source;
    file.material = preset->material;
    return file;
  }
  std::error_code ignored;
  if (std::filesystem::is_regular_file(name, ignored)) return read_material_file(name);
  return {};
}

}  // namespace

void add_material_options(CLI::App& app, MaterialOptions& options) {
  add_file(app, "--material", "MATERIAL", options.name,
           fmt::format("a material file (.json), a preset (burnish info --materials lists them), "
                       "or a model: {} (default {})",
                       model_list(), options.name));
  // The defaults are those of plain_material.
  const std::string own = " with a model's name, else the material's own";
  const Range<float> range = {kMinAlpha, kMaxAlpha};
  add_number(app, "--alpha-x", "A", options.alpha_x, range, "roughness (slope) along the tangent",
             "0.3" + own);
  add_number(app, "--alpha-y", "A", options.alpha_y, range, "roughness (slope) across the tangent",
             "0.03" + own);
  add_color(app, "--diffuse", options.diffuse, "diffuse albedo, linear", "0.5,0.5,0.5" + own);
  add_color(app, "--specular", options.specular,
            "linear: specular scale (ward, ward-balanced, fitted), or reflectance at normal "
            "incidence (ashikhmin, ggx, beckmann, blinn-phong)",
            "0.5,0.5,0.5" + own);
}

MaterialFile load_named_material(const std::string& name) {
  if (const auto material = find_material(name)) return *material;
  throw UsageError(
      fmt::format("found '{}', expected a file or a preset material ({})", name, preset_list()));
}

MaterialFile load_material(const MaterialOptions& options) {
  MaterialFile file;
  if (const ModelName* model = find_model(options.name)) {
    file.name = model->name;
    file.material = plain_material(*model);
  } else if (const auto material = find_material(options.name)) {
    file = *material;
  } else {
    throw UsageError(fmt::format(
        "--material: found '{}', expected a file (.json), a model ({}) or a preset ({})",
        options.name, model_list(), preset_list()));
  }
  check_overrides(options, file);
  override_material(options, file.material);
  return file;
}

}  // namespace burnish::tools
