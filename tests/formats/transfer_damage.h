#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <hdf5.h>

#include "burnish/formats/transfer_file.h"
#include "files.h"
#include "transfer_examples.h"

namespace burnish::test {

inline std::string read_error(const std::string& path) {
  return error_of(path, [&] { read_transfer(path); });
}

/// A transfer file opened with HDF5's own functions, to be damaged on purpose.
class OpenedFile {
 public:
  explicit OpenedFile(const std::string& path)
      : id(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT)) {
    EXPECT_GE(id, 0);
  }
  ~OpenedFile() { EXPECT_GE(H5Fclose(id), 0); }

  void remove(const char* name) { EXPECT_GE(H5Ldelete(id, name, H5P_DEFAULT), 0) << name; }
  void remove_attribute(const char* object, const char* name) {
    EXPECT_GE(H5Adelete_by_name(id, object, name, H5P_DEFAULT), 0) << object << " " << name;
  }

  /// Replaces a dataset by one as the format asks, of another type, shape or contents.
  template <class T>
  void replace(const char* name, hid_t file_type, hid_t memory_type,
               const std::vector<hsize_t>& shape, const std::vector<T>& values,
               bool with_filters = true) {
    remove(name);
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
    const hid_t properties = H5Pcreate(H5P_DATASET_CREATE);
    if (with_filters) {
      H5Pset_chunk(properties, static_cast<int>(shape.size()), shape.data());
      H5Pset_shuffle(properties);
      H5Pset_deflate(properties, 4);
      H5Pset_fletcher32(properties);
    }
    const hid_t set = H5Dcreate2(id, name, file_type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    if (!values.empty()) {
      EXPECT_GE(H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
    }
    H5Dclose(set);
    H5Pclose(properties);
    H5Sclose(space);
  }
  void replace(const char* name, const std::vector<hsize_t>& shape,
               const std::vector<float>& values) {
    replace(name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, shape, values);
  }
  void replace(const char* name, const std::vector<hsize_t>& shape,
               const std::vector<double>& values) {
    replace(name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, shape, values);
  }
  void replace(const char* name, const std::vector<hsize_t>& shape,
               const std::vector<std::uint32_t>& values) {
    replace(name, H5T_STD_U32LE, H5T_NATIVE_UINT32, shape, values);
  }

  // Deleted and made anew: HDF5 1.10.8 cannot rewrite an attribute that another handle wrote.
  void set_attribute(const char* object, const char* name, hid_t file_type, hid_t memory_type,
                     const void* value) {
    remove_attribute(object, name);
    const hid_t space = H5Screate(H5S_SCALAR);
    const hid_t attribute = H5Acreate_by_name(id, object, name, file_type, space, H5P_DEFAULT,
                                              H5P_DEFAULT, H5P_DEFAULT);
    EXPECT_GE(H5Awrite(attribute, memory_type, value), 0);
    H5Aclose(attribute);
    H5Sclose(space);
  }
  void set_int(const char* object, const char* name, std::int32_t value) {
    set_attribute(object, name, H5T_STD_I32LE, H5T_NATIVE_INT32, &value);
  }
  void set_byte(const char* object, const char* name, std::uint8_t value) {
    set_attribute(object, name, H5T_STD_U8LE, H5T_NATIVE_UINT8, &value);
  }
  void set_float(const char* object, const char* name, float value) {
    set_attribute(object, name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, &value);
  }
  void set_double(const char* object, const char* name, double value) {
    set_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
  }
  void set_text(const char* object, const char* name, const std::string& text) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, text.size() + 1);
    set_attribute(object, name, type, type, text.c_str());
    H5Tclose(type);
  }

  hid_t id;
};

struct Damage {
  const char* place;  ///< that the error names
  const char* cause;  ///< that the error says
  std::function<void(OpenedFile&)> apply;
};

/// Each damage to a file of version 2 with all that it can hold is an error of one line.
inline void expect_rejected(const std::vector<Damage>& damages) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  for (const Damage& damage : damages) {
    write_transfer(random_transfer_2(1), path);
    {
      OpenedFile file(path);
      damage.apply(file);
    }
    const std::string error = read_error(path);
    EXPECT_NE(error.find(": " + std::string(damage.place)), std::string::npos)
        << damage.place << " / " << damage.cause << ": " << error;
    EXPECT_NE(error.find(damage.cause), std::string::npos)
        << damage.place << " / " << damage.cause << ": " << error;
  }
}

}  // namespace burnish::test
