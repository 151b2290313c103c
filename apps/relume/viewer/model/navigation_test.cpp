#include "viewer/model/navigation.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "scene/scene.h"
#include "scene/testing/figure.h"
#include "viewer/model/actions.h"
#include "viewer/model/orbit_camera.h"
#include "viewer/model/state.h"

namespace relume::viewer {
namespace {

constexpr float kHeight_px = 100;
const Vec3 kCenter(2, 0, 0);

/// A plate of 2 by 2 metres that stands about kCenter, seen by a camera at `eye` that looks at `target`.
struct Stage {
  explicit Stage(const Vec3& eye = kCenter + Vec3(0, 0, 5), const Vec3& target = kCenter) {
    Scene scene;
    scene.materials.emplace_back();
    Mesh plate;
    plate.positions = {{1, -1, 0}, {3, -1, 0}, {3, 1, 0}, {1, 1, 0}};
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    plate.material = 0;
    scene.meshes.push_back(std::move(plate));
    scene.nodes.emplace_back().meshes = {0};
    state.document.emplace(std::make_shared<const LoadedScene>(LoadedScene{"plate", std::move(scene)}));
    auto frame = std::make_shared<ViewerFrame>();
    frame->scene = state.document->loaded();
    const Transform t = look_at(eye, target);
    frame->camera.to_world = glm::mat4_cast(t.rotation);
    frame->camera.to_world[3] = Vec4(t.translation, 1);
    state.frames[0] = std::move(frame);
  }
  void drag(const Vec2& by_px) {
    state.navigation.turn_px = by_px;
    navigate(state, Vec3(0), false, kHeight_px);
  }
  void wheel(float notches) {
    state.navigation.notches = notches;
    navigate(state, Vec3(0), false, kHeight_px);
  }
  void wait() { navigate(state, Vec3(0), false, kHeight_px); }
  float distance() const { return glm::length(Vec3(current_camera(state).to_world[3]) - kCenter); }

  State state;
};

TEST(Navigation, FramingWhileFlyingSetsThePivot) {
  Stage stage(Vec3(-3, 2, 8), Vec3(-3, 2, 0));
  set_mode(stage.state, CameraMode::fly);
  frame_selection(stage.state);
  stage.wait();
  set_mode(stage.state, CameraMode::orbit);
  const float distance = stage.distance();
  for (int i = 0; i < 5; ++i) {
    stage.drag({12, 5});
    EXPECT_NEAR(stage.distance(), distance, 1e-4f * distance) << i;
  }
}

TEST(Navigation, TurningWhileFlyingDropsThePivot) {
  Stage stage;
  set_mode(stage.state, CameraMode::fly);
  frame_selection(stage.state);
  EXPECT_TRUE(stage.state.navigation.has_pivot);
  stage.drag({20, 0});
  EXPECT_FALSE(stage.state.navigation.has_pivot);
}

TEST(Navigation, TheOrbitGoesAroundTheMiddleOfTheScene) {
  Stage stage(kCenter + Vec3(0.5f, 1, 5), kCenter + Vec3(0.2f, 0, 0));
  set_mode(stage.state, CameraMode::orbit);
  const float distance = stage.distance();
  stage.drag({30, 10});
  EXPECT_NEAR(stage.distance(), distance, 1e-4f * distance);
}

TEST(Navigation, TheOrbitBeginsInFrontOfTheCamera) {
  for (const auto& [eye, target] : {std::pair(kCenter, kCenter + Vec3(0, 0, -1)),                    // at the centre
                                    std::pair(kCenter + Vec3(0, 0, 3), kCenter + Vec3(0, 0, 9)),     // behind it
                                    std::pair(kCenter + Vec3(0, 0, 3), kCenter + Vec3(9, 0, 2))}) {  // beside it
    Stage stage(eye, target);
    set_mode(stage.state, CameraMode::orbit);
    const Vec3 before = current_camera(stage.state).to_world[3];
    stage.drag({20, 0});
    const CameraPose camera = current_camera(stage.state);
    EXPECT_TRUE(is_on_screen(camera, stage.state.navigation.pivot, 1));
    EXPECT_GT(glm::length(Vec3(camera.to_world[3]) - before), 0.01f);
    stage.wheel(-4);
    const CameraPose back = current_camera(stage.state);
    EXPECT_GT(depth_of(back, stage.state.navigation.pivot), depth_of(camera, stage.state.navigation.pivot));
  }
}

TEST(Navigation, BookmarksElsewhereDropThePivot) {
  Stage stage;
  set_mode(stage.state, CameraMode::orbit);
  stage.drag({20, 0});
  Viewpoint away = current_view(stage.state);
  away.rotation = glm::angleAxis(kPi, Vec3(0, 1, 0)) * away.rotation;
  set_view(stage.state, away);
  stage.drag({20, 0});
  EXPECT_TRUE(is_on_screen(current_camera(stage.state), stage.state.navigation.pivot, 1));
}

TEST(Navigation, TheWheelStaysWithinSightOfTheScene) {
  Stage stage;
  set_mode(stage.state, CameraMode::orbit);
  for (int i = 0; i < 200; ++i) stage.wheel(-3);
  const float diagonal = stage.state.document->bounds().diagonal();
  EXPECT_GT(stage.distance(), 10 * diagonal);
  EXPECT_LT(stage.distance(), 1000 * diagonal);
  for (int i = 0; i < 200; ++i) stage.wheel(3);
  EXPECT_GT(stage.distance(), 0);
  EXPECT_LT(stage.distance(), 0.01f * diagonal);
}

/// A figure in place of the plate; it is bent after a second.
struct FigureStage : Stage {
  explicit FigureStage(Scene scene) {
    state.document.emplace(std::make_shared<const LoadedScene>(LoadedScene{"figure", std::move(scene)}));
    auto frame = std::make_shared<ViewerFrame>(*state.frames[0]);
    frame->scene = state.document->loaded();
    state.frames[0] = std::move(frame);
    state.selection = {Selected::node, 0};
  }
};

TEST(Navigation, FramesFiguresInTheirPose) {
  FigureStage stage(testing::figure());  // no node can move it
  frame_selection(stage.state);
  const Vec3 straight = stage.state.navigation.pivot;
  stage.state.document->set_time(1);
  frame_selection(stage.state);
  EXPECT_EQ(stage.state.navigation.pivot, stage.state.document->bounds(0).center());
  EXPECT_GT(glm::length(stage.state.navigation.pivot - straight), 0.1f);
}

TEST(Navigation, AFigureIsDraggedByItsJointsOrRefusesWithAMessage) {
  FigureStage refused(testing::figure());
  EXPECT_EQ(selected_node(refused.state), kNone);
  drag_selection(refused.state, {0.1f, 0});
  EXPECT_TRUE(refused.state.document->edits().nodes.empty());
  ASSERT_EQ(refused.state.toasts.size(), 1u);
  EXPECT_NE(refused.state.toasts[0].text.find("is animated"), std::string::npos);

  Scene scene = testing::figure();
  scene.nodes[1].parent = scene.add_node(Node());
  FigureStage stage(std::move(scene));
  const Vec3 before = stage.state.document->bounds(0).center();
  drag_selection(stage.state, {0.1f, 0});
  EXPECT_GT(glm::length(stage.state.document->bounds(0).center() - before), 0.01f);
}

TEST(Navigation, AFigureIsDraggedAtItsOwnDepth) {
  Scene scene = testing::figure();
  Node far;  // moves with the figure's root
  far.meshes = {1};
  far.parent = 1;
  far.transform.translation = {0, 0, -200};
  scene.nodes.push_back(far);
  scene.nodes[1].parent = scene.add_node(Node());
  scene.meshes.push_back(scene.meshes[0]);
  FigureStage stage(std::move(scene));
  const CameraPose camera = current_camera(stage.state);
  const Vec3 before = stage.state.document->bounds(0).center();
  drag_selection(stage.state, {0.1f, 0});
  const float moved = glm::length(stage.state.document->bounds(0).center() - before);
  const float expected = 0.1f * view_height(camera.camera, depth_of(camera, before));
  EXPECT_NEAR(moved, expected, 1e-3f * expected);
}

}  // namespace
}  // namespace relume::viewer
