#include <array>
#include <filesystem>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "burnish/formats/image_file.h"
#include "burnish/formats/light_file.h"
#include "burnish/formats/mesh_file.h"
#include "burnish/formats/transfer_file.h"
#include "commands.h"
#include "common/options.h"

namespace burnish::tools {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string file;
  bool json = false;
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

Json transfer_info(const std::string& path) {
  const Transfer transfer = read_transfer(path);
  const Provenance& made = transfer.provenance;
  Json info = {{"kind", "transfer"}, {"file", path}, {"format", "HDF5"}};
  info["file_bytes"] = std::filesystem::file_size(path);
  info["vertices"] = transfer.vertex_count();
  info["triangles"] = transfer.triangles.size();
  info["occluder_triangles"] = transfer.occluder_triangles.size();
  info["bases"] = transfer.bases.size();
  info["resolution"] = transfer.bases.empty() ? 0 : transfer.bases.front().resolution;
  info["terms"] = transfer.terms();
  info["version"] = made.version;
  info["mesh_name"] = made.mesh_name;
  info["mesh_hash"] = made.mesh_hash;
  info["occluder_hash"] = made.occluder_hash;
  info["directions"] = made.directions;
  info["training_vertices"] = made.training_vertices;
  info["rays"] = made.rays;
  info["residual_rms_rad"] = made.residual_rms_rad;
  info["wrong_sign_fraction"] = made.wrong_sign_fraction;
  return info;
}

Json lights_info(const std::string& path) {
  const LightFile file = read_lights(path);
  Json info = {{"kind", "lights"}, {"file", path}, {"format", "JSON"}};
  info["name"] = file.name;
  info["source"] = file.source;
  info["lobes"] = file.rig.lobes.size();
  info["sphere_lights"] = file.rig.spheres.size();
  info["fit_relative_l2"] = file.fit_relative_l2 ? Json(*file.fit_relative_l2) : Json();
  // What the lobes give a white diffuse surface in the open, averaged over all normals, is a
  // quarter of this.
  Rgb power = Rgb::Zero();
  for (const EnvironmentLobe& light : file.rig.lobes) power += light.color * integral(light.lobe);
  info["radiance_integral"] = vector_json(power.matrix());
  return info;
}

bool starts_as_image(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> magic = {};
  file.read(magic.data(), magic.size());
  const std::string_view head(magic.data(), magic.size());
  return head == "\x76\x2f\x31\x01" || head.starts_with("#?");
}

Json file_info(const Options& options) {
  const std::string extension = lower_extension(options.file);
  if (is_hdf5_file(options.file) || extension == ".h5") return transfer_info(options.file);
  if (starts_as_image(options.file) || extension == ".exr" || extension == ".hdr" ||
      extension == ".pic")
    return image_info(options.file);
  if (extension == ".json") return lights_info(options.file);
  return mesh_info(options.file, options.reading);
}

/// A value as a person reads it: no quotes, lists with commas.
std::string value_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_null()) return "-";
  if (value.is_number_float()) return fmt::format("{:g}", value.get<double>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (!value.is_array()) return value.dump();
  std::string text;
  for (const Json& element : value) text += (text.empty() ? "" : ", ") + value_text(element);
  return text;
}

void print_text(const Json& info) {
  for (const auto& [key, value] : info.items()) {
    if (key == "notes") continue;
    std::string label = key;
    for (char& c : label)
      if (c == '_') c = ' ';
    fmt::print("{:<22}{}\n", label, value_text(value));
  }
  if (info.contains("notes"))
    for (const Json& note : info["notes"]) fmt::print("note: {}\n", note.get<std::string>());
}

void run(const Options& options) {
  const Json info = file_info(options);
  if (options.json)
    fmt::print("{}\n", info.dump(2, ' ', false, Json::error_handler_t::replace));
  else
    print_text(info);
}

}  // namespace

std::function<void()> declare_info(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  add_file(app, "FILE", "FILE", options->file,
           "mesh (.obj .ply .off .stl), picture (.exr .hdr), transfer (.h5) or lights (.json) "
           "(required)")
      ->required();
  app.add_flag("--json", options->json, "print JSON, with the same fields (default: text)");
  return [options] { run(*options); };
}

}  // namespace burnish::tools
