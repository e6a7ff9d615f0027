#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "file_bytes.h"
#include "hdf5_support.h"
#include "transfer_layout.h"

namespace burnish {
namespace {

constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n";
constexpr unsigned char kSuperblockVersion = 3;  // of HDF5 1.10: metadata has checksums
constexpr hsize_t kMaxChunkBytes = hsize_t{64} << 20;
constexpr hsize_t kMaxDeflateRatio = 1040;  // deflate cannot exceed 1032 : 1
constexpr hsize_t kAny = std::numeric_limits<hsize_t>::max();

/// One dataset whose type, shape and storage were found as they must be.
struct CheckedDataset {
  Hdf5Id id;
  std::vector<hsize_t> shape;
  bool is_float16 = false;

  hsize_t size() const {
    hsize_t product = 1;
    for (const hsize_t extent : shape) product *= extent;
    return product;
  }
};

class TransferReader {
 public:
  explicit TransferReader(const std::string& path) : path_(path) {
    const std::string bytes = read_file_bytes(path);
    file_bytes_ = bytes.size();
    if (bytes.compare(0, kHdf5Signature.size(), kHdf5Signature) != 0)
      throw Error(ErrorKind::input, path, "is not an HDF5 file, expected a burnish transfer");
    // Also keeps the library's older and less checked decoders out of reach.
    const auto superblock = bytes.size() > kHdf5Signature.size()
                                ? static_cast<unsigned char>(bytes[kHdf5Signature.size()])
                                : 0;
    if (superblock != kSuperblockVersion)
      throw Error(ErrorKind::input, path,
                  fmt::format("HDF5 superblock version {}, expected {}: not written by burnish",
                              superblock, kSuperblockVersion));
    Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    bool ok = H5Pset_fapl_core(access.get(), 1 << 20, false) >= 0 &&
              H5Pset_file_image(access.get(), const_cast<char*>(bytes.data()), bytes.size()) >= 0;
    // HDF5 takes two memory files of one name for one file.
    static std::atomic<std::uint64_t> opened = 0;
    const std::string name = fmt::format("burnish-transfer-{}", opened++);
    if (ok) file_ = Hdf5Id(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
    if (!file_)
      throw Error(ErrorKind::input, path,
                  fmt::format("broken or truncated HDF5 file: {}", hdf5_reason()));
  }

  [[noreturn]] void fail(const std::string& place, const std::string& message) const {
    throw Error(ErrorKind::input, path_, place + ": " + message);
  }

  /// Opens a dataset after checks. `shape` has the expected extents, or kAny.
  CheckedDataset open(const char* name, hid_t type, std::vector<hsize_t> shape,
                      bool allow_float16 = false) const {
    check_path(name);
    CheckedDataset dataset;
    dataset.id = Hdf5Id(H5Dopen2(file_.get(), name, H5P_DEFAULT), H5Dclose);
    if (!dataset.id) fail(name, "damaged, or not a dataset: " + hdf5_reason());
    check_type(name, dataset, type, allow_float16);
    check_shape(name, dataset, shape);
    check_storage(name, dataset);
    return dataset;
  }

  void read(const char* name, const CheckedDataset& dataset, hid_t memory_type,
            void* values) const {
    if (dataset.size() == 0) return;
    if (H5Dread(dataset.id.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
      fail(name, "damaged data: " + hdf5_reason());
  }

  template <class T>
  std::vector<T> read_vector(const char* name, hid_t file_type, hid_t memory_type,
                             std::vector<hsize_t> shape) const {
    const CheckedDataset dataset = open(name, file_type, std::move(shape));
    const hsize_t rows = dataset.shape[0];
    std::vector<T> values(rows);
    read(name, dataset, memory_type, values.data());
    return values;
  }
  std::vector<Vector3f> read_points(const char* name, hsize_t rows) const {
    return read_vector<Vector3f>(name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {rows, 3});
  }
  std::vector<Triangle> read_triangles(const char* name) const {
    return read_vector<Triangle>(name, H5T_STD_U32LE, H5T_NATIVE_UINT32, {kAny, 3});
  }

  template <class T>
  T read_number(const char* object, const char* name, hid_t file_type, hid_t memory_type) const {
    const Hdf5Id attribute = open_attribute(object, name);
    const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
    T value = {};
    if (H5Tequal(type.get(), file_type) <= 0)
      fail(attribute_place(object, name), "is not a number of the expected type");
    if (H5Aread(attribute.get(), memory_type, &value) < 0)
      fail(attribute_place(object, name), "cannot be read: " + hdf5_reason());
    return value;
  }
  std::int32_t read_int(const char* object, const char* name) const {
    return read_number<std::int32_t>(object, name, H5T_STD_I32LE, H5T_NATIVE_INT32);
  }
  double read_double(const char* object, const char* name) const {
    return read_number<double>(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE);
  }

  std::string read_text(const char* object, const char* name) const {
    const Hdf5Id attribute = open_attribute(object, name);
    const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
    const size_t size = H5Tget_size(type.get());
    if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0 || size < 1 ||
        size > kMaxAttributeString + 1)
      fail(attribute_place(object, name),
           fmt::format("is not a string of fixed length up to {} bytes", kMaxAttributeString));
    std::string text(size, '\0');
    if (H5Aread(attribute.get(), type.get(), text.data()) < 0)
      fail(attribute_place(object, name), "cannot be read: " + hdf5_reason());
    text.resize(std::strlen(text.c_str()));
    return text;
  }

 private:
  static std::string attribute_place(const char* object, const char* name) {
    return fmt::format("{}, attribute {}", object, name);
  }

  /// Every group on the way must be there: HDF5 does not say which is missing.
  void check_path(const std::string& name) const {
    for (size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
      const std::string part = name.substr(0, end);
      const htri_t exists = H5Lexists(file_.get(), part.c_str(), H5P_DEFAULT);
      if (exists < 0) fail(part, "damaged on the way to it: " + hdf5_reason());
      if (exists == 0) fail(part, "is missing");
      H5L_info_t link = {};  // links may lead to other files
      if (H5Lget_info(file_.get(), part.c_str(), &link, H5P_DEFAULT) < 0 ||
          link.type != H5L_TYPE_HARD)
        fail(part, "is a link to another place");
      if (end == std::string::npos) return;
    }
  }

  Hdf5Id open_attribute(const char* object, const char* name) const {
    if (std::string_view(object) != "/") check_path(object);
    const htri_t exists = H5Aexists_by_name(file_.get(), object, name, H5P_DEFAULT);
    if (exists < 0) fail(object, "damaged: " + hdf5_reason());
    if (exists == 0) fail(attribute_place(object, name), "is missing");
    Hdf5Id attribute(H5Aopen_by_name(file_.get(), object, name, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
    if (!attribute) fail(attribute_place(object, name), "cannot be opened: " + hdf5_reason());
    const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose);
    if (H5Sget_simple_extent_npoints(space.get()) != 1)
      fail(attribute_place(object, name), "is not a single value");
    return attribute;
  }

  void check_type(const char* name, CheckedDataset& dataset, hid_t type, bool allow_float16) const {
    const Hdf5Id found(H5Dget_type(dataset.id.get()), H5Tclose);
    if (H5Tequal(found.get(), type) > 0) return;
    const Hdf5Id half_type = hdf5_float16_type();
    dataset.is_float16 = allow_float16 && H5Tequal(found.get(), half_type.get()) > 0;
    if (dataset.is_float16) return;
    const char* kind = H5Tget_class(type) == H5T_FLOAT ? "floating-point" : "unsigned integer";
    fail(name, fmt::format("values of another type, expected {} of {} bits{}, little endian", kind,
                           8 * H5Tget_size(type), allow_float16 ? " (or 16)" : ""));
  }

  void check_shape(const char* name, CheckedDataset& dataset,
                   const std::vector<hsize_t>& expected) const {
    const Hdf5Id space(H5Dget_space(dataset.id.get()), H5Sclose);
    const int rank = H5Sget_simple_extent_ndims(space.get());
    if (rank != static_cast<int>(expected.size()))
      fail(name, fmt::format("has {} dimensions, expected {}", rank, expected.size()));
    dataset.shape.resize(expected.size());
    H5Sget_simple_extent_dims(space.get(), dataset.shape.data(), nullptr);
    for (size_t d = 0; d < expected.size(); ++d)
      if (expected[d] != kAny && dataset.shape[d] != expected[d])
        fail(name, fmt::format("shape [{}], expected {} along dimension {}",
                               fmt::join(dataset.shape, "]["), expected[d], d));
  }

  /// The layout must be as we write it, all data present, and no larger than the bytes of the file
  /// can stand for. After this, size() does not overflow and can be allocated.
  void check_storage(const char* name, const CheckedDataset& dataset) const {
    const Hdf5Id properties(H5Dget_create_plist(dataset.id.get()), H5Pclose);
    if (H5Pget_external_count(properties.get()) != 0) fail(name, "has its data in another file");
    bool is_empty = false;
    hsize_t elements = 1;
    for (const hsize_t extent : dataset.shape) {
      is_empty |= extent == 0;
      if (extent > 0 && elements > std::numeric_limits<hsize_t>::max() / 8 / extent)
        fail(name, fmt::format("impossible shape [{}]", fmt::join(dataset.shape, "][")));
      elements *= std::max<hsize_t>(extent, 1);
    }
    if (is_empty) return;
    const Hdf5Id type(H5Dget_type(dataset.id.get()), H5Tclose);
    const hsize_t element_bytes = H5Tget_size(type.get());
    check_chunks(name, dataset, properties.get(), element_bytes);
    const hsize_t stored = H5Dget_storage_size(dataset.id.get());
    if (stored > file_bytes_ || elements * element_bytes / kMaxDeflateRatio > stored)
      fail(name, fmt::format("shape [{}] in {} stored bytes of a file of {}",
                             fmt::join(dataset.shape, "]["), stored, file_bytes_));
  }

  void check_chunks(const char* name, const CheckedDataset& dataset, hid_t properties,
                    hsize_t element_bytes) const {
    constexpr H5Z_filter_t kFilters[] = {H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE,
                                         H5Z_FILTER_FLETCHER32};
    bool as_written = H5Pget_layout(properties) == H5D_CHUNKED &&
                      H5Pget_nfilters(properties) == static_cast<int>(std::size(kFilters));
    for (unsigned i = 0; as_written && i < std::size(kFilters); ++i) {
      unsigned flags = 0, filter_config = 0;
      size_t values = 0;
      as_written = H5Pget_filter2(properties, i, &flags, &values, nullptr, 0, nullptr,
                                  &filter_config) == kFilters[i];
    }
    if (!as_written)
      fail(name, "another storage layout, expected chunks with shuffle, deflate and Fletcher-32");
    std::vector<hsize_t> chunk(dataset.shape.size());
    H5Pget_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    hsize_t bytes = element_bytes, expected = 1, found = 0;
    for (size_t d = 0; d < chunk.size(); ++d) {
      if (chunk[d] < 1 || chunk[d] > kMaxChunkBytes / bytes)
        fail(name, fmt::format("chunks of more than {} bytes", kMaxChunkBytes));
      bytes *= chunk[d];
      expected *= (dataset.shape[d] - 1) / chunk[d] + 1;
    }
    // HDF5 reads chunks that are not there as zeros.
    const Hdf5Id space(H5Dget_space(dataset.id.get()), H5Sclose);
    if (H5Dget_num_chunks(dataset.id.get(), space.get(), &found) < 0 || found != expected)
      fail(name, fmt::format("{} of {} chunks are there", found, expected));
  }

  const std::string& path_;
  hsize_t file_bytes_ = 0;
  Hdf5Id file_;
};

void check_format(const TransferReader& reader, const std::string& path) {
  const std::string format = reader.read_text("/", "format");
  if (format != kTransferFormatName)
    reader.fail("/, attribute format",
                fmt::format("'{}', expected '{}'", format, kTransferFormatName));
  const std::int32_t version = reader.read_int("/", "format_version");
  if (version > kTransferFormatVersion)
    throw Error(ErrorKind::unsupported, path,
                fmt::format("transfer format version {}, this build reads up to {}", version,
                            kTransferFormatVersion));
  if (version < 1)
    reader.fail("/, attribute format_version", fmt::format("{}, expected 1 or more", version));
}

int resolution_of(const TransferReader& reader, hsize_t texels) {
  const auto resolution = static_cast<hsize_t>(std::llround(std::sqrt(double(texels))));
  constexpr hsize_t kMaxTexels = hsize_t{kMaxSsdfResolution} * kMaxSsdfResolution;
  if (texels > kMaxTexels || resolution * resolution != texels)
    reader.fail(transfer_path::kMean,
                fmt::format("{} texels, expected a square up to {}", texels, kMaxTexels));
  return static_cast<int>(resolution);
}

std::vector<SsdfBasis> read_bases(const TransferReader& reader) {
  const CheckedDataset mean_data = reader.open(transfer_path::kMean, H5T_IEEE_F32LE, {kAny, kAny});
  const hsize_t count = mean_data.shape[0], texels = mean_data.shape[1];
  if (count < 1 || count > kMaxBases)
    reader.fail(transfer_path::kMean, fmt::format("{} bases, expected 1..{}", count, kMaxBases));
  const int resolution = resolution_of(reader, texels);
  const CheckedDataset eigen_data =
      reader.open(transfer_path::kEigen, H5T_IEEE_F32LE, {count, texels, kAny});
  const hsize_t terms = eigen_data.shape[2];
  if (terms < 1 || terms > kMaxTerms)
    reader.fail(transfer_path::kEigen, fmt::format("{} terms, expected 1..{}", terms, kMaxTerms));
  std::vector<float> mean(mean_data.size()), eigen(eigen_data.size());
  reader.read(transfer_path::kMean, mean_data, H5T_NATIVE_FLOAT, mean.data());
  reader.read(transfer_path::kEigen, eigen_data, H5T_NATIVE_FLOAT, eigen.data());
  std::vector<SsdfBasis> bases(count);
  for (size_t b = 0; b < count; ++b) {
    const float* first_mean = mean.data() + b * texels;
    const float* first_eigen = eigen.data() + b * texels * terms;
    bases[b].resolution = resolution;
    bases[b].terms = static_cast<int>(terms);
    bases[b].mean.assign(first_mean, first_mean + texels);
    bases[b].eigen.assign(first_eigen, first_eigen + texels * terms);
  }
  return bases;
}

std::vector<float> read_coefficients(const TransferReader& reader, hsize_t vertices,
                                     hsize_t terms) {
  const char* const name = transfer_path::kCoefficients;
  const CheckedDataset dataset = reader.open(name, H5T_IEEE_F32LE, {vertices, terms}, true);
  std::vector<float> coefficients(dataset.size());
  if (!dataset.is_float16) {
    reader.read(name, dataset, H5T_NATIVE_FLOAT, coefficients.data());
    return coefficients;
  }
  std::vector<Eigen::half> halves(dataset.size());
  reader.read(name, dataset, hdf5_float16_type().get(), halves.data());
  std::transform(halves.begin(), halves.end(), coefficients.begin(),
                 [](Eigen::half value) { return static_cast<float>(value); });
  return coefficients;
}

Provenance read_provenance(const TransferReader& reader) {
  const char* const object = transfer_path::kProvenance;
  Provenance provenance;
  provenance.version = reader.read_text(object, "version");
  provenance.mesh_name = reader.read_text(object, "mesh_name");
  provenance.mesh_hash = reader.read_text(object, "mesh_hash");
  provenance.occluder_hash = reader.read_text(object, "occluder_hash");
  provenance.directions = reader.read_int(object, "directions");
  provenance.training_vertices = reader.read_int(object, "training_vertices");
  provenance.rays =
      reader.read_number<std::uint64_t>(object, "rays", H5T_STD_U64LE, H5T_NATIVE_UINT64);
  provenance.residual_rms_rad = reader.read_double(object, "residual_rms_rad");
  provenance.wrong_sign_fraction = reader.read_double(object, "wrong_sign_fraction");
  return provenance;
}

}  // namespace

Transfer read_transfer(const std::string& path) {
  Transfer transfer;
  {
    const Hdf5Session session;
    const TransferReader reader(path);
    check_format(reader, path);
    transfer.positions = reader.read_points(transfer_path::kPositions, kAny);
    const hsize_t vertices = transfer.positions.size();
    transfer.normals = reader.read_points(transfer_path::kNormals, vertices);
    transfer.tangents = reader.read_points(transfer_path::kTangents, vertices);
    transfer.file_vertex = reader.read_vector<std::uint32_t>(
        transfer_path::kFileVertex, H5T_STD_U32LE, H5T_NATIVE_UINT32, {vertices});
    transfer.triangles = reader.read_triangles(transfer_path::kTriangles);
    transfer.bases = read_bases(reader);
    transfer.coefficients =
        read_coefficients(reader, vertices, static_cast<hsize_t>(transfer.terms()));
    transfer.basis_id = reader.read_vector<std::uint8_t>(transfer_path::kBasisId, H5T_STD_U8LE,
                                                         H5T_NATIVE_UINT8, {vertices});
    transfer.occluder_positions = reader.read_points(transfer_path::kOccluderPositions, kAny);
    transfer.occluder_triangles = reader.read_triangles(transfer_path::kOccluderTriangles);
    transfer.provenance = read_provenance(reader);
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
