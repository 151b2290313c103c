#include "scene/animation.h"

#include <gtest/gtest.h>

#include "scene/compiled_scene.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

using testing::problem_of;

/// A scene with clips that move the plate along x by 1, 2 and 3, and a channel outside all clips that scales it.
Scene three_clips() {
  Scene scene = testing::plate();
  scene.clips = {"walk", "run, fast", "2"};
  for (Index clip = 0; clip < 3; ++clip) {
    const auto x = static_cast<float>(clip + 1);
    scene.animation.push_back(
        {0, AnimatedProperty::translation, Interpolation::linear, {0, x}, {Vec4(0), Vec4(x, 0, 0, 0)}, 0, clip});
  }
  testing::animate_scale(scene, 0, Vec3(1), Vec3(2));
  return scene;
}

std::vector<Index> selected(const std::string& choice) {
  Scene scene = three_clips();
  select_animation(scene, choice);
  std::vector<Index> clips;
  for (const AnimationChannel& channel : scene.animation) clips.push_back(channel.clip);
  return clips;
}

TEST(Animation, SelectsByNameAndNumber) {
  EXPECT_EQ(selected(""), (std::vector<Index>{0, kNone}));
  EXPECT_EQ(selected("walk"), (std::vector<Index>{0, kNone}));
  EXPECT_EQ(selected("run, fast"), (std::vector<Index>{1, kNone}));
  EXPECT_EQ(selected("2"), (std::vector<Index>{2, kNone}));  // names take precedence over numbers
  EXPECT_EQ(selected("1"), (std::vector<Index>{1, kNone}));
  EXPECT_EQ(selected("all"), (std::vector<Index>{0, kNone}));  // the first clip moves the plate
  EXPECT_EQ(selected("2,walk"), (std::vector<Index>{0, kNone}));
}

TEST(Animation, ErrorsListTheClips) {
  const std::string problem = problem_of([] { selected("fly"); });
  EXPECT_NE(problem.find("no animation 'fly'; it has 'walk', 'run, fast', '2'"), std::string::npos) << problem;
  Scene still = testing::plate();
  select_animation(still, "");
  EXPECT_NE(problem_of([&] { select_animation(still, "walk"); }).find("has no named animations"), std::string::npos);
}

TEST(Animation, CompiledScenePlaysTheChosenClips) {
  CompiledScene compiled(three_clips(), {.animation = "run, fast", .width = 4, .height = 4});
  compiled.set_time(2);
  EXPECT_EQ(compiled.view().instances[0].to_world.translation, Vec3(2, 0, 0));
  EXPECT_EQ(compiled.notes().size(), 1u);  // the light does not exist
  const CompiledScene first(three_clips(), {.width = 4, .height = 4});
  ASSERT_EQ(first.notes().size(), 2u);
  EXPECT_EQ(first.notes()[0], "using the animation 'walk'; --animation selects another ('run, fast', '2'), or all");
}

TEST(Animation, RangesHoldBetweenKeys) {
  AnimationChannel channel{0, AnimatedProperty::morph_weight, Interpolation::cubic_spline, {0, 1}, {}, 0, 0};
  for (const float x : {0.0f, 0.0f, 8.0f, -4.0f, 1.0f, 0.0f}) channel.values.emplace_back(x, 0.0f, 0.0f, 0.0f);
  const ValueRange range = value_range(channel);
  float high = 0;
  for (float t = 0; t <= 1; t += 0.01f) {
    const float x = evaluate(channel, t).x;
    EXPECT_GE(x, range.low);
    EXPECT_LE(x, range.high);
    high = std::max(high, x);
  }
  EXPECT_GT(high, 1.2f);  // the spline overshoots its keys
  EXPECT_LT(range.high, 3.0f);
}

TEST(Animation, HiddenNodesHideDescendants) {
  Scene scene = testing::plate();
  Node child;
  child.parent = 0;
  scene.add_node(child);
  scene.nodes[0].visible = false;
  EXPECT_EQ(visible_nodes(scene, 0), (std::vector<bool>{false, true, false}));
  scene.animation.push_back({0, AnimatedProperty::visible, Interpolation::step, {0, 1}, {Vec4(0), Vec4(1)}, 0, kNone});
  EXPECT_EQ(visible_nodes(scene, 0.9f), (std::vector<bool>{false, true, false}));
  EXPECT_EQ(visible_nodes(scene, 1), (std::vector<bool>{true, true, true}));
}

}  // namespace
}  // namespace relume
