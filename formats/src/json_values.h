#pragma once

#include <array>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/light/rgb.h"
#include "burnish/sphere/frame.h"
#include "json_text.h"

/// What the JSON files of lights, scenes and materials have in common: one validator for the values
/// of all three, and the writing of lists and vectors. All readers fail with the value's place.
namespace burnish {

inline constexpr float kMaxFloat = std::numeric_limits<float>::max();
/// What unit vectors and frames may be off by.
inline constexpr float kFrameTolerance = 1e-3f;
/// Off by no more, they are kept as written: some 30 roundings of a float near 1.
inline constexpr float kFrameRounding = 4e-6f;

/// A kind of file.
struct JsonFormat {
  const char* name;  ///< the field `format`, "burnish lights"
  const char* kind;  ///< for messages, "light"
  int newest;        ///< version that this build reads
};

/// Checks the fields `format` and `format_version` of a document; returns the version. Throws
/// Error(unsupported) for a newer one.
int read_format_version(const JsonPlace& root, const JsonFormat& format);

double read_number(const JsonPlace& place, double low = -kMaxFloat, double high = kMaxFloat);
double read_positive(const JsonPlace& place);
int read_integer(const JsonPlace& place, int low, int high);

/// Fails with the accepted names, "x, y or z".
[[noreturn]] void fail_choice(const JsonPlace& place, std::span<const char* const> accepted);

/// A string that is one of a table's names.
template <class Enum, size_t N>
Enum read_choice(const JsonPlace& place, const std::array<std::pair<const char*, Enum>, N>& names) {
  const std::string found = place.string();
  std::array<const char*, N> accepted = {};
  for (size_t i = 0; i < N; ++i) {
    if (found == names[i].first) return names[i].second;
    accepted[i] = names[i].first;
  }
  fail_choice(place, accepted);
}

/// Three numbers in a range.
/// @{
Vector3f read_vector(const JsonPlace& place, float low = -kMaxFloat, float high = kMaxFloat);
Vector3d read_vector_double(const JsonPlace& place);
Rgb read_color(const JsonPlace& place, float low = 0, float high = kMaxFloat);
/// @}
/// The same, or one number for all three.
Rgb read_color_or_grey(const JsonPlace& place, float low, float high);

Vector3f read_unit(const JsonPlace& place);
/// Made exactly orthonormal, unless it is but for rounding: then it is kept as written.
Frame<float> read_frame(const JsonPlace& axis, const JsonPlace& tangent);
/// A 3 x 3 rotation, rows first; made exactly orthonormal when it is not quite.
Eigen::Matrix3f read_rotation_matrix(const JsonPlace& place);

/// Fails unless just one of two fields is there.
void expect_one_of(const JsonPlace& place, const char* first, const char* second);

/// The elements of an array; none where the field is absent.
template <class Read>
auto read_list(const JsonPlace& root, const char* name, const Read& read) {
  std::vector<decltype(read(root))> elements;
  if (!root.has(name)) return elements;
  const JsonPlace list = root.at(name);
  list.expect_array();
  for (size_t i = 0; i < list.value.size(); ++i) elements.push_back(read(list.at(i)));
  return elements;
}

/// A relative error, >= 0; nothing where the field is absent or null.
std::optional<double> read_fit_error(const JsonPlace& root, const char* name);

/// Numbers in the shortest form that reads back to the same float.
std::string format_vector(const Vector3f& vector);

/// A field with an array, an element a line, in the way that `format` gives.
template <class Elements, class Format>
std::string format_list(const char* name, const Elements& elements, const Format& format,
                        const std::string& indent = "  ") {
  std::string text = indent + "\"" + name + "\": [";
  const char* separator = "\n";
  for (const auto& element : elements) {
    text += separator + indent + "  " + format(element);
    separator = ",\n";
  }
  return text + (elements.empty() ? "]" : "\n" + indent + "]");
}

/// Throws Error(output) "WHAT cannot be stored: ..." where `parse` throws an Error about `subject`:
/// what we could not read back is not written. `what` as in "these lights".
void require_readable(const std::string& subject, const char* what,
                      const std::function<void()>& parse);

}  // namespace burnish
