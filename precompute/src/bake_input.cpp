#include "bake_input.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <random>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/mesh_frames.h"
#include "burnish/formats/transfer_file.h"
#include "fnv1a.h"

namespace burnish {
namespace {

void check_range(const char* name, int value, int lowest, int highest, bool power_of_two = false) {
  if (value < lowest || value > highest ||
      (power_of_two && !std::has_single_bit(static_cast<unsigned>(value))))
    throw Error(ErrorKind::input, "bake",
                fmt::format("{} is {}, expected {}{}..{}", name, value,
                            power_of_two ? "a power of two in " : "", lowest, highest));
}

void check_not_negative(const char* name, double value) {
  if (!(value >= 0) || !std::isfinite(value))
    throw Error(ErrorKind::input, "bake",
                fmt::format("{} is {}, expected a number of at least 0", name, value));
}

/// `count` of `from`, each anywhere in one of as many equal stretches: at even steps they would
/// fall into step with the rows of a regular mesh.
std::vector<std::uint32_t> spread(const std::vector<std::uint32_t>& from, std::uint64_t count) {
  const std::uint64_t all = from.size();
  count = std::min(count, all);
  std::mt19937_64 random(20031027);
  std::vector<std::uint32_t> chosen(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t first = i * all / count, end = (i + 1) * all / count;
    chosen[i] = from[first + random() % (end - first)];
  }
  return chosen;
}

void add_mesh(const TriangleMesh& mesh, Fnv1a& hash) {
  hash.add(std::span(mesh.positions));
  hash.add(std::span(mesh.normals));
  hash.add(std::span(mesh.tangents));
  hash.add(std::span(mesh.triangles));
}

}  // namespace

void check_bake_options(const BakeOptions& options) {
  check_range("directions", options.directions, 64, 1024, true);
  check_range("coarsest", options.coarsest, 16, 1024, true);
  check_range("resolution", options.resolution, 16, options.directions, true);
  check_range("terms", options.terms, 1,
              std::min(kMaxTerms, options.resolution * options.resolution));
  check_not_negative("amplitude", options.amplitude_rad);
  check_range("bases", options.bases, 0, 256);
  check_range("ladder terms", options.ladder_terms, 0, 1024);
  check_range("training vertices", options.training_vertices, 0, 1 << 30);
  check_range("residual vertices", options.residual_vertices, 1, 4096);
  check_not_negative("origin offset", options.origin_offset);
  check_not_negative("target error", options.target_error);
}

std::string receiver_name(const TriangleMesh& mesh) {
  return mesh.name.empty() ? "receiver" : mesh.name;
}

void check_receiver(const TriangleMesh& mesh) {
  const std::string name = receiver_name(mesh);
  if (mesh.triangles.empty())
    throw Error(ErrorKind::input, name, "has no triangles, expected at least one");
  const std::size_t vertices = mesh.positions.size();
  const auto check = [&](const char* what, std::size_t size) {
    if (size != vertices)
      throw Error(ErrorKind::input, name,
                  fmt::format("has {} {}, expected one a vertex ({})", size, what, vertices));
  };
  check("normals", mesh.normals.size());
  check("tangents", mesh.tangents.size());
  check("file vertex numbers", mesh.file_vertex.size());
  if (!mesh.uvs.empty()) check("UVs", mesh.uvs.size());
}

std::vector<Vector3f> usable_normals(const TriangleMesh& mesh) {
  std::vector<Vector3f> normals(mesh.normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vector3d normal = mesh.normals[i].cast<double>();
    const double length = normal.norm();
    const bool usable = mesh.positions[i].allFinite() && std::isfinite(length) && length > 0;
    normals[i] = usable ? Vector3f((normal / length).cast<float>()) : Vector3f::Zero();
  }
  return normals;
}

void make_storable(Transfer& transfer) {
  constexpr float kTolerance = 1e-4f;  // good to shade with, and within what the file format takes
  const auto is_unit = [](const Vector3f& v) { return std::abs(v.norm() - 1) <= kTolerance; };
  for (std::size_t i = 0; i < transfer.positions.size(); ++i) {
    Vector3f& normal = transfer.normals[i];
    Vector3f& tangent = transfer.tangents[i];
    if (!transfer.positions[i].allFinite()) transfer.positions[i].setZero();
    if (!transfer.texcoords.empty() && !transfer.texcoords[i].allFinite())
      transfer.texcoords[i].setZero();
    if (!is_unit(normal)) {
      const double length = normal.cast<double>().norm();
      normal = length > 0 && std::isfinite(length)
                   ? Vector3f((normal.cast<double>() / length).cast<float>())
                   : Vector3f::UnitY();
    }
    if (is_unit(tangent) && std::abs(tangent.dot(normal)) <= kTolerance) continue;
    const Vector3d n = normal.cast<double>(), along = tangent.cast<double>().normalized();
    const Vector3d rest = along - along.dot(n) * n;
    tangent = rest.norm() > 1e-6 ? Vector3f(rest.normalized().cast<float>())
                                 : tangent_from_up(normal, UpAxis::y);
  }
}

VertexRoles assign_roles(const std::vector<Vector3f>& normals, const BakeOptions& options) {
  std::vector<std::uint32_t> usable;
  for (std::uint32_t i = 0; i < normals.size(); ++i)
    if (!normals[i].isZero(0)) usable.push_back(i);
  VertexRoles roles;
  roles.training = spread(usable, options.training_vertices == 0
                                      ? usable.size()
                                      : static_cast<std::uint64_t>(options.training_vertices));
  std::set_difference(usable.begin(), usable.end(), roles.training.begin(), roles.training.end(),
                      std::back_inserter(roles.others));
  roles.held_out = !roles.others.empty();
  roles.measured = spread(roles.held_out ? roles.others : roles.training,
                          static_cast<std::uint64_t>(options.residual_vertices));
  return roles;
}

std::string hash_of(const TriangleMesh& mesh) {
  Fnv1a hash;
  add_mesh(mesh, hash);
  return hash.hex();
}

std::string hash_of(std::span<const TriangleMesh> meshes) {
  if (meshes.empty()) return {};
  Fnv1a hash;
  for (const TriangleMesh& mesh : meshes) add_mesh(mesh, hash);
  return hash.hex();
}

BakeJournal::Facts bake_facts(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
                              const BakeOptions& options) {
  const auto number = [](auto value) { return fmt::format("{}", value); };
  return {{"version of burnish", BURNISH_VERSION},
          {"mesh (hash)", hash_of(receiver)},
          {"set of occluders (hash)", hash_of(occluders)},
          {"number of directions", number(options.directions)},
          {"coarsest level", number(options.coarsest)},
          {"origin offset", number(options.origin_offset)},
          {"resolution", number(options.resolution)},
          {"number of terms", number(options.terms)},
          {"amplitude", number(options.amplitude_rad)},
          {"number of bases", number(options.bases)},
          {"target error", number(options.target_error)},
          {"number of ladder terms", number(options.ladder_terms)},
          {"number of training vertices", number(options.training_vertices)},
          {"number of residual vertices", number(options.residual_vertices)}};
}

}  // namespace burnish
