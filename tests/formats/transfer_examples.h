#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "burnish/shading/transfer.h"
#include "burnish/sphere/frame.h"

namespace burnish::test {

/// Sizes of a transfer.
struct TransferSize {
  size_t vertices = 40, triangles = 30, occluder_vertices = 5, occluder_triangles = 4;
  int bases = 2, resolution = 8, terms = 6;
  float amplitude_rad = 0;
  int ladder_bases = 0, ladder_bands = 4, ladder_terms = 5;
  size_t parts = 0;
  bool texcoords = false;
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

inline Provenance example_provenance() {
  Provenance provenance;
  provenance.version = "0.1.0";
  provenance.mesh_name = "b\xc3\xbcste.obj";
  provenance.mesh_hash = "0123456789abcdef";
  provenance.directions = 512;
  provenance.training_vertices = 32;
  provenance.rays = 123456789012345u;
  provenance.residual_rms_rad = 0.026;
  provenance.wrong_sign_fraction = 0.03;
  return provenance;
}

/// What came with version 2 of the format, too.
inline Provenance example_provenance_2() {
  Provenance provenance = example_provenance();
  provenance.coarsest = 64;
  provenance.origin_offset = 1.25e-7;
  provenance.residual_vertices = 8;
  provenance.residual_held_out = true;
  provenance.ssdf_errors = {{8, 0.25}, {128, 0.125}};
  provenance.ladder_errors = {{1, 0.005}, {2, 0.01}, {4, 0.02}};
  return provenance;
}

/// Cuts the mesh into parts: the first has a name to be careful with, the second is empty. Gives
/// the triangles vertices of their own part.
inline void cut_into_parts(Transfer& transfer, size_t parts) {
  std::uint32_t vertex = 0, triangle = 0;
  for (size_t i = 0; i < parts; ++i) {
    MeshPart part;
    part.name = i == 0 ? "\xc3\xa4\xe2\x82\xac #1.obj" : std::string(i - 1, 'p');
    part.first_vertex = vertex;
    part.first_triangle = triangle;
    if (i + 1 == parts) {
      part.vertices = static_cast<std::uint32_t>(transfer.vertex_count()) - vertex;
      part.triangles = static_cast<std::uint32_t>(transfer.triangles.size()) - triangle;
    } else if (i != 1) {
      part.vertices = static_cast<std::uint32_t>(transfer.vertex_count() / parts);
      part.triangles = static_cast<std::uint32_t>(transfer.triangles.size() / parts);
    }
    vertex += part.vertices;
    triangle += part.triangles;
    for (std::uint32_t t = part.first_triangle; t < triangle; ++t)
      for (std::uint32_t& index : transfer.triangles[t])
        index = part.first_vertex + index % part.vertices;
    transfer.parts.push_back(part);
  }
}

inline std::vector<LadderBasis> random_ladder(std::mt19937& random, const TransferSize& size) {
  const auto values = static_cast<size_t>(size.ladder_bands * size.ladder_bands);
  std::vector<LadderBasis> bases(static_cast<size_t>(size.ladder_bases));
  for (LadderBasis& basis : bases) {
    basis.bands = size.ladder_bands;
    basis.terms = size.ladder_terms;
    basis.mean = random_floats(random, values, 3.5f);
    basis.eigen = random_floats(random, values * static_cast<size_t>(basis.terms), 1);
  }
  return bases;
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
    if (size.bases > 0)
      transfer.basis_id.push_back(
          static_cast<std::uint8_t>(random() % static_cast<unsigned>(size.bases)));
  }
  transfer.triangles = random_triangles(random, size.triangles, size.vertices);
  const size_t texels = static_cast<size_t>(size.resolution) * static_cast<size_t>(size.resolution);
  const auto terms = static_cast<size_t>(size.terms);
  for (int b = 0; b < size.bases; ++b)
    transfer.bases.push_back(
        {.resolution = size.resolution,
         .terms = size.terms,
         .amplitude_rad = size.amplitude_rad,
         .mean = random_floats(random, texels, size.amplitude_rad > 0 ? 1 : kPi<float>),
         .eigen = random_floats(random, texels * terms, 1)});
  if (size.bases > 0) transfer.coefficients = random_floats(random, size.vertices * terms, 20);
  for (size_t i = 0; i < size.occluder_vertices; ++i)
    transfer.occluder_positions.push_back(random_vector(random, 100));
  transfer.occluder_triangles =
      random_triangles(random, size.occluder_triangles, size.occluder_vertices);
  transfer.provenance = example_provenance();
  if (size.occluder_vertices > 0) transfer.provenance.occluder_hash = "fedcba9876543210";
  if (size.ladder_bases > 0) {
    transfer.ladder_bases = random_ladder(random, size);
    transfer.ladder_coefficients =
        random_floats(random, size.vertices * static_cast<size_t>(size.ladder_terms), 3);
    transfer.ladder_crossover = 16;
  }
  cut_into_parts(transfer, size.parts);
  if (size.texcoords)
    for (size_t i = 0; i < size.vertices; ++i)
      transfer.texcoords.push_back(random_vector(random, 3).head<2>());
  return transfer;
}

/// With all that version 2 of the format added.
inline Transfer random_transfer_2(unsigned seed) {
  Transfer transfer = random_transfer(seed, {.amplitude_rad = 1.5f, .ladder_bases = 2, .parts = 3});
  const std::string occluder_hash = transfer.provenance.occluder_hash;
  transfer.provenance = example_provenance_2();
  transfer.provenance.occluder_hash = occluder_hash;
  return transfer;
}

inline bool equal_parts(const MeshPart& a, const MeshPart& b) {
  return a.name == b.name && a.first_vertex == b.first_vertex && a.vertices == b.vertices &&
         a.first_triangle == b.first_triangle && a.triangles == b.triangles;
}

inline bool equal_bases(const SsdfBasis& a, const SsdfBasis& b) {
  return a.resolution == b.resolution && a.terms == b.terms && a.amplitude_rad == b.amplitude_rad &&
         a.mean == b.mean && a.eigen == b.eigen;
}

inline bool equal_ladder_bases(const LadderBasis& a, const LadderBasis& b) {
  return a.bands == b.bands && a.terms == b.terms && a.mean == b.mean && a.eigen == b.eigen;
}

inline bool equal_errors(const LobeError& a, const LobeError& b) {
  return a.bandwidth == b.bandwidth && a.relative_rms == b.relative_rms;
}

template <class T>
bool equal_lists(const std::vector<T>& a, const std::vector<T>& b,
                 bool (*equal)(const T&, const T&)) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), equal);
}

inline bool equal_provenance(const Provenance& a, const Provenance& b) {
  return a.version == b.version && a.mesh_name == b.mesh_name && a.mesh_hash == b.mesh_hash &&
         a.occluder_hash == b.occluder_hash && a.directions == b.directions &&
         a.coarsest == b.coarsest && a.origin_offset == b.origin_offset &&
         a.training_vertices == b.training_vertices && a.rays == b.rays &&
         a.residual_vertices == b.residual_vertices && a.residual_held_out == b.residual_held_out &&
         a.residual_rms_rad == b.residual_rms_rad &&
         a.wrong_sign_fraction == b.wrong_sign_fraction &&
         equal_lists(a.ssdf_errors, b.ssdf_errors, equal_errors) &&
         equal_lists(a.ladder_errors, b.ladder_errors, equal_errors);
}

/// The first field in which two transfers differ, or "".
inline std::string first_difference(const Transfer& a, const Transfer& b) {
  if (a.positions != b.positions) return "positions";
  if (a.normals != b.normals) return "normals";
  if (a.tangents != b.tangents) return "tangents";
  if (a.file_vertex != b.file_vertex) return "file_vertex";
  if (a.triangles != b.triangles) return "triangles";
  if (a.texcoords != b.texcoords) return "texcoords";
  if (!equal_lists(a.parts, b.parts, equal_parts)) return "parts";
  if (!equal_lists(a.bases, b.bases, equal_bases)) return "bases";
  if (a.basis_id != b.basis_id) return "basis_id";
  if (a.coefficients != b.coefficients) return "coefficients";
  if (!equal_lists(a.ladder_bases, b.ladder_bases, equal_ladder_bases)) return "ladder_bases";
  if (a.ladder_coefficients != b.ladder_coefficients) return "ladder_coefficients";
  if (a.ladder_crossover != b.ladder_crossover) return "ladder_crossover";
  if (a.occluder_positions != b.occluder_positions) return "occluder_positions";
  if (a.occluder_triangles != b.occluder_triangles) return "occluder_triangles";
  return equal_provenance(a.provenance, b.provenance) ? "" : "provenance";
}

}  // namespace burnish::test
