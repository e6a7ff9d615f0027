#pragma once

#include <random>

#include "burnish/shading/transfer.h"
#include "burnish/sphere/frame.h"

namespace burnish::test {

/// Sizes of a transfer.
struct TransferSize {
  size_t vertices = 40, triangles = 30, occluder_vertices = 5, occluder_triangles = 4;
  int bases = 2, resolution = 8, terms = 6;
};

inline Vector3f random_vector(std::mt19937& random, float scale) {
  std::normal_distribution<float> normal(0, scale);
  const float x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}

inline std::vector<float> random_floats(std::mt19937& random, size_t count, float scale) {
  std::uniform_real_distribution<float> uniform(-scale, scale);
  std::vector<float> values(count);
  for (float& value : values) value = uniform(random);
  return values;
}

inline std::vector<Triangle> random_triangles(std::mt19937& random, size_t count, size_t vertices) {
  std::vector<Triangle> triangles(count);
  for (Triangle& triangle : triangles)
    for (std::uint32_t& index : triangle) index = static_cast<std::uint32_t>(random() % vertices);
  return triangles;
}

/// A valid transfer with noise in every field.
inline Transfer random_transfer(unsigned seed, const TransferSize& size = {}) {
  std::mt19937 random(seed);
  Transfer transfer;
  for (size_t i = 0; i < size.vertices; ++i) {
    const Vector3f normal = random_vector(random, 1).normalized();
    transfer.positions.push_back(random_vector(random, 100));
    transfer.normals.push_back(normal);
    transfer.tangents.push_back(frame_from_normal_tangent(normal, random_vector(random, 1)).x);
    transfer.file_vertex.push_back(static_cast<std::uint32_t>(random()));
    transfer.basis_id.push_back(
        static_cast<std::uint8_t>(random() % static_cast<unsigned>(size.bases)));
  }
  transfer.triangles = random_triangles(random, size.triangles, size.vertices);
  const size_t texels = static_cast<size_t>(size.resolution) * static_cast<size_t>(size.resolution);
  const auto terms = static_cast<size_t>(size.terms);
  for (int b = 0; b < size.bases; ++b)
    transfer.bases.push_back({size.resolution, size.terms,
                              random_floats(random, texels, kPi<float>),
                              random_floats(random, texels * terms, 1)});
  transfer.coefficients = random_floats(random, size.vertices * terms, 20);
  for (size_t i = 0; i < size.occluder_vertices; ++i)
    transfer.occluder_positions.push_back(random_vector(random, 100));
  transfer.occluder_triangles =
      random_triangles(random, size.occluder_triangles, size.occluder_vertices);
  transfer.provenance = {.version = "0.1.0",
                         .mesh_name = "b\xc3\xbcste.obj",
                         .mesh_hash = "0123456789abcdef",
                         .occluder_hash = size.occluder_vertices > 0 ? "fedcba9876543210" : "",
                         .directions = 512,
                         .training_vertices = 32,
                         .rays = 123456789012345u,
                         .residual_rms_rad = 0.026,
                         .wrong_sign_fraction = 0.03};
  return transfer;
}

inline bool operator_equal(const SsdfBasis& a, const SsdfBasis& b) {
  return a.resolution == b.resolution && a.terms == b.terms && a.mean == b.mean &&
         a.eigen == b.eigen;
}

inline bool equal_provenance(const Provenance& a, const Provenance& b) {
  return a.version == b.version && a.mesh_name == b.mesh_name && a.mesh_hash == b.mesh_hash &&
         a.occluder_hash == b.occluder_hash && a.directions == b.directions &&
         a.training_vertices == b.training_vertices && a.rays == b.rays &&
         a.residual_rms_rad == b.residual_rms_rad && a.wrong_sign_fraction == b.wrong_sign_fraction;
}

/// The first field in which two transfers differ, or "".
inline std::string first_difference(const Transfer& a, const Transfer& b) {
  if (a.positions != b.positions) return "positions";
  if (a.normals != b.normals) return "normals";
  if (a.tangents != b.tangents) return "tangents";
  if (a.file_vertex != b.file_vertex) return "file_vertex";
  if (a.triangles != b.triangles) return "triangles";
  if (!std::equal(a.bases.begin(), a.bases.end(), b.bases.begin(), b.bases.end(), operator_equal))
    return "bases";
  if (a.basis_id != b.basis_id) return "basis_id";
  if (a.coefficients != b.coefficients) return "coefficients";
  if (a.occluder_positions != b.occluder_positions) return "occluder_positions";
  if (a.occluder_triangles != b.occluder_triangles) return "occluder_triangles";
  return equal_provenance(a.provenance, b.provenance) ? "" : "provenance";
}

}  // namespace burnish::test
