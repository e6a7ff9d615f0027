// What both programs are made of: option values, error lines, exit codes, the progress bar's text.

#include "common/program.h"

#include <csignal>
#include <new>

#include <gtest/gtest.h>

#include "burnish/formats/error.h"
#include "burnish/precompute/progress.h"
#include "common/command.h"
#include "common/options.h"
#include "common/progress_bar.h"
#include "common/work.h"
#include "subprocess.h"

namespace burnish::tools {
namespace {

/// Parses one option's value; returns the error line, or "" if it was accepted.
std::string parse(CLI::App& app, const std::string& flag, const std::string& value) {
  try {
    app.parse(std::vector<std::string>{value, flag});  // CLI11 takes them back to front
    return "";
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

TEST(Options, IntegerOutsideItsRangeIsRefusedWithTheRange) {
  CLI::App app;
  int value = 512;
  add_number(app, "--directions", "N", value, {64, 1024, "", true}, "directions");
  EXPECT_EQ(parse(app, "--directions", "32"),
            "--directions: found '32', expected an integer in 64..1024, a power of two");
  EXPECT_EQ(value, 512);
  for (const char* bad : {"2048", "100", "256x", "1e2", "", " 128", "-128", "0x80",
                          "18446744073709551744", "nan", "128.0"})
    EXPECT_NE(parse(app, "--directions", bad), "") << "accepted '" << bad << "'";
  EXPECT_EQ(value, 512);
  EXPECT_EQ(parse(app, "--directions", "64"), "");
  EXPECT_EQ(value, 64);
  EXPECT_EQ(parse(app, "--directions", "1024"), "");
  EXPECT_EQ(value, 1024);
}

TEST(Options, RealNumberIsParsedWholeAndInRange) {
  CLI::App app;
  float value = 0.25f;
  add_number(app, "--alpha-x", "A", value, {1e-4f, 1.0f}, "roughness");
  for (const char* bad : {"0", "1.01", "nan", "inf", "-0.5", "0.5 ", "0,5", "1e-5", "1e400", "a"})
    EXPECT_NE(parse(app, "--alpha-x", bad), "") << "accepted '" << bad << "'";
  EXPECT_EQ(value, 0.25f);
  EXPECT_EQ(parse(app, "--alpha-x", "1e-4"), "");  // the bound itself, rounded as a float is
  EXPECT_EQ(value, 1e-4f);
  EXPECT_EQ(parse(app, "--alpha-x", "+.5"), "");
  EXPECT_EQ(value, 0.5f);
}

TEST(Options, NegativeNumberIsAValueAndNotAFlag) {
  CLI::App app;
  float value = 0;
  add_number(app, "--exposure", "EV", value, {-20, 20, "stops"}, "exposure");
  EXPECT_EQ(parse(app, "--exposure", "-1.5"), "");
  EXPECT_EQ(value, -1.5f);
  EXPECT_EQ(parse(app, "--exposure", "-.5"), "");
  EXPECT_EQ(value, -0.5f);
}

TEST(Options, ColorTakesThreeNumbersFromZeroToOne) {
  CLI::App app;
  std::optional<Rgb> color;
  add_color(app, "--diffuse", color, "albedo", "the material's");
  for (const char* bad :
       {"1,1", "1,1,1,1", "1,1,", ",1,1", "1,1,1.5", "-0.1,1,1", "a,1,1", "1 1 1"})
    EXPECT_NE(parse(app, "--diffuse", bad), "") << "accepted '" << bad << "'";
  EXPECT_FALSE(color.has_value());
  EXPECT_EQ(parse(app, "--diffuse", "0,0.5,1"), "");
  ASSERT_TRUE(color.has_value());
  EXPECT_TRUE((*color == Rgb(0, 0.5f, 1)).all());
  EXPECT_NE(app.help().find("(default the material's)"), std::string::npos) << app.help();
}

TEST(Options, AnOptionalNumberIsNothingUnlessGiven) {
  CLI::App app;
  std::optional<float> value;
  add_number(app, "--alpha-x", "A", value, {0.25f, 1}, "roughness", "the material's");
  EXPECT_EQ(parse(app, "--alpha-x", "2"), "--alpha-x: found '2', expected a number in 0.25..1");
  EXPECT_FALSE(value.has_value());
  EXPECT_EQ(parse(app, "--alpha-x", "0.5"), "");
  EXPECT_EQ(value, 0.5f);
  EXPECT_NE(app.help().find("0.25..1 (default the material's)"), std::string::npos) << app.help();
}

TEST(Options, ChoiceNamesWhatIsAccepted) {
  CLI::App app;
  int value = 2;
  add_choice(app, "--up", value, {{"y", 2}, {"z", 3}}, "axis");
  EXPECT_EQ(parse(app, "--up", "w"), "--up: found 'w', expected one of y|z");
  EXPECT_EQ(parse(app, "--up", "z"), "");
  EXPECT_EQ(value, 3);
  EXPECT_NE(app.help().find("y|z"), std::string::npos) << app.help();
  EXPECT_NE(app.help().find("(default y)"), std::string::npos) << app.help();
}

TEST(Options, OutputNameMustHaveItsExtension) {
  CLI::App app;
  std::string path;
  add_file(app, "-o,--output", "FILE.h5", path, "output", ".h5");
  EXPECT_EQ(parse(app, "-o", "a.obj"),
            "--output: found 'a.obj', expected a file name that ends in .h5");
  EXPECT_NE(parse(app, "-o", "h5"), "");
  EXPECT_EQ(parse(app, "-o", "folder.x/A.H5"), "");
  EXPECT_EQ(path, "folder.x/A.H5");
}

TEST(OneLine, ControlCharactersDoNotReachTheTerminal) {
  EXPECT_EQ(one_line("a\nb\x1b[2Jc\td\x7f\n"), "a b?[2Jc?d?");
  EXPECT_EQ(one_line("naïve ü"), "naïve ü");
}

TEST(RunGuarded, ExceptionsBecomeExitCodes) {
  const auto code_of = [](const auto& thrown) {
    testing::internal::CaptureStderr();
    const int code = run_guarded("burnish test", [&] { throw thrown; });
    const std::string line = testing::internal::GetCapturedStderr();
    EXPECT_TRUE(line.starts_with("burnish test: ")) << line;
    EXPECT_EQ(line.find('\n'), line.size() - 1) << line;
    return code;
  };
  EXPECT_EQ(code_of(UsageError("what")), 1);
  EXPECT_EQ(code_of(Error(ErrorKind::input, "file", "two\nlines")), 2);
  EXPECT_EQ(code_of(Error(ErrorKind::unsupported, "file", "what")), 3);
  EXPECT_EQ(code_of(Error(ErrorKind::output, "file", "what")), 4);
  EXPECT_EQ(code_of(CheckFailed("what")), 5);
  EXPECT_EQ(code_of(std::bad_alloc()), 2);
  EXPECT_EQ(code_of(std::logic_error("what")), 70);
  EXPECT_EQ(run_guarded("burnish test", [] {}), 0);
}

TEST(RequireWritable, ProbesWithoutTouchingAnything) {
  const test::ScratchFolder folder;
  const std::string existing = folder.file("old.h5");
  test::write_whole_file(existing, "old");
  require_writable(std::vector<std::string>{existing, "", folder.file("new.h5"), ""});
  EXPECT_EQ(folder.names(), std::vector<std::string>{"old.h5"});
  EXPECT_EQ(test::read_whole_file(existing), "old");
  const auto kind_of = [](const std::string& path) {
    try {
      require_writable(std::vector{path});
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
      return error.kind();
    }
    ADD_FAILURE() << path << " passes for writable";
    return ErrorKind::input;
  };
  EXPECT_EQ(kind_of(folder.file("missing/new.h5")), ErrorKind::output);
  EXPECT_EQ(kind_of(folder.path().string()), ErrorKind::output);
  EXPECT_EQ(kind_of(existing + "/new.h5"), ErrorKind::output);
  EXPECT_THROW(require_writable(std::vector{existing, folder.file("./old.h5")}), UsageError);
}

TEST(CommandLine, ReadsBackInAShell) {
  char program[] = "burnish", plain[] = "a-b_1.h5", space[] = "two words", quote[] = "it's",
       empty[] = "";
  char* arguments[] = {program, plain, space, quote, empty};
  EXPECT_EQ(command_line(5, arguments), "burnish a-b_1.h5 'two words' 'it'\\''s' ''");
}

TEST(BytesText, TakesThreeDigitsAndAUnit) {
  EXPECT_EQ(bytes_text(0), "0 bytes");
  EXPECT_EQ(bytes_text(999), "999 bytes");
  EXPECT_EQ(bytes_text(1000), "1 kB");
  EXPECT_EQ(bytes_text(999499), "999 kB");
  EXPECT_EQ(bytes_text(999600), "1 MB");
  EXPECT_EQ(bytes_text(12345678), "12.3 MB");
}

TEST(CountText, TakesThreeDigitsAndAPrefix) {
  EXPECT_EQ(count_text(0), "0");
  EXPECT_EQ(count_text(999), "999");
  EXPECT_EQ(count_text(1e6), "1 M");
  EXPECT_EQ(count_text(3.287e9), "3.29 G");
  EXPECT_EQ(count_text(4.2e18), "4.2e+06 T");
}

TEST(ProgressLine, FillsTheWidthAndForetellsTheTimeLeft) {
  // A quarter done in 10 s leaves 30 s.
  const std::string line = progress_line("rays", 25, 100, 10, 80);
  EXPECT_EQ(line, "rays [##########------------------------------]  25 %, 0:30 left");
  EXPECT_NE(progress_line("rays", 1, 1000, 10, 80).find("2:46:30 left"), std::string::npos)
      << progress_line("rays", 1, 1000, 10, 80);
}

TEST(ProgressLine, StandsAnyCountsAndAnyWidth) {
  EXPECT_EQ(progress_line("rays", 0, 0, 0, 80).find("left"), std::string::npos);
  EXPECT_NE(progress_line("rays", 200, 100, 10, 80).find("100 %"), std::string::npos);
  for (const int columns : {0, 1, 2, 5, 20, 40, 79, 80, 81, 1000})
    for (const std::uint64_t done : {0u, 1u, 50u, 99u, 100u}) {
      const std::string line = progress_line("a rather long stage name", done, 100, 1e9, columns);
      EXPECT_LE(line.size(), static_cast<size_t>(std::max(columns - 1, 0))) << columns;
    }
}

}  // namespace
}  // namespace burnish::tools
