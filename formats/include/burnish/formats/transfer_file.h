#pragma once

#include <string>

#include "burnish/shading/transfer.h"

namespace burnish {

/// Version of the transfer format that this build writes, and the newest that it reads.
inline constexpr int kTransferFormatVersion = 1;

/// Limits of what a transfer file may hold (formats/FORMAT.md).
/// @{
inline constexpr int kMinSsdfResolution = 2;
inline constexpr int kMaxSsdfResolution = 4096;
inline constexpr int kMaxTerms = 1024;
inline constexpr int kMaxBases = 256;
/// @}

/// How coefficients and eigenimages are stored.
enum class CoefficientType {
  float32,  ///< as they are: the transfer reads back equal
  float16,  ///< rounded by at most 2^-11 of a value
  int16,    ///< coefficients as multiples of one step, eigenimages as float16
};

struct WriteTransferOptions {
  CoefficientType coefficient_type = CoefficientType::float32;
  int compression_level = 4;  ///< deflate, 0..9
};

/// Writes a transfer as an HDF5 file (formats/FORMAT.md). Equal transfers and options give equal
/// bytes. The file is put together in memory (about its own size, on top of the transfer) and
/// appears whole or not at all. Throws Error(ErrorKind::output), also for a transfer that breaks
/// a rule of the format: read_transfer would refuse it.
void write_transfer(const Transfer& transfer, const std::string& path,
                    const WriteTransferOptions& options = {});

/// Reads a transfer; every dataset's existence, type, rank, shape, checksum and values are checked.
/// Throws Error that names the dataset; for a file of a newer format version with both versions.
Transfer read_transfer(const std::string& path);

/// True when the file can be opened and begins as an HDF5 file does.
bool is_hdf5_file(const std::string& path);

}  // namespace burnish
