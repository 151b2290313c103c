// Sessions on the CUDA backend, on the stub driver: the device code of the library gives the bits of the host, through
// every change of a session, and after errors.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "determinism/same_bits.h"
#include "relume/error.h"
#include "render/session.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using support::bits_of;
using support::build;
using support::checkpoint_file;
using testing::StubDriver;

RenderSettings settings_of(std::string_view device) {
  RenderSettings settings;
  settings.width = 32;
  settings.height = 18;
  settings.threads = 1;
  settings.accel = AccelChoice::bvh;
  settings.auxiliary = true;
  settings.device = device;
  return settings;
}

void render(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) ASSERT_TRUE(session.render_frame());
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device);
    return error.what();
  } catch (const DeviceMemoryError& error) {
    return error.what();
  }
  return "no error";
}

/// A session on the GPU and one on the host.
class CudaSessionTest : public ::testing::Test {
 protected:
  /// The same for both.
  void both(const std::function<void(Session&)>& step) {
    step(gpu_);
    step(host_);
  }
  void expect_same_bits(const std::string& after) { EXPECT_TRUE(bits_of(gpu_) == bits_of(host_)) << after; }

  StubDriver stub_;
  Session gpu_{build("cornell"), settings_of("cuda")};
  Session host_{build("cornell"), settings_of("cpu")};
};

TEST_F(CudaSessionTest, RendersTheBitsOfTheHost) {
  const size_t before = StubDriver::calls("cuLaunchKernel");
  both([](Session& session) { render(session, 3); });
  EXPECT_GT(StubDriver::calls("cuLaunchKernel"), before);
  expect_same_bits("three frames");
  EXPECT_EQ(gpu_.statistics().rays, host_.statistics().rays);
  EXPECT_EQ(gpu_.estimated_error(), host_.estimated_error());
}

TEST_F(CudaSessionTest, LaunchesTheSameFramesAsGraphs) {
  StubDriver::configure("open=1");  // for two sessions
  struct Result {
    std::vector<uint32_t> bits;
    size_t kernels = 0;  ///< that were launched one by one
    size_t graphs = 0;
  };
  const auto result_of = [](Session& session) {
    const size_t kernels = StubDriver::calls("cuLaunchKernel");
    const size_t graphs = StubDriver::calls("cuGraphLaunch");
    render(session, 8);
    return Result{bits_of(session), StubDriver::calls("cuLaunchKernel") - kernels,
                  StubDriver::calls("cuGraphLaunch") - graphs};
  };
  const Result with = result_of(gpu_);
  ::setenv("RELUME_CUDA_GRAPHS", "0", 1);
  Session single(build("cornell"), settings_of("cuda"));
  ::unsetenv("RELUME_CUDA_GRAPHS");
  const Result without = result_of(single);
  EXPECT_GT(with.graphs, 0u);
  EXPECT_EQ(without.graphs, 0u);
  EXPECT_LT(with.kernels, without.kernels);
  EXPECT_TRUE(with.bits == without.bits);
}

TEST_F(CudaSessionTest, ChangesTheSizeOfTheImage) {
  for (const int width : {48, 20}) {
    both([&](Session& session) {
      RenderSettings settings = render_settings(session);
      settings.width = width;
      ASSERT_TRUE(session.set_settings(settings));
      render(session, 2);
    });
    expect_same_bits(std::to_string(width));
  }
}

TEST_F(CudaSessionTest, FollowsEditsOfTheScene) {
  both([](Session& session) {
    render(session, 1);
    Material material = build("cornell").materials.front();
    material.emission = Rgb(0.5f, 0.25f, 1.0f);
    session.set_material(0, material);
    render(session, 1);
  });
  expect_same_bits("a material");
  std::map<const Session*, NodeHandle> nodes;
  both([&](Session& session) {
    Mesh mesh;
    mesh.positions = {{-0.3f, 0, 0}, {0.3f, 0, 0}, {0, 0.3f, 0}};
    mesh.triangles = {{0, 1, 2}};
    mesh.material = 0;
    Node node;
    node.meshes = {session.add_mesh(mesh).index};
    node.matrix = session.camera().to_world;
    (*node.matrix)[3] -= 2.0f * session.camera().to_world[2];
    nodes[&session] = session.add_node(node);
    render(session, 2);
  });
  expect_same_bits("a new node");
  both([&](Session& session) {
    session.remove(nodes[&session]);
    render(session, 1);
  });
  expect_same_bits("a node that is removed");
}

/// Stops a frame before a band of the launch of the given name.
void expect_stop(Session& session, std::string_view launch, int stopped_band) {
  std::stop_source source;
  std::string name;
  int bands = 0;
  on_launch(session, [&](const LaunchEvent& event) {
    if (event.kind == LaunchEvent::Kind::begins) name = event.name;
  });
  on_tile(session, [&] {
    if (name == launch && ++bands == stopped_band) source.request_stop();
  });
  EXPECT_FALSE(session.render_frame(source.get_token())) << launch << ", " << stopped_band;
  on_tile(session, {});
  on_launch(session, {});
}

TEST_F(CudaSessionTest, StopsInTheMiddleOfAFrame) {
  StubDriver::configure("microseconds=50");  // images have several bands
  both([](Session& session) { render(session, 1); });
  for (const char* launch : {"gbuffer", "trace"}) {
    for (const int band : {1, 3}) {
      expect_stop(gpu_, launch, band);
      both([](Session& session) { render(session, 1); });
      expect_same_bits(std::string(launch) + " was stopped in band " + std::to_string(band));
    }
  }
}

TEST_F(CudaSessionTest, ContinuesFromCheckpointsOfBothDevices) {
  const std::filesystem::path file = checkpoint_file("cuda_session");
  for (Session* saved : {&gpu_, &host_}) {
    render(*saved, 2);
    saved->save_checkpoint(file);
    both([&](Session& session) {
      session.load_checkpoint(file);
      render(session, 2);
    });
    expect_same_bits(saved == &gpu_ ? "a checkpoint of the GPU" : "a checkpoint of the host");
  }
  std::filesystem::remove(file);
}

TEST_F(CudaSessionTest, StaysAfterAnAllocationThatFails) {
  both([](Session& session) { render(session, 1); });
  StubDriver::configure("fail=cuMemAllocManaged:1:2 fail=cuMemAllocManaged:2:2");  // it is tried again
  RenderSettings larger = settings_of("cuda");
  larger.width = 64;
  const std::string error = error_of([&] { gpu_.set_settings(larger); });
  EXPECT_NE(error.find("failed: CUDA_ERROR_OUT_OF_MEMORY"), std::string::npos) << error;
  both([](Session& session) { render(session, 1); });
  expect_same_bits("an allocation that failed");
}

TEST_F(CudaSessionTest, ReportsTheLossOfTheGpu) {
  both([](Session& session) { render(session, 1); });
  EXPECT_FALSE(device_is_lost(gpu_));
  EXPECT_FALSE(device_is_lost(host_));
  StubDriver::configure("lose=3");
  const std::string lost = error_of([&] { gpu_.render_frame(); });
  EXPECT_NE(lost.find("failed in or after the launch of '"), std::string::npos) << lost;
  EXPECT_TRUE(device_is_lost(gpu_));
  EXPECT_EQ(error_of([&] { gpu_.render_frame(); }), lost);
  EXPECT_EQ(error_of([&] { gpu_.image(); }), lost);
  EXPECT_EQ(error_of([&] { gpu_.save_checkpoint(checkpoint_file("lost")); }), lost);
  EXPECT_FALSE(std::filesystem::exists(checkpoint_file("lost")));
  render(host_, 1);
}

/// With memory that stays open: one session may access its own while the launches of another are queued.
TEST(CudaSessions, ShareAGpu) {
  const StubDriver stub("open=1");
  const auto bits = [](const char* scene, std::string_view device) {
    Session session(build(scene), settings_of(device));
    for (int i = 0; i < 3; ++i) session.render_frame();
    return bits_of(session);
  };
  const std::vector<const char*> scenes = {"cornell", "cornell-glass"};
  for (const char* scene : scenes) build(scene);
  std::vector<std::future<std::vector<uint32_t>>> on_gpu;
  for (const char* scene : scenes) on_gpu.push_back(std::async(std::launch::async, bits, scene, "cuda"));
  for (size_t i = 0; i < scenes.size(); ++i) EXPECT_TRUE(on_gpu[i].get() == bits(scenes[i], "cpu")) << scenes[i];
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(StubDriver::objects("leaked"), 0u);
}

}  // namespace
}  // namespace relume::cuda
