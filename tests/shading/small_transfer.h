#pragma once

#include <utility>

#include "burnish/shading/prepared_transfer.h"

/// Transfers of a few vertices, for tests that say what each of them sees.
namespace burnish::test {

/// Vertices at the origin, z up, in the open.
inline Transfer vertices_at_origin(size_t count) {
  Transfer transfer;
  transfer.positions.assign(count, Vector3f::Zero());
  transfer.normals.assign(count, Vector3f::UnitZ());
  transfer.tangents.assign(count, Vector3f::UnitX());
  return transfer;
}

/// One of them: nothing occludes but its horizon.
inline const PreparedTransfer kOpen = prepare_transfer(vertices_at_origin(1));

/// A vertex there that sees the mean of a basis.
inline Transfer vertex_that_sees(SsdfBasis basis) {
  Transfer transfer = vertices_at_origin(1);
  transfer.basis_id = {0};
  transfer.coefficients.assign(static_cast<size_t>(basis.terms), 0.0f);
  transfer.bases.push_back(std::move(basis));
  return transfer;
}

/// ... and of a ladder, which has lobes below the crossover.
inline Transfer vertex_that_sees(SsdfBasis basis, LadderBasis ladder, float crossover) {
  Transfer transfer = vertex_that_sees(std::move(basis));
  transfer.ladder_coefficients.assign(static_cast<size_t>(ladder.terms), 0.0f);
  transfer.ladder_bases.push_back(std::move(ladder));
  transfer.ladder_crossover = crossover;
  return transfer;
}

/// With the coefficients as they are.
inline PreparedTransfer prepare_exactly(const Transfer& transfer) {
  return prepare_transfer(transfer, RowFormat::float32);
}

}  // namespace burnish::test
