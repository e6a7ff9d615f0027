#pragma once

#include <functional>
#include <string>

#include <CLI/CLI.hpp>

#include "burnish/formats/settings_file.h"

namespace burnish::tools {

/// Some of a settings file's dials, and how a command declares the options that they are.
struct SettingsSection {
  std::vector<DialSetting> SettingsFile::*dials;
  const char* name;  ///< in the file
  std::function<void(CLI::App&)> declare;
};

/// Declares --settings FILE.json, whose dials set options as if they stood on the command line, in
/// the order that the options are declared in.
/// Call it before the options are declared: they are taken in that order, so that those given
/// override the file's. Each value goes through its option's own check; a bad one, and a dial that
/// there is not, throws the Error of the file.
void add_settings_option(CLI::App& app, std::vector<SettingsSection> sections);

}  // namespace burnish::tools
