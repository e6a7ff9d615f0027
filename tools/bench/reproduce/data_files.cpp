#include "bench/reproduce/data_files.h"

#include <algorithm>
#include <filesystem>

namespace burnish::tools {

std::vector<std::string> data_files(const std::string& data, const std::string& kind,
                                    const std::vector<std::string>& extensions) {
  namespace fs = std::filesystem;
  if (data.empty()) return {};
  const fs::path own = fs::path(data) / kind;
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(fs::is_directory(own) ? own : fs::path(data))) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() &&
        std::find(extensions.begin(), extensions.end(), extension) != extensions.end())
      paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace burnish::tools
