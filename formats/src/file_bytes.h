#pragma once

#include <string>

namespace burnish {

/// All bytes of a regular file. Throws Error(ErrorKind::input) that says why they cannot be had.
std::string read_file_bytes(const std::string& path);

/// The first bytes of a regular file, `count` or fewer. The same errors.
std::string read_file_start(const std::string& path, size_t count);

}  // namespace burnish
