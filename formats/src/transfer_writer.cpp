#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>

#include "burnish/formats/output_file.h"
#include "hdf5_support.h"
#include "transfer_layout.h"

namespace burnish {
namespace {

static_assert(sizeof(Vector3f) == 3 * sizeof(float), "vectors are written as rows of floats");
static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
static_assert(std::endian::native == std::endian::little, "float16 is written as it is in memory");

constexpr hsize_t kChunkBytes = 1 << 20;
constexpr unsigned kMaxAttributes = 64;  // of a group

/// The memory of an HDF5 file that is open in memory, kept when HDF5 closes the file and would free
/// it. (H5Fget_file_image alters a byte of the superblock after its checksum was taken.)
struct FileMemory {
  void* data = nullptr;
  size_t capacity = 0;

  FileMemory() = default;
  FileMemory(const FileMemory&) = delete;
  FileMemory& operator=(const FileMemory&) = delete;
  ~FileMemory() { std::free(data); }

  H5FD_file_image_callbacks_t callbacks() {
    H5FD_file_image_callbacks_t callbacks = {};
    callbacks.image_malloc = [](size_t size, H5FD_file_image_op_t, void*) {
      return std::malloc(size);
    };
    callbacks.image_memcpy = [](void* to, const void* from, size_t size, H5FD_file_image_op_t,
                                void*) { return std::memcpy(to, from, size); };
    callbacks.image_realloc = [](void* memory, size_t size, H5FD_file_image_op_t, void* self) {
      static_cast<FileMemory*>(self)->capacity = size;
      return std::realloc(memory, size);
    };
    callbacks.image_free = [](void* memory, H5FD_file_image_op_t operation, void* self) -> herr_t {
      if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE)
        static_cast<FileMemory*>(self)->data = memory;
      else
        std::free(memory);
      return 0;
    };
    callbacks.udata_copy = [](void* self) { return self; };
    callbacks.udata_free = [](void*) -> herr_t { return 0; };
    callbacks.udata = this;
    return callbacks;
  }

  /// The file, up to the end that its superblock states.
  std::string_view bytes() const {
    constexpr size_t kEndOfFileField = 28;  // superblock version 3: an address of 8 bytes
    std::uint64_t end = 0;
    if (!data || capacity < kEndOfFileField + sizeof(end)) return {};
    std::memcpy(&end, static_cast<const char*>(data) + kEndOfFileField, sizeof(end));
    return {static_cast<const char*>(data), end <= capacity ? end : 0};
  }
};

class TransferWriter {
 public:
  TransferWriter(const std::string& path, int compression_level)
      : path_(path), compression_level_(compression_level) {
    Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    Hdf5Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    // In memory: HDF5 recovers badly from a full disk. The 1.10 file structures carry checksums.
    check(H5Pset_fapl_core(access.get(), kChunkBytes, false), "memory file");
    check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110), "version bounds");
    H5FD_file_image_callbacks_t callbacks = memory_.callbacks();
    check(H5Pset_file_image_callbacks(access.get(), &callbacks), "memory file");
    // No times anywhere: equal transfers must give equal bytes.
    check(H5Pset_obj_track_times(creation.get(), false), "creation properties");
    file_ = Hdf5Id(H5Fcreate("transfer", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
    check(file_.get(), "file");
  }

  void group(const char* name) {
    Hdf5Id properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
    check(H5Pset_obj_track_times(properties.get(), false), name);
    // All attributes in the group's own header; HDF5 would move more than 8 to a heap.
    check(H5Pset_attr_phase_change(properties.get(), kMaxAttributes, 0), name);
    Hdf5Id group(H5Gcreate2(file_.get(), name, H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                 H5Gclose);
    check(group.get(), name);
  }

  void dataset(const char* name, hid_t file_type, hid_t memory_type,
               const std::vector<hsize_t>& shape, const void* values) {
    const hsize_t element_bytes = H5Tget_size(file_type);
    Hdf5Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
    check(space.get(), name);
    Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    check(H5Pset_obj_track_times(properties.get(), false), name);
    const bool is_empty = std::find(shape.begin(), shape.end(), hsize_t{0}) != shape.end();
    if (!is_empty) {  // HDF5 has no chunks of nothing
      const std::vector<hsize_t> chunk = chunk_shape(shape, element_bytes);
      check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), name);
      check(H5Pset_shuffle(properties.get()), name);
      check(H5Pset_deflate(properties.get(), static_cast<unsigned>(compression_level_)), name);
      check(H5Pset_fletcher32(properties.get()), name);
    }
    Hdf5Id dataset(H5Dcreate2(file_.get(), name, file_type, space.get(), H5P_DEFAULT,
                              properties.get(), H5P_DEFAULT),
                   H5Dclose);
    check(dataset.get(), name);
    if (!is_empty)
      check(H5Dwrite(dataset.get(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
  }

  void points(const char* name, const std::vector<Vector3f>& values) {
    dataset(name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {values.size(), 3}, values.data());
  }
  void triangles(const char* name, const std::vector<Triangle>& values) {
    dataset(name, H5T_STD_U32LE, H5T_NATIVE_UINT32, {values.size(), 3}, values.data());
  }

  void attribute(const char* object, const char* name, hid_t file_type, hid_t memory_type,
                 const void* value) {
    Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    Hdf5Id attribute(H5Acreate_by_name(file_.get(), object, name, file_type, space.get(),
                                       H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
    check(attribute.get(), name);
    check(H5Awrite(attribute.get(), memory_type, value), name);
  }
  void attribute(const char* object, const char* name, const std::string& text) {
    // Of fixed length: variable strings live in a heap without checksums.
    Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    check(H5Tset_size(type.get(), text.size() + 1), name);
    check(H5Tset_cset(type.get(), H5T_CSET_UTF8), name);
    attribute(object, name, type.get(), type.get(), text.c_str());
  }
  void attribute(const char* object, const char* name, std::int32_t value) {
    attribute(object, name, H5T_STD_I32LE, H5T_NATIVE_INT32, &value);
  }
  void attribute(const char* object, const char* name, std::uint64_t value) {
    attribute(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, &value);
  }
  void attribute(const char* object, const char* name, double value) {
    attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
  }

  /// Closes the file; its bytes live as long as this object.
  std::string_view finish() {
    check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), "file");
    check(H5Fclose(file_.release()), "file");
    const std::string_view bytes = memory_.bytes();
    check(bytes.empty() ? -1 : 0, "file");
    return bytes;
  }

 private:
  void check(std::int64_t result, const char* place) const {
    if (result < 0)
      throw Error(ErrorKind::output, path_,
                  fmt::format("{}: cannot write HDF5: {}", place, hdf5_reason()));
  }

  /// As many whole rows, from the last dimension up, as a chunk's bytes allow.
  static std::vector<hsize_t> chunk_shape(const std::vector<hsize_t>& shape,
                                          hsize_t element_bytes) {
    std::vector<hsize_t> chunk(shape.size(), 1);
    hsize_t left = kChunkBytes / element_bytes;
    for (size_t d = shape.size(); d-- > 0;) {
      chunk[d] = std::clamp<hsize_t>(left, 1, shape[d]);
      left /= chunk[d];
    }
    return chunk;
  }

  const std::string& path_;
  int compression_level_;
  FileMemory memory_;  // outlives file_
  Hdf5Id file_;
};

void write_mesh(TransferWriter& writer, const Transfer& transfer) {
  writer.group("/mesh");
  writer.points(transfer_path::kPositions, transfer.positions);
  writer.points(transfer_path::kNormals, transfer.normals);
  writer.points(transfer_path::kTangents, transfer.tangents);
  writer.dataset(transfer_path::kFileVertex, H5T_STD_U32LE, H5T_NATIVE_UINT32,
                 {transfer.file_vertex.size()}, transfer.file_vertex.data());
  writer.triangles(transfer_path::kTriangles, transfer.triangles);
  writer.group("/occluders");
  writer.points(transfer_path::kOccluderPositions, transfer.occluder_positions);
  writer.triangles(transfer_path::kOccluderTriangles, transfer.occluder_triangles);
}

void write_bases(TransferWriter& writer, const std::vector<SsdfBasis>& bases) {
  const hsize_t count = bases.size(), terms = static_cast<hsize_t>(bases[0].terms);
  const hsize_t texels = bases[0].mean.size();
  std::vector<float> mean, eigen;
  mean.reserve(count * texels);
  eigen.reserve(count * texels * terms);
  for (const SsdfBasis& basis : bases) {
    mean.insert(mean.end(), basis.mean.begin(), basis.mean.end());
    eigen.insert(eigen.end(), basis.eigen.begin(), basis.eigen.end());
  }
  writer.dataset(transfer_path::kMean, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {count, texels},
                 mean.data());
  writer.dataset(transfer_path::kEigen, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, {count, texels, terms},
                 eigen.data());
}

void write_coefficients(TransferWriter& writer, const Transfer& transfer, CoefficientType type,
                        const std::string& path) {
  const std::vector<hsize_t> shape = {transfer.vertex_count(),
                                      static_cast<hsize_t>(transfer.terms())};
  if (type == CoefficientType::float32) {
    writer.dataset(transfer_path::kCoefficients, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, shape,
                   transfer.coefficients.data());
    return;
  }
  std::vector<Eigen::half> halves(transfer.coefficients.size());
  for (size_t i = 0; i < halves.size(); ++i) {
    halves[i] = Eigen::half(transfer.coefficients[i]);
    if (!Eigen::half_impl::isfinite(halves[i]))
      throw Error(ErrorKind::output, path,
                  fmt::format("{}, value {}: {} is beyond float16, expected +-65504",
                              transfer_path::kCoefficients, i, transfer.coefficients[i]));
  }
  const Hdf5Id half_type = hdf5_float16_type();
  writer.dataset(transfer_path::kCoefficients, half_type.get(), half_type.get(), shape,
                 halves.data());
}

void write_provenance(TransferWriter& writer, const Provenance& provenance) {
  const char* const object = transfer_path::kProvenance;
  writer.group(object);
  writer.attribute(object, "version", provenance.version);
  writer.attribute(object, "mesh_name", provenance.mesh_name);
  writer.attribute(object, "mesh_hash", provenance.mesh_hash);
  writer.attribute(object, "occluder_hash", provenance.occluder_hash);
  writer.attribute(object, "directions", std::int32_t{provenance.directions});
  writer.attribute(object, "training_vertices", std::int32_t{provenance.training_vertices});
  writer.attribute(object, "rays", provenance.rays);
  writer.attribute(object, "residual_rms_rad", provenance.residual_rms_rad);
  writer.attribute(object, "wrong_sign_fraction", provenance.wrong_sign_fraction);
}

}  // namespace

void write_transfer(const Transfer& transfer, const std::string& path,
                    const WriteTransferOptions& options) {
  if (options.compression_level < 0 || options.compression_level > 9)
    throw Error(ErrorKind::output, path,
                fmt::format("compression level {}, expected 0..9", options.compression_level));
  check_transfer(transfer, ErrorKind::output, path);
  OutputFile file(path);  // first: a target that cannot be written is no reason to compress
  const Hdf5Session session;
  TransferWriter writer(path, options.compression_level);
  writer.attribute("/", "format", std::string(kTransferFormatName));
  writer.attribute("/", "format_version", std::int32_t{kTransferFormatVersion});
  write_mesh(writer, transfer);
  writer.group("/visibility");
  writer.group("/visibility/ssdf");
  writer.group("/visibility/ssdf/basis");
  write_bases(writer, transfer.bases);
  write_coefficients(writer, transfer, options.coefficient_type, path);
  writer.dataset(transfer_path::kBasisId, H5T_STD_U8LE, H5T_NATIVE_UINT8,
                 {transfer.basis_id.size()}, transfer.basis_id.data());
  write_provenance(writer, transfer.provenance);
  file.write(writer.finish());
  file.commit();
}

}  // namespace burnish
