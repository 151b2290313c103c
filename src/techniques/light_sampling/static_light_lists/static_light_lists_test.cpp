#include "techniques/light_sampling/static_light_lists/static_light_lists.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "core/stream_io.h"
#include "relume/error.h"
#include "scene/compiled_scene.h"
#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/static_light_lists/build_lists.h"
#include "techniques/light_sampling/static_light_lists/static_light_lists_pass.h"
#include "techniques/light_sampling/static_light_lists/visible_set_lists.h"
#include "testing/random.h"

namespace relume {
namespace {

class WarehouseLists : public ::testing::Test {
 protected:
  WarehouseLists() : scene_(find_builtin_scene("warehouse")->build(), {}) {
    Backend backend(2);
    data_ = build_light_lists(backend, scene_.view(), {4.6f, 4096});
  }
  bool listed(uint32_t cell, LightId light) const {
    return std::binary_search(data_.ids.begin() + data_.first[cell], data_.ids.begin() + data_.first[cell + 1], light);
  }
  const CompiledScene scene_;
  LightListData data_;
};

TEST_F(WarehouseLists, HoldNearlyAllVisibleLightsButNotAllLights) {
  const LightsView& lights = scene_.view().lights;
  testing::Random random(5);
  int visible = 0;
  int missed = 0;
  for (int i = 0; i < 16000; ++i) {
    // Points around and below every lamp, in its bay and behind the walls. Visible lamps must be listed.
    const LightId id = static_cast<LightId>(random.next() * static_cast<float>(lights.first_infinite));
    const Vec3 lamp = lights.lights[id].triangle.position(Vec2(1.0f / 3));
    const Vec3 p = lamp + Vec3(5 * random.next() - 2.5f, -0.5f - 4 * random.next(), 5 * random.next() - 2.5f);
    const LightSample s = sample_li(lights, id, p, random.next_2d());
    if (!s.valid() || occluded(scene_.view().accel, {p, s.wi, 0.999f * s.distance}, 0)) continue;
    ++visible;
    missed += listed(data_.grid.find(p), id) ? 0 : 1;
  }
  ASSERT_GT(visible, 400);
  EXPECT_LT(missed, visible / 20);
  const double mean = static_cast<double>(data_.ids.size()) / data_.grid.count();
  EXPECT_LT(mean, 0.5 * lights.first_infinite);  // most lamps are in other rooms
}

TEST_F(WarehouseLists, AreSortedWithoutRepetition) {
  ASSERT_EQ(data_.first.size(), data_.grid.count() + 1);
  for (uint32_t cell = 0; cell < data_.grid.count(); ++cell) {
    for (uint32_t i = data_.first[cell] + 1; i < data_.first[cell + 1]; ++i) EXPECT_LT(data_.ids[i - 1], data_.ids[i]);
  }
}

TEST(StaticLightLists, EachSeedFindsItsOwnLists) {
  // With few rays, a cell misses some lamps. These must differ between sessions.
  const CompiledScene scene(find_builtin_scene("warehouse")->build(), {});
  Backend backend(2);
  const auto lists = [&](uint32_t seed) { return build_light_lists(backend, scene.view(), {4.6f, 128}, seed).ids; };
  const std::vector<LightId> one = lists(1);
  const std::vector<LightId> two = lists(2);
  EXPECT_EQ(one, lists(1));
  EXPECT_NE(one, two);
  EXPECT_NEAR(static_cast<double>(two.size()) / static_cast<double>(one.size()), 1, 0.05);
}

TEST(LightListBuilder, StopsAndContinues) {
  const CompiledScene scene(find_builtin_scene("warehouse")->build(), {});
  Backend backend(2);
  const LightListOptions options{4.6f, 1024};
  LightListBuilder builder(scene.view(), options, 0);
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_FALSE(builder.advance(backend, scene.view(), stopped.get_token()));
  EXPECT_TRUE(builder.lists(backend).ids.empty());
  // Stops at an arbitrary point of the build.
  std::stop_source soon;
  const std::jthread timer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    soon.request_stop();
  });
  builder.advance(backend, scene.view(), soon.get_token());
  EXPECT_TRUE(builder.advance(backend, scene.view(), {}));
  const LightListData whole = build_light_lists(backend, scene.view(), options);
  EXPECT_EQ(builder.lists(backend).ids, whole.ids);
  EXPECT_EQ(builder.lists(backend).first, whole.first);
}

TEST(LightGrid, NumbersItsCells) {
  const LightGrid grid{Vec3(-1, 0, 2), 0.5f, UVec3(4, 3, 5)};
  for (uint32_t cell = 0; cell < grid.count(); ++cell) EXPECT_EQ(grid.find(grid.low(cell) + 0.25f), cell);
  EXPECT_EQ(grid.find(Vec3(-1e9f)), 0u);
  EXPECT_EQ(grid.find(Vec3(1e30f)), grid.count() - 1);
  EXPECT_LT(grid.find(Vec3(std::nanf(""))), grid.count());
}

TEST(StaticLightLists, SceneWithoutLightsHasNone) {
  const CompiledScene scene(find_builtin_scene("mine")->build(), {});
  Backend backend(1);
  EXPECT_TRUE(build_light_lists(backend, scene.view(), {}).ids.empty());
}

TEST(StaticLightListsPass, OtherLightsRemainIfPowersOverflow) {
  const CompiledScene scene(testing::make_overpowered_scene(), {.camera = {}, .width = 4, .height = 4});
  const StaticLightListsSettings settings;
  const LightSelectionSettings selection;
  StaticLightListsPass pass(settings, selection, host_memory());
  BufferTable buffers(4, 4);
  Backend backend(1);
  pass.run(FrameContext(scene.view(), buffers, backend, {}));
  const StaticLightLists& lists = pass.selector().lists;
  ASSERT_FALSE(lists.all.empty());
  EXPECT_GT(lists.all.pmf(2), 0.0f);
}

TEST(StaticLightListsPass, KeepsItsListsWithAnyFrameSeed) {
  // The camera moves, so every frame has a different seed.
  const CompiledScene scene(find_builtin_scene("warehouse")->build(), {});
  const StaticLightListsSettings settings{.rays = 128};
  const LightSelectionSettings selection;
  StaticLightListsPass pass(settings, selection, host_memory());
  BufferTable buffers(4, 4);
  Backend backend(2);
  const auto lists_in_frame = [&](uint32_t seed) {
    pass.run(FrameContext(scene.view(), buffers, backend, {.index = {.seed = seed}, .changes = Change::camera}));
    const View<const LightId> ids = pass.selector().lists.ids;
    return std::vector<LightId>(ids.data, ids.data + ids.size);
  };
  const std::vector<LightId> first = lists_in_frame(1);
  EXPECT_EQ(first, lists_in_frame(2));
  StaticLightListsPass another(settings, selection, host_memory());
  another.run(FrameContext(scene.view(), buffers, backend, {.index = {.seed = 2}, .changes = Change::camera}));
  const View<const LightId> ids = another.selector().lists.ids;
  EXPECT_NE(first, std::vector<LightId>(ids.data, ids.data + ids.size));
}

TEST(StaticLightListsPass, CompletesItsListsInLaterFrames) {
  const CompiledScene scene(find_builtin_scene("warehouse")->build(), {});
  const StaticLightListsSettings settings{.rays = 128};
  const LightSelectionSettings selection;
  StaticLightListsPass pass(settings, selection, host_memory());
  BufferTable buffers(4, 4);
  Backend backend(2);
  const auto run = [&](StaticLightListsPass& p, std::stop_token hurry) {
    const FrameContext frame(scene.view(), buffers, backend, {.index = {.seed = 3}, .hurry = std::move(hurry)});
    EXPECT_TRUE(p.run(frame)) << "a hurry ended the frame";
  };
  const auto checkpoint = [&] {
    std::stringstream file;
    pass.save(file);
    StaticLightListsPass restored(settings, selection, host_memory());
    restored.load(file);
    EXPECT_TRUE(file);
    run(restored, {});
    return std::vector<LightId>(restored.selector().lists.ids.begin(), restored.selector().lists.ids.end());
  };
  std::stop_source stop;
  stop.request_stop();
  run(pass, stop.get_token());
  EXPECT_FALSE(pass.prepared());
  EXPECT_EQ(pass.selector().lists.ids.size, 0u);
  const std::vector<LightId> remade = checkpoint();
  run(pass, {});
  EXPECT_TRUE(pass.prepared());
  const View<const LightId> ids = pass.selector().lists.ids;
  EXPECT_GT(ids.size, 0u);
  EXPECT_EQ(remade, std::vector<LightId>(ids.begin(), ids.end())) << "a checkpoint does not pass half a list on";
  EXPECT_EQ(remade, checkpoint());
}

TEST(StaticLightListsPass, RejectsInvalidCheckpoints) {
  const StaticLightListsSettings settings;
  const LightSelectionSettings selection;
  const auto loads = [&](const LightListData& data) {
    std::stringstream file;
    write_value(file, uint32_t{3});  // lights
    write_value(file, 0.0f);
    write_value(file, uint32_t{4096});
    write_value(file, uint32_t{0});  // found by rays
    write_value(file, data.grid.corner);
    write_value(file, data.grid.cell_size);
    write_value(file, data.grid.cells);
    write_vector(file, data.first);
    write_vector(file, data.ids);
    StaticLightListsPass pass(settings, selection, host_memory());
    pass.load(file);
    return static_cast<bool>(file);
  };
  LightListData data{{Vec3(0), 1, UVec3(2, 1, 1)}, {0, 1, 2}, {1, 2}};
  EXPECT_TRUE(loads(data));
  data.ids = {1, 3};
  EXPECT_FALSE(loads(data));
  data.ids = {1, 2};
  data.grid.cell_size = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(loads(data));
  // In 32 bits, the product of the cell counts overflows to 65536.
  EXPECT_FALSE(loads({{Vec3(0), 1, UVec3(65537, 65536, 1)}, std::vector<uint32_t>(65537, 0), {}}));
}

/// Two rooms of 2 m see each other, a third one beside them only itself. Each has a lamp.
class SetLists : public ::testing::Test {
 protected:
  SetLists() {
    SceneBuilder builder("sets");
    const Index lamp = builder.add_material(emitter("lamp", Rgb(1)));
    std::vector<VisibleSet> sets;
    for (int room = 0; room < 3; ++room) {
      const float x = 2 * static_cast<float>(room);
      builder.add("lamp " + std::to_string(room), quad({x + 0.9f, 2.9f, 0.9f}, {0.2f, 0, 0}, {0, 0, 0.2f}), lamp);
      sets.push_back({{x, 0, 0}, {x + 2, 3, 2}, room < 2 ? std::vector<uint32_t>{0, 1} : std::vector<uint32_t>{2}});
    }
    builder.set_visible_sets(std::move(sets));
    builder.add_camera({1, 1, 1}, {3, 1, 1}, 60);
    scene_ = std::make_unique<CompiledScene>(builder.take(), CompileOptions{.camera = {}, .width = 4, .height = 4});
  }

  /// Rooms with a lamp on the list at p.
  std::set<int> rooms_seen(const LightListData& data, const Vec3& p) const {
    std::set<int> rooms;
    const uint32_t cell = data.grid.find(p);
    for (uint32_t i = data.first[cell]; i < data.first[cell + 1]; ++i)
      rooms.insert(static_cast<int>(position_of(scene_->view().lights.lights[data.ids[i]]).x / 2));
    return rooms;
  }

  std::unique_ptr<CompiledScene> scene_;
};

TEST_F(SetLists, HoldTheLightsOfVisibleBoxes) {
  const LightListData data = lists_from_visible_sets(scene_->view().lights, scene_->source().visible_sets, 0);
  EXPECT_EQ(data.grid.cell_size, 2);
  ASSERT_EQ(data.first.size(), data.grid.count() + 1);
  EXPECT_EQ(rooms_seen(data, {0.1f, 0.1f, 0.1f}), (std::set<int>{0, 1}));
  EXPECT_EQ(rooms_seen(data, {3.9f, 2.9f, 1.9f}), (std::set<int>{0, 1}));
  EXPECT_EQ(rooms_seen(data, {4.1f, 0, 1}), (std::set<int>{2}));
}

/// A cell of 3 m overlaps two rooms.
TEST_F(SetLists, CellsOfSeveralBoxesHaveTheLightsOfAll) {
  const LightListData data = lists_from_visible_sets(scene_->view().lights, scene_->source().visible_sets, 3);
  EXPECT_EQ(rooms_seen(data, {1, 1, 1}), (std::set<int>{0, 1}));
  EXPECT_EQ(rooms_seen(data, {5, 1, 1}), (std::set<int>{0, 1, 2}));
}

TEST_F(SetLists, LightsOutsideAllBoxesAreOnAllLists) {
  std::vector<VisibleSet> sets = scene_->source().visible_sets;
  sets.pop_back();
  const LightListData data = lists_from_visible_sets(scene_->view().lights, sets, 0);
  EXPECT_EQ(rooms_seen(data, {1, 1, 1}), (std::set<int>{0, 1, 2}));
}

TEST_F(SetLists, ReplaceRaysInThePass) {
  const StaticLightListsSettings settings{.visibility = LightListVisibility::sets};
  StaticLightListsPass pass(settings, LightSelectionSettings(), host_memory());
  BufferTable buffers(4, 4);
  Backend backend(1);
  pass.run(FrameContext(scene_->view(), buffers, backend, {.visible_sets = &scene_->source().visible_sets}));
  EXPECT_TRUE(pass.prepared());
  EXPECT_EQ(pass.selector().lists.grid.cell_size, 2);
  EXPECT_GT(pass.selector().lists.ids.size, 0u);
  EXPECT_THROW(StaticLightListsPass(settings, LightSelectionSettings(), host_memory())
                   .run(FrameContext(scene_->view(), buffers, backend, {})),
               Error);
}

/// In a base, rays find no light that the visible sets lack.
TEST(BaseLists, HoldAllVisibleLights) {
  const CompiledScene scene(find_builtin_scene("base-1")->build(), {});
  const LightsView& lights = scene.view().lights;
  const LightListData data = lists_from_visible_sets(lights, scene.source().visible_sets, 0);
  EXPECT_EQ(data.grid.cell_size, 1);
  testing::Random random(7);
  int visible = 0;
  for (int i = 0; i < 40000; ++i) {
    const LightId id = static_cast<LightId>(random.next() * static_cast<float>(lights.first_infinite));
    const Vec3 lamp = position_of(lights.lights[id]);
    const Vec3 p(lamp.x + 16 * random.next() - 8, 0.05f + 3 * random.next(), lamp.z + 16 * random.next() - 8);
    if (p.x < 0 || p.x > 48 || p.z < 0 || p.z > 40) continue;
    const LightSample s = sample_li(lights, id, p, random.next_2d());
    if (!s.valid() || occluded(scene.view().accel, {p, s.wi, 0.999f * s.distance}, 0)) continue;
    ++visible;
    const uint32_t cell = data.grid.find(p);
    ASSERT_TRUE(std::binary_search(data.ids.begin() + data.first[cell], data.ids.begin() + data.first[cell + 1], id));
  }
  EXPECT_GT(visible, 400);
  const double mean = static_cast<double>(data.ids.size()) / data.grid.count();
  EXPECT_LT(mean, 0.5 * lights.first_infinite);
}

}  // namespace
}  // namespace relume
