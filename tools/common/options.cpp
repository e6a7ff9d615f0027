#include "common/options.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <filesystem>

namespace burnish::tools {
namespace {

constexpr int kMaxSide = 16384;  ///< of a picture

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  T value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T>
std::string range_text(const Range<T>& range) {
  return fmt::format("{}..{}{}{}", range.minimum, range.maximum,
                     range.unit.empty() ? "" : " " + range.unit,
                     range.power_of_two ? ", a power of two" : "");
}

/// A number in a range, into a T or an optional one.
template <class T, class Value>
CLI::Option* add_real(CLI::App& app, const std::string& flags, const std::string& placeholder,
                      Value& value, const Range<T>& range, const std::string& text,
                      const std::string& otherwise) {
  const std::string accepted = range_text(range);
  const auto parse = [&value, range](const std::string& found) {
    const std::optional<double> number = parse_number(found);
    if (!number) return false;
    const auto rounded = static_cast<T>(*number);
    if (!(rounded >= range.minimum && rounded <= range.maximum)) return false;
    value = rounded;
    return true;
  };
  return add_parsed(app, flags, placeholder,
                    fmt::format("{}; {} (default {})", text, accepted, otherwise),
                    "a number in " + accepted, parse);
}

}  // namespace

std::optional<long long> parse_integer(std::string_view text) {
  return parse_whole<long long>(text);
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::vector<double>> parse_numbers(std::string_view text, char separator) {
  std::vector<double> values;
  while (true) {
    const size_t end = text.find(separator);
    const std::optional<double> value = parse_number(text.substr(0, end));
    if (!value) return std::nullopt;
    values.push_back(*value);
    if (end == std::string_view::npos) return values;
    text.remove_prefix(end + 1);
  }
}

CLI::Option* add_parsed(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        const std::string& text, const std::string& expected,
                        const std::function<bool(const std::string&)>& parse) {
  const std::string name = flags.substr(flags.find_last_of(',') + 1);
  const auto callback = [name, expected, parse](const std::string& found) {
    if (!parse(found))
      throw CLI::ValidationError(name, fmt::format("found '{}', expected {}", found, expected));
  };
  return app.add_option_function<std::string>(flags, callback, text)->option_text(placeholder);
}

CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        int& value, const Range<int>& range, const std::string& text) {
  const std::string accepted = range_text(range);
  const auto parse = [&value, range](const std::string& found) {
    const std::optional<long long> number = parse_integer(found);
    if (!number || *number < range.minimum || *number > range.maximum) return false;
    if (range.power_of_two && !std::has_single_bit(static_cast<unsigned long long>(*number)))
      return false;
    value = static_cast<int>(*number);
    return true;
  };
  return add_parsed(app, flags, placeholder,
                    fmt::format("{}; {} (default {})", text, accepted, value),
                    "an integer in " + accepted, parse);
}

CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        float& value, const Range<float>& range, const std::string& text) {
  return add_real(app, flags, placeholder, value, range, text, fmt::format("{}", value));
}

CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        double& value, const Range<double>& range, const std::string& text) {
  return add_real(app, flags, placeholder, value, range, text, fmt::format("{}", value));
}

CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        std::uint64_t& value, const std::string& text) {
  const std::string accepted = fmt::format("0..{}", UINT64_MAX);
  const auto parse = [&value](const std::string& found) {
    const auto number = parse_whole<std::uint64_t>(found);
    if (number) value = *number;
    return number.has_value();
  };
  return add_parsed(app, flags, placeholder, fmt::format("{}; 0..2^64-1 (default {})", text, value),
                    "an integer in " + accepted, parse);
}

CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        std::optional<float>& value, const Range<float>& range,
                        const std::string& text, const std::string& otherwise) {
  return add_real(app, flags, placeholder, value, range, text, otherwise);
}

CLI::Option* add_color(CLI::App& app, const std::string& flags, std::optional<Rgb>& value,
                       const std::string& text, const std::string& otherwise) {
  const auto parse = [&value](const std::string& found) {
    const auto numbers = parse_numbers(found);
    if (!numbers || numbers->size() != 3) return false;
    for (const double number : *numbers)
      if (number < 0 || number > 1) return false;
    value = Eigen::Array3d((*numbers)[0], (*numbers)[1], (*numbers)[2]).cast<float>();
    return true;
  };
  return add_parsed(app, flags, "R,G,B", fmt::format("{}; each 0..1 (default {})", text, otherwise),
                    "three numbers R,G,B in 0..1", parse);
}

CLI::Option* add_size(CLI::App& app, int& width, int& height) {
  const auto parse = [&width, &height](const std::string& found) {
    const size_t cross = std::min(found.find('x'), found.size());
    const auto wide = parse_integer(found.substr(0, cross));
    const auto high = parse_integer(found.substr(std::min(cross + 1, found.size())));
    if (!wide || !high || *wide < 1 || *wide > kMaxSide || *high < 1 || *high > kMaxSide)
      return false;
    width = static_cast<int>(*wide);
    height = static_cast<int>(*high);
    return true;
  };
  const std::string accepted = fmt::format("1..{} pixels", kMaxSide);
  return add_parsed(app, "--size", "WxH",
                    fmt::format("picture size, each {} (default {}x{})", accepted, width, height),
                    "WIDTHxHEIGHT, each an integer in " + accepted, parse);
}

CLI::Option* add_file(CLI::App& app, const std::string& flags, const std::string& placeholder,
                      std::string& value, const std::string& text, const std::string& extension) {
  const std::string expected =
      extension.empty() ? "a file name" : fmt::format("a file name that ends in {}", extension);
  return add_parsed(app, flags, placeholder, text, expected,
                    [&value, extension](const std::string& found) {
                      if (found.empty()) return false;
                      if (!extension.empty() && lower_extension(found) != extension) return false;
                      value = found;
                      return true;
                    });
}

std::string lower_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return extension;
}

}  // namespace burnish::tools
