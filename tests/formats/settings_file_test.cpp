#include "burnish/formats/settings_file.h"

#include <gtest/gtest.h>

#include "files.h"
#include "json_damage.h"

namespace burnish::test {
namespace {

using Dials = std::vector<DialSetting>;

/// Of every kind of value; names in the order in which they are read.
SettingsFile some_settings() {
  return {.bake = {{"amplitude", "0.6"}, {"bases", "8"}, {"coarsest", "all"}},
          .lights = {{"lobes", "10"}},
          .shading = {{"cosine", "horizon-normalised"}, {"ladder-reach", "2.5"}},
          .source = "quotes \" backslash \\ newline \n umlaut \xc3\xbc"};
}

void expect_equal(const SettingsFile& a, const SettingsFile& b) {
  EXPECT_EQ(a.bake, b.bake);
  EXPECT_EQ(a.lights, b.lights);
  EXPECT_EQ(a.shading, b.shading);
  EXPECT_EQ(a.source, b.source);
}

class SettingsFileOnDisk : public testing::Test {
 protected:
  SettingsFile read(const std::string& json) const {
    write_bytes(path_, json);
    return read_settings(path_);
  }
  /// After the file's name.
  std::string error_of(const std::string& json, ErrorKind kind = ErrorKind::input) const {
    const std::string what = test::error_of(
        path_, [&] { read(json); }, kind);
    return what.empty() ? "" : what.substr(path_.size() + 2);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.file("a.json");
};

TEST_F(SettingsFileOnDisk, ReadsBackWhatWasWritten) {
  SettingsFile one_section;
  one_section.shading = {{"integral", "fast"}};
  for (const SettingsFile& settings : {some_settings(), SettingsFile{}, one_section}) {
    write_settings(settings, path_);
    expect_equal(read_settings(path_), settings);
  }
}

TEST_F(SettingsFileOnDisk, IsReadableByPeople) {
  write_settings({{{"terms", "16"}, {"coarsest", "all"}}, {}, {{"ladder-reach", "2.5"}}, "by hand"},
                 path_);
  EXPECT_EQ(read_bytes(path_), R"({
  "format": "burnish settings",
  "format_version": 1,
  "source": "by hand",
  "bake": {
    "terms": 16,
    "coarsest": "all"
  },
  "lights": {},
  "shading": {
    "ladder-reach": 2.5
  }
}
)");
}

TEST_F(SettingsFileOnDisk, SectionsAndSourceMayBeLeftOut) {
  const SettingsFile settings =
      read(R"({"format": "burnish settings", "format_version": 1, "bake": {"terms": "16"}})");
  EXPECT_EQ(settings.bake, (Dials{{"terms", "16"}}));
  EXPECT_TRUE(settings.lights.empty());
  EXPECT_TRUE(settings.shading.empty());
  EXPECT_EQ(settings.source, "");
}

TEST_F(SettingsFileOnDisk, BadFilesAreNamedWithPlaceAndWhatWasExpected) {
  const auto document = [](const std::string& rest) {
    return R"({"format": "burnish settings", "format_version": 1)" + rest + "}";
  };
  const struct {
    std::string json, place, expected;
  } cases[] = {
      {"terms 16", "line 1", "column"},
      {"[]", "line 1", "is array, expected an object"},
      {R"({"format_version": 1})", "line 1", "has no field 'format'"},
      {R"({"format": "burnish lights", "format_version": 2})", "/format",
       "'burnish lights', expected 'burnish settings'"},
      {R"({"format": "burnish settings", "format_version": 1.5})", "/format_version",
       "expected an integer"},
      {document(R"(, "render": {})"), "render", "expected"},
      {document(R"(, "bake": [16])"), "/bake", "expected an object of dials"},
      {document(R"(, "source": 1)"), "/source", "string"},
      {document(R"(, "bake": {"terms": [16]})"), "/bake/terms", "expected a number or a string"},
      {document(R"(, "lights": {"lobes": null})"), "/lights/lobes",
       "expected a number or a string"},
      {document(R"(, "shading": {"ladder": true})"), "/shading/ladder",
       "expected a number or a string"},
      {document(R"(, "bake": {"terms": 1, "terms": 2})"), "terms", "twice"},
  };
  for (const auto& bad : cases) {
    const std::string message = error_of(bad.json);
    EXPECT_NE(message.find(bad.place), std::string::npos) << bad.json << "\n" << message;
    EXPECT_NE(message.find(bad.expected), std::string::npos) << bad.json << "\n" << message;
  }
  EXPECT_EQ(
      error_of(R"({"format": "burnish settings", "format_version": 2})", ErrorKind::unsupported),
      "settings format version 2, this build reads up to 1");
  const std::string missing = folder_.file("missing.json");
  EXPECT_NE(test::error_of(missing, [&] { read_settings(missing); }), "");
}

TEST_F(SettingsFileOnDisk, WhatCannotBeReadBackIsNotWritten) {
  const SettingsFile twice = {{{"terms", "1"}, {"terms", "2"}}, {}, {}, ""};
  EXPECT_NE(test::error_of(
                path_, [&] { write_settings(twice, path_); }, ErrorKind::output)
                .find("these settings cannot be stored"),
            std::string::npos);
  EXPECT_EQ(folder_.file_count(), 0u);
}

TEST_F(SettingsFileOnDisk, DamageIsRefusedOrRead) {
  write_settings(some_settings(), path_);
  const std::string json = read_bytes(path_);
  expect_damage_is_refused_or_read(json, 5, [&](const std::string& text) { read(text); });
}

TEST(SettingsFile, OutputSurvivesFailure) {
  expect_output_survives_failure(
      "a.json", [](const std::string& path) { write_settings(some_settings(), path); });
}

}  // namespace
}  // namespace burnish::test
