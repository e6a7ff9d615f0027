#include "json_text.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "burnish/formats/error.h"

namespace burnish {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 64;

std::string line_and_column(std::string_view text, size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const size_t newline = before.rfind('\n');
  const size_t line_start = newline == std::string_view::npos ? 0 : newline + 1;
  const size_t column = before.size() - line_start;
  return fmt::format("line {}, column {}", line, std::max<size_t>(column, 1));
}

/// One line, whatever strings of the file it quotes.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

/// nlohmann's message without its own name, number and position.
std::string short_reason(const json::exception& error) {
  std::string reason = error.what();
  if (const size_t bracket = reason.find("] "); bracket != std::string::npos)
    reason.erase(0, bracket + 2);
  if (const size_t position = reason.find(": ");
      reason.rfind("parse error at", 0) == 0 && position != std::string::npos)
    reason.erase(0, position + 2);
  return one_line(reason);
}

/// The place of a number that no double can hold: nlohmann quotes it but says not where it is.
std::string overflow_place(std::string_view text, const std::string& reason) {
  const size_t first = reason.find('\''), last = reason.rfind('\'');
  if (first == std::string::npos || last <= first) return "";
  const size_t byte = text.find(reason.substr(first + 1, last - first - 1));
  return byte == std::string_view::npos ? "" : line_and_column(text, byte + 1) + ": ";
}

/// Walks over a text that is known to be valid JSON.
struct JsonScanner {
  std::string_view text;
  size_t position = 0;

  void skip_space() {
    while (position < text.size() && std::strchr(" \t\r\n", text[position])) ++position;
  }
  void skip_string() {
    for (++position; text[position] != '"'; ++position)
      if (text[position] == '\\') ++position;
    ++position;
  }
  void skip_value() {
    int depth = 0;
    do {
      skip_space();
      const char c = text[position];
      if (c == '"') {
        skip_string();
      } else if (std::strchr("[]{}", c)) {
        depth += c == '[' || c == '{' ? 1 : -1;
        ++position;
      } else {
        position = std::min(text.find_first_of("[]{}\",: \t\r\n", position + 1), text.size());
      }
    } while (depth > 0);
  }
  /// From the start of an array or object to the start of one of its values.
  bool enter(const std::string& token) {
    const bool is_object = text[position] == '{';
    if (!is_object && text[position] != '[') return false;
    ++position;
    for (size_t index = 0;; ++index) {
      skip_space();
      if (text[position] == ']' || text[position] == '}') return false;
      bool found = !is_object && token == std::to_string(index);
      if (is_object) {
        const size_t start = position;
        skip_string();
        found = json::parse(text.substr(start, position - start)) == token;
        skip_space();
        ++position;  // the colon
        skip_space();
      }
      if (found) return true;
      skip_value();
      skip_space();
      if (text[position] == ',') ++position;
    }
  }
};

std::vector<std::string> pointer_tokens(json::json_pointer pointer) {
  std::vector<std::string> tokens;
  for (; !pointer.empty(); pointer.pop_back()) tokens.push_back(pointer.back());
  std::reverse(tokens.begin(), tokens.end());
  return tokens;
}

}  // namespace

json parse_json(std::string_view text, const std::string& subject) {
  std::vector<std::set<std::string>> keys;
  std::string duplicate;
  bool too_deep = false;
  const auto watch = [&](int depth, json::parse_event_t event, json& value) {
    too_deep |= depth > kMaxDepth;
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key && duplicate.empty() && !keys.empty() &&
        !keys.back().insert(value.get<std::string>()).second)
      duplicate = value.get<std::string>();
    return !too_deep;
  };
  if (const size_t zero = text.find('\0'); zero != std::string_view::npos)
    throw Error(ErrorKind::input, subject,  // nlohmann would take it for the end of the text
                line_and_column(text, zero + 1) + ": a zero byte");
  json document;
  try {
    document = json::parse(text, watch);
  } catch (const json::parse_error& error) {
    throw Error(ErrorKind::input, subject,
                fmt::format("{}: {}", line_and_column(text, error.byte), short_reason(error)));
  } catch (const json::exception& error) {
    const std::string reason = short_reason(error);
    throw Error(ErrorKind::input, subject, overflow_place(text, reason) + reason);
  }
  if (too_deep)
    throw Error(ErrorKind::input, subject, fmt::format("nested deeper than {} levels", kMaxDepth));
  if (!duplicate.empty())
    throw Error(ErrorKind::input, subject,
                fmt::format("the field {} occurs twice in one object", json_string(duplicate)));
  return document;
}

size_t json_line(std::string_view text, const json::json_pointer& pointer) {
  JsonScanner scanner{text};
  if (text.substr(0, 3) == "\xef\xbb\xbf") scanner.position = 3;  // byte order mark
  scanner.skip_space();
  size_t found = scanner.position;
  for (const std::string& token : pointer_tokens(pointer)) {
    if (!scanner.enter(token)) break;
    found = scanner.position;
  }
  const std::string_view before = text.substr(0, found);
  return 1 + static_cast<size_t>(std::count(before.begin(), before.end(), '\n'));
}

std::string json_string(const std::string& text) {
  return json(text).dump(-1, ' ', false, json::error_handler_t::replace);
}

void JsonPlace::fail(const std::string& message) const {
  const std::string path = pointer.to_string();
  const std::string message_and_place =
      fmt::format("line {}, {}: {}", json_line(text, pointer), path.empty() ? "/" : path, message);
  throw Error(ErrorKind::input, subject, one_line(message_and_place));
}

JsonPlace JsonPlace::at(const std::string& key) const {
  if (!value.is_object()) fail(fmt::format("is {}, expected an object", value.type_name()));
  if (!has(key)) fail(fmt::format("has no field '{}'", key));
  return {value.at(key), pointer / key, text, subject};
}

JsonPlace JsonPlace::at(size_t index) const {
  return {value.at(index), pointer / index, text, subject};
}

void JsonPlace::expect_fields(std::initializer_list<const char*> fields) const {
  if (!value.is_object()) fail(fmt::format("is {}, expected an object", value.type_name()));
  for (const auto& [key, field] : value.items()) {
    const bool known = std::any_of(fields.begin(), fields.end(),
                                   [&key = key](const char* name) { return key == name; });
    if (!known) {
      std::string accepted;
      for (const char* name : fields) accepted += std::string(accepted.empty() ? "" : ", ") + name;
      at(key).fail("unknown field, expected one of " + accepted);
    }
  }
}

void JsonPlace::expect_array() const {
  if (!value.is_array()) fail(fmt::format("is {}, expected an array", value.type_name()));
}

void JsonPlace::expect_array(size_t size) const {
  expect_array();
  if (value.size() != size) fail(fmt::format("has {} elements, expected {}", value.size(), size));
}

std::string JsonPlace::string() const {
  if (!value.is_string()) fail(fmt::format("is {}, expected a string", value.type_name()));
  return value.get<std::string>();
}

double JsonPlace::number() const {
  if (!value.is_number()) fail(fmt::format("is {}, expected a number", value.type_name()));
  return value.get<double>();
}

bool JsonPlace::boolean() const {
  if (!value.is_boolean()) fail(fmt::format("is {}, expected true or false", value.type_name()));
  return value.get<bool>();
}

float JsonPlace::float_in(float low, float high) const {
  const double found = number();
  const auto rounded = static_cast<float>(found);
  // In the order that a NaN fails; the range is asked of the float that will be used.
  if (!(rounded >= low && rounded <= high))
    fail(fmt::format("{}, expected {}..{}", found, low, high));
  return rounded;
}

}  // namespace burnish
