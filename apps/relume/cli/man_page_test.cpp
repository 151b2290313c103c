#include "cli/man_page.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "cli/platform.h"
#include "cli/roff.h"

namespace relume::cli {
namespace {

TEST(Roff, TextToBeCopiedHasMinusSigns) { EXPECT_EQ(roff_literal("--a-b C:\\x"), "\\-\\-a\\-b C:\\ex"); }

TEST(Roff, RunningTextKeepsHyphensInWordsOnly) {
  EXPECT_EQ(roff_prose("A built-in scene, with --max-bounces -1 (--seed)"),
            "A built-in scene, with \\-\\-max\\-bounces \\-1 (\\-\\-seed)\n");
}

TEST(Roff, CodeIsBold) {
  EXPECT_EQ(roff_prose("See `relume man -o x` first"), "See \\fBrelume man \\-o x\\fR first\n");
}

TEST(Roff, NoLineBeginsWithARequest) {
  EXPECT_EQ(roff_prose(".exr or .hdr"), "\\&.exr or .hdr\n");
  EXPECT_EQ(roff_prose("It's 'quoted'"), "It\\(aqs \\(aqquoted\\(aq\n");
  EXPECT_EQ(roff_literal(".x"), "\\&.x");
}

TEST(Roff, OtherCharactersAreNamed) {
  EXPECT_EQ(roff_prose("a … é 𝛑"), "a \\[u2026] \\[u00E9] \\[u1D6D1]\n");
  EXPECT_EQ(roff_prose("cut \xe2\x80"), "cut \\[u0080]\n");
}

TEST(Roff, SentencesAndLongLinesEnd) {
  EXPECT_EQ(roff_prose("One. Two."), "One.\nTwo.\n");
  const std::string text = roff_prose(std::string(30, 'a') + " " + std::string(30, 'b') + " " + std::string(30, 'c'));
  EXPECT_EQ(text, std::string(30, 'a') + " " + std::string(30, 'b') + "\n" + std::string(30, 'c') + "\n");
}

TEST(ManPage, DocumentsAllDeclarations) {
  std::string text;
  int count = 3;
  bool hot = false;
  const Command cook{.name = "cook",
                     .summary = "Cook a meal.",
                     .examples = {{"relume cook soup", "soup"}},
                     .arguments = {{"MEAL", &text, "What to cook", false}},
                     .options = {{{"plates", &count, "How many", {.min = 1, .max = 9}}, "", 'p'}},
                     .setting_groups = {{"Heat", "Of the stove.", {{"oven.hot", &hot, "Serve hot"}}}},
                     .setting_flags = nullptr,
                     .run = {},
                     .folders = {kReferenceFolder}};
  const std::string page = man_page(cook, {cook});
  for (const char* part : {
           ".SH NAME\n\\fBrelume\\-cook\\fR \\- Cook a meal\n",
           "\\fBrelume cook\\fR [\\fIMEAL\\fR] [\\fIOPTIONS\\fR]\n",
           ".TP\n\\fB\\-p\\fR, \\fB\\-\\-plates\\fR \\fIN\\fR\nHow many.\nInteger from 1 to 9; default 3.\n",
           ".SS \"Heat\"\nOf the stove.\n.TP\n\\fB\\-\\-oven.hot\\fR, \\fB\\-\\-no\\-oven.hot\\fR\nServe hot.\n",
           ".TP\n\\fBrelume cook soup\\fR\nsoup\n",
           ".TP\n\\fBXDG_CACHE_HOME\\fR\n",
           "\\fI\\(ti/.cache/relume/references/\\fR\n",
       }) {
    EXPECT_NE(page.find(part), page.npos) << part << "\nin\n" << page;
  }
}

TEST(ManPage, NamesTheFoldersThatTheProgramUses) {
  setenv("XDG_CACHE_HOME", "/cache", 1);
  setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(reference_folder("") + "/", "/cache/" + std::string(kReferenceFolder.path));
  EXPECT_EQ(state_folder() + "/bookmarks/", "/state/" + std::string(kBookmarkFolder.path));
  unsetenv("XDG_CACHE_HOME");
  unsetenv("XDG_STATE_HOME");
  setenv("HOME", "/home/somebody", 1);
  EXPECT_EQ(reference_folder("") + "/",
            "/home/somebody/" + std::string(kReferenceFolder.below_home) + "/" + std::string(kReferenceFolder.path));
  EXPECT_EQ(state_folder() + "/bookmarks/",
            "/home/somebody/" + std::string(kBookmarkFolder.below_home) + "/" + std::string(kBookmarkFolder.path));
}

}  // namespace
}  // namespace relume::cli
