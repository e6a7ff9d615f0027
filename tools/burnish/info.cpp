#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/image_file.h"
#include "burnish/formats/json_kind.h"
#include "burnish/formats/light_file.h"
#include "burnish/formats/mesh_file.h"
#include "burnish/formats/transfer_file.h"
#include "commands.h"
#include "common/options.h"
#include "common/program.h"
#include "harness/transfer_picture.h"
#include "material_info.h"
#include "material_options.h"

namespace burnish::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string file;
  bool materials = false;
  bool json = false;
  std::string png;
  MeshReadOptions reading;
};

Json vector_json(const Vector3f& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json mesh_info(const std::string& path, const MeshReadOptions& options) {
  MeshReport report;
  read_mesh(path, options, &report);
  const MeshStatistics& mesh = report.statistics;
  Json info = {{"kind", "mesh"}, {"file", path}, {"format", report.format}};
  info["file_vertices"] = report.file_vertices;
  info["file_faces"] = report.file_faces;
  info["loaded_faces"] = report.loaded_faces;
  info["short_faces"] = report.short_faces;
  info["triangulated_faces"] = report.triangulated_faces;
  info["degenerate_triangles"] = report.degenerate_triangles;
  info["vertices"] = mesh.vertices;
  info["triangles"] = mesh.triangles;
  info["components"] = mesh.components;
  info["boundary_edges"] = mesh.boundary_edges;
  info["non_manifold_edges"] = mesh.non_manifold_edges;
  info["inconsistent_edges"] = mesh.inconsistent_edges;
  info["duplicate_vertices"] = mesh.duplicate_vertices;
  info["split_vertices"] = mesh.split_vertices;
  info["unused_vertices"] = mesh.unused_vertices;
  info["has_normals"] = report.has_normals;
  info["missing_normals"] = report.missing_normals;
  info["invalid_normals"] = report.invalid_normals;
  info["has_uvs"] = report.has_uvs;
  info["missing_uvs"] = report.missing_uvs;
  info["uv_tangents"] = report.uv_tangents;
  info["ignored_elements"] = report.ignored_elements;
  info["bounds_min"] = mesh.bounds.isEmpty() ? Json() : vector_json(mesh.bounds.min());
  info["bounds_max"] = mesh.bounds.isEmpty() ? Json() : vector_json(mesh.bounds.max());
  info["notes"] = report.notes;
  return info;
}

Json image_info(const std::string& path) {
  ImageReport report;
  read_image(path, &report);
  Json info = {{"kind", "image"}, {"file", path}, {"format", report.format}};
  info["storage"] = report.storage;
  info["compression"] = report.compression;
  info["channels"] = report.channels;
  info["width"] = report.width;
  info["height"] = report.height;
  info["min"] = report.min;
  info["max"] = report.max;
  info["mean"] = report.mean;
  info["nan_values"] = report.nan_values;
  info["infinite_values"] = report.infinite_values;
  info["negative_values"] = report.negative_values;
  info["notes"] = report.notes;
  return info;
}

Json lobe_errors_json(const std::vector<LobeError>& errors) {
  Json list = Json::array();
  for (const LobeError& error : errors)
    list.push_back({{"bandwidth", error.bandwidth}, {"relative_rms", error.relative_rms}});
  return list;
}

Json parts_json(const std::vector<MeshPart>& parts) {
  Json list = Json::array();
  for (const MeshPart& part : parts)
    list.push_back(
        {{"name", part.name}, {"vertices", part.vertices}, {"triangles", part.triangles}});
  return list;
}

void add_visibility(const Transfer& transfer, Json& info) {
  info["bases"] = transfer.bases.size();
  std::vector<std::size_t> vertices(transfer.bases.size());
  for (const std::uint8_t id : transfer.basis_id) ++vertices[id];
  info["basis_vertices"] = vertices;
  info["resolution"] = transfer.bases.empty() ? 0 : transfer.bases.front().resolution;
  info["terms"] = transfer.terms();
  info["amplitude_rad"] = transfer.bases.empty() ? 0 : transfer.bases.front().amplitude_rad;
  const bool has_ladder = !transfer.ladder_bases.empty();
  info["ladder_bases"] = transfer.ladder_bases.size();
  info["ladder_bands"] = has_ladder ? transfer.ladder_bases.front().bands : 0;
  info["ladder_terms"] = transfer.ladder_terms();
  info["ladder_crossover"] = transfer.ladder_crossover;
}

void add_provenance(const Provenance& made, Json& info) {
  info["version"] = made.version;
  info["mesh_name"] = made.mesh_name;
  info["mesh_hash"] = made.mesh_hash;
  info["occluder_hash"] = made.occluder_hash;
  info["directions"] = made.directions;
  info["coarsest"] = made.coarsest;
  info["origin_offset"] = made.origin_offset;
  info["training_vertices"] = made.training_vertices;
  info["rays"] = made.rays;
  info["residual_vertices"] = made.residual_vertices;
  info["residual_held_out"] = made.residual_held_out;
  info["residual_rms_rad"] = made.residual_rms_rad;
  info["wrong_sign_fraction"] = made.wrong_sign_fraction;
  info["ssdf_errors"] = lobe_errors_json(made.ssdf_errors);
  info["ladder_errors"] = lobe_errors_json(made.ladder_errors);
}

Json transfer_info(const std::string& path, const std::string& png) {
  const Transfer transfer = read_transfer(path);
  Json info = {{"kind", "transfer"}, {"file", path}, {"format", "HDF5"}};
  info["file_bytes"] = std::filesystem::file_size(path);
  info["vertices"] = transfer.vertex_count();
  info["triangles"] = transfer.triangles.size();
  info["occluder_triangles"] = transfer.occluder_triangles.size();
  info["has_uvs"] = !transfer.texcoords.empty();
  info["parts"] = parts_json(transfer.parts);
  add_visibility(transfer, info);
  add_provenance(transfer.provenance, info);
  if (!png.empty()) write_png(draw_transfer(transfer), png);
  return info;
}

Json lights_info(const std::string& path) {
  const LightFile file = read_lights(path);
  Json info = {{"kind", "lights"}, {"file", path}, {"format", "JSON"}};
  info["name"] = file.name;
  info["source"] = file.source;
  info["lobes"] = file.rig.lobes.size();
  info["directional_lights"] = file.rig.directionals.size();
  info["sphere_lights"] = file.rig.spheres.size();
  info["rectangle_lights"] = file.rig.rectangles.size();
  info["scale"] = file.scale;
  const auto error = [](const auto& value) { return value ? Json(*value) : Json(); };
  info["fit_relative_l2"] = error(file.fit_relative_l2);
  info["fit_irradiance_relative_l2"] = error(file.fit_irradiance_relative_l2);
  // Of the lobes alone, scaled. What they give a white diffuse surface in the open, averaged over
  // all normals, is a quarter of this.
  Rgb power = Rgb::Zero();
  for (const EnvironmentLobe& light : world_lights(file).lobes)
    power += light.color * integral(light.lobe);
  info["lobes_radiance_integral"] = vector_json(power.matrix());
  return info;
}

bool starts_as_image(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> magic = {};
  file.read(magic.data(), magic.size());
  const std::string_view head(magic.data(), magic.size());
  return head == "\x76\x2f\x31\x01" || head.starts_with("#?");
}

/// A material file, or what looks like the name of a preset and is no file.
bool is_material(const std::string& file, const std::string& extension) {
  if (extension == ".json") return read_json_format(file) == "burnish material";
  std::error_code ignored;
  return extension.empty() && !std::filesystem::exists(file, ignored);
}

Json file_info(const Options& options) {
  const std::string extension = lower_extension(options.file);
  if (is_hdf5_file(options.file) || extension == ".h5")
    return transfer_info(options.file, options.png);
  if (is_material(options.file, extension))
    return material_info(options.file, load_named_material(options.file), options.png);
  if (!options.png.empty())
    throw UsageError(
        fmt::format("--png: found {}, expected a transfer or a material", options.file));
  if (starts_as_image(options.file) || extension == ".exr" || extension == ".hdr" ||
      extension == ".pic")
    return image_info(options.file);
  if (extension == ".json") return lights_info(options.file);
  return mesh_info(options.file, options.reading);
}

/// A field's name with spaces.
std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// A value as a person reads it: no quotes, lists with commas.
std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return "-";
  if (value.is_number_float()) return fmt::format("{:g}", value.get<double>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  std::string text;
  if (value.is_object()) {
    for (const auto& [key, field] : value.items())
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", words(key), value_text(field));
    return text;
  }
  if (!value.is_array()) return value.dump();
  for (const Json& element : value) text += (text.empty() ? "" : ", ") + value_text(element);
  return text;
}

void print_text(const Json& info) {
  for (const auto& [key, value] : info.items()) {
    if (key == "notes") continue;
    std::string label = words(key);
    // A line for each object of a list.
    const bool is_table = value.is_array() && !value.empty() && value.front().is_object();
    for (const Json& line : is_table ? value : Json::array({value})) {
      fmt::print("{:<21} {}\n", label, value_text(line));
      label.clear();
    }
  }
  if (info.contains("notes"))
    for (const Json& note : info["notes"]) fmt::print("note: {}\n", note.get<std::string>());
}

void run(const Options& options) {
  require_writable(std::vector{options.png});
  if (options.materials != options.file.empty())
    throw UsageError(options.materials ? "--materials: found a FILE, too, expected one of them"
                                       : "FILE is required");
  if (options.materials && !options.png.empty())
    throw UsageError("--png: found --materials, expected one material");
  const Json info = options.materials ? presets_info() : file_info(options);
  if (options.json)
    fmt::print("{}\n", info.dump(2, ' ', false, Json::error_handler_t::replace));
  else
    print_text(info);
}

}  // namespace

std::function<void()> declare_info(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_file(app, "FILE", "FILE", options->file,
           "mesh (.obj .ply .off .stl), picture (.exr .hdr), transfer (.h5), lights or material "
           "(.json), or the name of a preset material (required)");
  app.add_flag("--materials", options->materials,
               "list the preset materials in place of a file (default: not)");
  app.add_flag("--json", options->json, "print JSON, with the same fields (default: text)");
  add_file(
      app, "--png", "FILE.png", options->png,
      "of a transfer: draw octahedral maps, blue visible, red hidden. First row: the SSDFs of "
      "eight vertices; then of each basis its mean and its leading eigen-SSDFs; then of each "
      "ladder what lobes of bandwidth 1, 2, 4, ..., 128 see on average, and how that changes "
      "along its leading eigenvector. At most eight bases. Of a material: draw what a viewer sees "
      "of its specular part, over the hemisphere from above; a row a view, 0, 30, 60 and 80 "
      "degrees from the normal; exact, as the lobes that shading uses, and ten times the "
      "difference",
      ".png");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
