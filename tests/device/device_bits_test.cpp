// Tests that device code gives the bits of the host: every technique in every built-in scene while the camera moves, on
// the emulated device and in the host's scalar forms with relume's BVH.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "device/host_and_device.h"
#include "device/kernels.h"
#include "scene/testing/figure.h"
#include "support/scenes.h"
#include "support/technique_checks.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

class DeviceBits : public ::testing::TestWithParam<const BuiltinScene*> {};
TEST_P(DeviceBits, EqualThoseOfTheHost) {
  HostAndDevice sessions(GetParam()->build());
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    EXPECT_TRUE(sessions.agrees(technique)) << technique.name;
  }
}

std::vector<const BuiltinScene*> all_scenes() {
  std::vector<const BuiltinScene*> scenes;
  for (const BuiltinScene& scene : builtin_scenes()) scenes.push_back(&scene);
  return scenes;
}

std::string scene_name(const ::testing::TestParamInfo<const BuiltinScene*>& info) {
  return test_name(std::string(info.param->name));
}

INSTANTIATE_TEST_SUITE_P(Some, DeviceBits, ::testing::Values(find_builtin_scene("cornell-glass")), scene_name);
INSTANTIATE_TEST_SUITE_P(SlowAll, DeviceBits, ::testing::ValuesIn(all_scenes()), scene_name);

/// Kernels also deform the mesh.
TEST(DeviceBitsOfMotion, EqualThoseOfTheHost) {
  HostAndDevice sessions(testing::figure({.morphs = true}));
  for (const float time_s : {0.0f, 0.3f, 0.6f}) {
    for (Session* session : {&sessions.host(), &sessions.on_device()}) {
      session->set_time(time_s);
      session->render_frame();
    }
    EXPECT_EQ(frame_hash(sessions.host()), frame_hash(sessions.on_device())) << time_s;
  }
}

/// Kernels also write the vertices at the keys of the shutter.
TEST(DeviceBitsOfMotion, EqualThoseOfTheHostWithAnOpenShutter) {
  HostAndDevice sessions(in_a_room(testing::figure({.morphs = true})));
  for (const char* estimator : {"path", "bdpt", "light", "vcm"}) {
    const std::string json = R"({"shutter": 0.3, "shutter-keys": 5, "estimator": ")" + std::string(estimator) + "\"}";
    EXPECT_TRUE(sessions.agrees({.name = "motion blur", .json = json}, 0.15f)) << estimator;
  }
}

/// The same in every technique, while the camera moves, too.
TEST(SlowDeviceBitsOfMotion, EqualThoseOfTheHostInEveryTechnique) {
  HostAndDevice sessions(in_a_room(testing::figure({.morphs = true})));
  for (const DeterminismCheck& technique : technique_checks().determinism) {
    EXPECT_TRUE(sessions.agrees(technique, 0.15f)) << technique.name;
  }
}

/// The comparison notices code whose multiply-adds are fused.
TEST(DeviceBitsOfContractedCode, DifferFromTheHost) {
  const DeterminismCheck technique{.name = "reprojection", .json = R"({"history": "reproject"})"};
  const Scene scene = find_builtin_scene("cornell")->build();
  EXPECT_TRUE(HostAndDevice(scene).agrees(technique));
  EXPECT_FALSE(HostAndDevice(scene, {&ptx::contracted, &ptx::all_kernels}).agrees(technique));
}

}  // namespace
}  // namespace relume::support
