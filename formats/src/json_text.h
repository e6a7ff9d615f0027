#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

/// The JSON that our formats share: strict reading with places, and writing of numbers and strings.
namespace burnish {

/// Parses a whole document. Throws Error(input, subject) with line and column for a syntax error, a
/// key that occurs twice in an object, a number out of range, and nesting beyond 64 levels.
nlohmann::json parse_json(std::string_view text, const std::string& subject);

/// The line, from 1, on which the value at a JSON pointer (RFC 6901) starts, in a text that
/// parse_json accepted; of its nearest enclosing value when there is no such value.
size_t json_line(std::string_view text, const nlohmann::json::json_pointer& pointer);

/// A value and where it came from, so that every error has its JSON path and line.
struct JsonPlace {
  const nlohmann::json& value;
  nlohmann::json::json_pointer pointer;
  std::string_view text;
  const std::string& subject;

  [[noreturn]] void fail(const std::string& message) const;

  JsonPlace at(const std::string& key) const;  ///< a field that must be there; fails on non-objects
  JsonPlace at(size_t index) const;            ///< an element that is there
  bool has(const std::string& key) const { return value.contains(key); }

  /// Fails unless this is an object without other fields than these.
  void expect_fields(std::initializer_list<const char*> fields) const;
  /// Fails unless this is an array (of `size` elements, if given).
  void expect_array() const;
  void expect_array(size_t size) const;
  std::string string() const;
  double number() const;
  bool boolean() const;
  float float_in(float low, float high) const;  ///< a finite number in range
};

/// A JSON string literal, quotes and all. Bytes that are not UTF-8 become U+FFFD.
std::string json_string(const std::string& text);

}  // namespace burnish
