#pragma once

#include <cmath>

#include "burnish/shading/shade.h"
#include "shading/block.h"

namespace burnish {

/// From a position toward the eye; the normal where they are one.
inline Vector3f toward(const Vector3f& eye, const Vector3f& position, const Vector3f& normal) {
  const Vector3f difference = eye - position;
  const float length = difference.stableNorm();
  if (!(length > 0) || !std::isfinite(length)) return normal;
  return lift_above_horizon(difference / length, normal);
}

/// Rows of coefficients that a block of points of this transfer has room for.
inline size_t block_rows(const PreparedTransfer& transfer) {
  const size_t size = padded_terms(transfer.terms) + padded_terms(transfer.ladder_terms);
  return size == 0 ? kBlockRows : std::min(kBlockRows, kBlockCoefficients / size);
}

template <class T>
void start_block(ShadingBlock<T>& block) {
  block.count = block.row_count = 0;
}

template <class T>
bool has_room(const PreparedTransfer& transfer, const ShadingBlock<T>& block) {
  return block.count < kBlock && block.row_count + 3 <= block_rows(transfer);
}

namespace internal {

template <class T>
void set_vector(const Vector3f& v, size_t i, BlockVector3<T>& vectors) {
  vectors.x[i] = v.x();
  vectors.y[i] = v.y();
  vectors.z[i] = v.z();
}

/// The row of a basis of the last point of the block; made if there is none.
template <class T>
VisibilityRow<T>& row_of(const PreparedTransfer& transfer, std::uint8_t basis,
                         ShadingBlock<T>& block) {
  for (size_t r = block.row_count; r > 0 && block.row[r - 1].point == block.count; --r)
    if (block.row[r - 1].basis == basis) return block.row[r - 1];
  const size_t terms = padded_terms(transfer.terms);
  VisibilityRow<T>& row = block.row[block.row_count];
  row = {};
  row.point = block.count;
  row.basis = basis;
  row.weight = 0;
  row.ssdf = block.coefficients + block.row_count * (terms + padded_terms(transfer.ladder_terms));
  row.ladder = row.ssdf + terms;
  ++block.row_count;
  return row;
}

}  // namespace internal

/// Requires has_room. `outgoing` in the frame of the point.
template <class T>
void add_point(const PreparedTransfer& transfer, const ShadingPoint& point,
               const Vector3f& outgoing, ShadingBlock<T>& block) {
  const size_t i = block.count;
  block.position[i] = point.position;
  internal::set_vector(point.frame.x, i, block.tangent);
  internal::set_vector(point.frame.y, i, block.bitangent);
  internal::set_vector(point.frame.z, i, block.normal);
  internal::set_vector(outgoing, i, block.outgoing);
  if (!transfer.bases.empty())
    for (size_t corner = 0; corner < 3; ++corner) {
      const T weight = static_cast<T>(point.weight[corner]);
      if (weight == 0) continue;
      const std::uint32_t vertex = point.vertices[corner];
      VisibilityRow<T>& row = internal::row_of(transfer, transfer.basis_id[vertex], block);
      const size_t n = static_cast<size_t>(row.vertex_count++);
      row.vertex[n] = vertex;
      row.vertex_weight[n] = weight;
      row.weight += weight;
    }
  ++block.count;
}

/// The same of a vertex: find_vertex_views does the rest.
template <class T>
void add_vertex(const PreparedTransfer& transfer, size_t vertex, ShadingBlock<T>& block) {
  const size_t i = block.count;
  block.position[i] = transfer.positions[vertex];
  internal::set_vector(transfer.positions[vertex], i, block.outgoing);
  internal::set_vector(transfer.normals[vertex], i, block.normal);
  internal::set_vector(transfer.tangents[vertex], i, block.tangent);
  if (!transfer.bases.empty()) {
    VisibilityRow<T>& row = internal::row_of(transfer, transfer.basis_id[vertex], block);
    row.vertex_count = 1;
    row.vertex[0] = static_cast<std::uint32_t>(vertex);
    row.vertex_weight[0] = row.weight = 1;
  }
  ++block.count;
}

}  // namespace burnish
