#pragma once

#include <string>
#include <vector>

namespace burnish {

/// A dial and what it is set to, as on the command line but for the dashes: {"terms", "16"}.
struct DialSetting {
  std::string name, value;
  friend bool operator==(const DialSetting&, const DialSetting&) = default;
};

/// Settings of a scene's way from its mesh to radiance, by the commands that take them.
struct SettingsFile {
  std::vector<DialSetting> bake, lights, shading;
  std::string source;  ///< where they come from, for people
};

inline constexpr int kSettingsFormatVersion = 1;

/// Reads a JSON file of format "burnish settings" (formats/FORMAT.md). Which dials there are, and
/// their ranges, are the commands' to know: values are numbers or strings here. Throws Error with
/// path, line and what was expected.
SettingsFile read_settings(const std::string& path);

/// Writes them whole or not at all; values that are numbers become numbers.
void write_settings(const SettingsFile& settings, const std::string& path);

}  // namespace burnish
