#include "package/include_rules.h"

#include <algorithm>
#include <fstream>
#include <optional>

namespace burnish {
namespace fs = std::filesystem;

const std::vector<Layer>& layers() {
  static const std::vector<Layer> all = {
      {"runtime", {"Eigen/", "unsupported/Eigen/"}, {"hwy/"}},
      {"formats",
       {"Eigen/"},
       {"OpenMesh/", "OpenEXR/", "Imath/", "png.h", "stb/", "hdf5.h", "H5Cpp.h", "nlohmann/",
        "fmt/", "fcntl.h", "unistd.h", "sys/"}},
      {"precompute",
       {"Eigen/"},
       {"embree3/", "embree4/", "tbb/", "ceres/", "fmt/", "hwy/", "fcntl.h", "sys/", "unistd.h"}},
      {"tools",
       {},
       {"CLI/", "Eigen/", "benchmark/", "nlohmann/", "fmt/", "tbb/", "fcntl.h", "poll.h",
        "signal.h", "spawn.h", "sys/", "unistd.h"}},
  };
  return all;
}

namespace {

bool begins_with_any(std::string_view path, const std::vector<std::string_view>& prefixes) {
  return std::any_of(prefixes.begin(), prefixes.end(),
                     [&](std::string_view prefix) { return path.starts_with(prefix); });
}

/// Why a file of this layer must not include `header`; empty when it may.
std::string objection(const fs::path& root, size_t layer, const fs::path& file, bool is_public,
                      const std::string& header) {
  if (header.find_first_of("./") == std::string::npos) return {};  // <vector>

  const fs::path own = root / layers()[layer].folder;
  if (fs::exists(own / "include" / header)) return {};
  const bool is_own = fs::exists(file.parent_path() / header) ||
                      fs::exists(file.parent_path() / (header + ".in")) ||  // generated
                      fs::exists(own / "src" / header) || fs::exists(own / header);
  if (is_own) return is_public ? "a public header includes a private one" : "";

  for (size_t other = 0; other < layers().size(); ++other) {
    if (!fs::exists(root / layers()[other].folder / "include" / header)) continue;
    return other < layer ? "" : "points back to " + std::string(layers()[other].folder);
  }
  const Layer& rule = layers()[layer];
  if (begins_with_any(header, rule.public_third_party)) return {};
  if (!begins_with_any(header, rule.private_third_party)) return "not among the layer's headers";
  return is_public ? "not among the headers of the layer's interface" : "";
}

/// What follows #include in a line; nothing in any other line.
std::optional<std::string> include_operand(std::string_view line) {
  for (const std::string_view token : {"#", "include"}) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (!line.starts_with(token)) return std::nullopt;
    line.remove_prefix(token.size());
  }
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  return std::string(line);
}

/// The header of `<header>` or `"header"`, whatever follows; empty for anything else.
std::string header_name(std::string_view operand) {
  if (operand.empty() || (operand[0] != '<' && operand[0] != '"')) return {};
  const size_t end = operand.find(operand[0] == '<' ? '>' : '"', 1);
  return end == std::string_view::npos ? "" : std::string(operand.substr(1, end - 1));
}

}  // namespace

IncludeReport check_includes(const fs::path& root, size_t layer) {
  const fs::path folder = root / layers()[layer].folder;
  IncludeReport report;
  if (!fs::is_directory(folder)) return report;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& file = entry.path();
    if (file.extension() != ".h" && file.extension() != ".cpp") continue;
    ++report.files;
    const bool is_public = file.lexically_relative(folder).begin()->string() == "include";
    std::ifstream in(file);
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
      const std::optional<std::string> operand = include_operand(line);
      if (!operand) continue;
      const std::string header = header_name(*operand);
      const std::string why = header.empty() ? "cannot tell what is included"
                                             : objection(root, layer, file, is_public, header);
      if (why.empty()) continue;
      report.violations.push_back(file.lexically_relative(root).string() + ":" +
                                  std::to_string(number) + ": " + *operand + ": " + why);
    }
  }
  return report;
}

}  // namespace burnish
