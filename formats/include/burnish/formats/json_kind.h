#pragma once

#include <string>

namespace burnish {

/// What kind of JSON file this is: its field `format` ("burnish lights", "burnish material",
/// "burnish scene"), or "" where that is absent or no string. Throws Error for what is not JSON.
std::string read_json_format(const std::string& path);

}  // namespace burnish
