#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace burnish {

/// A folder at the top of the tree, and which headers its files may include besides the C++
/// standard library's and its own. Third-party headers are named by the beginning of their path.
struct Layer {
  std::string_view folder;
  std::vector<std::string_view> public_third_party;   ///< for files below its include/
  std::vector<std::string_view> private_third_party;  ///< for its other files, beside the above
};

/// The layers of the project: each may include the public headers of those before it.
const std::vector<Layer>& layers();

struct IncludeReport {
  std::vector<std::string> violations;  ///< "file:line: what"
  int files = 0;                        ///< C++ files read
};

/// Reads the #include lines of every C++ file of one layer, an index into layers(), below `root`.
IncludeReport check_includes(const std::filesystem::path& root, size_t layer);

}  // namespace burnish
