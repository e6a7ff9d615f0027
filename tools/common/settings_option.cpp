#include "common/settings_option.h"

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

void apply(const std::string& file, const SettingsSection& section, const DialSetting& dial) {
  // The options once more, on an app of their own: what they are bound to is the same.
  CLI::App app;
  section.declare(app);
  const std::string option = "--" + dial.name;
  if (!app.get_option_no_throw(option))
    throw Error(ErrorKind::input, file,
                fmt::format("/{}/{}: is no dial, expected one of {}", section.name, dial.name,
                            names_of(app)));
  try {
    // Taken from the back.
    app.parse(std::vector<std::string>{dial.value, option});
  } catch (const CLI::ParseError& error) {
    std::string message = error.what();
    if (message.starts_with(option + ": ")) message.erase(0, option.size() + 2);
    throw Error(ErrorKind::input, file,
                fmt::format("/{}/{}: {}", section.name, dial.name, message));
  }
}

}  // namespace

void add_settings_option(CLI::App& app, std::vector<SettingsSection> sections) {
  app.add_option_function<std::string>(
         "--settings",
         [sections = std::move(sections)](const std::string& path) {
           const SettingsFile file = read_settings(path);
           for (const SettingsSection& section : sections)
             for (const DialSetting& dial : file.*section.dials) apply(path, section, dial);
         },
         "dials as `burnish tune` writes them; those given themselves override them")
      ->option_text("FILE.json");
}

}  // namespace burnish::tools
