#include "burnish/formats/settings_file.h"

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/output_file.h"
#include "file_bytes.h"
#include "json_values.h"

namespace burnish {
namespace {

constexpr JsonFormat kFormat = {"burnish settings", "settings", kSettingsFormatVersion};

std::vector<DialSetting> read_dials(const JsonPlace& root, const char* section) {
  std::vector<DialSetting> dials;
  if (!root.has(section)) return dials;
  const JsonPlace place = root.at(section);
  if (!place.value.is_object()) place.fail("expected an object of dials");
  for (const auto& [name, value] : place.value.items()) {
    if (!value.is_number() && !value.is_string())
      place.at(name).fail("expected a number or a string, as on the command line");
    dials.push_back({name, value.is_string() ? value.get<std::string>() : value.dump()});
  }
  return dials;
}

std::string format_dials(const char* section, const std::vector<DialSetting>& dials) {
  std::string text = fmt::format("  \"{}\": {{", section);
  const char* separator = "\n";
  for (const DialSetting& dial : dials) {
    const bool is_number =
        nlohmann::json::accept(dial.value) && nlohmann::json::parse(dial.value).is_number();
    text += fmt::format("{}    {}: {}", separator, json_string(dial.name),
                        is_number ? dial.value : json_string(dial.value));
    separator = ",\n";
  }
  return text + (dials.empty() ? "}" : "\n  }");
}

SettingsFile parse_settings(const std::string& text, const std::string& subject) {
  const nlohmann::json document = parse_json(text, subject);
  const JsonPlace root{document, nlohmann::json::json_pointer(), text, subject};
  read_format_version(root, kFormat);
  root.expect_fields({"format", "format_version", "source", "bake", "lights", "shading"});
  SettingsFile settings;
  if (root.has("source")) settings.source = root.at("source").string();
  settings.bake = read_dials(root, "bake");
  settings.lights = read_dials(root, "lights");
  settings.shading = read_dials(root, "shading");
  return settings;
}

}  // namespace

SettingsFile read_settings(const std::string& path) {
  return parse_settings(read_file_bytes(path), path);
}

void write_settings(const SettingsFile& settings, const std::string& path) {
  const std::string text = fmt::format(
      "{{\n  \"format\": \"{}\",\n  \"format_version\": {},\n  \"source\": {},\n{},\n{},\n{}\n}}\n",
      kFormat.name, kSettingsFormatVersion, json_string(settings.source),
      format_dials("bake", settings.bake), format_dials("lights", settings.lights),
      format_dials("shading", settings.shading));
  require_readable(path, "these settings", [&] { parse_settings(text, path); });
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace burnish
