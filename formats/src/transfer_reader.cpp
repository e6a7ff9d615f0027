#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "burnish/visibility/visibility_ladder.h"
#include "file_bytes.h"
#include "hdf5_reader.h"
#include "transfer_layout.h"

namespace burnish {
namespace {

constexpr hsize_t kBlockBytes = 1 << 20;

class TransferReader {
 public:
  explicit TransferReader(const std::string& path) : reader_(path) {
    const std::string format = reader_.read_text("/", "format");
    if (format != kTransferFormatName)
      reader_.fail("/, attribute format",
                   fmt::format("'{}', expected '{}'", format, kTransferFormatName));
    version_ = reader_.read_attribute<std::int32_t>("/", "format_version");
    if (version_ > kTransferFormatVersion)
      throw Error(ErrorKind::unsupported, path,
                  fmt::format("transfer format version {}, this build reads up to {}", version_,
                              kTransferFormatVersion));
    if (version_ < 1)
      reader_.fail("/, attribute format_version", fmt::format("{}, expected 1 or more", version_));
  }

  Transfer read() {
    read_mesh();
    if (version_ == 1) {
      read_ssdf();
    } else {
      const std::int32_t bases = read_count("bases");
      const std::int32_t ladder_bases = read_count("ladder_bases");
      if (bases > 0) read_ssdf(static_cast<hsize_t>(bases));
      if (ladder_bases > 0) read_ladder(static_cast<hsize_t>(ladder_bases));
    }
    read_provenance();
    return std::move(transfer_);
  }

 private:
  std::vector<Vector3f> read_points(const char* name, hsize_t rows) const {
    return reader_.read<float, Vector3f>(name, {rows, 3});
  }
  std::vector<Triangle> read_triangles(const char* name) const {
    return reader_.read<std::uint32_t, Triangle>(name, {kAnyExtent, 3});
  }

  void read_mesh() {
    transfer_.positions = read_points(transfer_path::kPositions, kAnyExtent);
    vertices_ = transfer_.positions.size();
    transfer_.normals = read_points(transfer_path::kNormals, vertices_);
    transfer_.tangents = read_points(transfer_path::kTangents, vertices_);
    transfer_.file_vertex = reader_.read<std::uint32_t>(transfer_path::kFileVertex, {vertices_});
    transfer_.triangles = read_triangles(transfer_path::kTriangles);
    if (version_ >= 2) read_parts();
    if (version_ >= 2 && reader_.has(transfer_path::kTexcoords))
      transfer_.texcoords =
          reader_.read<float, Vector2<float>>(transfer_path::kTexcoords, {vertices_, 2});
    transfer_.occluder_positions = read_points(transfer_path::kOccluderPositions, kAnyExtent);
    transfer_.occluder_triangles = read_triangles(transfer_path::kOccluderTriangles);
  }

  void read_parts() {
    const std::vector<std::uint32_t> ranges =
        reader_.read<std::uint32_t>(transfer_path::kPartRanges, {kAnyExtent, 4});
    std::vector<std::string> names =
        reader_.read_texts(transfer_path::kPartNames, ranges.size() / 4);
    for (size_t i = 0; i < names.size(); ++i)
      transfer_.parts.push_back({.name = std::move(names[i]),
                                 .first_vertex = ranges[4 * i],
                                 .vertices = ranges[4 * i + 1],
                                 .first_triangle = ranges[4 * i + 2],
                                 .triangles = ranges[4 * i + 3]});
  }

  std::int32_t read_count(const char* name) const {
    const auto count = reader_.read_attribute<std::int32_t>(transfer_path::kVisibility, name);
    if (count < 0 || count > kMaxBases)
      reader_.fail(fmt::format("{}, attribute {}", transfer_path::kVisibility, name),
                   fmt::format("{}, expected 0..{}", count, kMaxBases));
    return count;
  }

  /// The root of a count that must be a square.
  int edge_of(const char* name, const char* what, hsize_t count, int most) const {
    const auto edge = static_cast<hsize_t>(std::llround(std::sqrt(double(count))));
    if (edge > static_cast<hsize_t>(most) || edge * edge != count)
      reader_.fail(name, fmt::format("{} {}, expected a square up to {}^2", count, what, most));
    return static_cast<int>(edge);
  }

  void check_extent(const char* name, const char* what, hsize_t count, int most) const {
    if (count < 1 || count > static_cast<hsize_t>(most))
      reader_.fail(name, fmt::format("{} {}, expected 1..{}", count, what, most));
  }

  /// Rows that may be stored as floats, as float16, or as integers with a scale.
  void read_rows(const Hdf5Dataset& dataset, hsize_t first, hsize_t rows, float scale,
                 float* values) const {
    if (dataset.type == 0) return reader_.read_rows(dataset, float32_, first, rows, values);
    if (dataset.type == 1)
      return decode_rows<Eigen::half>(dataset, float16_, first, rows, values,
                                      [](Eigen::half value) { return float(value); });
    decode_rows<std::int16_t>(dataset, int16_, first, rows, values,
                              [scale](std::int16_t value) { return scale * float(value); });
  }

  template <class Stored, class Decode>
  void decode_rows(const Hdf5Dataset& dataset, const Hdf5Type& type, hsize_t first, hsize_t rows,
                   float* values, Decode decode) const {
    std::vector<Stored> block(rows * dataset.row_size());
    reader_.read_rows(dataset, type, first, rows, block.data());
    std::transform(block.begin(), block.end(), values, decode);
  }

  /// Means and eigenimages of each basis.
  template <class Basis>
  void read_images(const Hdf5Dataset& mean, const Hdf5Dataset& eigen,
                   std::vector<Basis>& bases) const {
    for (size_t b = 0; b < bases.size(); ++b) {
      bases[b].mean.resize(mean.row_size());
      read_rows(mean, b, 1, 1, bases[b].mean.data());
      bases[b].eigen.resize(eigen.row_size());
      read_rows(eigen, b, 1, 1, bases[b].eigen.data());
    }
  }

  std::vector<float> read_coefficients(const char* name, int terms) const {
    const std::vector<hsize_t> shape = {vertices_, static_cast<hsize_t>(terms)};
    const Hdf5Dataset dataset = version_ == 1
                                    ? reader_.open(name, {&float32_, &float16_}, shape)
                                    : reader_.open(name, {&float32_, &float16_, &int16_}, shape);
    const float scale = dataset.type == 2 ? read_scale(name) : 1;
    std::vector<float> coefficients(dataset.size());
    const hsize_t row_size = dataset.row_size();
    const hsize_t chunks = kBlockBytes / (dataset.chunk_rows * row_size * sizeof(std::int16_t));
    const hsize_t block = dataset.chunk_rows * std::max<hsize_t>(chunks, 1);
    for (hsize_t first = 0; first < vertices_; first += block)
      read_rows(dataset, first, std::min(block, vertices_ - first), scale,
                coefficients.data() + first * row_size);
    return coefficients;
  }

  float read_scale(const char* name) const {
    const auto scale = reader_.read_attribute<float>(name, kScaleFactor);
    if (!(scale > 0) || !std::isfinite(scale))
      reader_.fail(fmt::format("{}, attribute {}", name, kScaleFactor),
                   fmt::format("{}, expected a positive number", scale));
    return scale;
  }

  void read_ssdf(hsize_t count = kAnyExtent) {
    const Hdf5Dataset mean = reader_.open(transfer_path::kMean, {&float32_}, {count, kAnyExtent});
    check_extent(transfer_path::kMean, "bases", mean.rows(), kMaxBases);
    SsdfBasis basis;
    basis.resolution = edge_of(transfer_path::kMean, "texels", mean.shape[1], kMaxSsdfResolution);
    const std::vector<hsize_t> shape = {mean.rows(), mean.shape[1], kAnyExtent};
    const Hdf5Dataset eigen =
        version_ == 1 ? reader_.open(transfer_path::kEigen, {&float32_}, shape)
                      : reader_.open(transfer_path::kEigen, {&float32_, &float16_}, shape);
    check_extent(transfer_path::kEigen, "terms", eigen.shape[2], kMaxTerms);
    basis.terms = static_cast<int>(eigen.shape[2]);
    if (version_ >= 2)
      basis.amplitude_rad = reader_.read_attribute<float>(transfer_path::kSsdf, "amplitude_rad");
    transfer_.bases.assign(mean.rows(), basis);
    read_images(mean, eigen, transfer_.bases);
    transfer_.coefficients = read_coefficients(transfer_path::kCoefficients, basis.terms);
    transfer_.basis_id = reader_.read<std::uint8_t>(transfer_path::kBasisId, {vertices_});
  }

  void read_ladder(hsize_t count) {
    const Hdf5Dataset mean =
        reader_.open(transfer_path::kLadderMean, {&float32_}, {count, kAnyExtent});
    LadderBasis basis;
    basis.bands = edge_of(transfer_path::kLadderMean, "harmonics", mean.shape[1], kMaxLadderBands);
    const Hdf5Dataset eigen =
        reader_.open(transfer_path::kLadderEigen, {&float32_}, {count, mean.shape[1], kAnyExtent});
    check_extent(transfer_path::kLadderEigen, "terms", eigen.shape[2], kMaxTerms);
    basis.terms = static_cast<int>(eigen.shape[2]);
    transfer_.ladder_bases.assign(count, basis);
    read_images(mean, eigen, transfer_.ladder_bases);
    transfer_.ladder_coefficients =
        read_coefficients(transfer_path::kLadderCoefficients, basis.terms);
    transfer_.ladder_crossover = reader_.read_attribute<float>(transfer_path::kLadder, "crossover");
  }

  void read_provenance() {
    const char* const object = transfer_path::kProvenance;
    Provenance& provenance = transfer_.provenance;
    provenance.version = reader_.read_text(object, "version");
    provenance.mesh_name = reader_.read_text(object, "mesh_name");
    provenance.mesh_hash = reader_.read_text(object, "mesh_hash");
    provenance.occluder_hash = reader_.read_text(object, "occluder_hash");
    provenance.directions = reader_.read_attribute<std::int32_t>(object, "directions");
    provenance.training_vertices =
        reader_.read_attribute<std::int32_t>(object, "training_vertices");
    provenance.rays = reader_.read_attribute<std::uint64_t>(object, "rays");
    provenance.residual_rms_rad = reader_.read_attribute<double>(object, "residual_rms_rad");
    provenance.wrong_sign_fraction = reader_.read_attribute<double>(object, "wrong_sign_fraction");
    if (version_ == 1) return;
    provenance.coarsest = reader_.read_attribute<std::int32_t>(object, "coarsest");
    provenance.origin_offset = reader_.read_attribute<double>(object, "origin_offset");
    provenance.residual_vertices =
        reader_.read_attribute<std::int32_t>(object, "residual_vertices");
    provenance.residual_held_out = read_flag(object, "residual_held_out");
    provenance.ssdf_errors = read_errors(transfer_path::kSsdfErrors);
    provenance.ladder_errors = read_errors(transfer_path::kLadderErrors);
  }

  bool read_flag(const char* object, const char* name) const {
    const auto flag = reader_.read_attribute<std::uint8_t>(object, name);
    if (flag > 1)
      reader_.fail(fmt::format("{}, attribute {}", object, name),
                   fmt::format("{}, expected 0 or 1", flag));
    return flag == 1;
  }

  std::vector<LobeError> read_errors(const char* name) const {
    return reader_.read<double, LobeError>(name, {kAnyExtent, 2});
  }

  Hdf5Reader reader_;
  const Hdf5Type float32_ = Hdf5Type::of<float>();
  const Hdf5Type float16_ = Hdf5Type::of<Eigen::half>();
  const Hdf5Type int16_ = Hdf5Type::of<std::int16_t>();
  std::int32_t version_ = 0;
  hsize_t vertices_ = 0;
  Transfer transfer_;
};

}  // namespace

Transfer read_transfer(const std::string& path) {
  Transfer transfer;
  {
    const Hdf5Session session;
    transfer = TransferReader(path).read();
  }
  check_transfer(transfer, ErrorKind::input, path);
  return transfer;
}

bool is_hdf5_file(const std::string& path) {
  try {
    return read_file_start(path, kHdf5Signature.size()) == kHdf5Signature;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace burnish
