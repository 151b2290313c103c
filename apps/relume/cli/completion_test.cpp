#include "cli/completion.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace relume::cli {
namespace {

enum class Taste : int { sweet, sour };

std::string script() {
  static std::string text;
  static bool flag = false;
  static Taste taste = Taste::sweet;
  const Command cook{.name = "cook",
                     .summary = "Cook.",
                     .examples = {},
                     .arguments = {{"SCENE", &text, "What", true, Completion::scene}},
                     .options = {{{"output", &text, "Where to"}, "FILE", 'o', Completion::file},
                                 {{"preset", &text, "Recipe"}, "NAME", 0, Completion::preset},
                                 {{"taste", choice(taste, {"sweet", "sour"}), "How"}},
                                 {{"hot", &flag, "Serve hot"}}},
                     .setting_groups = {},
                     .setting_flags = nullptr,
                     .run = {}};
  return bash_completion({cook}, {.scenes = {"cornell", "city"}, .presets = {"quick", "slow"}, .experiments = {}});
}

/// Bash's completions at the end of `words` (shell syntax); sorted, separated by spaces.
std::string complete(const std::string& words) {
  const auto file =
      std::filesystem::path(testing::TempDir()) /
      (std::string("relume_completion_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".bash");
  std::ofstream(file) << script() << "COMP_WORDS=(relume " << words << ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n"
                      << "compopt() { :; }\n_relume\nprintf '%s\\n' \"${COMPREPLY[@]}\" | sort | tr '\\n' ' '\n";
  std::string result;
  std::FILE* pipe = popen(("cd /usr && bash --norc " + file.string()).c_str(), "r");
  for (int c = 0; (c = std::fgetc(pipe)) != EOF;) result += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0);
  std::filesystem::remove(file);
  return result;
}

TEST(Completion, OffersCommands) { EXPECT_EQ(complete("c"), "cook "); }

TEST(Completion, OffersOptions) {
  EXPECT_EQ(complete("cook --"), "--help --hot --no-hot --output --preset --taste ");
  EXPECT_EQ(complete("cook x --ta"), "--taste ");
}

TEST(Completion, OffersValues) {
  EXPECT_EQ(complete("cook --taste s"), "sour sweet ");
  EXPECT_EQ(complete("cook --preset q"), "quick ");
  EXPECT_EQ(complete("cook -o sha"), "share ");
  EXPECT_EQ(complete("cook c"), "city cornell ");
}

}  // namespace
}  // namespace relume::cli
