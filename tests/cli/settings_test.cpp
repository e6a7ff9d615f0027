// Dials of settings files: as if they stood on the command line.

#include "tradeoff/settings.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/options.h"
#include "common/pipeline_options.h"
#include "common/settings_option.h"
#include "sample_files.h"

namespace burnish::tools {
namespace {

using test::burnish;
using test::is_one_clean_line;
using test::joined;
using test::read_whole_file;
using test::RunResult;
using test::ScratchFolder;
using test::write_whole_file;

/// The options of bake and render that are dials, on one command.
class Command {
 public:
  Command() {
    const auto bake = [this](CLI::App& app) { add_bake_options(app, settings_.bake); };
    const auto lights = [this](CLI::App& app) {
      add_number(app, "--lobes", "N", settings_.lobes, {1, 128}, "as render declares it");
    };
    const auto shading = [this](CLI::App& app) {
      add_shading_options(app, settings_.shading);
      add_choice(app, "--specular-from", settings_.specular_from_map,
                 {{"map", true}, {"lobes", false}}, "as render declares it");
    };
    add_settings_option(app_, {{&SettingsFile::bake, "bake", bake},
                               {&SettingsFile::lights, "lights", lights},
                               {&SettingsFile::shading, "shading", shading}});
    for (const auto& declare : std::vector<std::function<void(CLI::App&)>>{bake, lights, shading})
      declare(app_);
  }
  Settings parse(std::vector<std::string> arguments) {
    std::reverse(arguments.begin(), arguments.end());  // CLI11 takes them from the back
    app_.parse(arguments);
    return settings_;
  }

 private:
  CLI::App app_;
  Settings settings_;
};

/// No dial as it is by default.
Settings unusual_settings() {
  Settings settings;
  settings.bake = {.directions = 128,
                   .coarsest = 1024,
                   .origin_offset = 0.1,
                   .resolution = 32,
                   .terms = 7,
                   .amplitude_rad = 0.7,
                   .bases = 3,
                   .target_error = 0,
                   .ladder_terms = 5,
                   .training_vertices = 1234,
                   .residual_vertices = 12};
  settings.lobes = 11;
  ShadingOptions& shading = settings.shading;
  shading.visibility = VisibilityModel::cap;
  shading.cosine = CosineModel::constant;
  shading.integral = AsgIntegral::series;
  shading.ladder = false;
  shading.ladder_reach = 3.3f;
  shading.specular = {SpecularForm::peak, 2, 1};
  shading.split_bandwidth = 0.1f;
  shading.environment_taps = 8;
  shading.highlight_lobe = HighlightLobe::whole;
  settings.specular_from_map = false;
  return settings;
}

TEST(SettingsOption, EveryDialOfAFileIsAnOptionAndComesBack) {
  const ScratchFolder folder;
  const nlohmann::ordered_json usual = settings_json({});
  const nlohmann::ordered_json unusual = settings_json(unusual_settings());
  for (const auto& [section, dials] : unusual.items())
    for (const auto& [dial, value] : dials.items())
      EXPECT_NE(value, usual[section][dial]) << section << "/" << dial;
  for (const Settings& settings : {unusual_settings(), Settings{}}) {
    write_settings(settings_file(settings), folder.file("a.json"));
    const Settings found = Command().parse({"--settings", folder.file("a.json")});
    EXPECT_EQ(settings_json(found).dump(1), settings_json(settings).dump(1));
  }
}

TEST(SettingsOption, OptionsOverrideTheFileBeforeItAndAfterIt) {
  const ScratchFolder folder;
  const std::string file = folder.file("a.json");
  write_settings(settings_file(unusual_settings()), file);
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"--terms", "9", "--specular-taps", "4", "--settings", file},
        {"--settings", file, "--terms", "9", "--specular-taps", "4"}}) {
    const Settings found = Command().parse(arguments);
    EXPECT_EQ(found.bake.terms, 9);
    EXPECT_EQ(found.shading.specular.taps, 4);
    EXPECT_EQ(found.bake.directions, 128);
    EXPECT_EQ(found.lobes, 11);
  }
}

// Its dials come in any order; --quality sets those that are not given themselves.
TEST(SettingsOption, QualityOfAFileLeavesTheFilesOtherDials) {
  const ScratchFolder folder;
  const std::string file = folder.file("a.json");
  write_settings({{}, {}, {{"environment-taps", "2"}, {"quality", "accurate"}}, ""}, file);
  const Settings found = Command().parse({"--settings", file});
  EXPECT_EQ(found.shading.environment_taps, 2);
  EXPECT_EQ(found.shading.specular.taps, shading_options(Quality::accurate).specular.taps);
  EXPECT_NE(found.shading.specular.taps, ShadingOptions{}.specular.taps);
}

std::string settings_text(const std::string& sections) {
  return R"({"format": "burnish settings", "format_version": 1, )" + sections + "}";
}

void expect_refusal(const RunResult& result, const std::vector<std::string>& named) {
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  for (const std::string& part : named)
    EXPECT_NE(result.err.find(part), std::string::npos) << part << " in " << result.err;
}

TEST(SettingsProgram, BadDialsNameFilePlaceFoundAndExpected) {
  const ScratchFolder folder;
  write_whole_file(folder.file("box.obj"), test::box_over_floor_obj());
  const std::string file = folder.file("bad.json");
  const auto bake = [&](const std::string& sections) {
    write_whole_file(file, settings_text(sections));
    return burnish({"bake", folder.file("box.obj"), "--settings", file, "-o", folder.file("a.h5")});
  };
  const std::string number = "an integer in 1..1024";
  expect_refusal(bake(R"("bake": {"terms": 0})"), {file, "/bake/terms: found '0'", number});
  expect_refusal(bake(R"("bake": {"terms": -3})"), {file, "/bake/terms: found '-3'", number});
  expect_refusal(bake(R"("bake": {"terms": 16.5})"), {file, "/bake/terms: found '16.5'", number});
  expect_refusal(bake(R"("bake": {"terms": "many"})"), {file, "/bake/terms: found 'many'", number});
  expect_refusal(bake(R"("bake": {"terms": ""})"), {file, "/bake/terms: found ''", "expected"});
  expect_refusal(bake(R"("bake": {"coarsest": "--help"})"),
                 {file, "/bake/coarsest: found '--help'", "one of 16|32"});
  for (const std::string name : {"lobes", "help", "settings", "terms=3", ""})
    expect_refusal(
        bake("\"bake\": {\"" + name + "\": 1}"),
        {file, "/bake/" + name + ": is no dial, expected one of", "directions, ", "ladder-terms"});
  expect_refusal(bake(R"("bakes": {})"), {file, "bakes"});

  write_whole_file(file, settings_text(R"("shading": {"visibility": "all"})"));
  expect_refusal(burnish({"render", folder.file("a.h5"), "--env", "studio", "--settings", file,
                          "--png", folder.file("a.png")}),
                 {file, "/shading/visibility: found 'all'", "one of cap|hemisphere|directional"});
  const std::string missing = folder.file("missing.json");
  expect_refusal(
      burnish({"bake", folder.file("box.obj"), "--settings", missing, "-o", folder.file("a.h5")}),
      {missing});
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"bad.json", "box.obj"}));
}

TEST(SettingsProgram, BakeAndRenderTakeAFileAsTheyTakeItsDials) {
  const ScratchFolder folder;
  ASSERT_EQ(test::make_quick_bake(folder).exit_code, 0);
  const std::string file = folder.file("a.json");
  write_whole_file(file, settings_text(R"("bake": {"directions": 64, "resolution": 32, "terms": 8},
      "lights": {"lobes": 3}, "shading": {"specular-from": "lobes", "cosine": "constant"})"));
  const auto run = [&](std::vector<std::string> command, const std::string& output,
                       const std::vector<std::string>& dials) {
    command.insert(command.end(), {"-o", folder.file(output)});
    const RunResult result = burnish(joined(command, dials));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_whole_file(folder.file(output));
  };
  EXPECT_EQ(run({"bake", folder.file("box.obj")}, "settings.h5", {"--settings", file}),
            read_whole_file(folder.file("box.h5")));
  const std::vector<std::string> render = {"render",     folder.file("box.h5"),
                                           "--env",      folder.file("env.exr"),
                                           "--material", "ward",
                                           "--size",     "24x16"};
  const std::string by_file = run(render, "a.exr", {"--settings", file});
  EXPECT_EQ(by_file, run(render, "b.exr",
                         {"--lobes", "3", "--specular-from", "lobes", "--cosine", "constant"}));
  for (const std::vector<std::string>& one : {std::vector<std::string>{"--lobes", "4"},
                                              {"--specular-from", "map"},
                                              {"--cosine", "horizon-normalised"}})
    EXPECT_NE(by_file, run(render, "c.exr", joined({"--settings", file}, one))) << one[0];
}

TEST(SettingsProgram, TuneWritesWhatBakeAndRenderTake) {
  const ScratchFolder folder;
  write_whole_file(folder.file("box.obj"), test::box_over_floor_obj());
  test::write_small_environment(folder.file("env.exr"));
  const std::string file = folder.file("a.json");
  const auto tune = [&](const std::vector<std::string>& target) {
    return burnish(
        joined({"tune", folder.file("box.obj"), folder.file("env.exr"), "-o", file, "--report",
                folder.file("a.report.json"), "--directions", "64", "--resolution", "32",
                "--material", "satin", "--views", "1", "--vertices", "8", "--noise", "1"},
               target));
  };
  // The first point of the grid is accurate enough: all others are dearer.
  RunResult result = tune({"--target-error", "9"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.rfind("1 of ", 0), 0u) << result.out;
  EXPECT_NE(result.out.find(file + ": terms 8, lobes 4"), std::string::npos) << result.out;
  const SettingsFile settings = read_settings(file);
  EXPECT_NE(settings.source.find("burnish tune"), std::string::npos);
  const auto report = nlohmann::json::parse(read_whole_file(folder.file("a.report.json")));
  EXPECT_TRUE(report["met"]);
  EXPECT_EQ(report["tried"].size(), 1u);
  EXPECT_TRUE(report["tried"][0].contains("check"));

  result = burnish({"bake", folder.file("box.obj"), "--settings", file, "-o", folder.file("a.h5")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find(" 8 + "), std::string::npos) << result.out;
  result = burnish({"render", folder.file("a.h5"), "--env", folder.file("env.exr"), "--settings",
                    file, "--png", folder.file("a.png"), "--report", folder.file("b.report.json"),
                    "--size", "24x16"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(read_whole_file(folder.file("b.report.json")))["lobes"], 4);

  // A target out of reach leaves the old file, and says what is nearest.
  const std::string before = read_whole_file(file);
  result = tune({"--target-ms", "1e-9"});
  EXPECT_NE(result.exit_code, 0);
  EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  EXPECT_NE(result.err.find("out of reach; nearest is terms 8"), std::string::npos) << result.err;
  EXPECT_EQ(read_whole_file(file), before);

  for (const std::vector<std::string>& target :
       {std::vector<std::string>{}, {"--target-ms", "1", "--target-error", "1"}})
    EXPECT_EQ(tune(target).exit_code, 1);
}

}  // namespace
}  // namespace burnish::tools
