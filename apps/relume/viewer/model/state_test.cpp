#include "viewer/model/state.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "core/clock.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/scene_io.h"
#include "viewer/model/actions.h"
#include "viewer/model/preparation_lines.h"
#include "viewer/render/render_thread.h"

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
  /// Changes the scene's file, and waits for the reload to start.
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

TEST_F(StateTest, OutputsReplaceNoFileOfTheScene) {
  const auto refused = [&](const char* name) {
    try {
      check_not_read(state_, file(name));
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  std::filesystem::create_symlink("scene.ply", file("link.ply"));
  for (const char* name : {"scene.ply", "link.ply"})
    EXPECT_EQ(refused(name), file(name) + " would be replaced, but the scene is read from it; choose another name");
  EXPECT_THROW(save_image(state_, file("scene.ply")), Error);
  EXPECT_EQ(refused("new.ply"), "");
  EXPECT_EQ(refused("other.ply"), "");
  state_.settings[1].scene.env = file("other.ply");
  EXPECT_NE(refused("other.ply"), "");
  state_.settings[1].scene.env = "sky";
  open_scene(state_, file("other.ply"));
  EXPECT_NE(refused("other.ply"), "") << "while it is loading";
  EXPECT_NE(refused("scene.ply"), "") << "which is still shown";
  finish();
  EXPECT_NE(refused("other.ply"), "");
  EXPECT_EQ(refused("scene.ply"), "");
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

TEST(PreparationLines, ASceneThatChangesIsNamed) {
  State state;
  RenderThread renderer;
  state.renderer = &renderer;
  Scene water = find_builtin_scene("cornell-water")->build();  // slow to load
  show_document(state, std::make_shared<const LoadedScene>(LoadedScene{"cornell-water", std::move(water)}), true);
  for (AllSettings& side : state.settings) {
    side.render.width = 32;
    side.render.height = 24;
    side.render.threads = 1;
  }
  const auto lines_before_frame_of = [&](uint64_t version) {
    std::vector<std::string> seen;
    renderer.post(make_request(state, version, version));
    for (;;) {
      state.frames[0] = renderer.frame(0);
      if (state.frame() && state.frame()->request_version >= version) return seen;
      state.now_s = now_s() + 1;  // a moment after any start
      for (std::string& line : preparation_lines(state)) seen.push_back(std::move(line));
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  };
  const auto is_compiling = [](const std::string& line) { return line.starts_with("compiling cornell-water ..."); };
  const auto is_updating = [](const std::string& line) { return line.starts_with("updating cornell-water ..."); };
  const auto count = [](const std::vector<std::string>& lines, const auto& is) {
    return std::count_if(lines.begin(), lines.end(), is);
  };
  const auto rests = [&] {
    state.now_s = now_s();
    return preparation_lines(state).empty();
  };
  const auto first = lines_before_frame_of(1);
  EXPECT_FALSE(first.empty());
  EXPECT_TRUE(std::all_of(first.begin(), first.end(), is_compiling));
  EXPECT_TRUE(rests());
  change_setting(state, 0, "max-bounces", "1");
  EXPECT_EQ(count(lines_before_frame_of(2), is_compiling), 0) << "nothing is compiled";
  change_setting(state, 0, "texture-filter", "encoded");
  const auto again = lines_before_frame_of(3);
  EXPECT_GT(count(again, is_compiling), 0);
  EXPECT_EQ(count(again, is_compiling) + count(again, is_updating), std::ssize(again));
  EXPECT_TRUE(rests());
  for (size_t k = 0; k < state.document->outline().materials.size(); ++k) {  // all become lamps, which takes long
    Material lamp = state.document->outline().materials[k];
    lamp.emission = Rgb(1);
    state.document->set_material(static_cast<Index>(k), lamp);
  }
  const auto edited = lines_before_frame_of(4);
  EXPECT_GT(count(edited, is_updating), 0);
  EXPECT_EQ(count(edited, is_compiling), 0);
  EXPECT_TRUE(rests());
}

}  // namespace
}  // namespace relume::viewer
