#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/shading/transfer.h"

namespace burnish {

enum class RowFormat {
  float32,
  float16,  ///< half the memory, and faster; what it adds to the compression's error does not show
};

/// A transfer as the frame calls read it: prepared once, then immutable, and shared between
/// threads. It holds all that shading needs; the transfer itself may go.
struct PreparedTransfer {
  /// A basis of SSDFs: a row of its eigenvectors for each texel, padded with zeros to whole
  /// vectors, as [resolution^2][padded_terms(terms)], in the transfer's format.
  struct Basis {
    std::vector<float> mean;             ///< [resolution^2]
    std::vector<std::uint16_t> eigen16;  ///< IEEE 754 binary16
    std::vector<float> eigen32;
  };
  /// A basis of the visibility ladder as pictures of the sphere, in the directions in which lights
  /// are multiplied by it (docs/maths.md, "Irradiance table"), and as it was baked.
  struct Ladder {
    std::vector<float> images;  ///< of each direction: the terms', then the mean's, padded
    LadderBasis harmonics;
  };

  std::vector<Vector3f> positions, normals, tangents;  ///< #V, as in Transfer
  std::vector<std::uint8_t> basis_id;                  ///< #V
  int terms = 0, ladder_terms = 0;                     ///< 0: none
  int resolution = 0;                                  ///< of the bases
  float amplitude_rad = 0, ladder_crossover = 0;       ///< as in Transfer
  std::vector<Basis> bases;
  std::vector<Ladder> ladders;  ///< none, one, or one for each of `bases`

  /// A row for each vertex: its coefficients, and then those of the ladder. One of the two is used.
  /// @{
  RowFormat format = RowFormat::float16;
  std::vector<std::uint16_t> rows16;  ///< IEEE 754 binary16
  std::vector<float> rows32;
  /// @}

  size_t vertex_count() const { return positions.size(); }
  size_t row_size() const { return static_cast<size_t>(terms + ladder_terms); }
  int ladder_of(std::uint8_t basis) const { return ladders.size() == 1 ? 0 : basis; }
  /// Bytes that grow with the vertices.
  size_t bytes_per_vertex() const;
};

/// `terms`, rounded up to the lanes of any vector.
inline size_t padded_terms(int terms) { return (static_cast<size_t>(terms) + 15) / 16 * 16; }

/// `transfer` keeps the rules of Transfer, as one from read_transfer or bake does: sizes and ids
/// are not checked. Numbers beyond the range of float16, 65504, make it float32.
PreparedTransfer prepare_transfer(const Transfer& transfer, RowFormat format = RowFormat::float16);

}  // namespace burnish
