#pragma once

#include <string>

#include "burnish/shading/transfer.h"

namespace burnish {

/// Version of the transfer format that this build writes, and the newest that it reads.
inline constexpr int kTransferFormatVersion = 2;

/// Limits of what a transfer file may hold (formats/FORMAT.md).
/// @{
inline constexpr int kMinSsdfResolution = 2;
inline constexpr int kMaxSsdfResolution = 4096;
inline constexpr int kMaxTerms = 1024;
inline constexpr int kMaxBases = 256;
/// @}

/// How coefficients and eigen-SSDFs are stored. Bytes a vertex of 48 SSDF coefficients after
/// compression, and the RMS error of the SSDF that rounding adds, in parts of what compression to
/// 48 terms leaves: formats/FORMAT.md.
enum class CoefficientType {
  float32,  ///< as they are: the transfer reads back equal
  float16,  ///< both rounded by at most 2^-11 of a value
  int16,    ///< coefficients as multiples of one step (at most 2^-14 of the largest), eigen-SSDFs
          ///< as float16. Of a transfer that was read from such a file, the coefficients are kept.
};

struct WriteTransferOptions {
  CoefficientType coefficient_type = CoefficientType::int16;
  int compression_level = 4;  ///< deflate, 0..9
};

/// Writes a transfer as an HDF5 file (formats/FORMAT.md). Equal transfers and options give equal
/// bytes. The file is put together in memory (its own size and a few MB, on top of the transfer)
/// and appears whole or not at all. Throws Error(ErrorKind::output), also for a transfer that
/// breaks a rule of the format: read_transfer would refuse it.
void write_transfer(const Transfer& transfer, const std::string& path,
                    const WriteTransferOptions& options = {});

/// Reads a transfer of this version or an older one (then without parts and ladder, and with zeros
/// for what was not recorded); every dataset's existence, type, rank, shape, checksum and values
/// are checked. Throws Error that names the dataset; for a file of a newer format version with both
/// versions.
Transfer read_transfer(const std::string& path);

/// True when the file can be opened and begins as an HDF5 file does.
bool is_hdf5_file(const std::string& path);

}  // namespace burnish
