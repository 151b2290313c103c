#include "cli/command_line.h"

#include <gtest/gtest.h>

#include <functional>

#include "render/settings.h"

namespace relume::cli {
namespace {

/// A command with one option of each kind.
struct Fixture {
  std::string input;
  std::string output;
  int count = 3;
  bool loud = false;
  AllSettings defaults;
  std::vector<std::pair<std::string, std::string>> flags;
  int runs = 0;

  Command command() {
    return {.name = "paint",
            .summary = "Paint.",
            .examples = {{"relume paint in -o out", "as an example"}},
            .arguments = {{"INPUT", &input, "What to paint"}},
            .options = {{{"output", &output, "Where to"}, "FILE", 'o'},
                        {{"count", &count, "How often", {.min = 1, .max = 9}}},
                        {{"loud", &loud, "Sing"}}},
            .setting_groups = setting_groups(defaults),
            .setting_flags = &flags,
            .run = [this] { return ++runs, kExitDone; }};
  }

  std::string error_of(const std::vector<std::string>& arguments) {
    try {
      parse_arguments(command(), arguments);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST(CommandLine, AssignsGivenOptions) {
  Fixture f;
  EXPECT_EQ(parse_arguments(f.command(), {"-o", "out.png", "scene.glb", "--count=4", "--loud"}), Request::run);
  EXPECT_EQ(f.input, "scene.glb");
  EXPECT_EQ(f.output, "out.png");
  EXPECT_EQ(f.count, 4);
  EXPECT_TRUE(f.loud);
}

TEST(CommandLine, JoinsRepeatedOptions) {
  std::string how;
  std::string names;
  std::string flags;
  int runs = 0;
  const Command command{.name = "sing",
                        .summary = "Sing.",
                        .examples = {},
                        .arguments = {{"HOW", &how, "How", true, Completion::none},
                                      {"NAME", &names, "What", false, Completion::none, true}},
                        .options = {{{"voice", &flags, "Who"}, "LIST", 0, Completion::none, true}},
                        .setting_groups = {},
                        .setting_flags = nullptr,
                        .run = [&] { return ++runs, kExitDone; }};
  EXPECT_EQ(parse_arguments(command, {"softly", "a", "--voice", "x=1,y:2", "b", "--voice", "z", "c"}), Request::run);
  EXPECT_EQ(how, "softly");
  EXPECT_EQ(names, "a,b,c");
  EXPECT_EQ(flags, "x=1,y:2,z");
}

TEST(CommandLine, CollectsSettings) {
  Fixture f;
  parse_arguments(f.command(), {"in", "--exposure", "-1", "--time", "10s", "--no-path.russian-roulette", "--env",
                                "1,1,1", "--seed", "1", "--seed", "2"});
  const AllSettings settings = resolve({.flags = f.flags});
  EXPECT_EQ(settings.output.exposure, -1);
  EXPECT_EQ(settings.stop.time_s, 10);
  EXPECT_FALSE(settings.render.path.russian_roulette);
  EXPECT_EQ(settings.scene.env, "1,1,1");
  EXPECT_EQ(settings.render.seed, 2);
  EXPECT_FALSE(f.defaults.output.exposure) << "parsing must not assign settings";
}

TEST(CommandLine, SwitchesBooleansEitherWay) {
  Fixture f;
  parse_arguments(f.command(), {"in", "--path.russian-roulette=off", "--loud=true"});
  EXPECT_FALSE(resolve({.flags = f.flags}).render.path.russian_roulette);
  EXPECT_TRUE(f.loud);
}

TEST(CommandLine, ErrorsAreOneSentence) {
  Fixture f;
  EXPECT_EQ(f.error_of({}), "paint needs INPUT; see relume paint --help");
  EXPECT_EQ(f.error_of({"in", "--cuont", "3"}), "paint has no option --cuont; did you mean --count?");
  EXPECT_EQ(f.error_of({"--max-bonces=3", "in"}), "paint has no option --max-bonces; did you mean --max-bounces?");
  EXPECT_EQ(f.error_of({"in", "--xyzzy"}), "paint has no option --xyzzy; see relume paint --help");
  EXPECT_EQ(f.error_of({"in", "-x"}), "paint has no option -x; see relume paint --help");
  EXPECT_EQ(f.error_of({"in", "more"}), "paint: unexpected argument 'more'; see relume paint --help");
  EXPECT_EQ(f.error_of({"in", "--count", "10"}), "--count is '10', but must be from 1 to 9");
  EXPECT_EQ(f.error_of({"in", "--max-bounces", "-1"}), "--max-bounces is '-1', but must be from 0 to 1024");
  EXPECT_EQ(f.error_of({"in", "--guide", "cqd"}), "--guide is 'cqd', but this version has bsdf, cdq and mcpg");
  EXPECT_NE(f.error_of({"in", "--count"}), "no error");
  EXPECT_NE(f.error_of({"in", "-o"}), "no error");
}

TEST(CommandLine, HelpPrecedesErrors) {
  Fixture f;
  EXPECT_EQ(parse_arguments(f.command(), {"--help"}), Request::help);
  EXPECT_EQ(parse_arguments(f.command(), {"in", "-h", "--seed", "1"}), Request::help);
  EXPECT_EQ(parse_arguments(f.command(), {"--help-all", "--nope"}), Request::help_all);
}

TEST(CommandLine, ProgramRunsCommandsAndReportsByExitCode) {
  Fixture f;
  EXPECT_EQ(run_program({f.command()}, {"paint", "in"}), kExitDone);
  EXPECT_EQ(f.runs, 1);
  EXPECT_EQ(run_program({f.command()}, {"paint", "in", "--nope"}), kExitUsage);
  EXPECT_EQ(run_program({f.command()}, {"pant", "in"}), kExitUsage);
  EXPECT_EQ(run_program({f.command()}, {}), kExitUsage);
  EXPECT_EQ(run_program({f.command()}, {"paint", "--help"}), kExitDone);
  EXPECT_EQ(run_program({f.command()}, {"--version"}), kExitDone);
  EXPECT_EQ(f.runs, 1);
  Command failing = f.command();
  failing.run = []() -> int { throw Error("no paint is left; buy some"); };
  EXPECT_EQ(run_program({failing}, {"paint", "in"}), kExitFailed);
}

TEST(CommandLine, ProgramSaysWhichMemoryIsMissing) {
  Fixture f;
  Command failing = f.command();
  failing.run = []() -> int { throw DeviceMemoryError("the GPU has no room for 5 MiB; use a smaller image"); };
  testing::internal::CaptureStderr();
  EXPECT_EQ(run_program({failing}, {"paint", "in"}), kExitFailed);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "relume: the GPU has no room for 5 MiB; use a smaller image\n");
}

TEST(CommandLine, UnknownCommandGetsASuggestion) {
  Fixture f;
  testing::internal::CaptureStderr();
  run_program({f.command()}, {"pant"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "relume: there is no command 'pant'; did you mean 'paint'?\n");
}

TEST(Help, ShowsExamplesFirstAndEverySetting) {
  Fixture f;
  const std::string help = help_text(f.command());
  EXPECT_LT(help.find("Examples:"), help.find("Usage:"));
  EXPECT_NE(help.find("  -o, --output FILE           Where to\n"), std::string::npos) << help;
  EXPECT_NE(help.find("  --count N                   How often [3]\n"), std::string::npos) << help;
  AllSettings settings;
  for (const Setting& setting : describe(settings)) {
    const bool is_switch = std::holds_alternative<bool*>(setting.value);
    EXPECT_NE(help.find((is_switch ? "  --[no-]" : "  --") + setting.name), std::string::npos) << setting.name;
  }
  for (size_t begin = 0; begin < help.size(); begin = help.find('\n', begin) + 1) {
    EXPECT_LE(help.find('\n', begin) - begin, 100u) << help.substr(begin, 120);
  }
}

TEST(Help, ShowsEssentialsInOrderAndNamesHelpAll) {
  Fixture f;
  Command command = f.command();
  command.essentials = {"spp", "output"};
  const std::string help = help_text(command);
  EXPECT_LT(help.find("  --spp N"), help.find("  -o, --output FILE"));
  EXPECT_EQ(help.find("--count"), help.npos) << help;
  EXPECT_NE(help.find("--help-all"), help.npos) << help;
  const std::string all = full_help_text(command);
  EXPECT_NE(all.find("  --count N"), all.npos);
  EXPECT_NE(all.find("  --max-bounces N"), all.npos);
}

}  // namespace
}  // namespace relume::cli
