#include "viewer/state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"

namespace relume::viewer {
namespace {

/// A file with one triangle, and a state that shows it.
class StateTest : public ::testing::Test {
 protected:
  StateTest() {
    write("scene.ply", 1);
    write("other.ply", 2);
    show_document(state_,
                  std::make_shared<const LoadedScene>(LoadedScene{file("scene.ply"), load_scene(file("scene.ply"))}),
                  true);
  }
  std::string file(const char* name) const { return (folder_ / name).string(); }
  void write(const char* name, int size) const {
    std::ofstream(folder_ / name) << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                     "end_header\n0 0 0\n"
                                  << size << " 0 0\n0 " << size << " 0\n3 0 1 2\n";
  }
  /// Changes the scene's file, and waits until it is being read again.
  void begin_reload() {
    write("scene.ply", 300);
    for (int i = 0; i < 100 && !state_.loading.valid(); ++i) {
      state_.now_s += 0.3;
      follow_files(state_);
    }
    ASSERT_TRUE(state_.loading.valid());
    ASSERT_TRUE(state_.reloads);
  }
  void finish() {
    for (int i = 0; i < 60000 && state_.loading.valid(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      finish_loading(state_);
    }
    EXPECT_FALSE(state_.loading.valid());
  }
  bool said(const std::string& part) const {
    return std::any_of(state_.toasts.begin(), state_.toasts.end(),
                       [&](const Toast& toast) { return toast.text.find(part) != std::string::npos; });
  }

  TempFolder folder_;
  State state_;
};

TEST_F(StateTest, OpeningASceneEndsTheReloadOfAnother) {
  begin_reload();
  open_scene(state_, file("other.ply"));
  EXPECT_FALSE(said("wait"));
  finish();
  EXPECT_EQ(state_.document->name(), file("other.ply"));
  open_scene(state_, file("scene.ply"));
  open_scene(state_, file("other.ply"));
  EXPECT_TRUE(said("wait for it")) << "the user has asked for both";
  finish();
}

TEST_F(StateTest, AReloadThatWasDroppedFollowsAfterAFailure) {
  begin_reload();
  open_scene(state_, file("missing.ply"));
  finish();
  EXPECT_TRUE(said("missing.ply"));
  follow_files(state_);
  finish();
  EXPECT_FLOAT_EQ(state_.document->bounds().high.x, 300);
}

TEST_F(StateTest, AReloadKeepsEditsOrNamesThem) {
  Environment light = state_.document->outline().environment;
  light.kind = EnvironmentKind::constant;
  light.color = {1, 2, 3};
  state_.document->set_environment(light);
  state_.document->set_material(0, state_.document->outline().materials.at(0));
  begin_reload();
  finish();
  EXPECT_FLOAT_EQ(state_.document->bounds().high.x, 300);
  EXPECT_EQ(state_.document->outline().environment.color, light.color);
  const bool kept = state_.document->edits().materials.size() == 1;
  EXPECT_NE(kept, said("are lost"));
}

}  // namespace
}  // namespace relume::viewer
