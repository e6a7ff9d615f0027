#pragma once

#include <string>
#include <vector>

namespace burnish::tools {

/// Files of these extensions (with the dot) in the sub-folder `kind` of the data folder, or in the
/// data folder itself where there is no such sub-folder; sorted by name. None for an empty `data`,
/// else a folder that exists.
std::vector<std::string> data_files(const std::string& data, const std::string& kind,
                                    const std::vector<std::string>& extensions);

}  // namespace burnish::tools
