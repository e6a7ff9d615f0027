#include "hdf5_writer.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "burnish/formats/error.h"

namespace burnish {
namespace {

constexpr hsize_t kChunkBytes = 1 << 20;
constexpr unsigned kMaxAttributes = 64;  // of a group

/// Keeps the memory when HDF5 closes the file and would free it. (H5Fget_file_image alters a byte
/// of the superblock after its checksum was taken.)
H5FD_file_image_callbacks_t memory_callbacks(Hdf5Memory& memory) {
  H5FD_file_image_callbacks_t callbacks = {};
  callbacks.image_malloc = [](size_t size, H5FD_file_image_op_t, void*) {
    return std::malloc(size);
  };
  callbacks.image_memcpy = [](void* to, const void* from, size_t size, H5FD_file_image_op_t,
                              void*) { return std::memcpy(to, from, size); };
  callbacks.image_realloc = [](void* data, size_t size, H5FD_file_image_op_t, void* self) {
    static_cast<Hdf5Memory*>(self)->capacity = size;
    return std::realloc(data, size);
  };
  callbacks.image_free = [](void* data, H5FD_file_image_op_t operation, void* self) -> herr_t {
    if (operation == H5FD_FILE_IMAGE_OP_FILE_CLOSE)
      static_cast<Hdf5Memory*>(self)->data = data;
    else
      std::free(data);
    return 0;
  };
  callbacks.udata_copy = [](void* self) { return self; };
  callbacks.udata_free = [](void*) -> herr_t { return 0; };
  callbacks.udata = &memory;
  return callbacks;
}

/// The file, up to the end that its superblock states.
std::string_view file_bytes(const Hdf5Memory& memory) {
  constexpr size_t kEndOfFileField = 28;  // superblock version 3: an address of 8 bytes
  std::uint64_t end = 0;
  if (!memory.data || memory.capacity < kEndOfFileField + sizeof(end)) return {};
  std::memcpy(&end, static_cast<const char*>(memory.data) + kEndOfFileField, sizeof(end));
  return {static_cast<const char*>(memory.data), end <= memory.capacity ? end : 0};
}

bool has_no_elements(const std::vector<hsize_t>& shape) {
  return std::find(shape.begin(), shape.end(), hsize_t{0}) != shape.end();
}

/// As many whole rows, from the last dimension up, as a chunk's bytes allow, and at most
/// `most_rows` of the first: chunks that are not written at once would be compressed twice.
std::vector<hsize_t> chunk_shape(const std::vector<hsize_t>& shape, hsize_t element_bytes,
                                 hsize_t most_rows) {
  std::vector<hsize_t> chunk(shape.size(), 1);
  hsize_t left = std::max<hsize_t>(kChunkBytes / element_bytes, 1);
  for (size_t d = shape.size(); d-- > 0;) {
    chunk[d] = std::clamp<hsize_t>(left, 1, shape[d]);
    left /= chunk[d];
  }
  chunk[0] = std::min(chunk[0], most_rows);
  return chunk;
}

}  // namespace

Hdf5Writer::Hdf5Writer(const std::string& subject, int compression_level)
    : subject_(subject), compression_level_(compression_level) {
  Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  Hdf5Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  // In memory: HDF5 recovers badly from a full disk. The 1.10 file structures carry checksums.
  check(H5Pset_fapl_core(access.get(), kChunkBytes, false), "memory file");
  check(H5Pset_libver_bounds(access.get(), H5F_LIBVER_V110, H5F_LIBVER_V110), "version bounds");
  H5FD_file_image_callbacks_t callbacks = memory_callbacks(memory_);
  check(H5Pset_file_image_callbacks(access.get(), &callbacks), "memory file");
  // No times anywhere: equal calls must give equal bytes.
  check(H5Pset_obj_track_times(creation.get(), false), "creation properties");
  file_ = Hdf5Id(H5Fcreate("memory", H5F_ACC_TRUNC, creation.get(), access.get()), H5Fclose);
  check(file_.get(), "file");
}

void Hdf5Writer::group(const char* name) {
  Hdf5Id properties(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(properties.get(), false), name);
  // All attributes in the group's own header; HDF5 would move more than 8 to a heap.
  check(H5Pset_attr_phase_change(properties.get(), kMaxAttributes, 0), name);
  Hdf5Id group(H5Gcreate2(file_.get(), name, H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Gclose);
  check(group.get(), name);
}

Hdf5Id Hdf5Writer::create_dataset(const char* name, const Hdf5Type& type,
                                  const std::vector<hsize_t>& shape, hsize_t rows_at_a_time,
                                  hid_t space) {
  Hdf5Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  check(H5Pset_obj_track_times(properties.get(), false), name);
  if (!has_no_elements(shape)) {  // HDF5 has no chunks of nothing
    const std::vector<hsize_t> chunk = chunk_shape(shape, type.file_bytes(), rows_at_a_time);
    check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), name);
    check(H5Pset_shuffle(properties.get()), name);
    check(H5Pset_deflate(properties.get(), static_cast<unsigned>(compression_level_)), name);
    check(H5Pset_fletcher32(properties.get()), name);
  }
  Hdf5Id dataset(
      H5Dcreate2(file_.get(), name, type.file(), space, H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  check(dataset.get(), name);
  return dataset;
}

void Hdf5Writer::dataset(const char* name, const Hdf5Type& type, const std::vector<hsize_t>& shape,
                         const void* values) {
  dataset(name, type, shape, std::max<hsize_t>(shape[0], 1),
          [values](hsize_t, hsize_t) { return values; });
}

void Hdf5Writer::dataset(const char* name, const Hdf5Type& type, const std::vector<hsize_t>& shape,
                         hsize_t rows_at_a_time, const Rows& values) {
  const Hdf5Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  check(space.get(), name);
  const Hdf5Id dataset = create_dataset(name, type, shape, rows_at_a_time, space.get());
  if (has_no_elements(shape)) return;
  std::vector<hsize_t> start(shape.size(), 0), count = shape;
  for (; start[0] < shape[0]; start[0] += count[0]) {
    count[0] = std::min(rows_at_a_time, shape[0] - start[0]);
    const Hdf5Id memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                        H5Sclose);
    check(memory.get(), name);
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                              nullptr),
          name);
    check(H5Dwrite(dataset.get(), type.memory(), memory.get(), space.get(), H5P_DEFAULT,
                   values(start[0], count[0])),
          name);
  }
}

hsize_t Hdf5Writer::chunk_rows(const std::vector<hsize_t>& shape, size_t element_bytes) {
  return has_no_elements(shape) ? 1 : chunk_shape(shape, element_bytes, shape[0])[0];
}

void Hdf5Writer::attribute(const char* object, const char* name, const Hdf5Type& type,
                           const void* value) {
  Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
  Hdf5Id attribute(H5Acreate_by_name(file_.get(), object, name, type.file(), space.get(),
                                     H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                   H5Aclose);
  check(attribute.get(), name);
  check(H5Awrite(attribute.get(), type.memory(), value), name);
}

std::string_view Hdf5Writer::finish() {
  check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), "file");
  check(H5Fclose(file_.release()), "file");
  const std::string_view bytes = file_bytes(memory_);
  check(bytes.empty() ? -1 : 0, "file");
  return bytes;
}

void Hdf5Writer::check(std::int64_t result, const char* place) const {
  if (result < 0)
    throw Error(ErrorKind::output, subject_,
                fmt::format("{}: cannot write HDF5: {}", place, hdf5_reason()));
}

}  // namespace burnish
