// Scenes and frame buffers in the memory of the CUDA backend, on the stub driver: their content stays on the device.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <memory>
#include <span>

#include "core/array.h"
#include "frame/cuda/cuda_device.h"
#include "framebuffer/buffer_table.h"
#include "kernels.h"
#include "launch_kernel.h"
#include "relume/builtin_scenes.h"
#include "scene/compiled_scene.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::queue;
using testing::StubDriver;

constexpr BufferKey<uint32_t> kCount{"count"};

size_t moves() { return StubDriver::calls("cuMemPrefetchAsync"); }

class CudaSceneTest : public ::testing::Test {
 protected:
  /// A launch: everything that the host has written moves to the device.
  void launch() { queue(*device_, AddKernel{1, number_.mutable_view()}, {0, 0, 1, 1}); }

  StubDriver stub_;
  std::unique_ptr<Device> device_ = open_device(stub_.driver(), testing::test_device_code());
  KernelValue<uint32_t> number_{device_->memory()};
};

/// A thousand glowing triangles in a row: instances and lights take blocks that move as a whole.
Scene many_lamps() {
  Scene scene;
  scene.materials.emplace_back().emission = Rgb(1);
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.material = 0;
  Node node;
  node.meshes = {0};
  for (int i = 0; i < 1000; ++i)
    node.instances.push_back(glm::translate(Mat4(1), Vec3(2 * static_cast<float>(i), 0, 0)));
  scene.add_node(node);
  return scene;
}

TEST_F(CudaSceneTest, AMovingCameraMovesNoMemory) {
  for (const Scene& source : {builtin_scene("cornell-water"), many_lamps()}) {
    const size_t at_first = moves();
    CompiledScene scene(source, {.width = 16, .height = 16, .accel = AccelChoice::bvh}, device_->memory());
    launch();
    EXPECT_GT(moves(), at_first) << "the scene has large blocks";
    device_->finish();
    CameraPose pose = scene.camera();
    for (int i = 0; i < 3; ++i) {
      launch();
      const size_t before = moves();
      pose.to_world[3].x += 0.01f;
      EXPECT_EQ(scene.set_camera(pose), Change::camera);
      launch();
      scene.end_frame();
      launch();
      EXPECT_EQ(moves(), before);
      EXPECT_EQ(scene.view().previous_camera.position, scene.view().camera.position);
    }
  }
}

TEST_F(CudaSceneTest, BuffersAreKeptAndClearedOnTheDevice) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  BufferTable table(kWidth, kHeight, BlockPool::create(device_->memory()));
  Buffer& count = table.add({.id = kCount, .persistent = true});
  const auto add = [&] { queue(*device_, AddKernel{1, count.view<uint32_t>()}, {0, 0, kWidth * kHeight, 1}); };
  EXPECT_TRUE(table.clear_new({}));
  add();
  table.keep();
  const size_t before = moves();
  add();
  table.restore();
  add();
  EXPECT_EQ(moves(), before);
  EXPECT_EQ(StubDriver::calls("cuMemcpyDtoDAsync_v2"), 2u);
  const View<const uint32_t> sums = count.read<uint32_t>();
  EXPECT_TRUE(std::all_of(sums.data, sums.data + sums.size, [](uint32_t sum) { return sum == 2; }));
  add();
  count.clear();
  EXPECT_EQ(count.read<uint32_t>()[5], 0u);
  EXPECT_EQ(StubDriver::calls("cuMemcpyHtoDAsync_v2"), 1u) << "the arguments of launches";
}

}  // namespace
}  // namespace relume::cuda
