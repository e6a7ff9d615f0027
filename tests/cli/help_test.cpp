// Help, version and usage errors of every command of both programs.

#include <regex>

#include <gtest/gtest.h>

#include "sample_files.h"

namespace burnish::test {
namespace {

struct Case {
  const char* program;
  const char* name;
  std::vector<std::string> command;
};

const std::vector<Case>& all_commands() {
  static const std::vector<Case> kCases = {
      {BURNISH_PROGRAM, "burnish", {"bake"}},
      {BURNISH_PROGRAM, "burnish", {"info"}},
      {BURNISH_PROGRAM, "burnish", {"fit-light"}},
      {BURNISH_PROGRAM, "burnish", {"fit-brdf"}},
      {BURNISH_PROGRAM, "burnish", {"render"}},
      {BURNISH_PROGRAM, "burnish", {"shade"}},
      {BURNISH_PROGRAM, "burnish", {"demo"}},
      {BURNISH_BENCH_PROGRAM, "burnish-bench", {"bake"}},
      {BURNISH_BENCH_PROGRAM, "burnish-bench", {"shade"}},
  };
  return kCases;
}

std::string full_name(const Case& command) {
  return std::string(command.name) + " " + command.command[0];
}

TEST(Help, EveryCommandListsItsOptions) {
  for (const Case& command : all_commands()) {
    SCOPED_TRACE(full_name(command));
    const RunResult flag = run_program(command.program, {command.command[0], "--help"});
    EXPECT_EQ(flag.exit_code, 0);
    EXPECT_EQ(flag.err, "");
    EXPECT_NE(flag.out.find("Usage: " + full_name(command)), std::string::npos) << flag.out;
    EXPECT_NE(flag.out.find("Exit codes: "), std::string::npos) << flag.out;
    const RunResult word = run_program(command.program, {"help", command.command[0]});
    EXPECT_EQ(word.exit_code, 0);
    EXPECT_EQ(word.out, flag.out);
    const RunResult short_flag = run_program(command.program, {command.command[0], "-h"});
    EXPECT_EQ(short_flag.out, flag.out);
  }
}

// An option with a value of a scale (a number, a choice, a colour, a size) says what it is when
// left out, and its range where it is a number.
TEST(Help, EveryDialStatesItsDefault) {
  const std::regex option(R"(\n  (?:-\w,)?(--[\w-]+) (\S+) +([^\n]*(?:\n {20,}[^\n]*)*))");
  int dials = 0;
  for (const Case& command : all_commands()) {
    const std::string help = run_program(command.program, {command.command[0], "--help"}).out;
    for (std::sregex_iterator match(help.begin(), help.end(), option), end; match != end; ++match) {
      const std::string name = (*match)[1], placeholder = (*match)[2];
      const std::string text = std::regex_replace((*match)[3].str(), std::regex("\\s+"), " ");
      const bool number = placeholder == "N" || placeholder == "A" || placeholder == "DEG" ||
                          placeholder == "EV" || placeholder == "SPP" || placeholder == "R,G,B";
      if (number) {
        EXPECT_NE(text.find(".."), std::string::npos) << full_name(command) << " " << name;
      }
      if (number || placeholder.find('|') != std::string::npos || placeholder == "WxH") {
        EXPECT_NE(text.find("(default "), std::string::npos) << full_name(command) << " " << name;
        ++dials;
      }
    }
  }
  EXPECT_GT(dials, 60);  // of 8 commands; guards the pattern above against matching nothing
}

TEST(Help, ProgramsListTheirCommands) {
  for (const char* program : {BURNISH_PROGRAM, BURNISH_BENCH_PROGRAM}) {
    const RunResult word = run_program(program, {"help"});
    EXPECT_EQ(word.exit_code, 0);
    EXPECT_EQ(word.err, "");
    for (const Case& command : all_commands())
      if (command.program == std::string(program)) {
        EXPECT_NE(word.out.find("\n  " + command.command[0] + " "), std::string::npos) << word.out;
      }
    EXPECT_EQ(run_program(program, {"--help"}).out, word.out);
    const RunResult nothing = run_program(program, {});
    EXPECT_EQ(nothing.exit_code, 1);
    EXPECT_EQ(nothing.out, word.out);
    EXPECT_TRUE(is_one_clean_line(nothing.err)) << nothing.err;
    const RunResult unknown = run_program(program, {"help", "frobnicate"});
    EXPECT_EQ(unknown.exit_code, 1);
    EXPECT_TRUE(is_one_clean_line(unknown.err)) << unknown.err;
  }
}

TEST(Version, NamesCompilerEmbreeAndCommit) {
  const std::regex form(
      R"((burnish|burnish-bench) \d+\.\d+\.\d+ \(commit \S+, (GNU|Clang) \d+\S* \S+ build, )"
      R"(Embree [34]\.\d+\.\d+\)\n)");
  for (const Case& command : all_commands()) {
    SCOPED_TRACE(full_name(command));
    const RunResult whole = run_program(command.program, {"--version"});
    EXPECT_EQ(whole.exit_code, 0);
    EXPECT_TRUE(std::regex_match(whole.out, form)) << whole.out;
    const RunResult own = run_program(command.program, {command.command[0], "--version"});
    EXPECT_EQ(own.exit_code, 0);
    EXPECT_EQ(own.out, whole.out);
  }
}

TEST(Usage, UnknownOptionIsOneLineAndExitOne) {
  for (const Case& command : all_commands()) {
    SCOPED_TRACE(full_name(command));
    const RunResult result = run_program(command.program, {command.command[0], "--frobnicate"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
    EXPECT_TRUE(result.err.starts_with(full_name(command) + ": ")) << result.err;
  }
}

TEST(Usage, UnknownCommandNamesTheKnownOnes) {
  const RunResult result = burnish({"frobnicate"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err,
            "burnish: unknown command 'frobnicate', expected one of bake info fit-light fit-brdf "
            "render shade tune demo\n");
}

TEST(Usage, ValuesOutOfRangeNameTheRange) {
  const RunResult result = burnish({"bake", "a.obj", "-o", "a.h5", "--directions", "100"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err,
            "burnish bake: --directions: found '100', expected an integer in 64..1024, a power of "
            "two (see burnish help bake)\n");
}

TEST(Usage, ContradictionsAreRefusedBeforeAnyFileIsRead) {
  const std::vector<std::vector<std::string>> wrong = {
      {"bake", "a.obj"},                                    // no output
      {"bake", "a.obj", "-o", "a.exr"},                     // not .h5
      {"bake", "a.obj", "b.scene.json", "-o", "a.h5"},      // a scene is baked alone
      {"bake", "b.scene.json", "--up", "z", "-o", "a.h5"},  // the scene says what is up
      {"bake", "a.obj", "-o", "a.h5", "--resume", "--restart"},
      {"bake", "a.obj", "-o", "a.h5", "--directions", "64", "--resolution", "128"},
      {"fit-light", "-o", "a.json"},          // no environment
      {"fit-brdf", "-o", "a.json"},           // no measurement
      {"fit-brdf", "a.bsdf", "-o", "a.png"},  // not .json
      {"render", "a.h5", "--env", "studio"},  // no output
      {"render", "a.h5", "--png", "a.png"},   // no light
      {"render", "a.h5", "--env", "studio", "--png", "a.png", "--compare", "b.png"},
      {"render", "a.h5", "--env", "studio", "--png", "a.png", "--reference", "4", "--frames", "2"},
      {"render", "a.h5", "--env", "studio", "--png", "a.png", "--size", "16384x16384"},
      {"render", "a.h5", "--env", "studio", "--png", "a.png", "--camera", "0,0,0,0,0,0,40"},
      {"render", "a.h5", "--env", "studio", "--png", "a.png", "--compare", "a.png", "--reference",
       "4"},  // one file twice
  };
  const ScratchFolder folder;
  RunOptions options;
  options.folder = folder.path();
  for (const auto& arguments : wrong) {
    const RunResult result = burnish(arguments, options);
    EXPECT_EQ(result.exit_code, 1) << testing::PrintToString(arguments);
    EXPECT_TRUE(is_one_clean_line(result.err)) << result.err;
  }
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace burnish::test
