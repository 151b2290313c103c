// The model behind the page, steered by messages without a network.
#include "serve/model.h"

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "builtin_scenes/builtin.h"
#include "core/clock.h"
#include "relume/error.h"
#include "serve/frame_encoder.h"

namespace relume::serve {
namespace {

using nlohmann::json;

constexpr double kPatience_s = 60;  // allows for a busy machine

/// Keeps the newest of everything.
struct Kept : Publisher {
  void show(std::shared_ptr<const ShownImage> shown) override { image = std::move(shown); }
  void tell(Topic topic, std::string text) override { texts[topic] = std::move(text); }
  json text(Topic topic) const { return json::parse(texts.at(topic)); }

  std::shared_ptr<const ShownImage> image;
  std::map<Topic, std::string> texts;
};

AllSettings small_settings() {
  AllSettings settings;
  settings.render.width = 48;
  settings.render.height = 32;
  settings.render.threads = 1;
  settings.render.path.max_bounces = 2;
  return settings;
}

class ModelTest : public ::testing::Test {
 protected:
  ModelTest() { inbox_.note_viewers(1); }

  void put(const MessageBody& body, uint32_t number = 0) { inbox_.put({1, {number, body}}); }
  /// Turns until the condition holds.
  static ::testing::AssertionResult turn_until(Model& model, const std::function<bool()>& holds) {
    const double start_s = now_s();
    while (now_s() - start_s < kPatience_s) {
      model.turn(now_s());
      if (holds()) return ::testing::AssertionSuccess();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return ::testing::AssertionFailure() << "not within " << kPatience_s << " s";
  }
  ::testing::AssertionResult turn_until(const std::function<bool()>& holds) { return turn_until(model_, holds); }
  static uint64_t frames_of(const Model& model) { return model.state().frame() ? model.state().frame()->serial : 0; }
  /// Turns until no frame was rendered for a moment, in which a small image has many.
  static ::testing::AssertionResult turn_until_idle(Model& model) {
    uint64_t last = 0;
    double since_s = now_s();
    return turn_until(model, [&] {
      const uint64_t frames = frames_of(model);
      if (frames != std::exchange(last, frames)) since_s = now_s();
      return now_s() - since_s > 0.4;
    });
  }
  Vec3 eye() const { return viewer::current_view(model_.state()).eye; }
  std::string value(size_t side, const char* name) const {
    AllSettings copy = model_.state().settings[side];
    return to_string(*find_setting(describe(copy), name));
  }

  Inbox inbox_;
  Kept kept_;
  Model model_{{.settings = small_settings(), .fixed_size = false},
               std::make_shared<const viewer::LoadedScene>(
                   viewer::LoadedScene{"cornell", find_builtin_scene("cornell")->build()}),
               {},
               inbox_,
               kept_};
};

TEST_F(ModelTest, ShowsImagesAndDescribesAllSettings) {
  ASSERT_TRUE(turn_until([&] { return kept_.image && kept_.texts.contains(Topic::values); }));
  const json declarations = kept_.text(Topic::declarations);
  size_t count = 0;
  for (const json& group : declarations["groups"]) count += group["settings"].size();
  AllSettings defaults;
  EXPECT_EQ(count, describe(defaults).size());
  EXPECT_EQ(declarations["groups"][0]["role"], "slots");
  EXPECT_EQ(kept_.text(Topic::values)["sides"].size(), 2u);
  EXPECT_EQ(kept_.text(Topic::values)["sides"][0].size(), count);
  put(Still{});
  ASSERT_TRUE(turn_until([&] { return kept_.text(Topic::status).contains("width"); }));
  EXPECT_EQ(kept_.text(Topic::status)["scene"], "cornell");
  EXPECT_FALSE(kept_.text(Topic::status)["times"][0]["passes"].empty());
}

TEST_F(ModelTest, FliesWhileKeysAreHeldAndImagesNameTheInput) {
  ASSERT_TRUE(turn_until([&] { return kept_.image && model_.state().has_camera(); }));
  const Vec3 before = eye();
  put(Fly{.axes = {0, 0, -1}}, 5);
  ASSERT_TRUE(turn_until([&] { return eye() != before; }));
  ASSERT_TRUE(turn_until([&] { return kept_.image->input == 5 && kept_.image->viewer == 1; }));
  put(Left{});
  model_.turn(now_s());
  const Vec3 after = eye();
  for (int i = 0; i < 20; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    model_.turn(now_s());
  }
  EXPECT_EQ(eye(), after) << "a viewer that left holds no keys";
}

TEST_F(ModelTest, HeldKeysExpire) {
  ASSERT_TRUE(turn_until([&] { return model_.state().has_camera(); }));
  put(Fly{.axes = {0, 0, -1}});
  model_.turn(now_s());
  model_.turn(now_s() + 1.5);
  const Vec3 after = eye();
  model_.turn(now_s() + 1.7);
  EXPECT_EQ(eye(), after);
}

TEST_F(ModelTest, SettingsChangeByTheirNames) {
  put(ChangeSetting{0, "max-bounces", "3"});
  put(ChangeSetting{1, "max-bounces", "4"});
  ASSERT_TRUE(turn_until([&] { return value(0, "max-bounces") == "3" && value(1, "max-bounces") == "4"; }));
  put(ChangeSetting{0, "max-bounces", "many"});
  put(ChangeSetting{0, "no-such-setting", "1"});
  put(ApplyPreset{0, "no-such-preset"});
  model_.turn(now_s());
  EXPECT_EQ(value(0, "max-bounces"), "3");
  EXPECT_GE(model_.state().toasts.size(), 3u);
}

TEST_F(ModelTest, APageNamesNoFiles) {
  const AllSettings start = small_settings();
  for (const char* env : {"/etc/passwd", "sky.exr", "../x.hdr", "1,1", "1,1,1,1", "sky ", "file.exr,1,1"})
    EXPECT_THROW(check_page_value(start, "env", env), Error) << env;
  for (const char* env : {"", "studio", "sky", "sun_sky", "none", "1,1,1", "0.5, 0.25, 1e2"})
    EXPECT_NO_THROW(check_page_value(start, "env", env)) << env;
  AllSettings own = start;
  own.scene.env = "own.exr";
  EXPECT_NO_THROW(check_page_value(own, "env", "own.exr"));
  EXPECT_NO_THROW(check_page_value(start, "width", "4096"));
  for (const char* width : {"4097", "99999999999", "1e3", "x"})
    EXPECT_THROW(check_page_value(start, "width", width), Error) << width;
  put(ChangeSetting{0, "env", "/etc/passwd"});
  model_.turn(now_s());
  EXPECT_EQ(value(0, "env"), "");
}

TEST_F(ModelTest, PausesWithoutViewersAndContinuesWithOne) {
  ASSERT_TRUE(turn_until([&] { return frames_of(model_) > 2; }));
  inbox_.note_viewers(0);
  ASSERT_TRUE(turn_until_idle(model_));
  const uint64_t before = frames_of(model_);
  EXPECT_FALSE(model_.state().paused) << "viewers find the button as they left it";
  inbox_.note_viewers(1);
  EXPECT_TRUE(turn_until([&] { return frames_of(model_) > before + 3; }));
}

TEST_F(ModelTest, RendersOneFrameForTheFirstViewer) {
  inbox_.note_viewers(0);
  ASSERT_TRUE(turn_until([&] { return kept_.image != nullptr; }));
  EXPECT_TRUE(turn_until_idle(model_));
}

TEST_F(ModelTest, RendersWithoutViewersWhenToldTo) {
  Inbox inbox;
  Kept kept;
  Model model({.settings = small_settings(), .renders_unwatched = true}, model_.state().document->loaded(), {}, inbox,
              kept);
  EXPECT_TRUE(turn_until(model, [&] { return frames_of(model) > 5; }));
}

TEST_F(ModelTest, AnimationsPauseWithoutViewers) {
  Inbox inbox;
  Kept kept;
  Model model({.settings = small_settings()},
              std::make_shared<const viewer::LoadedScene>(
                  viewer::LoadedScene{"turntable", find_builtin_scene("turntable")->build()}),
              {}, inbox, kept);
  inbox.note_viewers(1);
  inbox.put({1, {0, Press{Button::animate}}});
  ASSERT_TRUE(turn_until(model, [&] { return frames_of(model) > 2 && model.state().document->time_s() > 0; }));
  inbox.note_viewers(0);
  ASSERT_TRUE(turn_until_idle(model));
  const float time_s = model.state().document->time_s();
  EXPECT_TRUE(model.state().animating);
  inbox.note_viewers(1);
  EXPECT_TRUE(turn_until(model, [&] { return model.state().document->time_s() != time_s; }));
}

TEST(ModelSize, IsEvenAndLimited) {
  EXPECT_EQ(image_size({641, 361}), IVec2(640, 360));
  EXPECT_EQ(image_size({1, 1}), IVec2(kLeastSide));
  EXPECT_EQ(image_size({16384, 16384}), IVec2(kMostSide));
}

TEST_F(ModelTest, ButtonsBufferAndSizeFollow) {
  ASSERT_TRUE(turn_until([&] { return kept_.image != nullptr; }));
  put(Press{Button::split});
  ASSERT_TRUE(turn_until([&] { return kept_.image->frames[1] && kept_.image->split_at == 0.5f; }));
  put(MoveSplit{0.25f});
  ASSERT_TRUE(turn_until([&] { return kept_.image->split_at == 0.25f; }));
  put(Press{Button::split});
  ASSERT_TRUE(turn_until([&] { return !kept_.image->frames[1]; }));
  put(ShowBuffer{"depth"});
  ASSERT_TRUE(turn_until([&] { return kept_.image->frames[0]->buffer == "depth"; }));
  EXPECT_EQ(kept_.image->transforms[0].mode, viewer::DisplayMode::false_color);
  put(Resize{101, 30});
  model_.turn(now_s());
  EXPECT_EQ(value(0, "width"), "100");
  EXPECT_EQ(value(1, "height"), std::to_string(kLeastSide));
  put(Press{Button::pause});
  model_.turn(now_s());
  EXPECT_TRUE(model_.state().paused);
}

}  // namespace
}  // namespace relume::serve
