#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "burnish/formats/output_file.h"
#include "hdf5_writer.h"
#include "transfer_layout.h"

namespace burnish {
namespace {

constexpr long kMostSteps = 32767;  // the range of int16 without its odd end

hsize_t extent(int value) { return static_cast<hsize_t>(value); }

/// Writes floats that are had some rows at a time, each through `encode(value, index)`.
template <class Stored, class Values, class Encode>
void write_encoded(Hdf5Writer& writer, const char* name, const std::vector<hsize_t>& shape,
                   hsize_t rows_at_a_time, Values values, Encode encode) {
  const hsize_t row_size = std::accumulate(shape.begin() + 1, shape.end(), hsize_t{1},
                                           [](hsize_t a, hsize_t b) { return a * b; });
  std::vector<Stored> block;
  writer.dataset(name, Hdf5Type::of<Stored>(), shape, rows_at_a_time,
                 [&](hsize_t first, hsize_t rows) {
                   const float* const source = values(first);
                   block.resize(rows * row_size);
                   for (size_t i = 0; i < block.size(); ++i)
                     block[i] = encode(source[i], first * row_size + i);
                   return block.data();
                 });
}

class TransferWriter {
 public:
  TransferWriter(const Transfer& transfer, const std::string& path,
                 const WriteTransferOptions& options)
      : transfer_(transfer),
        path_(path),
        type_(options.coefficient_type),
        writer_(path, options.compression_level) {}

  /// The bytes live as long as this object.
  std::string_view write() {
    writer_.attribute("/", "format", std::string(kTransferFormatName));
    writer_.attribute("/", "format_version", std::int32_t{kTransferFormatVersion});
    write_mesh();
    writer_.group(transfer_path::kVisibility);
    writer_.attribute(transfer_path::kVisibility, "bases",
                      static_cast<std::int32_t>(transfer_.bases.size()));
    writer_.attribute(transfer_path::kVisibility, "ladder_bases",
                      static_cast<std::int32_t>(transfer_.ladder_bases.size()));
    if (!transfer_.bases.empty()) write_ssdf();
    if (!transfer_.ladder_bases.empty()) write_ladder();
    write_provenance();
    return writer_.finish();
  }

 private:
  void write_points(const char* name, const std::vector<Vector3f>& values) {
    writer_.dataset(name, Hdf5Type::of<float>(), {values.size(), 3}, values.data());
  }
  void write_triangles(const char* name, const std::vector<Triangle>& values) {
    writer_.dataset(name, Hdf5Type::of<std::uint32_t>(), {values.size(), 3}, values.data());
  }

  void write_mesh() {
    writer_.group("/mesh");
    write_points(transfer_path::kPositions, transfer_.positions);
    write_points(transfer_path::kNormals, transfer_.normals);
    write_points(transfer_path::kTangents, transfer_.tangents);
    writer_.array(transfer_path::kFileVertex, {transfer_.file_vertex.size()},
                  transfer_.file_vertex);
    write_triangles(transfer_path::kTriangles, transfer_.triangles);
    if (!transfer_.texcoords.empty())
      writer_.dataset(transfer_path::kTexcoords, Hdf5Type::of<float>(),
                      {transfer_.texcoords.size(), 2}, transfer_.texcoords.data());
    write_parts();
    writer_.group("/occluders");
    write_points(transfer_path::kOccluderPositions, transfer_.occluder_positions);
    write_triangles(transfer_path::kOccluderTriangles, transfer_.occluder_triangles);
  }

  void write_parts() {
    const std::vector<MeshPart>& parts = transfer_.parts;
    size_t longest = 0;
    for (const MeshPart& part : parts) longest = std::max(longest, part.name.size());
    const size_t stride = longest + 1;
    std::string names(parts.size() * stride, '\0');
    std::vector<std::uint32_t> ranges;
    for (size_t i = 0; i < parts.size(); ++i) {
      const MeshPart& part = parts[i];
      std::copy(part.name.begin(), part.name.end(), names.data() + i * stride);
      ranges.insert(ranges.end(),
                    {part.first_vertex, part.vertices, part.first_triangle, part.triangles});
    }
    writer_.group(transfer_path::kParts);
    writer_.dataset(transfer_path::kPartNames, Hdf5Type::text(stride), {parts.size()},
                    names.data());
    writer_.array(transfer_path::kPartRanges, {parts.size(), 4}, ranges);
  }

  void write_ssdf() {
    const std::vector<SsdfBasis>& bases = transfer_.bases;
    const SsdfBasis& first = bases[0];
    writer_.group(transfer_path::kSsdf);
    writer_.attribute(transfer_path::kSsdf, "amplitude_rad", first.amplitude_rad);
    writer_.group("/visibility/ssdf/basis");
    write_basis(transfer_path::kMean, transfer_path::kEigen, bases,
                type_ != CoefficientType::float32);
    writer_.array(transfer_path::kBasisId, {transfer_.basis_id.size()}, transfer_.basis_id);
    write_coefficients(transfer_path::kCoefficients, transfer_.coefficients, first.terms);
  }

  void write_ladder() {
    const std::vector<LadderBasis>& bases = transfer_.ladder_bases;
    const LadderBasis& first = bases[0];
    writer_.group(transfer_path::kLadder);
    writer_.attribute(transfer_path::kLadder, "crossover", transfer_.ladder_crossover);
    writer_.group("/visibility/ladder/basis");
    write_basis(transfer_path::kLadderMean, transfer_path::kLadderEigen, bases, false);
    write_coefficients(transfer_path::kLadderCoefficients, transfer_.ladder_coefficients,
                       first.terms);
  }

  /// Means and eigenvectors; these as halves, or as they are.
  template <class Basis>
  void write_basis(const char* mean_path, const char* eigen_path, const std::vector<Basis>& bases,
                   bool halves) {
    const hsize_t size = bases[0].mean.size();
    write_rows(mean_path, {bases.size(), size}, [&](hsize_t b) { return bases[b].mean.data(); });
    const std::vector<hsize_t> shape = {bases.size(), size, extent(bases[0].terms)};
    const auto eigen = [&](hsize_t b) { return bases[b].eigen.data(); };
    if (halves)
      write_halves(eigen_path, shape, 1, eigen);
    else
      write_rows(eigen_path, shape, eigen);
  }

  /// Floats as they are; `values(row)` gives one along the first dimension.
  template <class Values>
  void write_rows(const char* name, const std::vector<hsize_t>& shape, Values values) {
    writer_.dataset(name, Hdf5Type::of<float>(), shape, 1,
                    [&](hsize_t row, hsize_t) { return values(row); });
  }

  void write_coefficients(const char* name, const std::vector<float>& coefficients, int terms) {
    const std::vector<hsize_t> shape = {transfer_.vertex_count(), extent(terms)};
    const auto values = [&](hsize_t v) { return coefficients.data() + v * extent(terms); };
    if (type_ == CoefficientType::float32) {
      writer_.array(name, shape, coefficients);
    } else if (type_ == CoefficientType::float16) {
      write_halves(name, shape, Hdf5Writer::chunk_rows(shape, sizeof(Eigen::half)), values);
    } else {
      const float step = int16_step(coefficients);
      write_encoded<std::int16_t>(
          writer_, name, shape, Hdf5Writer::chunk_rows(shape, sizeof(std::int16_t)), values,
          [step](float value, size_t) {
            // The last floats before infinity are a step further.
            const long steps = std::clamp(std::lrint(value / step), -kMostSteps, kMostSteps);
            return static_cast<std::int16_t>(steps);
          });
      writer_.attribute(name, kScaleFactor, step);
    }
  }

  template <class Values>
  void write_halves(const char* name, const std::vector<hsize_t>& shape, hsize_t rows_at_a_time,
                    Values values) {
    write_encoded<Eigen::half>(writer_, name, shape, rows_at_a_time, values,
                               [&](float value, size_t index) {
                                 const Eigen::half half(value);
                                 if (!Eigen::half_impl::isfinite(half))
                                   throw Error(ErrorKind::output, path_,
                                               fmt::format("{}, value {}: {} is beyond float16, "
                                                           "expected +-65504",
                                                           name, index, value));
                                 return half;
                               });
  }

  /// The least power of two whose 32767-fold is the largest magnitude or more: quotients and
  /// products are exact, and what was read can be written again without a change.
  static float int16_step(const std::vector<float>& values) {
    constexpr int kLeastExponent = -126;    // the least of a float that is not subnormal
    constexpr int kGreatestExponent = 113;  // 32767 steps are still a float
    float largest = 0;
    for (const float value : values) largest = std::max(largest, std::abs(value));
    if (largest == 0) return 1;
    int exponent = 0;
    if (std::frexp(largest / double{kMostSteps}, &exponent) == 0.5) --exponent;
    return std::ldexp(1.0f, std::clamp(exponent, kLeastExponent, kGreatestExponent));
  }

  void write_provenance() {
    const char* const object = transfer_path::kProvenance;
    const Provenance& provenance = transfer_.provenance;
    writer_.group(object);
    writer_.attribute(object, "version", provenance.version);
    writer_.attribute(object, "mesh_name", provenance.mesh_name);
    writer_.attribute(object, "mesh_hash", provenance.mesh_hash);
    writer_.attribute(object, "occluder_hash", provenance.occluder_hash);
    writer_.attribute(object, "directions", std::int32_t{provenance.directions});
    writer_.attribute(object, "coarsest", std::int32_t{provenance.coarsest});
    writer_.attribute(object, "origin_offset", provenance.origin_offset);
    writer_.attribute(object, "training_vertices", std::int32_t{provenance.training_vertices});
    writer_.attribute(object, "rays", provenance.rays);
    writer_.attribute(object, "residual_vertices", std::int32_t{provenance.residual_vertices});
    writer_.attribute(object, "residual_held_out", std::uint8_t{provenance.residual_held_out});
    writer_.attribute(object, "residual_rms_rad", provenance.residual_rms_rad);
    writer_.attribute(object, "wrong_sign_fraction", provenance.wrong_sign_fraction);
    write_errors(transfer_path::kSsdfErrors, provenance.ssdf_errors);
    write_errors(transfer_path::kLadderErrors, provenance.ladder_errors);
  }

  void write_errors(const char* name, const std::vector<LobeError>& errors) {
    writer_.dataset(name, Hdf5Type::of<double>(), {errors.size(), 2}, errors.data());
  }

  const Transfer& transfer_;
  const std::string& path_;
  CoefficientType type_;
  Hdf5Writer writer_;
};

}  // namespace

void write_transfer(const Transfer& transfer, const std::string& path,
                    const WriteTransferOptions& options) {
  if (options.compression_level < 0 || options.compression_level > 9)
    throw Error(ErrorKind::output, path,
                fmt::format("compression level {}, expected 0..9", options.compression_level));
  check_transfer(transfer, ErrorKind::output, path);
  OutputFile file(path);  // first: a target that cannot be written is no reason to compress
  const Hdf5Session session;
  TransferWriter writer(transfer, path, options);
  file.write(writer.write());
  file.commit();
}

}  // namespace burnish
