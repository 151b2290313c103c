#include "cli/console.h"

#include <gtest/gtest.h>

#include "relume/scene.h"

namespace relume::cli {
namespace {

using Sentences = std::vector<std::string>;

TEST(Console, NamesEachFileOnce) {
  const Sentences once = name_files_once(
      {"a/b.glb: one", "a/b.glb: x.png: two", "c.json: three", "c.json: four", "five"}, {"a/b.glb", "c.json", "x.png"});
  EXPECT_EQ(once, (Sentences{"a/b.glb: one", "x.png: two", "c.json: three", "four", "five"}));
}

TEST(Console, NamesAFileAgainAfterAnotherOne) {
  EXPECT_EQ(name_files_once({"a: one", "b: two", "a: three"}, {"a", "b"}), (Sentences{"a: one", "b: two", "a: three"}));
}

TEST(Console, CutsBetweenCharacters) {
  const std::string text = "K\u00fcche \u6728 x";
  EXPECT_EQ(first_characters(text, 2), "K\u00fc");
  EXPECT_EQ(first_characters(text, 1), "K");
  EXPECT_EQ(first_characters(text, 7), "K\u00fcche \u6728");
  EXPECT_EQ(first_characters(text, 9), text);
  EXPECT_EQ(first_characters(text, 90), text);
  EXPECT_EQ(first_characters(text, 0), text);
}

TEST(Console, PrintsNotesOnlyIfVerbose) {
  Scene scene;
  scene.source_files = {"a.glb"};
  scene.warnings = {"a.glb: one", "a.glb: two"};
  scene.notes = {"a.glb: three"};
  testing::internal::CaptureStderr();
  warn_all({}, scene);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: a.glb: one\nwarning: two\n");
  testing::internal::CaptureStderr();
  warn_all({.verbose = true}, scene);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "warning: a.glb: one\nwarning: two\na.glb: three\n");
}

}  // namespace
}  // namespace relume::cli
