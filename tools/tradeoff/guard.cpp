#include "tradeoff/guard.h"

#include <algorithm>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "burnish/formats/error.h"
#include "burnish/formats/output_file.h"
#include "harness/rivals/runtime_rival.h"
#include "harness/studio_environment.h"
#include "tradeoff/trial.h"

namespace burnish::tools {
namespace {

constexpr const char* kHeader = "scene,settings,relative_l2";

struct NamedSettings {
  const char* name;
  ShadingOptions shading;
};

std::vector<NamedSettings> guarded_settings() {
  return {{"fast", shading_options(Quality::fast)},
          {"balanced", shading_options(Quality::balanced)},
          {"accurate", shading_options(Quality::accurate)},
          {"paper", paper_shading_options()}};
}

/// Small enough to bake in a second, with what the others lack: wide shadows, brushed highlights,
/// self-shadowing.
std::vector<ProceduralScene> guarded_scenes() {
  return {make_scene("wall"), make_scene("sphere"), make_knot(2000)};
}

const GuardError* find(const std::vector<GuardError>& errors, const GuardError& like) {
  const auto found = std::find_if(errors.begin(), errors.end(), [&](const GuardError& error) {
    return error.scene == like.scene && error.settings == like.settings;
  });
  return found == errors.end() ? nullptr : &*found;
}

std::string name_of(const GuardError& error) {
  return fmt::format("{}, {}", error.scene, error.settings);
}

}  // namespace

std::vector<GuardError> measure_guard(const Progress& progress) {
  Settings settings;
  settings.bake.directions = 64;
  settings.bake.resolution = 32;
  settings.bake.terms = settings.bake.ladder_terms = 24;
  settings.bake.bases = 2;
  settings.bake.training_vertices = 512;
  TrialOptions options;
  options.vertices = 200;
  options.truth = {.noise = 0, .first_samples = 128, .most_samples = 128};
  options.cache.folder.clear();
  options.frames = 1;
  options.most_terms = settings.bake.terms;
  std::vector<GuardError> errors;
  for (ProceduralScene& scene : guarded_scenes()) {
    const std::string name = scene.name;
    const std::vector<Vector3f> eyes = eyes_around(scene.camera, 2);
    Trial trial({std::move(scene), "studio", studio_environment(), eyes}, options, progress);
    for (const NamedSettings& named : guarded_settings()) {
      settings.shading = named.shading;
      errors.push_back({name, named.name, trial.run(settings).error.value});
    }
  }
  return errors;
}

GuardFile read_guard(const std::string& path) {
  std::ifstream file(path);
  if (!file)
    throw Error(ErrorKind::input, path, "cannot be opened, expected errors to compare with");
  GuardFile guard;
  std::string line;
  int number = 0;
  bool has_header = false;
  while (std::getline(file, line)) {
    ++number;
    if (line.starts_with("# ")) {
      guard.origin = line.substr(2);
      continue;
    }
    if (!has_header) {
      if (line != kHeader)
        throw Error(ErrorKind::input, path,
                    fmt::format("line {}: found \"{}\", expected \"{}\"", number, line, kHeader));
      has_header = true;
      continue;
    }
    std::istringstream fields(line);
    GuardError error;
    std::string value, rest;
    size_t used = 0;
    try {
      if (std::getline(fields, error.scene, ',') && std::getline(fields, error.settings, ',') &&
          std::getline(fields, value))
        error.relative_l2 = std::stod(value, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || used != value.size() || !(error.relative_l2 >= 0))
      throw Error(ErrorKind::input, path,
                  fmt::format("line {}: found \"{}\", expected a scene, settings and an error",
                              number, line));
    guard.errors.push_back(error);
  }
  if (!has_header)
    throw Error(ErrorKind::input, path, fmt::format("is empty, expected \"{}\"", kHeader));
  return guard;
}

void write_guard(const GuardFile& guard, const std::string& path) {
  std::string text = fmt::format("# {}\n{}\n", guard.origin, kHeader);
  for (const GuardError& error : guard.errors)
    text += fmt::format("{},{},{:.5f}\n", error.scene, error.settings, error.relative_l2);
  OutputFile file(path);
  file.write(text);
  file.commit();
}

GuardVerdict compare_guard(const std::vector<GuardError>& expected,
                           const std::vector<GuardError>& found) {
  GuardVerdict verdict;
  for (const GuardError& error : found) {
    const GuardError* before = find(expected, error);
    if (!before) {
      verdict.unmatched.push_back(name_of(error) + ": measured, but nothing is expected");
      continue;
    }
    const double margin = kGuardMargin * before->relative_l2;
    const std::string line =
        fmt::format("{}: found {:.5f}, expected {:.5f} +- {:.5f}", name_of(error),
                    error.relative_l2, before->relative_l2, margin);
    if (!(error.relative_l2 <= before->relative_l2 + margin)) verdict.worse.push_back(line);
    if (error.relative_l2 < before->relative_l2 - margin) verdict.better.push_back(line);
  }
  for (const GuardError& error : expected)
    if (!find(found, error))
      verdict.unmatched.push_back(name_of(error) + ": expected, but not measured");
  return verdict;
}

}  // namespace burnish::tools
