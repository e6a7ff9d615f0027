#pragma once

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>

#include <Eigen/Core>
#include <hdf5.h>

/// What the writer and the reader of HDF5 files need on top of HDF5's C interface.
namespace burnish {

/// Owns an identifier of the HDF5 library.
class Hdf5Id {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Id() = default;
  Hdf5Id(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Id(Hdf5Id&& other) noexcept { swap(other); }
  Hdf5Id& operator=(Hdf5Id&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Hdf5Id() {
    if (id_ >= 0) close_(id_);
  }
  hid_t get() const { return id_; }
  hid_t release() { return std::exchange(id_, H5I_INVALID_HID); }
  explicit operator bool() const { return id_ >= 0; }

 private:
  void swap(Hdf5Id& other) {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
  }
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// While it lives, HDF5 prints nothing, and no other thread is inside HDF5 through us (builds of
/// the library without thread safety exist).
class Hdf5Session {
 public:
  Hdf5Session() : lock_(mutex()) {
    static const bool silent_exit = silence_exit();
    (void)silent_exit;
    H5Eget_auto2(H5E_DEFAULT, &print_, &print_data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Hdf5Session() {
    H5Eclear2(H5E_DEFAULT);
    H5Eset_auto2(H5E_DEFAULT, print_, print_data_);
  }
  Hdf5Session(const Hdf5Session&) = delete;
  Hdf5Session& operator=(const Hdf5Session&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  /// HDF5 1.10 loses memory when it meets a damaged object header, and complains about that on
  /// stderr when the program ends. Handlers run in reverse order: ours before HDF5's.
  static bool silence_exit() {
    return H5open() >= 0 && std::atexit([] { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }) == 0;
  }
  std::lock_guard<std::mutex> lock_;
  H5E_auto2_t print_ = nullptr;
  void* print_data_ = nullptr;
};

/// HDF5's own words for the cause of the last failure, from the bottom of its error stack.
inline std::string hdf5_reason() {
  std::string reason;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* entry, void* data) -> herr_t {
        if (depth == 0 && entry->desc) *static_cast<std::string*>(data) = entry->desc;
        return 0;
      },
      &reason);
  H5Eclear2(H5E_DEFAULT);
  return reason.empty() ? "no reason given" : reason;
}

/// A type as it is stored (little endian), and as it is in memory.
class Hdf5Type {
 public:
  Hdf5Type(hid_t file, hid_t memory) : file_(file), memory_(memory) {}
  hid_t file() const { return own_ ? own_.get() : file_; }
  hid_t memory() const { return own_ ? own_.get() : memory_; }
  size_t file_bytes() const { return H5Tget_size(file()); }

  template <class T>
  static Hdf5Type of();

  /// UTF-8, zero-terminated. Of fixed length: variable strings live in a heap without checksums.
  static Hdf5Type text(size_t bytes_with_zero) {
    Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    const bool ok = H5Tset_size(type.get(), bytes_with_zero) >= 0 &&
                    H5Tset_cset(type.get(), H5T_CSET_UTF8) >= 0;
    return Hdf5Type(ok ? std::move(type) : Hdf5Id());
  }

 private:
  explicit Hdf5Type(Hdf5Id own) : own_(std::move(own)) {}

  /// IEEE 754 binary16; HDF5 1.10 has no name for it.
  static Hdf5Type float16() {
    Hdf5Id type(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
    const bool ok = H5Tset_fields(type.get(), 15, 10, 5, 0, 10) >= 0 &&
                    H5Tset_size(type.get(), 2) >= 0 && H5Tset_ebias(type.get(), 15) >= 0;
    return Hdf5Type(ok ? std::move(type) : Hdf5Id());
  }

  Hdf5Id own_;
  hid_t file_ = H5I_INVALID_HID, memory_ = H5I_INVALID_HID;
};

static_assert(std::endian::native == std::endian::little, "float16 is stored as it is in memory");

template <class T>
Hdf5Type Hdf5Type::of() {
  if constexpr (std::is_same_v<T, float>) return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT};
  if constexpr (std::is_same_v<T, double>) return {H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE};
  if constexpr (std::is_same_v<T, std::int16_t>) return {H5T_STD_I16LE, H5T_NATIVE_INT16};
  if constexpr (std::is_same_v<T, std::int32_t>) return {H5T_STD_I32LE, H5T_NATIVE_INT32};
  if constexpr (std::is_same_v<T, std::uint8_t>) return {H5T_STD_U8LE, H5T_NATIVE_UINT8};
  if constexpr (std::is_same_v<T, std::uint32_t>) return {H5T_STD_U32LE, H5T_NATIVE_UINT32};
  if constexpr (std::is_same_v<T, std::uint64_t>) return {H5T_STD_U64LE, H5T_NATIVE_UINT64};
  if constexpr (std::is_same_v<T, Eigen::half>) return float16();
}

}  // namespace burnish
