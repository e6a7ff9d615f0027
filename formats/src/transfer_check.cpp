#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "burnish/visibility/visibility_ladder.h"
#include "transfer_layout.h"

namespace burnish {
namespace {

constexpr float kUnitTolerance = 1e-3f;
constexpr float kRangeTolerance = 1e-3f;  // of means, whose range only rounding exceeds

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

  template <class Vector>
  void check_points(const char* path, const std::vector<Vector>& points) const {
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
    if (!transfer.texcoords.empty())
      check_count(transfer_path::kTexcoords, transfer.texcoords.size(), vertices);
    check_points(transfer_path::kTexcoords, transfer.texcoords);
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
    check_parts();
  }

  /// The next of consecutive ranges that cover all. Sums in 64 bits do not overflow.
  void check_range_of_part(size_t part, const char* what, std::uint64_t first,
                           std::uint64_t expected, std::uint64_t end, std::uint64_t all) const {
    const bool is_last = part + 1 == transfer.parts.size();
    if (first != expected || end > all || (is_last && end != all))
      fail(fmt::format("{}[{}]", transfer_path::kPartRanges, part),
           fmt::format("{} {}..{}, expected them from {} to {}{}", what, first, end, expected,
                       is_last ? "" : "at most ", all));
  }

  void check_parts() const {
    std::uint64_t vertex = 0, triangle = 0;
    for (size_t i = 0; i < transfer.parts.size(); ++i) {
      const MeshPart& part = transfer.parts[i];
      check_text(fmt::format("{}[{}]", transfer_path::kPartNames, i), part.name);
      const std::uint64_t vertex_end = std::uint64_t{part.first_vertex} + part.vertices;
      const std::uint64_t triangle_end = std::uint64_t{part.first_triangle} + part.triangles;
      check_range_of_part(i, "vertices", part.first_vertex, vertex, vertex_end,
                          transfer.vertex_count());
      check_range_of_part(i, "triangles", part.first_triangle, triangle, triangle_end,
                          transfer.triangles.size());
      for (std::uint64_t t = triangle; t < triangle_end; ++t)
        for (const std::uint32_t index : transfer.triangles[t])
          if (index < vertex || index >= vertex_end)
            fail(fmt::format("{}[{}]", transfer_path::kTriangles, t),
                 fmt::format("vertex {}, expected one of its part: {} or more, below {}", index,
                             vertex, vertex_end));
      vertex = vertex_end;
      triangle = triangle_end;
    }
  }

  /// Mean and eigenvectors of a basis of edge * edge values (texels or harmonics).
  template <class Basis>
  void check_basis(const char* mean_path, const char* eigen_path, const Basis& basis, int edge,
                   float most) const {
    if (basis.terms < 1 || basis.terms > kMaxTerms)
      fail(eigen_path, fmt::format("{} terms, expected 1..{}", basis.terms, kMaxTerms));
    const size_t values = static_cast<size_t>(edge) * static_cast<size_t>(edge);
    check_count(mean_path, basis.mean.size(), values);
    check_count(eigen_path, basis.eigen.size(), values * static_cast<size_t>(basis.terms));
    check_finite(mean_path, basis.mean);
    check_finite(eigen_path, basis.eigen);
    for (size_t i = 0; i < values; ++i)
      if (std::abs(basis.mean[i]) > most + kRangeTolerance)
        fail(fmt::format("{}, value {}", mean_path, i),
             fmt::format("{}, expected -{}..{}", basis.mean[i], most, most));
  }

  void check_ssdf_basis(const SsdfBasis& basis) const {
    const SsdfBasis& first = transfer.bases[0];
    if (!(basis.amplitude_rad >= 0) || !std::isfinite(basis.amplitude_rad))
      fail(fmt::format("{}, attribute amplitude_rad", transfer_path::kSsdf),
           fmt::format("{}, expected 0 or more", basis.amplitude_rad));
    if (basis.resolution < kMinSsdfResolution || basis.resolution > kMaxSsdfResolution ||
        !std::has_single_bit(static_cast<unsigned>(basis.resolution)))
      fail(transfer_path::kMean,
           fmt::format("resolution {}, expected a power of two in {}..{}", basis.resolution,
                       kMinSsdfResolution, kMaxSsdfResolution));
    check_basis(transfer_path::kMean, transfer_path::kEigen, basis, basis.resolution,
                basis.amplitude_rad > 0 ? 1 : kPi<float>);
    if (basis.resolution != first.resolution || basis.terms != first.terms ||
        basis.amplitude_rad != first.amplitude_rad)
      fail(transfer_path::kEigen, "the bases differ in resolution, terms or amplitude");
  }

  void check_ssdf() const {
    const size_t bases = transfer.bases.size();
    if (bases > kMaxBases)
      fail(transfer_path::kMean, fmt::format("{} bases, expected 0..{}", bases, kMaxBases));
    for (const SsdfBasis& basis : transfer.bases) check_ssdf_basis(basis);
    const size_t vertices = bases == 0 ? 0 : transfer.vertex_count();
    check_count(transfer_path::kBasisId, transfer.basis_id.size(), vertices);
    for (size_t i = 0; i < vertices; ++i)
      if (transfer.basis_id[i] >= bases)
        fail(fmt::format("{}[{}]", transfer_path::kBasisId, i),
             fmt::format("basis {}, expected below {}", int{transfer.basis_id[i]}, bases));
    check_count(transfer_path::kCoefficients, transfer.coefficients.size(),
                vertices * static_cast<size_t>(transfer.terms()));
    check_finite(transfer_path::kCoefficients, transfer.coefficients);
  }

  void check_ladder_basis(const LadderBasis& basis) const {
    const LadderBasis& first = transfer.ladder_bases[0];
    if (basis.bands < 1 || basis.bands > kMaxLadderBands)
      fail(transfer_path::kLadderMean,
           fmt::format("{} bands, expected 1..{}", basis.bands, kMaxLadderBands));
    // The norm of a visibility of 1 everywhere bounds each of its harmonics.
    check_basis(transfer_path::kLadderMean, transfer_path::kLadderEigen, basis, basis.bands,
                std::sqrt(4 * kPi<float>));
    if (basis.bands != first.bands || basis.terms != first.terms)
      fail(transfer_path::kLadderEigen, "the bases differ in bands or terms");
  }

  void check_ladder() const {
    const std::vector<LadderBasis>& bases = transfer.ladder_bases;
    if (!bases.empty() && transfer.bases.empty())
      fail(transfer_path::kLadderMean, "a ladder, expected none where the SSDF has no basis");
    if (bases.size() > 1 && bases.size() != transfer.bases.size())
      fail(transfer_path::kLadderMean,
           fmt::format("{} bases, expected none, one, or one for each of the SSDF's {}",
                       bases.size(), transfer.bases.size()));
    for (const LadderBasis& basis : bases) check_ladder_basis(basis);
    const size_t vertices = bases.empty() ? 0 : transfer.vertex_count();
    check_count(transfer_path::kLadderCoefficients, transfer.ladder_coefficients.size(),
                vertices * static_cast<size_t>(transfer.ladder_terms()));
    check_finite(transfer_path::kLadderCoefficients, transfer.ladder_coefficients);
    const float crossover = transfer.ladder_crossover;
    if (!(crossover >= 0) || !std::isfinite(crossover) || (bases.empty() && crossover != 0))
      fail(fmt::format("{}, attribute crossover", transfer_path::kLadder),
           fmt::format("{}, expected {}", crossover,
                       bases.empty() ? "0 without a ladder" : "0 or more"));
  }

  void check_occluders() const {
    const size_t vertices = transfer.occluder_positions.size();
    if (vertices > std::numeric_limits<std::uint32_t>::max())
      fail(transfer_path::kOccluderPositions,
           fmt::format("{} vertices, expected 0..2^32 - 1", vertices));
    check_points(transfer_path::kOccluderPositions, transfer.occluder_positions);
    check_triangles(transfer_path::kOccluderTriangles, transfer.occluder_triangles, vertices);
  }

  void check_text(const std::string& place, const std::string& text) const {
    if (text.size() > kMaxText || text.find('\0') != std::string::npos)
      fail(place, fmt::format("expected at most {} bytes, none of them zero", kMaxText));
  }

  void check_errors(const char* path, const std::vector<LobeError>& errors) const {
    for (size_t i = 0; i < errors.size(); ++i) {
      const auto [bandwidth, error] = errors[i];
      if (!(bandwidth > 0 && error >= 0) || !std::isfinite(bandwidth) || !std::isfinite(error))
        fail(fmt::format("{}[{}]", path, i),
             fmt::format("error {} at bandwidth {}, expected 0 or more at a positive one", error,
                         bandwidth));
    }
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
    check_text("/provenance, attribute version", provenance.version);
    check_text("/provenance, attribute mesh_name", provenance.mesh_name);
    check_hash("mesh_hash", provenance.mesh_hash);
    check_hash("occluder_hash", provenance.occluder_hash);
    check_range("directions", provenance.directions, 0, 1 << 16);
    check_range("coarsest", provenance.coarsest, 0, provenance.directions);
    check_range("origin_offset", provenance.origin_offset, 0.0, std::numeric_limits<double>::max());
    check_range("residual_vertices", provenance.residual_vertices, 0,
                std::numeric_limits<int>::max());
    check_range("training_vertices", provenance.training_vertices, 0,
                std::numeric_limits<int>::max());
    check_range("residual_rms_rad", provenance.residual_rms_rad, 0.0, 2 * kPi<double>);
    check_range("wrong_sign_fraction", provenance.wrong_sign_fraction, 0.0, 1.0);
    check_errors(transfer_path::kSsdfErrors, provenance.ssdf_errors);
    check_errors(transfer_path::kLadderErrors, provenance.ladder_errors);
  }
};

}  // namespace

void check_transfer(const Transfer& transfer, ErrorKind kind, const std::string& subject) {
  const TransferChecker checker{transfer, kind, subject};
  checker.check_mesh();
  checker.check_ssdf();
  checker.check_ladder();
  checker.check_occluders();
  checker.check_provenance();
}

}  // namespace burnish
