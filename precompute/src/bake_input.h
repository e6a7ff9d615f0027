#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burnish/precompute/bake.h"

/// What a bake is asked to do, checked, and which vertices serve for what.
namespace burnish {

/// Throws Error for a dial out of range.
void check_bake_options(const BakeOptions& options);

/// Throws Error for arrays that do not match, or without triangles.
void check_receiver(const TriangleMesh& mesh);

/// The name that errors use.
std::string receiver_name(const TriangleMesh& mesh);

/// Unit normals; zero where a vertex cannot be baked.
std::vector<Vector3f> usable_normals(const TriangleMesh& mesh);

/// Repairs what a transfer cannot hold: positions and UVs that are not finite become 0, and normals
/// and tangents unit and orthogonal. What is good stays as it is.
void make_storable(Transfer& transfer);

/// Disjoint sets of usable vertices, each in rising order.
struct VertexRoles {
  std::vector<std::uint32_t> training;  ///< what the bases are trained on
  std::vector<std::uint32_t> others;
  /// What errors are measured on: spread over the others, or over the training set if there are no
  /// others.
  std::vector<std::uint32_t> measured;
  bool held_out = false;  ///< `measured` is of the others
};
VertexRoles assign_roles(const std::vector<Vector3f>& normals, const BakeOptions& options);

std::string hash_of(const TriangleMesh& mesh);
std::string hash_of(std::span<const TriangleMesh> meshes);  ///< empty without any

/// All that the bytes of the result depend on.
BakeJournal::Facts bake_facts(const TriangleMesh& receiver, std::span<const TriangleMesh> occluders,
                              const BakeOptions& options);

}  // namespace burnish
