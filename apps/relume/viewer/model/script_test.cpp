#include "viewer/model/script.h"

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume::viewer {
namespace {

std::string error_of(const auto& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Script, ReadsStepsAndComments) {
  const auto steps = parse_script("# a tour\nkey w 20  # forward\n\n  drop my scene.glb \r\nset lights uniform\n", "t");
  ASSERT_EQ(steps.size(), 3u);
  EXPECT_EQ(steps[0].verb, "key");
  EXPECT_EQ(steps[0].words, (std::vector<std::string>{"w", "20"}));
  EXPECT_EQ(steps[1].words, (std::vector<std::string>{"my scene.glb"}));
  EXPECT_EQ(steps[2].line, 5);
}

TEST(Script, RefusesWithPlaceAndLine) {
  EXPECT_EQ(error_of([] { parse_script("key w\ndance\n", "tour.txt"); }),
            "tour.txt:2: there is no step 'dance'; docs/viewer.md lists them");
  EXPECT_EQ(error_of([] { parse_script("drag 0 0 1\n", "tour.txt"); }),
            "tour.txt:1: drag needs at least 4 arguments, but has 3; see docs/viewer.md");
  EXPECT_EQ(error_of([] { parse_keys("shift+bogus", "tour.txt"); }),
            "tour.txt: there is no key 'bogus'; docs/viewer.md lists them");
}

TEST(Script, NamesKeysAsGlfwDoes) {
  EXPECT_EQ(parse_keys("w", ""), (std::vector<int>{'W'}));
  EXPECT_EQ(parse_keys("ctrl+1", ""), (std::vector<int>{341, '1'}));
}

/// Plays a script with simulated counters.
struct Stage {
  uint64_t frames = 0;
  uint64_t request = 1;
  uint64_t following = 1;  ///< first frame that follows the newest request
  double now_s = 0;
  bool loading = false;
  std::vector<std::string> acts;

  ScriptTarget target() {
    return {.frames = [this] { return frames; },
            .request = [this] { return request; },
            .first_frame_following = [this](uint64_t version) { return version <= request ? following : 0; },
            .now_s = [this] { return now_s; },
            .loading = [this] { return loading; },
            .act = [this](const ScriptStep& step) { acts.push_back(step.verb); }};
  }
};

TEST(ScriptPlayer, WaitsForFramesTimeAndLoading) {
  Stage stage;
  ScriptPlayer player(parse_script("frames 2\nset a b\nseconds 1\nloaded\nreport\n", "t"), "t");
  player.update(stage.target());
  EXPECT_TRUE(stage.acts.empty());
  stage.frames = 2;
  stage.loading = true;
  player.update(stage.target());
  EXPECT_EQ(stage.acts.size(), 1u);
  stage.now_s = 2;
  player.update(stage.target());
  EXPECT_FALSE(player.done());
  stage.loading = false;
  player.update(stage.target());
  EXPECT_TRUE(player.done());
  EXPECT_EQ(stage.acts.back(), "report");
}

TEST(ScriptPlayer, FramesFollowEarlierSteps) {
  Stage stage;
  stage.frames = 7;
  ScriptPlayer player(parse_script("set a b\nframes 2\nreport\n", "t"), "t");
  player.update(stage.target());
  stage.request = 2;  // at the end of a frame of the interface
  stage.following = 0;
  for (stage.frames = 8; stage.frames < 10; ++stage.frames) {  // these were in progress
    player.update(stage.target());
    EXPECT_EQ(stage.acts.back(), "set");
  }
  stage.following = stage.frames;
  player.update(stage.target());
  EXPECT_FALSE(player.done());
  ++stage.frames;
  player.update(stage.target());
  EXPECT_TRUE(player.done());
}

TEST(ScriptPlayer, TakesScreenshotsBeforeTheNextStep) {
  Stage stage;
  ScriptPlayer player(parse_script("screenshot a.png\nsplit on\n", "t"), "t");
  player.update(stage.target());
  EXPECT_EQ(stage.acts, std::vector<std::string>{"screenshot"});
  player.update(stage.target());
  EXPECT_EQ(stage.acts, (std::vector<std::string>{"screenshot", "split"}));
}

TEST(ScriptPlayer, HoldsAndReleasesKeys) {
  Stage stage;
  ScriptPlayer player(parse_script("key w 3\n", "t"), "t");
  for (int i = 0; i < 3; ++i) {
    player.update(stage.target());
    EXPECT_EQ(player.input().keys, (std::vector<int>{'W'})) << i;
  }
  player.update(stage.target());
  EXPECT_TRUE(player.input().keys.empty());
  player.update(stage.target());
  EXPECT_TRUE(player.done());
}

TEST(ScriptPlayer, DragsFromOnePointToTheOther) {
  Stage stage;
  ScriptPlayer player(parse_script("drag 0.2 0.4 0.6 0.8\n", "t"), "t");
  Vec2 pressed_at(-1);
  Vec2 released_at(-1);
  bool was_down = false;
  while (!player.done()) {
    player.update(stage.target());
    const ScriptedInput& input = player.input();
    if (input.left && !was_down) pressed_at = input.point;
    if (!input.left && was_down) released_at = input.point;
    was_down = input.left;
  }
  EXPECT_FALSE(was_down);
  EXPECT_EQ(pressed_at, Vec2(0.2f, 0.4f));
  EXPECT_NEAR(released_at.x, 0.6f, 1e-6f);
  EXPECT_NEAR(released_at.y, 0.8f, 1e-6f);
}

TEST(ScriptPlayer, GivesUpAfterFiveMinutes) {
  Stage stage;
  ScriptPlayer player(parse_script("seconds 400\nframes 3\n", "tour.txt"), "tour.txt");
  player.update(stage.target());
  stage.now_s = 401;
  player.update(stage.target());
  for (; stage.frames < 2; ++stage.frames) {  // slow, but in progress
    stage.now_s += 290;
    player.update(stage.target());
  }
  player.update(stage.target());
  stage.now_s += 301;
  EXPECT_EQ(error_of([&] { player.update(stage.target()); }),
            "tour.txt:2: frames: no frame was rendered for five minutes; reduce --width and --height, or run on an "
            "idle machine");
}

}  // namespace
}  // namespace relume::viewer
