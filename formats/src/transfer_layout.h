#pragma once

#include <string>

#include "burnish/formats/error.h"
#include "burnish/formats/transfer_file.h"

/// What the writer and the reader of transfer files share; formats/FORMAT.md is normative.
namespace burnish {

inline constexpr const char* kTransferFormatName = "burnish transfer";
inline constexpr size_t kMaxAttributeString = 4096;  ///< bytes, without the closing zero

namespace transfer_path {
inline constexpr const char* kPositions = "/mesh/positions";
inline constexpr const char* kNormals = "/mesh/normals";
inline constexpr const char* kTangents = "/mesh/tangents";
inline constexpr const char* kFileVertex = "/mesh/file_vertex";
inline constexpr const char* kTriangles = "/mesh/triangles";
inline constexpr const char* kMean = "/visibility/ssdf/basis/mean";
inline constexpr const char* kEigen = "/visibility/ssdf/basis/eigen";
inline constexpr const char* kCoefficients = "/visibility/ssdf/coefficients";
inline constexpr const char* kBasisId = "/visibility/ssdf/basis_id";
inline constexpr const char* kOccluderPositions = "/occluders/positions";
inline constexpr const char* kOccluderTriangles = "/occluders/triangles";
inline constexpr const char* kProvenance = "/provenance";
}  // namespace transfer_path

/// Throws Error(kind, subject) for the first rule of the format that the transfer's sizes and
/// values break, named by dataset and index.
void check_transfer(const Transfer& transfer, ErrorKind kind, const std::string& subject);

}  // namespace burnish
