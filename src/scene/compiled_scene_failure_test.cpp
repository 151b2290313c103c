// Changes of a compiled scene that run out of memory.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>
#include <new>
#include <vector>

#include "scene/compiled_scene.h"
#include "scene/scene_launcher.h"
#include "scene/testing/figure.h"
#include "scene/testing/light_scene.h"
#include "testing/failing_memory.h"

namespace relume {
namespace {

/// Memory in which allocations and openings fail, and which knows its blocks.
class WatchedMemory final : public Memory {
 public:
  testing::FailingMemory failing;

  /// The opening for writing after `before` others fails, as of a device that cannot move the block. −1: none.
  void fail_opening(int before) { openings_ = before; }
  void open_for_writing(void* /*block*/) override {
    if (openings_ >= 0 && openings_-- == 0) throw std::bad_alloc();
  }

  void* allocate(size_t bytes, size_t alignment) override {
    void* const block = failing.allocate(bytes, alignment);
    const std::lock_guard lock(mutex_);
    blocks_[static_cast<std::byte*>(block)] = bytes;
    return block;
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    {
      const std::lock_guard lock(mutex_);
      blocks_.erase(static_cast<std::byte*>(block));
    }
    failing.deallocate(block, bytes, alignment);
  }

  /// Whether all elements of the view are in a block.
  template <typename T>
  bool has(const View<T>& view) const {
    if (view.empty()) return true;
    const auto* const begin = reinterpret_cast<const std::byte*>(view.data);
    const std::lock_guard lock(mutex_);
    const auto after = blocks_.upper_bound(begin);
    if (after == blocks_.begin()) return false;
    const auto block = std::prev(after);
    return begin + size_t{view.size} * sizeof(T) <= block->first + block->second;
  }

 private:
  std::atomic<int> openings_ = -1;  ///< before the one that fails
  mutable std::mutex mutex_;
  std::map<const std::byte*, size_t> blocks_;
};

/// A lit figure, which bends.
Scene source() {
  Scene scene = testing::figure({.parts = 2});
  scene.environment = testing::noise_environment(16, 8);
  testing::add_light_node(scene, {.name = "bulb"}, Vec3(0, 3, 3), Vec3(0));
  return scene;
}

/// The same, which begins to emit, beside a wall that moves.
Scene moving_source() {
  Scene scene = source();
  scene.parameter_animation.push_back({.part = AnimatedPart::material,
                                       .index = 0,
                                       .parameter = "emission",
                                       .times = {0, 1},
                                       .values = {Vec4(0), Vec4(1)}});
  Mesh& wall = scene.meshes.emplace_back();
  wall.positions = {{-1, 2.1f, 1}, {1, 2.1f, 1}, {0, 3, 1}};
  wall.triangles = {{0, 1, 2}};
  wall.material = 0;
  Node node;
  node.meshes = {static_cast<Index>(scene.meshes.size()) - 1};
  const Index placed = scene.add_node(node);
  scene.animation.push_back(
      {placed, AnimatedProperty::translation, Interpolation::linear, {0, 1}, {Vec4(0), Vec4(0.1f, 0, 0, 0)}, 0, 0});
  return scene;
}

CompileOptions options() { return {.width = 16, .height = 16, .accel = AccelChoice::bvh}; }

/// Whether a ray along −Z at that height hits the figure.
bool is_hit(const CompiledScene& scene, float height) {
  return intersect(scene.view().accel, {Vec3(0, height, 5), Vec3(0, 0, -1), kInfinity}, 0).valid();
}

void expect_existing_arrays(const CompiledScene& scene, const WatchedMemory& memory) {
  const SceneView& view = scene.view();
  EXPECT_TRUE(memory.has(view.vertices) && memory.has(view.triangles) && memory.has(view.previous_positions));
  EXPECT_TRUE(memory.has(view.meshes) && memory.has(view.instances));
  EXPECT_TRUE(memory.has(view.materials) && memory.has(view.layers));
  EXPECT_TRUE(memory.has(view.lights.lights) && memory.has(view.lights.previous) && memory.has(view.lights.changed));
  EXPECT_TRUE(memory.has(view.lights.environment.map));
}

void expect_same_view(const CompiledScene& scene, const CompiledScene& expected) {
  for (const float height : {0.05f, 0.5f, 1.0f, 1.5f, 1.95f, 2.2f})
    EXPECT_EQ(is_hit(scene, height), is_hit(expected, height)) << height;
  EXPECT_EQ(scene.view().camera.resolution, expected.view().camera.resolution);
  EXPECT_EQ(scene.view().camera.position, expected.view().camera.position);
  EXPECT_EQ(scene.view().lights.lights.size, expected.view().lights.lights.size);
  EXPECT_EQ(scene.view().lights.environment.width, expected.view().lights.environment.width);
  EXPECT_EQ(scene.view().lights.environment.map.size, expected.view().lights.environment.map.size);
  EXPECT_EQ(scene.view().layers.size, expected.view().layers.size);
  EXPECT_EQ(scene.view().materials[0].emission, expected.view().materials[0].emission);
}

/// Runs `change` while the allocation after `before` others fails. Returns whether one failed.
bool fails(const std::function<void()>& change, WatchedMemory& memory, int before) {
  memory.failing.fail_after(before);
  try {
    change();
  } catch (const std::bad_alloc&) {
  }
  memory.failing.recover();
  return memory.failing.failed();
}

/// Fails each allocation of an update in turn. Then the view must be valid, and the repeated update complete.
void expect_valid_views(const std::function<Change(CompiledScene&)>& update) {
  CompiledScene expected(source(), options());
  update(expected);
  int before = 0;
  for (;; ++before) {
    SCOPED_TRACE(before);
    WatchedMemory memory;
    CompiledScene scene(source(), options(), memory);
    const bool has_failed = fails([&] { update(scene); }, memory, before);
    expect_existing_arrays(scene, memory);
    if (!has_failed) break;
    EXPECT_TRUE(scene.is_stale());
    EXPECT_FALSE(is_hit(scene, 0.5f));
    EXPECT_EQ(scene.view().lights.lights.size, 0u);
    EXPECT_EQ(update(scene), Change::any);
    EXPECT_FALSE(scene.is_stale());
    expect_same_view(scene, expected);
  }
  EXPECT_GT(before, 0) << "the update allocates";
}

TEST(CompiledSceneFailure, OfAnUpdateLeavesAnEmptyScene) {
  Material layered;
  layered.sheen_color = Rgb(0.5f);
  layered.emission = Rgb(1);
  PunctualLight bright;
  bright.intensity = Rgb(5);
  expect_valid_views([&](CompiledScene& scene) { return scene.set_light(0, bright); });
  expect_valid_views([](CompiledScene& scene) { return scene.set_environment(testing::noise_environment(64, 32)); });
  expect_valid_views([&](CompiledScene& scene) { return scene.set_material(0, layered); });
}

TEST(CompiledSceneFailure, OfAnEnvironmentKeepsThePreviousOne) {
  CompiledScene expected(source(), options());
  for (int before = 0;; ++before) {
    SCOPED_TRACE(before);
    WatchedMemory memory;
    CompiledScene scene(source(), options(), memory);
    if (!fails([&] { scene.set_environment(testing::noise_environment(64, 32)); }, memory, before)) break;
    EXPECT_EQ(scene.set_time(0), Change::any);
    expect_same_view(scene, expected);
  }
}

bool fails_to_set_time(CompiledScene& scene, WatchedMemory& memory, int before) {
  const bool has_failed = fails([&] { scene.set_time(1); }, memory, before);
  EXPECT_EQ(scene.is_stale(), has_failed);
  return has_failed;
}

/// Fails each allocation of a change of the time in turn. Then `update` must rebuild the scene of the time before.
void expect_scene_of_one_time(const std::function<void(CompiledScene&)>& update) {
  CompiledScene expected(moving_source(), options());
  update(expected);
  int before = 0;
  for (;; ++before) {
    SCOPED_TRACE(before);
    WatchedMemory memory;
    CompiledScene scene(moving_source(), options(), memory);
    if (!fails_to_set_time(scene, memory, before)) break;
    update(scene);
    EXPECT_FALSE(scene.is_stale());
    expect_existing_arrays(scene, memory);
    expect_same_view(scene, expected);
  }
  EXPECT_GT(before, 0) << "the change allocates";
}

TEST(CompiledSceneFailure, OfAChangeOfTheTimeKeepsThePreviousTime) {
  expect_scene_of_one_time([](CompiledScene& scene) { scene.set_time(0); });
  expect_scene_of_one_time([](CompiledScene& scene) {
    CameraPose camera = scene.camera();
    camera.to_world[3].x += 0.1f;
    scene.set_camera(camera);
  });
  expect_scene_of_one_time([](CompiledScene& scene) { scene.set_resolution(24, 12); });
  expect_scene_of_one_time([](CompiledScene& scene) {
    Node node;
    node.light = scene.add_light({.name = "second bulb"});
    scene.add_node(node);
    scene.commit_edits();
  });
}

TEST(CompiledSceneFailure, OfAnImageSizeKeepsThePreviousOneOfAStaleScene) {
  CompiledScene expected(moving_source(), options());
  int before = 0;
  for (;; ++before) {
    SCOPED_TRACE(before);
    WatchedMemory memory;
    CompiledScene scene(moving_source(), options(), memory);
    ASSERT_TRUE(fails_to_set_time(scene, memory, 0));
    if (!fails([&] { scene.set_resolution(24, 12); }, memory, before)) break;
    EXPECT_EQ(scene.set_time(0), Change::any);
    expect_same_view(scene, expected);
  }
  EXPECT_GT(before, 0) << "the change allocates";
}

TEST(CompiledSceneFailure, OfOpeningMemoryLeavesTheEndOfAFrameToTheNext) {
  PunctualLight bright;
  bright.intensity = Rgb(5);
  int failures = 0;
  for (bool fails = true; fails;) {
    SCOPED_TRACE(failures);
    WatchedMemory memory;
    CompiledScene scene(moving_source(), options(), memory);
    scene.set_time(1);
    scene.set_light(0, bright);
    memory.fail_opening(failures);
    fails = false;
    try {
      scene.end_frame();
    } catch (const std::bad_alloc&) {
      fails = true;
      ++failures;
      scene.end_frame();
    }
    for (const Instance& instance : scene.view().instances)
      EXPECT_EQ(instance.previous_to_world.translation, instance.to_world.translation);
    EXPECT_EQ(scene.view().lights.changed.size, 0u);
    EXPECT_EQ(scene.view().lights.previous.size, scene.view().lights.lights.size);
    for (const Light& light : scene.view().lights.lights) EXPECT_FALSE(light.changed);
  }
  EXPECT_GT(failures, 0);
}

/// Runs kernels on the host, except for one of those that store previous positions.
class FailingLauncher final : public SceneLauncher {
 public:
  /// That after `before` others fails.
  void fail_after(int before) { before_ = before; }

  void run(const DeformVerticesKernel& kernel, uint32_t count) override { host_.run(kernel, count); }
  void run(const StorePreviousPositionsKernel& kernel, uint32_t count) override {
    if (before_-- == 0) throw std::bad_alloc();
    host_.run(kernel, count);
  }

 private:
  SceneLauncher& host_ = host_scene_launcher(Denormals::keep);
  int before_ = -1;
};

std::vector<Vec3> previous_positions(const CompiledScene& scene) {
  const View<const Vec3> positions = scene.view().previous_positions;
  return {positions.begin(), positions.end()};
}

TEST(CompiledSceneFailure, OfTheEndOfAFrameKeepsPreviousPositions) {
  FailingLauncher launcher;
  int failures = 0;
  for (bool fails = true; fails;) {
    SCOPED_TRACE(failures);
    CompiledScene scene(source(), options(), host_memory(), launcher);
    const std::vector<Vec3> before = previous_positions(scene);
    scene.set_time(1);
    launcher.fail_after(failures);
    fails = false;
    try {
      scene.end_frame();
    } catch (const std::bad_alloc&) {
      fails = true;
      ++failures;
      EXPECT_EQ(previous_positions(scene), before);
      launcher.fail_after(-1);
      scene.end_frame();
    }
    EXPECT_NE(previous_positions(scene), before);
  }
  EXPECT_GT(failures, 0);
}

TEST(CompiledSceneFailure, AddsNothing) {
  Material layered;
  layered.sheen_color = Rgb(0.5f);
  const auto add_wall = [&](CompiledScene& scene) {
    Mesh wall;
    wall.positions = {{-1, 2.1f, 1}, {1, 2.1f, 1}, {0, 3, 1}};
    wall.uv1 = {{0, 0}, {1, 0}, {0, 1}};
    wall.colors.assign(3, Vec4(1));
    wall.triangles = {{0, 1, 2}};
    wall.material = scene.add_material(layered);
    return scene.add_mesh(wall);
  };
  const auto place = [](CompiledScene& scene, Index mesh) {
    Node node;
    node.meshes = {mesh};
    scene.add_node(node);
    scene.commit_edits();
  };
  CompiledScene expected(source(), options());
  place(expected, add_wall(expected));
  for (int before = 0;; ++before) {
    SCOPED_TRACE(before);
    WatchedMemory memory;
    CompiledScene scene(source(), options(), memory);
    const size_t materials = scene.source().materials.size();
    const size_t meshes = scene.source().meshes.size();
    const uint32_t vertices = scene.view().vertices.size;
    if (!fails([&] { add_wall(scene); }, memory, before)) break;
    EXPECT_EQ(scene.source().meshes.size(), meshes);
    EXPECT_LE(scene.source().materials.size(), materials + 1) << "that of the mesh may have been added";
    scene.commit_edits();
    expect_existing_arrays(scene, memory);
    EXPECT_EQ(scene.view().vertices.size, vertices);
    EXPECT_EQ(scene.view().materials.size, scene.source().materials.size() + 1);
    const Index mesh = add_wall(scene);
    EXPECT_EQ(mesh, static_cast<Index>(meshes));
    place(scene, mesh);
    EXPECT_TRUE(is_hit(scene, 2.2f));
    for (const float height : {0.05f, 1.0f, 2.2f}) EXPECT_EQ(is_hit(scene, height), is_hit(expected, height)) << height;
  }
}

}  // namespace
}  // namespace relume
