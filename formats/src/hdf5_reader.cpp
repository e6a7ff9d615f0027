#include "hdf5_reader.h"

#include <algorithm>
#include <atomic>
#include <cstring>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "file_bytes.h"
#include "transfer_layout.h"

namespace burnish {
namespace {

constexpr unsigned char kSuperblockVersion = 3;  // of HDF5 1.10: metadata has checksums
constexpr hsize_t kMaxChunkBytes = hsize_t{64} << 20;
constexpr hsize_t kMaxDeflateRatio = 1040;  // deflate cannot exceed 1032 : 1

/// HDF5 would copy a file in memory twice; it reads ours in place.
H5FD_file_image_callbacks_t in_place_callbacks(std::string& bytes) {
  H5FD_file_image_callbacks_t callbacks = {};
  callbacks.image_malloc = [](size_t size, H5FD_file_image_op_t, void* self) -> void* {
    auto& file = *static_cast<std::string*>(self);
    return size == file.size() ? file.data() : nullptr;
  };
  callbacks.image_memcpy = [](void* to, const void*, size_t, H5FD_file_image_op_t, void*) {
    return to;
  };
  callbacks.image_realloc = [](void*, size_t, H5FD_file_image_op_t, void*) -> void* {
    return nullptr;
  };
  callbacks.image_free = [](void*, H5FD_file_image_op_t, void*) -> herr_t { return 0; };
  callbacks.udata_copy = [](void* self) { return self; };
  callbacks.udata_free = [](void*) -> herr_t { return 0; };
  callbacks.udata = &bytes;
  return callbacks;
}

std::string attribute_place(const std::string& object, const char* name) {
  return fmt::format("{}, attribute {}", object, name);
}

std::string type_text(const Hdf5Type& type) {
  const H5T_class_t kind = H5Tget_class(type.file());
  const size_t bits = 8 * type.file_bytes();
  if (kind == H5T_FLOAT) return fmt::format("float{}", bits);
  return fmt::format("{}int{}", H5Tget_sign(type.file()) == H5T_SGN_NONE ? "u" : "", bits);
}

bool is_fixed_text(hid_t type) {
  const size_t size = H5Tget_size(type);
  return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 && size >= 1 &&
         size <= kMaxText + 1;
}

}  // namespace

Hdf5Reader::Hdf5Reader(const std::string& path) : path_(path), bytes_(read_file_bytes(path)) {
  if (!bytes_.starts_with(kHdf5Signature))
    throw Error(ErrorKind::input, path, "is not an HDF5 file, expected a burnish transfer");
  // Also keeps the library's older and less checked decoders out of reach.
  const auto superblock = bytes_.size() > kHdf5Signature.size()
                              ? static_cast<unsigned char>(bytes_[kHdf5Signature.size()])
                              : 0;
  if (superblock != kSuperblockVersion)
    throw Error(ErrorKind::input, path,
                fmt::format("HDF5 superblock version {}, expected {}: not written by burnish",
                            superblock, kSuperblockVersion));
  Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5FD_file_image_callbacks_t callbacks = in_place_callbacks(bytes_);
  const bool ok = H5Pset_fapl_core(access.get(), 1 << 20, false) >= 0 &&
                  H5Pset_file_image_callbacks(access.get(), &callbacks) >= 0 &&
                  H5Pset_file_image(access.get(), bytes_.data(), bytes_.size()) >= 0;
  // HDF5 takes two memory files of one name for one file.
  static std::atomic<std::uint64_t> opened = 0;
  const std::string name = fmt::format("burnish-memory-{}", opened++);
  if (ok) file_ = Hdf5Id(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!file_)
    throw Error(ErrorKind::input, path,
                fmt::format("broken or truncated HDF5 file: {}", hdf5_reason()));
}

void Hdf5Reader::fail(const std::string& place, const std::string& message) const {
  throw Error(ErrorKind::input, path_, place + ": " + message);
}

Hdf5Dataset Hdf5Reader::open_any_type(const char* name) const {
  check_path(name);
  Hdf5Dataset dataset;
  dataset.name = name;
  dataset.id = Hdf5Id(H5Dopen2(file_.get(), name, H5P_DEFAULT), H5Dclose);
  if (!dataset.id) fail(name, "damaged, or not a dataset: " + hdf5_reason());
  return dataset;
}

Hdf5Dataset Hdf5Reader::open(const char* name, const std::vector<const Hdf5Type*>& types,
                             const std::vector<hsize_t>& shape) const {
  Hdf5Dataset dataset = open_any_type(name);
  const Hdf5Id found(H5Dget_type(dataset.id.get()), H5Tclose);
  const auto type = std::find_if(types.begin(), types.end(), [&](const Hdf5Type* accepted) {
    return H5Tequal(found.get(), accepted->file()) > 0;
  });
  if (type == types.end()) {
    std::vector<std::string> names;
    for (const Hdf5Type* accepted : types) names.push_back(type_text(*accepted));
    fail(name, fmt::format("values of another type, expected {}, little endian",
                           fmt::join(names, " or ")));
  }
  dataset.type = static_cast<size_t>(type - types.begin());
  check_shape(dataset, shape);
  check_storage(dataset);
  return dataset;
}

void Hdf5Reader::read_rows(const Hdf5Dataset& dataset, const Hdf5Type& type, hsize_t first,
                           hsize_t rows, void* values) const {
  if (rows * dataset.row_size() == 0) return;
  std::vector<hsize_t> start(dataset.shape.size(), 0), count = dataset.shape;
  start[0] = first;
  count[0] = rows;
  const Hdf5Id memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                      H5Sclose);
  const Hdf5Id space(H5Dget_space(dataset.id.get()), H5Sclose);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                          nullptr) < 0 ||
      H5Dread(dataset.id.get(), type.memory(), memory.get(), space.get(), H5P_DEFAULT, values) < 0)
    fail(dataset.name, "damaged data: " + hdf5_reason());
}

std::vector<std::string> Hdf5Reader::read_texts(const char* name, hsize_t rows) const {
  Hdf5Dataset dataset = open_any_type(name);
  const Hdf5Id found(H5Dget_type(dataset.id.get()), H5Tclose);
  if (!is_fixed_text(found.get()))
    fail(name,
         fmt::format("values of another type, expected strings of fixed length up to {} bytes",
                     kMaxText));
  check_shape(dataset, {rows});
  check_storage(dataset);
  const size_t size = H5Tget_size(found.get());
  std::vector<std::string> texts;
  for (hsize_t first = 0; first < dataset.rows(); first += dataset.chunk_rows) {
    const hsize_t count = std::min(dataset.chunk_rows, dataset.rows() - first);
    std::string block(count * size, '\0');
    read_rows(dataset, Hdf5Type(found.get(), found.get()), first, count, block.data());
    for (hsize_t i = 0; i < count; ++i) {
      const char* const text = block.data() + i * size;
      texts.emplace_back(text, std::find(text, text + size, '\0'));
    }
  }
  return texts;
}

void Hdf5Reader::read_number(const std::string& object, const char* name, const Hdf5Type& type,
                             void* value) const {
  const Hdf5Id attribute = open_attribute(object, name);
  const Hdf5Id found(H5Aget_type(attribute.get()), H5Tclose);
  if (H5Tequal(found.get(), type.file()) <= 0)
    fail(attribute_place(object, name), "is not a number of the expected type");
  if (H5Aread(attribute.get(), type.memory(), value) < 0)
    fail(attribute_place(object, name), "cannot be read: " + hdf5_reason());
}

std::string Hdf5Reader::read_text(const std::string& object, const char* name) const {
  const Hdf5Id attribute = open_attribute(object, name);
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  if (!is_fixed_text(type.get()))
    fail(attribute_place(object, name),
         fmt::format("is not a string of fixed length up to {} bytes", kMaxText));
  std::string text(H5Tget_size(type.get()), '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0)
    fail(attribute_place(object, name), "cannot be read: " + hdf5_reason());
  text.resize(std::strlen(text.c_str()));
  return text;
}

/// Every group on the way must be there: HDF5 does not say which is missing.
void Hdf5Reader::check_path(const std::string& name) const {
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

bool Hdf5Reader::has(const char* name) const {
  const std::string path = name;
  check_path(path.substr(0, path.rfind('/')));
  const htri_t exists = H5Lexists(file_.get(), name, H5P_DEFAULT);
  if (exists < 0) fail(name, "damaged on the way to it: " + hdf5_reason());
  return exists > 0;
}

Hdf5Id Hdf5Reader::open_attribute(const std::string& object, const char* name) const {
  if (object != "/") check_path(object);
  const htri_t exists = H5Aexists_by_name(file_.get(), object.c_str(), name, H5P_DEFAULT);
  if (exists < 0) fail(object, "damaged: " + hdf5_reason());
  if (exists == 0) fail(attribute_place(object, name), "is missing");
  Hdf5Id attribute(H5Aopen_by_name(file_.get(), object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose);
  if (!attribute) fail(attribute_place(object, name), "cannot be opened: " + hdf5_reason());
  const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.get()) != 1)
    fail(attribute_place(object, name), "is not a single value");
  return attribute;
}

void Hdf5Reader::check_shape(Hdf5Dataset& dataset, const std::vector<hsize_t>& expected) const {
  const Hdf5Id space(H5Dget_space(dataset.id.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank != static_cast<int>(expected.size()))
    fail(dataset.name, fmt::format("has {} dimensions, expected {}", rank, expected.size()));
  dataset.shape.resize(expected.size());
  H5Sget_simple_extent_dims(space.get(), dataset.shape.data(), nullptr);
  for (size_t d = 0; d < expected.size(); ++d)
    if (expected[d] != kAnyExtent && dataset.shape[d] != expected[d])
      fail(dataset.name, fmt::format("shape [{}], expected {} along dimension {}",
                                     fmt::join(dataset.shape, "]["), expected[d], d));
}

/// The layout must be as we write it, all data present, and no larger than the bytes of the file
/// can stand for. After this, size() does not overflow and can be allocated.
void Hdf5Reader::check_storage(Hdf5Dataset& dataset) const {
  const Hdf5Id properties(H5Dget_create_plist(dataset.id.get()), H5Pclose);
  if (H5Pget_external_count(properties.get()) != 0)
    fail(dataset.name, "has its data in another file");
  bool is_empty = false;
  hsize_t elements = 1;
  const Hdf5Id type(H5Dget_type(dataset.id.get()), H5Tclose);
  const hsize_t element_bytes = H5Tget_size(type.get());
  const hsize_t most = std::numeric_limits<hsize_t>::max() / std::max<hsize_t>(element_bytes, 8);
  for (const hsize_t extent : dataset.shape) {
    is_empty |= extent == 0;
    if (extent > 0 && elements > most / extent)
      fail(dataset.name, fmt::format("impossible shape [{}]", fmt::join(dataset.shape, "][")));
    elements *= std::max<hsize_t>(extent, 1);
  }
  if (is_empty) return;
  check_chunks(dataset, properties.get(), element_bytes);
  const hsize_t stored = H5Dget_storage_size(dataset.id.get());
  if (stored > bytes_.size() || elements * element_bytes / kMaxDeflateRatio > stored)
    fail(dataset.name, fmt::format("shape [{}] in {} stored bytes of a file of {}",
                                   fmt::join(dataset.shape, "]["), stored, bytes_.size()));
}

void Hdf5Reader::check_chunks(Hdf5Dataset& dataset, hid_t properties, hsize_t element_bytes) const {
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
    fail(dataset.name,
         "another storage layout, expected chunks with shuffle, deflate and Fletcher-32");
  std::vector<hsize_t> chunk(dataset.shape.size());
  H5Pget_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
  hsize_t bytes = element_bytes, expected = 1, found = 0;
  for (size_t d = 0; d < chunk.size(); ++d) {
    if (chunk[d] < 1 || chunk[d] > kMaxChunkBytes / bytes)
      fail(dataset.name, fmt::format("chunks of more than {} bytes", kMaxChunkBytes));
    bytes *= chunk[d];
    expected *= (dataset.shape[d] - 1) / chunk[d] + 1;
  }
  // HDF5 reads chunks that are not there as zeros.
  const Hdf5Id space(H5Dget_space(dataset.id.get()), H5Sclose);
  if (H5Dget_num_chunks(dataset.id.get(), space.get(), &found) < 0 || found != expected)
    fail(dataset.name, fmt::format("{} of {} chunks are there", found, expected));
  dataset.chunk_rows = chunk[0];
}

}  // namespace burnish
