#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hdf5_support.h"

namespace burnish {

/// The memory of an HDF5 file that is open in memory.
struct Hdf5Memory {
  void* data = nullptr;
  size_t capacity = 0;

  Hdf5Memory() = default;
  Hdf5Memory(const Hdf5Memory&) = delete;
  Hdf5Memory& operator=(const Hdf5Memory&) = delete;
  ~Hdf5Memory() { std::free(data); }
};

/// Puts an HDF5 file together in memory: equal calls give equal bytes. Lives within an Hdf5Session.
/// Throws Error(ErrorKind::output, subject).
class Hdf5Writer {
 public:
  /// `subject` outlives the writer. Deflate's `compression_level` 0..9.
  Hdf5Writer(const std::string& subject, int compression_level);

  void group(const char* name);

  /// Values of a dataset of any rank, row-major. Without elements it has no storage.
  void dataset(const char* name, const Hdf5Type& type, const std::vector<hsize_t>& shape,
               const void* values);

  /// The same, some rows (along the first dimension) at a time: `values(first, rows)` gives them,
  /// and they are used before the next call.
  using Rows = std::function<const void*(hsize_t first, hsize_t rows)>;
  void dataset(const char* name, const Hdf5Type& type, const std::vector<hsize_t>& shape,
               hsize_t rows_at_a_time, const Rows& values);

  /// Rows of a chunk: the least that are well written at a time.
  static hsize_t chunk_rows(const std::vector<hsize_t>& shape, size_t element_bytes);

  template <class T>
  void array(const char* name, const std::vector<hsize_t>& shape, const std::vector<T>& values) {
    dataset(name, Hdf5Type::of<T>(), shape, values.data());
  }
  template <class T>
  void attribute(const char* object, const char* name, T value) {
    attribute(object, name, Hdf5Type::of<T>(), &value);
  }
  void attribute(const char* object, const char* name, const std::string& text) {
    attribute(object, name, Hdf5Type::text(text.size() + 1), text.c_str());
  }

  /// Closes the file; its bytes live as long as this object.
  std::string_view finish();

 private:
  void attribute(const char* object, const char* name, const Hdf5Type& type, const void* value);
  void check(std::int64_t result, const char* place) const;
  Hdf5Id create_dataset(const char* name, const Hdf5Type& type, const std::vector<hsize_t>& shape,
                        hsize_t rows_at_a_time, hid_t space);

  const std::string& subject_;
  int compression_level_;
  Hdf5Memory memory_;  // outlives file_
  Hdf5Id file_;
};

}  // namespace burnish
