#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "burnish/light/rgb.h"

/// Options whose help states range, unit and default, and whose errors state what was found and
/// what is accepted.
namespace burnish::tools {

/// What a number may be.
template <class T>
struct Range {
  T minimum;
  T maximum;
  std::string unit = {};      ///< of the value, as "degrees"
  bool power_of_two = false;  ///< integers only
};

/// An integer or a number that fills the whole of `text`; nothing otherwise, nor for NaN or
/// infinity.
/// @{
std::optional<long long> parse_integer(std::string_view text);
std::optional<double> parse_number(std::string_view text);
/// @}
/// "1,2.5,3" as numbers; nothing if any of them is not one.
std::optional<std::vector<double>> parse_numbers(std::string_view text, char separator = ',');

/// An option with a value of any form. `parse` gets the text and returns false if it does not fit
/// `expected`, a phrase for the error line. `text` is the help as it stands.
CLI::Option* add_parsed(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        const std::string& text, const std::string& expected,
                        const std::function<bool(const std::string&)>& parse);

/// An integer or a real number in a range; the help says the range and the present value.
/// @{
CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        int& value, const Range<int>& range, const std::string& text);
CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        float& value, const Range<float>& range, const std::string& text);
CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        double& value, const Range<double>& range, const std::string& text);
CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        std::uint64_t& value, const std::string& text);
/// @}

/// What may be left out: nothing unless it is given. `otherwise` says in the help what then holds.
/// @{
CLI::Option* add_number(CLI::App& app, const std::string& flags, const std::string& placeholder,
                        std::optional<float>& value, const Range<float>& range,
                        const std::string& text, const std::string& otherwise);
/// Three numbers "R,G,B", each 0..1.
CLI::Option* add_color(CLI::App& app, const std::string& flags, std::optional<Rgb>& value,
                       const std::string& text, const std::string& otherwise);
/// @}

/// --size "WIDTHxHEIGHT" of a picture, each 1..16384 pixels.
CLI::Option* add_size(CLI::App& app, int& width, int& height);

/// One of several words.
template <class T>
CLI::Option* add_choice(CLI::App& app, const std::string& flags, T& value,
                        const std::vector<std::pair<std::string, T>>& choices,
                        const std::string& text) {
  std::string words, chosen;
  for (const auto& [word, choice] : choices) {
    words += (words.empty() ? "" : "|") + word;
    if (choice == value) chosen = word;
  }
  return add_parsed(app, flags, words, fmt::format("{} (default {})", text, chosen),
                    "one of " + words, [&value, choices](const std::string& found) {
                      for (const auto& [word, choice] : choices)
                        if (word == found) {
                          value = choice;
                          return true;
                        }
                      return false;
                    });
}

/// A file name. An output's `extension` (".h5") is required of the name; "" accepts any.
CLI::Option* add_file(CLI::App& app, const std::string& flags, const std::string& placeholder,
                      std::string& value, const std::string& text,
                      const std::string& extension = "");

/// The lower-case extension of a file name, with its dot; "" if it has none.
std::string lower_extension(const std::string& path);

}  // namespace burnish::tools
