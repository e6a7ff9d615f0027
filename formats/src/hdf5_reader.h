#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "hdf5_support.h"

namespace burnish {

inline constexpr std::string_view kHdf5Signature = "\x89HDF\r\n\x1a\n";
inline constexpr hsize_t kAnyExtent = std::numeric_limits<hsize_t>::max();

/// A dataset whose type, shape and storage were found as they must be: its data can be allocated.
struct Hdf5Dataset {
  std::string name;
  Hdf5Id id;
  std::vector<hsize_t> shape;
  hsize_t chunk_rows = 1;  ///< along the first dimension
  size_t type = 0;         ///< which of the types that were accepted

  hsize_t rows() const { return shape[0]; }
  hsize_t row_size() const {
    hsize_t product = 1;
    for (size_t d = 1; d < shape.size(); ++d) product *= shape[d];
    return product;
  }
  hsize_t size() const { return rows() * row_size(); }
};

/// Reads HDF5 files of the strict kind that Hdf5Writer writes (formats/FORMAT.md, "Storage");
/// everything is checked before it is used. Lives within an Hdf5Session.
/// Throws Error(ErrorKind::input, path) that names the object and what is wrong with it.
class Hdf5Reader {
 public:
  /// Reads the file into memory. `path` outlives the reader.
  explicit Hdf5Reader(const std::string& path);

  [[noreturn]] void fail(const std::string& place, const std::string& message) const;

  /// Whether there is a member of this name in a group that must be there.
  bool has(const char* name) const;
  /// `shape` has the expected extents, or kAnyExtent; `types` what is accepted.
  Hdf5Dataset open(const char* name, const std::vector<const Hdf5Type*>& types,
                   const std::vector<hsize_t>& shape) const;

  void read_rows(const Hdf5Dataset& dataset, const Hdf5Type& type, hsize_t first, hsize_t rows,
                 void* values) const;

  /// All of a dataset. A T is one value, or a row that holds nothing but values.
  template <class Value, class T = Value>
  std::vector<T> read(const char* name, const std::vector<hsize_t>& shape) const {
    const Hdf5Type type = Hdf5Type::of<Value>();
    const Hdf5Dataset dataset = open(name, {&type}, shape);
    std::vector<T> values(dataset.size() * sizeof(Value) / sizeof(T));
    read_rows(dataset, type, 0, dataset.rows(), values.data());
    return values;
  }
  std::vector<std::string> read_texts(const char* name, hsize_t rows) const;

  template <class T>
  T read_attribute(const std::string& object, const char* name) const {
    T value = {};
    read_number(object, name, Hdf5Type::of<T>(), &value);
    return value;
  }
  std::string read_text(const std::string& object, const char* name) const;

 private:
  void check_path(const std::string& name) const;
  void check_shape(Hdf5Dataset& dataset, const std::vector<hsize_t>& expected) const;
  void check_storage(Hdf5Dataset& dataset) const;
  void check_chunks(Hdf5Dataset& dataset, hid_t properties, hsize_t element_bytes) const;
  Hdf5Dataset open_any_type(const char* name) const;
  Hdf5Id open_attribute(const std::string& object, const char* name) const;
  void read_number(const std::string& object, const char* name, const Hdf5Type& type,
                   void* value) const;

  const std::string& path_;
  std::string bytes_;  // outlives file_
  Hdf5Id file_;
};

}  // namespace burnish
