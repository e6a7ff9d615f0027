#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "transfer_layout.h"

namespace burnish {
namespace {

constexpr float kUnitTolerance = 1e-3f;
constexpr float kDistanceTolerance = 1e-3f;  // radians; beyond pi only by rounding

struct TransferChecker {
  const Transfer& transfer;
  ErrorKind kind;
  const std::string& subject;

  [[noreturn]] void fail(const std::string& place, const std::string& message) const {
    throw Error(kind, subject, place + ": " + message);
  }

  void check_count(const char* path, size_t found, size_t expected) const {
    if (found != expected) fail(path, fmt::format("{} entries, expected {}", found, expected));
  }

  void check_finite(const char* path, const std::vector<float>& values) const {
    const auto bad = std::find_if_not(values.begin(), values.end(),
                                      [](float value) { return std::isfinite(value); });
    if (bad != values.end())
      fail(fmt::format("{}, value {}", path, bad - values.begin()),
           fmt::format("{}, expected a finite number", *bad));
  }

  void check_points(const char* path, const std::vector<Vector3f>& points) const {
    for (size_t i = 0; i < points.size(); ++i)
      if (!points[i].allFinite()) fail(fmt::format("{}[{}]", path, i), "not finite");
  }

  void check_units(const char* path, const std::vector<Vector3f>& vectors) const {
    for (size_t i = 0; i < vectors.size(); ++i) {
      const float length = vectors[i].norm();
      if (!(std::abs(length - 1) <= kUnitTolerance))
        fail(fmt::format("{}[{}]", path, i),
             fmt::format("length {}, expected 1 within {}", length, kUnitTolerance));
    }
  }

  void check_triangles(const char* path, const std::vector<Triangle>& triangles,
                       size_t vertices) const {
    for (size_t i = 0; i < triangles.size(); ++i)
      for (const std::uint32_t index : triangles[i])
        if (index >= vertices)
          fail(fmt::format("{}[{}]", path, i),
               fmt::format("vertex {}, expected below {}", index, vertices));
  }

  void check_mesh() const {
    const size_t vertices = transfer.vertex_count();
    if (vertices < 1 || vertices > std::numeric_limits<std::uint32_t>::max())
      fail(transfer_path::kPositions, fmt::format("{} vertices, expected 1..2^32 - 1", vertices));
    check_count(transfer_path::kNormals, transfer.normals.size(), vertices);
    check_count(transfer_path::kTangents, transfer.tangents.size(), vertices);
    check_count(transfer_path::kFileVertex, transfer.file_vertex.size(), vertices);
    check_points(transfer_path::kPositions, transfer.positions);
    check_units(transfer_path::kNormals, transfer.normals);
    check_units(transfer_path::kTangents, transfer.tangents);
    for (size_t i = 0; i < vertices; ++i) {
      const float cosine = transfer.normals[i].dot(transfer.tangents[i]);
      if (!(std::abs(cosine) <= kUnitTolerance))
        fail(
            fmt::format("{}[{}]", transfer_path::kTangents, i),
            fmt::format("cosine {} with the normal, expected 0 within {}", cosine, kUnitTolerance));
    }
    check_triangles(transfer_path::kTriangles, transfer.triangles, vertices);
  }

  void check_basis(const SsdfBasis& basis) const {
    const auto resolution = static_cast<unsigned>(std::max(basis.resolution, 0));
    if (basis.resolution < kMinSsdfResolution || basis.resolution > kMaxSsdfResolution ||
        !std::has_single_bit(resolution))
      fail(transfer_path::kMean,
           fmt::format("resolution {}, expected a power of two in {}..{}", basis.resolution,
                       kMinSsdfResolution, kMaxSsdfResolution));
    if (basis.terms < 1 || basis.terms > kMaxTerms)
      fail(transfer_path::kEigen, fmt::format("{} terms, expected 1..{}", basis.terms, kMaxTerms));
    const size_t texels = size_t{resolution} * resolution;
    check_count(transfer_path::kMean, basis.mean.size(), texels);
    check_count(transfer_path::kEigen, basis.eigen.size(),
                texels * static_cast<size_t>(basis.terms));
    check_finite(transfer_path::kMean, basis.mean);
    check_finite(transfer_path::kEigen, basis.eigen);
    for (const float distance : basis.mean)
      if (std::abs(distance) > kPi<float> + kDistanceTolerance)
        fail(transfer_path::kMean, fmt::format("{} rad, expected -pi..pi", distance));
  }

  void check_visibility() const {
    const size_t vertices = transfer.vertex_count(), bases = transfer.bases.size();
    if (bases < 1 || bases > kMaxBases)
      fail(transfer_path::kMean, fmt::format("{} bases, expected 1..{}", bases, kMaxBases));
    for (const SsdfBasis& basis : transfer.bases) {
      check_basis(basis);
      if (basis.resolution != transfer.bases[0].resolution ||
          basis.terms != transfer.bases[0].terms)
        fail(transfer_path::kEigen, "the bases differ in resolution or terms");
    }
    check_count(transfer_path::kBasisId, transfer.basis_id.size(), vertices);
    for (size_t i = 0; i < vertices; ++i)
      if (transfer.basis_id[i] >= bases)
        fail(fmt::format("{}[{}]", transfer_path::kBasisId, i),
             fmt::format("basis {}, expected below {}", int{transfer.basis_id[i]}, bases));
    check_count(transfer_path::kCoefficients, transfer.coefficients.size(),
                vertices * static_cast<size_t>(transfer.terms()));
    check_finite(transfer_path::kCoefficients, transfer.coefficients);
  }

  void check_occluders() const {
    const size_t vertices = transfer.occluder_positions.size();
    if (vertices > std::numeric_limits<std::uint32_t>::max())
      fail(transfer_path::kOccluderPositions,
           fmt::format("{} vertices, expected 0..2^32 - 1", vertices));
    check_points(transfer_path::kOccluderPositions, transfer.occluder_positions);
    check_triangles(transfer_path::kOccluderTriangles, transfer.occluder_triangles, vertices);
  }

  void check_text(const char* name, const std::string& text) const {
    if (text.size() > kMaxAttributeString || text.find('\0') != std::string::npos)
      fail(fmt::format("{}, attribute {}", transfer_path::kProvenance, name),
           fmt::format("expected at most {} bytes, none of them zero", kMaxAttributeString));
  }

  void check_hash(const char* name, const std::string& hash) const {
    const bool is_hash =
        hash.size() == 16 && hash.find_first_not_of("0123456789abcdef") == std::string::npos;
    if (!hash.empty() && !is_hash)
      fail(fmt::format("{}, attribute {}", transfer_path::kProvenance, name),
           "expected 16 hex digits or nothing");
  }

  template <class T>
  void check_range(const char* name, T value, T low, T high) const {
    if (!(value >= low && value <= high))
      fail(fmt::format("{}, attribute {}", transfer_path::kProvenance, name),
           fmt::format("{}, expected {}..{}", value, low, high));
  }

  void check_provenance() const {
    const Provenance& provenance = transfer.provenance;
    check_text("version", provenance.version);
    check_text("mesh_name", provenance.mesh_name);
    check_hash("mesh_hash", provenance.mesh_hash);
    check_hash("occluder_hash", provenance.occluder_hash);
    check_range("directions", provenance.directions, 0, 1 << 16);
    check_range("training_vertices", provenance.training_vertices, 0,
                std::numeric_limits<int>::max());
    check_range("residual_rms_rad", provenance.residual_rms_rad, 0.0, 2 * kPi<double>);
    check_range("wrong_sign_fraction", provenance.wrong_sign_fraction, 0.0, 1.0);
  }
};

}  // namespace

void check_transfer(const Transfer& transfer, ErrorKind kind, const std::string& subject) {
  const TransferChecker checker{transfer, kind, subject};
  checker.check_mesh();
  checker.check_visibility();
  checker.check_occluders();
  checker.check_provenance();
}

}  // namespace burnish
