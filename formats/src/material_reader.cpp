#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/material_file.h"
#include "burnish/formats/material_names.h"
#include "burnish/material/roughness.h"
#include "file_bytes.h"
#include "json_values.h"
#include "material_format.h"

namespace burnish {
namespace {

constexpr float kTiny = std::numeric_limits<float>::min();

/// Fails for a field that belongs to other models.
void expect_of_model(const JsonPlace& root, const char* field, bool of_model, SpecularModel model) {
  if (root.has(field) && !of_model)
    root.at(field).fail(
        fmt::format("not a field of the model '{}'", name_of(kSpecularModelNames, model)));
}

void expect_fields_of(const JsonPlace& root, SpecularModel model) {
  const bool microfacets = model == SpecularModel::cook_torrance;
  expect_of_model(root, "specular", model != SpecularModel::none, model);
  for (const char* field : {"alpha", "alpha_x", "alpha_y", "roughness", "tangent_rotation_rad"})
    expect_of_model(root, field, has_alpha(model), model);
  expect_of_model(root, "fresnel", has_fresnel(model), model);
  expect_of_model(root, "distribution", microfacets, model);
  expect_of_model(root, "shadowing", microfacets, model);
  expect_of_model(root, "fitted", model == SpecularModel::fitted, model);
}

/// A field that may be a texture: "texture" and, unless it has its own meaning, scale and offset.
std::optional<TextureFile> read_texture_of(const JsonPlace& root, const char* field,
                                           bool may_scale = true) {
  if (!root.has(field) || !root.at(field).value.is_object()) return {};
  const JsonPlace place = root.at(field);
  if (may_scale)
    place.expect_fields({"texture", "scale", "offset"});
  else
    place.expect_fields({"texture"});
  TextureFile texture;
  texture.file = place.at("texture").string();
  if (texture.file.empty()) place.at("texture").fail("empty, expected a picture file");
  if (place.has("scale")) texture.scale = place.at("scale").float_in(-kMaxFloat, kMaxFloat);
  if (place.has("offset")) texture.offset = place.at("offset").float_in(-kMaxFloat, kMaxFloat);
  return texture;
}

/// A field that is always a texture.
std::optional<TextureFile> require_texture_of(const JsonPlace& root, const char* field,
                                              bool may_scale) {
  if (!root.has(field)) return {};
  if (!root.at(field).value.is_object())
    root.at(field).fail(
        fmt::format("is {}, expected an object with a texture", root.at(field).value.type_name()));
  return read_texture_of(root, field, may_scale);
}

void read_colors(const JsonPlace& root, MaterialFile& file) {
  Material& material = file.material;
  material.diffuse = Rgb::Zero();
  file.textures.diffuse = read_texture_of(root, "diffuse");
  file.textures.specular = read_texture_of(root, "specular");
  if (file.textures.diffuse)
    material.diffuse = Material().diffuse;
  else if (material.model == SpecularModel::none || root.has("diffuse"))
    material.diffuse = read_color_or_grey(root.at("diffuse"), 0, 1);
  if (root.has("specular") && !file.textures.specular)
    material.specular = read_color_or_grey(root.at("specular"), 0, kMaxSpecular);
}

void read_alphas(const JsonPlace& root, MaterialFile& file) {
  Material& material = file.material;
  MaterialTextures& textures = file.textures;
  const bool by_axis = root.has("alpha_x") || root.has("alpha_y");
  if (root.has("alpha") + root.has("roughness") + by_axis != 1)
    root.fail("expected one of 'alpha', 'roughness', and 'alpha_x' with 'alpha_y'");
  const auto read = [&](const char* field, std::optional<TextureFile>& texture, float& alpha) {
    texture = read_texture_of(root, field);
    if (!texture) alpha = root.at(field).float_in(kMinAlpha, kMaxAlpha);
  };
  if (by_axis) {
    read("alpha_x", textures.alpha_x, material.alpha_x);
    read("alpha_y", textures.alpha_y, material.alpha_y);
    return;
  }
  if (root.has("alpha")) {
    read("alpha", textures.alpha_x, material.alpha_x);
    textures.alpha_y = textures.alpha_x;
  } else {
    textures.roughness = read_texture_of(root, "roughness");
    if (!textures.roughness)
      material.alpha_x =
          alpha_from_roughness(root.at("roughness").float_in(kMinRoughness, kMaxRoughness));
  }
  material.alpha_y = material.alpha_x;
}

Fresnel read_fresnel(const JsonPlace& place) {
  place.expect_fields({"normal_reflectance", "eta", "k"});
  expect_one_of(place, "normal_reflectance", "eta");
  Fresnel fresnel;
  if (place.has("normal_reflectance")) {
    if (place.has("k")) place.at("k").fail("beside 'normal_reflectance', expected it with 'eta'");
    fresnel.normal_reflectance = read_color_or_grey(place.at("normal_reflectance"), 0, 1);
    return fresnel;
  }
  fresnel.model = place.has("k") ? FresnelModel::conductor : FresnelModel::dielectric;
  fresnel.eta = read_color_or_grey(place.at("eta"), kMinEta, kMaxEta);
  if (place.has("k")) fresnel.k = read_color_or_grey(place.at("k"), 0, kMaxEta);
  return fresnel;
}

AnisotropicGaussian<float> read_half_vector_lobe(const JsonPlace& place) {
  place.expect_fields({"axis", "tangent", "bandwidth_x", "bandwidth_y", "amplitude"});
  AnisotropicGaussian<float> lobe;
  lobe.frame = read_frame(place.at("axis"), place.at("tangent"));
  lobe.bandwidth_x = place.at("bandwidth_x").float_in(kTiny, kMaxFloat);
  lobe.bandwidth_y = place.at("bandwidth_y").float_in(kTiny, kMaxFloat);
  lobe.amplitude = place.at("amplitude").float_in(0, kMaxFloat);
  return lobe;
}

/// An array of some elements.
template <class Read>
auto read_sized_list(const JsonPlace& root, const char* name, size_t fewest, size_t most,
                     const Read& read) {
  const JsonPlace place = root.at(name);
  place.expect_array();
  if (const size_t size = place.value.size(); size < fewest || size > most)
    place.fail(fmt::format("has {} elements, expected {}..{}", size, fewest, most));
  return read_list(root, name, read);
}

std::shared_ptr<const FittedSpecular> read_fitted(const JsonPlace& place) {
  place.expect_fields({"lobes", "color_by_difference", "masking"});
  auto fitted = std::make_shared<FittedSpecular>();
  fitted->lobes = read_sized_list(place, "lobes", 1, kMaxFittedLobes, read_half_vector_lobe);
  fitted->color_by_difference = read_sized_list(
      place, "color_by_difference", 2, kMaxFittedTable,
      [](const JsonPlace& color) { return read_color_or_grey(color, 0, kMaxFloat); });
  fitted->masking =
      read_sized_list(place, "masking", 2, kMaxFittedTable,
                      [](const JsonPlace& value) { return value.float_in(0, kMaxFloat); });
  return fitted;
}

void read_model(const JsonPlace& root, MaterialFile& file) {
  Material& material = file.material;
  material.model = read_choice(root.at("model"), kSpecularModelNames);
  expect_fields_of(root, material.model);
  read_colors(root, file);
  if (has_alpha(material.model)) read_alphas(root, file);
  if (has_fresnel(material.model)) material.fresnel = read_fresnel(root.at("fresnel"));
  if (root.has("distribution"))
    material.distribution = read_choice(root.at("distribution"), kDistributionNames);
  if (root.has("shadowing"))
    material.shadowing = read_choice(root.at("shadowing"), kShadowingNames);
  if (material.model == SpecularModel::fitted) material.fitted = read_fitted(root.at("fitted"));
  // What reads is what shades.
  if (const std::string error = domain_error(material); !error.empty()) root.fail(error);
}

}  // namespace

MaterialFile parse_material(std::string_view json, const std::string& subject) {
  const nlohmann::json document = parse_json(json, subject);
  const JsonPlace root{document, nlohmann::json::json_pointer(), json, subject};
  read_format_version(root, kMaterialFormat);
  root.expect_fields({"format", "format_version", "name", "source", "fit_relative_l2", "model",
                      "diffuse", "specular", "alpha", "alpha_x", "alpha_y", "roughness", "fresnel",
                      "distribution", "shadowing", "fitted", "tangent_rotation_rad", "normal",
                      "wrap"});
  MaterialFile file;
  if (root.has("name")) file.name = root.at("name").string();
  if (root.has("source")) file.source = root.at("source").string();
  file.fit_relative_l2 = read_fit_error(root, "fit_relative_l2");
  read_model(root, file);
  MaterialTextures& textures = file.textures;
  textures.tangent_rotation_rad = require_texture_of(root, "tangent_rotation_rad", true);
  textures.normal = require_texture_of(root, "normal", false);
  if (root.has("wrap")) {
    if (textures.empty()) root.at("wrap").fail("without a texture");
    textures.wrap = read_choice(root.at("wrap"), kTextureWrapNames);
  }
  return file;
}

MaterialFile read_material_file(const std::string& path) {
  return parse_material(read_file_bytes(path), path);
}

Material read_material(const std::string& path) {
  const MaterialFile file = read_material_file(path);
  if (!file.textures.empty())
    throw Error(ErrorKind::unsupported, path, "has textures, expected one material everywhere");
  return file.material;
}

}  // namespace burnish
