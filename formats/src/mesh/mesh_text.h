#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// The small change of reading mesh files: lines, words, numbers.
namespace burnish::detail {

/// Text as one byte a character with '\n' between lines: a UTF-8 byte order mark is removed, UTF-16
/// (either order, told by its mark) is narrowed, with '?' for what is not ASCII; where '\r' alone
/// ends lines it becomes '\n'.
std::string decode_text(std::string bytes);

/// Takes the next word off `rest`; words are separated by spaces, tabs and control characters of
/// the same use. Empty at the end.
std::string_view next_word(std::string_view& rest);

/// Whether the whole word is a number that is finite as a float. Decimal, independent of the
/// locale; what is too small for a float becomes 0.
bool parse_float(std::string_view word, float& value);

/// Whether the whole word is a number; NaN and infinities, as C and Windows print them, are
/// numbers.
bool parse_double(std::string_view word, double& value);

/// Whether the whole word is an integer that fits.
bool parse_integer(std::string_view word, std::int64_t& value);

/// A piece of a file, fit for an error of one line: quoted, unprintable characters as '?', cut
/// after 32 characters.
std::string quoted(std::string_view piece);

/// Line of the text, from 1, that the byte at `offset` is on.
size_t line_at(std::string_view text, size_t offset);

/// Whether `word` is `lower_case`, but for case.
bool equals_ignoring_case(std::string_view word, std::string_view lower_case);

/// The lines of a text, one after the other.
class LineReader {
 public:
  explicit LineReader(std::string_view text, bool join_continued = false)
      : text_(text), join_continued_(join_continued) {}

  /// The next line without its end, or false. A line that ends in '\' goes on in the next one if
  /// the reader was asked to join (OBJ); it is valid until the next call.
  bool next(std::string_view& line);

  /// Of the line last read (of its first line where lines were joined), from 1.
  size_t number() const { return number_; }

 private:
  bool next_raw(std::string_view& line);

  std::string_view text_;
  bool join_continued_;
  std::string joined_;
  size_t offset_ = 0;
  size_t lines_read_ = 0;
  size_t number_ = 0;
};

}  // namespace burnish::detail
