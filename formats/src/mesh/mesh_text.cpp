#include "mesh_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace burnish::detail {
namespace {

bool is_separator(char c) { return c == ' ' || (c >= '\t' && c <= '\r') || c == '\0'; }

std::string narrow_utf16(std::string_view bytes, bool big_endian) {
  std::string text;
  text.reserve(bytes.size() / 2);
  for (size_t i = 0; i + 1 < bytes.size(); i += 2) {
    const auto high = static_cast<unsigned char>(bytes[big_endian ? i : i + 1]);
    const auto low = static_cast<unsigned char>(bytes[big_endian ? i + 1 : i]);
    text += high == 0 && low < 128 ? static_cast<char>(low) : '?';
  }
  return text;
}

template <class T>
bool parse_number(std::string_view word, T& value) {
  // from_chars takes no '+'; "+-1" is no number.
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (stop != end || word.empty()) return false;
  if (error == std::errc()) return true;
  if (error != std::errc::result_out_of_range) return false;
  // Too large and too small are reported alike: a double tells them apart for a float, and beyond
  // its range the sign of the exponent does.
  double wide = 0;
  if (std::from_chars(word.data(), end, wide).ec == std::errc())
    value = static_cast<T>(wide);
  else if (word.find("e-") != word.npos || word.find("E-") != word.npos)
    value = 0;
  else
    value = std::numeric_limits<T>::infinity();
  return true;
}

}  // namespace

std::string decode_text(std::string bytes) {
  const std::string_view view = bytes;
  if (view.starts_with("\xEF\xBB\xBF"))
    bytes.erase(0, 3);
  else if (view.starts_with("\xFE\xFF") || view.starts_with("\xFF\xFE"))
    bytes = narrow_utf16(view.substr(2), view[0] == '\xFE');
  if (bytes.find('\n') == std::string::npos) std::replace(bytes.begin(), bytes.end(), '\r', '\n');
  return bytes;
}

std::string_view next_word(std::string_view& rest) {
  size_t begin = 0;
  while (begin < rest.size() && is_separator(rest[begin])) ++begin;
  size_t end = begin;
  while (end < rest.size() && !is_separator(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

bool parse_float(std::string_view word, float& value) {
  return parse_number(word, value) && std::isfinite(value);
}

bool parse_double(std::string_view word, double& value) {
  if (parse_number(word, value)) return true;
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  for (const std::string_view name : {"1.#ind", "1.#inf", "1.#qnan"}) {
    if (!equals_ignoring_case(word, name)) continue;
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  return false;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

std::string quoted(std::string_view piece) {
  constexpr size_t kMaxShown = 32;
  std::string text = "'";
  for (const char c : piece.substr(0, kMaxShown)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (piece.size() > kMaxShown ? "...'" : "'");
}

size_t line_at(std::string_view text, size_t offset) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size()));
  return 1 + static_cast<size_t>(std::count(text.begin(), end, '\n'));
}

bool equals_ignoring_case(std::string_view word, std::string_view lower_case) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [&](char a, char b) { return lower(a) == b; });
}

bool LineReader::next_raw(std::string_view& line) {
  if (offset_ >= text_.size()) return false;
  const size_t end = std::min(text_.find('\n', offset_), text_.size());
  line = text_.substr(offset_, end - offset_);
  offset_ = end + 1;
  if (line.ends_with('\r')) line.remove_suffix(1);
  ++lines_read_;
  return true;
}

bool LineReader::next(std::string_view& line) {
  if (!next_raw(line)) return false;
  number_ = lines_read_;
  if (!join_continued_ || !line.ends_with('\\')) return true;
  joined_.clear();
  std::string_view part = line;
  bool more = true;
  while (more && part.ends_with('\\')) {
    joined_.append(part.substr(0, part.size() - 1)).append(1, ' ');
    part = {};
    more = next_raw(part);
  }
  joined_.append(part);
  line = joined_;
  return true;
}

}  // namespace burnish::detail
