#include "burnish/formats/json_kind.h"

#include "file_bytes.h"
#include "json_text.h"

namespace burnish {

std::string read_json_format(const std::string& path) {
  const nlohmann::json document = parse_json(read_file_bytes(path), path);
  const auto format = document.is_object() ? document.find("format") : document.end();
  return format != document.end() && format->is_string() ? format->get<std::string>() : "";
}

}  // namespace burnish
