#include "tradeoff/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "harness/content_hash.h"

namespace burnish::tools {
namespace {

using nlohmann::ordered_json;

constexpr const char* kFormat = "burnish tradeoff";
constexpr int kFormatVersion = 1;

struct Figure {
  const char* name;
  double SweepRow::*value;
};
constexpr std::array kFigures = {Figure{"frame_ms", &SweepRow::frame_ms},
                                 Figure{"frame_cpu_ms", &SweepRow::frame_cpu_ms},
                                 Figure{"prepare_ms", &SweepRow::prepare_ms},
                                 Figure{"bake_s", &SweepRow::bake_s},
                                 Figure{"memory_bytes", &SweepRow::memory_bytes},
                                 Figure{"bytes_per_vertex", &SweepRow::bytes_per_vertex},
                                 Figure{"file_bytes", &SweepRow::file_bytes},
                                 Figure{"relative_l2", &SweepRow::relative_l2},
                                 Figure{"truth_noise", &SweepRow::truth_noise},
                                 Figure{"absolute_mean", &SweepRow::absolute_mean},
                                 Figure{"absolute_95", &SweepRow::absolute_95},
                                 Figure{"absolute_999", &SweepRow::absolute_999}};

constexpr std::array kKinds = {RowKind::grid, RowKind::preset, RowKind::paper, RowKind::rival};

ordered_json row_json(const SweepRow& row) {
  ordered_json json = {{"key", row.key}, {"name", row.name}, {"kind", name_of(row.kind)}};
  for (const Figure& figure : kFigures) json[figure.name] = row.*figure.value;
  json["below_noise"] = row.below_noise;
  json["settings"] = row.settings;
  return json;
}

/// Reads fields of an object in a file; its errors name both.
class Fields {
 public:
  Fields(const std::string& path, std::string place, const ordered_json& json)
      : path_(path), place_(std::move(place)), json_(json) {
    if (!json.is_object()) fail("", json, "an object");
  }
  const ordered_json& get(const char* name) const {
    const auto found = json_.find(name);
    if (found == json_.end())
      throw Error(ErrorKind::input, path_, fmt::format("{}{}: found nothing", place_, name));
    return *found;
  }
  std::string text(const char* name) const {
    const ordered_json& value = get(name);
    if (!value.is_string()) fail(name, value, "a text");
    return value.get<std::string>();
  }
  double number(const char* name) const {
    const ordered_json& value = get(name);
    if (!value.is_number() || !(value.get<double>() >= 0)) fail(name, value, "a number >= 0");
    return value.get<double>();
  }
  bool truth(const char* name) const {
    const ordered_json& value = get(name);
    if (!value.is_boolean()) fail(name, value, "true or false");
    return value.get<bool>();
  }
  [[noreturn]] void fail(const std::string& name, const ordered_json& found,
                         const std::string& expected) const {
    std::string text = found.dump(-1, ' ', true, ordered_json::error_handler_t::replace);
    if (text.size() > 60) text = text.substr(0, 57) + "...";
    throw Error(ErrorKind::input, path_,
                fmt::format("{}{}: found {}, expected {}", place_, name, text, expected));
  }

 private:
  const std::string& path_;
  std::string place_;
  const ordered_json& json_;
};

SweepRow read_row(const std::string& path, size_t index, const ordered_json& json) {
  const Fields fields(path, fmt::format("rows[{}].", index), json);
  SweepRow row;
  row.key = fields.text("key");
  row.name = fields.text("name");
  const std::string kind = fields.text("kind");
  const auto found = std::find_if(kKinds.begin(), kKinds.end(),
                                  [&](RowKind known) { return name_of(known) == kind; });
  if (found == kKinds.end()) fields.fail("kind", kind, "one of grid, preset, paper, rival");
  row.kind = *found;
  for (const Figure& figure : kFigures) row.*figure.value = fields.number(figure.name);
  row.below_noise = fields.truth("below_noise");
  row.settings = fields.get("settings");
  if (!row.settings.is_object()) fields.fail("settings", row.settings, "an object");
  return row;
}

ordered_json parse_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorKind::input, path, "cannot be opened");
  std::ostringstream text;
  text << file.rdbuf();
  try {
    return ordered_json::parse(text.str());
  } catch (const nlohmann::json::parse_error& error) {
    throw Error(ErrorKind::input, path,
                fmt::format("byte {}: is not JSON, expected what tradeoff wrote", error.byte));
  }
}

}  // namespace

std::string name_of(RowKind kind) {
  switch (kind) {
    case RowKind::grid:
      return "grid";
    case RowKind::preset:
      return "preset";
    case RowKind::paper:
      return "paper";
    case RowKind::rival:
      break;
  }
  return "rival";
}

SweepRow sweep_row(const TrialOutcome& outcome, size_t vertices) {
  SweepRow row;
  row.frame_ms = outcome.frame_ms;
  row.frame_cpu_ms = outcome.frame_cpu_ms;
  row.prepare_ms = outcome.prepare_ms;
  row.bake_s = outcome.bake_s;
  row.bytes_per_vertex = static_cast<double>(outcome.bytes_per_vertex);
  row.memory_bytes = row.bytes_per_vertex * static_cast<double>(vertices) +
                     static_cast<double>(outcome.bytes_shared);
  row.file_bytes = static_cast<double>(outcome.file_bytes);
  row.relative_l2 = outcome.error.without_noise;
  row.truth_noise = outcome.error.truth_noise;
  row.below_noise = !above_noise(outcome.error);
  row.absolute_mean = outcome.absolute.mean;
  row.absolute_95 = outcome.absolute.percentile_95;
  row.absolute_999 = outcome.absolute.percentile_999;
  return row;
}

std::string sweep_key(const std::vector<std::string>& parts) {
  ContentHash hash;
  hash.add(kSweepVersion);
  for (const std::string& part : parts) hash.add(std::string_view(part));
  return hash.hex();
}

std::vector<SweepRow> run_sweep(const std::vector<SweepEntry>& entries,
                                const std::vector<SweepRow>& known,
                                const std::function<void(const std::vector<SweepRow>&)>& save) {
  std::vector<const SweepEntry*> wanted;
  std::set<std::string> keys;
  for (const SweepEntry& entry : entries)
    if (keys.insert(entry.row.key).second) wanted.push_back(&entry);
  std::vector<SweepRow> rows(wanted.size());
  std::vector<bool> have(wanted.size(), false);
  const auto put = [&](size_t i, const SweepRow& figures) {
    rows[i] = figures;
    rows[i].key = wanted[i]->row.key;
    rows[i].name = wanted[i]->row.name;
    rows[i].kind = wanted[i]->row.kind;
    rows[i].settings = wanted[i]->row.settings;
    have[i] = true;
  };
  for (size_t i = 0; i < wanted.size(); ++i)
    for (const SweepRow& row : known)
      if (row.key == wanted[i]->row.key) put(i, row);
  const auto so_far = [&] {
    std::vector<SweepRow> result;
    for (size_t i = 0; i < rows.size(); ++i)
      if (have[i]) result.push_back(rows[i]);
    return result;
  };
  for (size_t i = 0; i < wanted.size(); ++i) {
    if (have[i] || !wanted[i]->measure) continue;
    put(i, wanted[i]->measure());
    save(so_far());
  }
  return so_far();
}

ordered_json sweep_json(const Sweep& sweep) {
  ordered_json json = {{"format", kFormat},
                       {"format_version", kFormatVersion},
                       {"scene", sweep.scene},
                       {"environment", sweep.environment},
                       {"scene_key", sweep.scene_key},
                       {"vertices", sweep.vertices},
                       {"machine", sweep.machine},
                       {"pictures", sweep.pictures}};
  json["rows"] = ordered_json::array();
  for (const SweepRow& row : sweep.rows) json["rows"].push_back(row_json(row));
  return json;
}

Sweep read_sweep(const std::string& path) {
  const ordered_json json = parse_file(path);
  const Fields fields(path, "", json);
  if (const std::string format = fields.text("format"); format != kFormat)
    fields.fail("format", format, fmt::format("\"{}\"", kFormat));
  if (const double version = fields.number("format_version"); version != kFormatVersion)
    fields.fail("format_version", version, fmt::format("{}", kFormatVersion));
  Sweep sweep;
  sweep.scene = fields.text("scene");
  sweep.environment = fields.text("environment");
  sweep.scene_key = fields.text("scene_key");
  sweep.vertices = static_cast<size_t>(fields.number("vertices"));
  sweep.machine = fields.get("machine");
  if (!sweep.machine.is_object()) fields.fail("machine", sweep.machine, "an object");
  sweep.pictures = fields.get("pictures");
  const ordered_json& rows = fields.get("rows");
  if (!rows.is_array()) fields.fail("rows", rows, "an array");
  for (size_t i = 0; i < rows.size(); ++i) sweep.rows.push_back(read_row(path, i, rows[i]));
  return sweep;
}

ordered_json flat_row(const SweepRow& row) {
  ordered_json flat = row_json(row);
  flat.erase("settings");
  flat["below_noise"] = row.below_noise ? "yes" : "no";
  for (const auto& [group, dials] : row.settings.items())
    for (const auto& [name, value] : dials.items()) flat[group + "." + name] = value;
  return flat;
}

}  // namespace burnish::tools
