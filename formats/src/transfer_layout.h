#pragma once

#include <cstdint>
#include <string>

#include "burnish/formats/error.h"
#include "burnish/formats/transfer_file.h"

/// What the writer and the reader of transfer files share; formats/FORMAT.md is normative.
namespace burnish {

inline constexpr const char* kTransferFormatName = "burnish transfer";

inline constexpr size_t kMaxText = 4096;  ///< bytes of a string, without the closing zero

namespace transfer_path {
inline constexpr const char* kPositions = "/mesh/positions";
inline constexpr const char* kNormals = "/mesh/normals";
inline constexpr const char* kTangents = "/mesh/tangents";
inline constexpr const char* kTexcoords = "/mesh/texcoords";
inline constexpr const char* kFileVertex = "/mesh/file_vertex";
inline constexpr const char* kTriangles = "/mesh/triangles";
inline constexpr const char* kParts = "/mesh/parts";
inline constexpr const char* kPartNames = "/mesh/parts/names";
inline constexpr const char* kPartRanges = "/mesh/parts/ranges";
inline constexpr const char* kVisibility = "/visibility";
inline constexpr const char* kSsdf = "/visibility/ssdf";
inline constexpr const char* kMean = "/visibility/ssdf/basis/mean";
inline constexpr const char* kEigen = "/visibility/ssdf/basis/eigen";
inline constexpr const char* kCoefficients = "/visibility/ssdf/coefficients";
inline constexpr const char* kBasisId = "/visibility/ssdf/basis_id";
inline constexpr const char* kLadder = "/visibility/ladder";
inline constexpr const char* kLadderMean = "/visibility/ladder/basis/mean";
inline constexpr const char* kLadderEigen = "/visibility/ladder/basis/eigen";
inline constexpr const char* kLadderCoefficients = "/visibility/ladder/coefficients";
inline constexpr const char* kOccluderPositions = "/occluders/positions";
inline constexpr const char* kOccluderTriangles = "/occluders/triangles";
inline constexpr const char* kProvenance = "/provenance";
inline constexpr const char* kSsdfErrors = "/provenance/ssdf_errors";
inline constexpr const char* kLadderErrors = "/provenance/ladder_errors";
}  // namespace transfer_path

/// What a coefficient that is stored as an integer is to be multiplied by: an attribute of the
/// dataset, named as the CF conventions do.
inline constexpr const char* kScaleFactor = "scale_factor";

static_assert(sizeof(Vector3f) == 3 * sizeof(float), "vectors are stored as rows of floats");
static_assert(sizeof(Vector2<float>) == 2 * sizeof(float));
static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
static_assert(sizeof(LobeError) == 2 * sizeof(double));

/// Throws Error(kind, subject) for the first rule of the format that the transfer's sizes and
/// values break, named by dataset and index.
void check_transfer(const Transfer& transfer, ErrorKind kind, const std::string& subject);

}  // namespace burnish
