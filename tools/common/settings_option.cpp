#include "common/settings_option.h"

#include <algorithm>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "common/options.h"

namespace burnish::tools {
namespace {

std::string names_of(const CLI::App& app) {
  std::string names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames())
      if (name != "help") names += (names.empty() ? "" : ", ") + name;
  return names;
}

[[noreturn]] void fail(const std::string& file, const SettingsSection& section,
                       const DialSetting& dial, const std::string& message) {
  throw Error(ErrorKind::input, file, fmt::format("/{}/{}: {}", section.name, dial.name, message));
}

/// Dials in the order of their options: --quality, which sets others, comes before those.
std::vector<DialSetting> in_order(const std::string& file, const SettingsSection& section,
                                  const CLI::App& app, std::vector<DialSetting> dials) {
  const std::vector<const CLI::Option*> options = app.get_options();
  const auto place = [&](const DialSetting& dial) {
    return std::find(options.begin(), options.end(), app.get_option_no_throw("--" + dial.name));
  };
  for (const DialSetting& dial : dials)
    if (dial.name == "help" || place(dial) == options.end())
      fail(file, section, dial, fmt::format("is no dial, expected one of {}", names_of(app)));
  std::stable_sort(dials.begin(), dials.end(),
                   [&](const DialSetting& a, const DialSetting& b) { return place(a) < place(b); });
  return dials;
}

void apply(const std::string& file, const SettingsSection& section,
           const std::vector<DialSetting>& dials) {
  // The options once more, on an app of their own: what they are bound to is the same.
  CLI::App app;
  section.declare(app);
  for (const DialSetting& dial : in_order(file, section, app, dials)) {
    const std::string option = "--" + dial.name;
    if (dial.value.empty()) fail(file, section, dial, "found '', expected a value");
    try {
      app.parse(std::vector<std::string>{option + "=" + dial.value});
    } catch (const CLI::ParseError& error) {
      std::string message = error.what();
      if (message.starts_with(option + ": ")) message.erase(0, option.size() + 2);
      fail(file, section, dial, message);
    }
  }
}

}  // namespace

void add_settings_option(CLI::App& app, std::vector<SettingsSection> sections) {
  app.add_option_function<std::string>(
         "--settings",
         [sections = std::move(sections)](const std::string& path) {
           const SettingsFile file = read_settings(path);
           for (const SettingsSection& section : sections)
             apply(path, section, file.*section.dials);
         },
         "dials as `burnish tune` writes them; those given themselves override them")
      ->option_text("FILE.json");
}

}  // namespace burnish::tools
